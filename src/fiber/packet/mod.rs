//! Rays eight at a time: [`Fiber::next_hit`] lane by lane, with the same bits. What is rare is not done
//! here but left to the search for one ray.

mod cells;
mod march;
mod pigment;
mod quadratic;
mod rays;
mod state;

pub(super) use cells::Shell;

use super::cells::Sixteens;
use super::cortex::Pigment;
use super::march::Side;
use super::scales::Scales;
use super::section::Section;
use super::surface::Surface;
use super::{Element, Fiber, HitState, Region};
use crate::math::lanes::{F64x8, Mask, U64x8, Vectors, Wide};
use cells::{Cells, at};
use glam::DVec3;
use march::{Marched, StartOn, march};
use rays::UnitRays;
use state::{FACE, RISER, RISER_OF_LOWER};

/// Eight rays and what each starts on, as of [`HitState::bits`].
#[derive(Clone, Copy)]
pub(crate) struct Rays<W: Wide> {
    pub(crate) lanes: Mask<W>,
    pub(crate) origin: Vectors<W>,
    pub(crate) dir: Vectors<W>,
    pub(crate) from: U64x8<W>,
}

/// What eight rays came to. Those in neither mask are left to [`Fiber::next_hit`].
pub(crate) struct Hits<W: Wide> {
    /// Those that met the outer surface.
    pub(crate) met: Mask<W>,
    /// Those that meet none of it where it was looked for.
    pub(crate) through: Mask<W>,
    pub(crate) riser: Mask<W>,
    pub(crate) t: F64x8<W>,
    /// Unit normals, against the rays.
    pub(crate) normal: Vectors<W>,
    /// States to go on from.
    pub(crate) state: U64x8<W>,
}

/// Where rays in the cortex are on the circle within all scales and on the one around all.
struct Within<W: Wide> {
    from: F64x8<W>,
    to: F64x8<W>,
    /// Those that are within all scales now or later.
    inner: Mask<W>,
    /// The way to the circle around all.
    leave: F64x8<W>,
}

/// The outer surface of a fiber, for rays eight at a time.
#[derive(Clone, Copy)]
pub(crate) struct PacketShell<'a, W> {
    simd: W,
    section: &'a Section,
    scales: &'a Scales,
    pigment: &'a Pigment,
    /// Whether the medulla is in pieces.
    pieces: bool,
}

impl<'a, W: Wide> PacketShell<'a, W> {
    /// Rays from far away: where they enter the fiber, or that they miss it.
    #[inline(always)]
    pub(crate) fn arrive(&self, rays: &Rays<W>) -> Hits<W> {
        let (simd, scales) = (self.simd, self.scales);
        let zero = simd.all(0.0);
        // Far origins cost digits: start beside the axis, on the way in.
        let far = UnitRays::new(self.section, rays.origin, rays.dir);
        let ahead = (-far.b / far.a).max(zero).or(far.a.gt(zero), zero);
        let ahead = (ahead - 2.0 * scales.rho_max / far.a.sqrt()).max(zero);
        let near = Rays {
            origin: rays.origin.plus(rays.dir.times(ahead)),
            ..*rays
        };
        let unit = UnitRays::new(self.section, near.origin, near.dir);
        let (t0, limit, lanes, gone) = self.outside(rays.lanes, &unit);
        let lanes = lanes & !far.axial(simd);
        let (t0, start) = self.locate(&unit, lanes, t0);
        let marched = march(simd, lanes, &unit, t0, start, Side::Outside, limit);
        let mut hits = self.hits(&near, marched);
        hits.t = hits.t + ahead;
        hits.through = hits.through | gone;
        hits
    }

    /// Where rays outside may meet the shell: from, to, those that do, and those that surely do not.
    #[inline(always)]
    fn outside(
        &self,
        lanes: Mask<W>,
        unit: &UnitRays<W>,
    ) -> (F64x8<W>, F64x8<W>, Mask<W>, Mask<W>) {
        let (simd, scales) = (self.simd, self.scales);
        let zero = simd.all(0.0);
        let sure = lanes & !unit.axial(simd);
        let (t0, t1, near) = unit.inside_circle(simd, scales.rho_max);
        let gone = sure & !(near & t1.gt(zero));
        let t0 = t0.max(zero);
        let (inner, _, within) = unit.inside_circle(simd, scales.rho_min);
        let limit = inner.or(within & inner.gt(t0), t1);
        (t0, limit, sure & !gone, gone)
    }

    /// What follows from ways to the walls of voids.
    ///
    /// * `gradient`: in the unit-circle frame.
    #[inline(always)]
    pub(crate) fn void_hits(
        &self,
        rays: &Rays<W>,
        t: F64x8<W>,
        gradient: Vectors<W>,
        state: U64x8<W>,
    ) -> Hits<W> {
        Hits {
            met: rays.lanes,
            through: self.simd.none(),
            riser: self.simd.none(),
            t,
            normal: self.normal_against(gradient, rays.dir),
            state,
        }
    }

    /// Pigment along rays in the cortex, and the lanes in which it is known. See [`Fiber::pigment_um`].
    #[inline(always)]
    pub(crate) fn pigment_um(
        &self,
        rays: &Rays<W>,
        lanes: Mask<W>,
        t: F64x8<W>,
    ) -> (F64x8<W>, Mask<W>) {
        if self.pieces {
            return (t, self.simd.none());
        }
        let unit = UnitRays::new(self.section, rays.origin, rays.dir);
        self.pigment.along_rays(self.simd, lanes, &unit, t)
    }

    /// Rays outside that start on the surface: what they meet of it, or that they leave it.
    #[inline(always)]
    pub(crate) fn enter(&self, rays: &Rays<W>) -> Hits<W> {
        let unit = UnitRays::new(self.section, rays.origin, rays.dir);
        let (t0, limit, lanes, gone) = self.outside(rays.lanes, &unit);
        let start = self.start(&unit, t0, rays.from, Side::Outside);
        let marched = march(self.simd, lanes, &unit, t0, start, Side::Outside, limit);
        let mut hits = self.hits(rays, marched);
        hits.through = hits.through | gone;
        hits
    }

    /// Rays in the cortex that start on the surface: what they meet of it before they are within all
    /// scales.
    #[inline(always)]
    pub(crate) fn inward(&self, rays: &Rays<W>) -> Hits<W> {
        let (simd, scales) = (self.simd, self.scales);
        let zero = simd.all(0.0);
        let unit = UnitRays::new(self.section, rays.origin, rays.dir);
        let Within {
            from, inner, leave, ..
        } = self.within(&unit);
        let limit = from.max(zero).or(inner, leave);
        let in_shell = unit.c.ge(simd.all(scales.rho_min * scales.rho_min)) | !inner;
        let lanes = rays.lanes & in_shell & !unit.axial(simd);
        let start = self.start(&unit, zero, rays.from, Side::Inside);
        let marched = march(simd, lanes, &unit, zero, start, Side::Inside, limit);
        let mut hits = self.hits(rays, marched);
        hits.through = hits.through & inner;
        hits
    }

    /// Rays in the cortex that meet nothing within all scales: where they meet the surface.
    #[inline(always)]
    pub(crate) fn outward(&self, rays: &Rays<W>) -> Hits<W> {
        let simd = self.simd;
        let unit = UnitRays::new(self.section, rays.origin, rays.dir);
        let Within {
            to, inner, leave, ..
        } = self.within(&unit);
        let lanes = rays.lanes & inner & !unit.axial(simd);
        let (to, start) = self.locate(&unit, lanes, to);
        let limit = leave.max(to);
        let marched = march(simd, lanes, &unit, to, start, Side::Inside, limit);
        let mut hits = self.hits(rays, marched);
        hits.through = self.simd.none();
        hits
    }

    /// Where rays in the cortex are within all scales, and where they leave the shell.
    #[inline(always)]
    fn within(&self, unit: &UnitRays<W>) -> Within<W> {
        let (simd, scales) = (self.simd, self.scales);
        let zero = simd.all(0.0);
        let (from, to, within) = unit.inside_circle(simd, scales.rho_min);
        let (_, end, near) = unit.inside_circle(simd, scales.rho_max);
        Within {
            from,
            to,
            inner: within & to.gt(zero),
            leave: end.max(zero).or(near, zero),
        }
    }

    /// The cells that rays come to from elsewhere at `t`. Lanes that are not asked for look at a place that exists.
    #[inline(always)]
    fn locate(
        &self,
        unit: &UnitRays<W>,
        lanes: Mask<W>,
        t: F64x8<W>,
    ) -> (F64x8<W>, (Cells<'a, W>, StartOn<W>)) {
        let t = t.or(lanes, self.simd.all(0.0));
        let cells = Cells::locate(self.simd, self.scales, unit.at(t));
        (t, (cells, StartOn::nothing(self.simd)))
    }

    /// The cells in which rays start, and what of these the start lies on. See `Scales::start`.
    #[inline(always)]
    fn start(
        &self,
        unit: &UnitRays<W>,
        t: F64x8<W>,
        from: U64x8<W>,
        side: Side,
    ) -> (Cells<'a, W>, StartOn<W>) {
        let (simd, scales) = (self.simd, self.scales);
        let low = simd.all_bits(0xffff);
        let kind = from.right::<32>();
        let face = kind.is(simd.all_bits(FACE));
        let riser = kind.is(simd.all_bits(RISER));
        let riser_of_lower = kind.is(simd.all_bits(RISER_OF_LOWER));
        let mut cells = Cells::new(simd, scales, from.and(low), from.right::<16>().and(low));
        let p = unit.at(t);
        let u = cells.across(p);
        let end = at(cells.end, u);
        let middle = 0.5 * (end + at(cells.begin, u));
        let z = middle.or(face, end);
        cells.shift = scales.period * ((p.z - z) / scales.period + 0.5).floor();
        let (upper, lower) = match side {
            Side::Outside => (riser, riser_of_lower),
            Side::Inside => (riser_of_lower, riser),
        };
        if lower.any() {
            cells.up(lower);
            cells.look_up_strips();
        }
        (cells, StartOn { face, lower, upper })
    }

    /// See [`Section::normal_against`].
    #[inline(always)]
    fn normal_against(&self, gradient: Vectors<W>, dir: Vectors<W>) -> Vectors<W> {
        let [ia, ib] = self.section.inverse;
        let n = Vectors::new(gradient.x * ia, gradient.y * ib, gradient.z);
        let n = n.normalized();
        let turned = n.dot(dir).gt(self.simd.all(0.0));
        n.times(self.simd.all(-1.0)).or(turned, n)
    }

    #[inline(always)]
    fn hits(&self, rays: &Rays<W>, marched: Marched<W>) -> Hits<W> {
        let simd = self.simd;
        let Marched {
            t,
            gradient,
            sector,
            strip,
            face,
            riser,
            solid_below,
            through,
        } = marched;
        let kind = simd.all_bits(RISER_OF_LOWER).or(
            solid_below,
            simd.all_bits(RISER).or(riser, simd.all_bits(FACE)),
        );
        Hits {
            met: face | riser,
            through,
            riser,
            t,
            normal: self.normal_against(gradient, rays.dir),
            state: sector.plus(strip.left::<16>()).plus(kind.left::<32>()),
        }
    }
}

impl Fiber {
    /// Its outer surface for rays eight at a time, where [`Fiber::has_packets`].
    pub(crate) fn packet_shell<W: Wide>(&self, simd: W) -> Option<PacketShell<'_, W>> {
        match &self.surface {
            Surface::Scales(scales) if self.has_packets() => Some(PacketShell {
                simd,
                section: &self.section,
                scales,
                pigment: &self.pigment,
                pieces: self.medulla.pieces.is_some(),
            }),
            _ => None,
        }
    }

    /// Whether a ray in the cortex may meet anything but the outer surface.
    pub(crate) fn has_voids(&self) -> bool {
        self.medulla.ratio > 0.0
    }

    /// The next wall of a void along a ray in one (`inside`) or in the cortex, there only if nothing of the outer surface
    /// comes before: the way, the gradient in the unit-circle frame and the state to go on from.
    #[inline(always)]
    pub(crate) fn next_void<W: Wide>(
        &self,
        origin: DVec3,
        dir: DVec3,
        from: HitState,
        inside: bool,
        simd: W,
    ) -> Option<(f64, DVec3, HitState)> {
        let rays = super::medulla::Rays {
            origin,
            dir,
            unit: self.section.unit_ray(origin, dir),
        };
        let from = match from.element {
            Element::Void(index) => Some(index),
            _ => None,
        };
        let (t, index) = if inside {
            match self.medulla.cells() {
                Some(cells) => cells.leave_by(Sixteens(simd), origin, dir, from)?,
                None => self.medulla.leave_void(&rays, from)?,
            }
        } else {
            let (t0, t1) = match from {
                Some(_) => (0.0, f64::INFINITY),
                None => {
                    let (t0, t1) = rays.unit.inside_circle(self.surface.rho_min())?;
                    (t0.max(0.0), t1)
                }
            };
            match self.medulla.cells() {
                Some(cells) => cells.enter_by(Sixteens(simd), (origin, dir), t0, t1, from)?,
                None => self.medulla.enter_void(&rays, t0, t1, from)?,
            }
        };
        let point = origin + t * dir;
        let gradient = self.medulla.void_gradient(&self.section, point, index);
        let element = Element::Void(index);
        Some((t, gradient, HitState { element }))
    }

    /// Whether the way through keratin is what counts of it, as pigment is alike all over it.
    pub(crate) fn has_even_pigment(&self) -> bool {
        self.pigment.is_plain()
    }

    /// Whether rays of it can be traced eight at a time: scales on an elliptic section, voids of air or none.
    pub(crate) fn has_packets(&self) -> bool {
        self.triangles.is_none()
            && self.fusi.is_none()
            && self.section.is_ellipse()
            && matches!(self.surface, Surface::Scales(_))
            && !self.medulla.outlined()
            && self.medulla.fill() == Region::Void
    }
}
