//! Voids of any shape: unions of convex bodies, some with solid islands inside, in a grid of cells.
//!
//! A convex body is what some half-spaces and quadrics have in common, so that a ray is in it along
//! one interval, known exactly. Bodies of voids may overlap: a ray that leaves one goes on in the
//! next until none holds it. Where a ray is follows from the element it starts on, never from the
//! sign of a distance there, so that rounding can move a hit but not lose one.

mod chord;
#[cfg(target_arch = "x86_64")]
mod lanes;
mod met;
mod shape;

pub(super) use shape::Shape;

use super::cells::Cells;
use super::convex::{Convex, Plane, Quadric, holds};
use super::grid::Grid;
use super::section::nearest_image;
use chord::{OneByOne, Slabs};
use glam::DVec3;
use met::Met;
use std::ops::Range;

/// A convex body in the store.
#[derive(Clone, Debug)]
struct Body {
    center: DVec3,
    /// Square of the radius of a ball about the center that holds it.
    reach2: f64,
    planes: Range<u32>,
    quadrics: Range<u32>,
    /// Its planes by eights, if it has so many that this is faster.
    #[cfg(target_arch = "x86_64")]
    eights: Range<u32>,
    island: bool,
}

/// The bodies of one period. A face is known by its place among all planes, then among all quadrics.
#[derive(Clone, Debug)]
pub(super) struct Bodies {
    period: f64,
    bodies: Vec<Body>,
    planes: Vec<Plane>,
    quadrics: Vec<Quadric>,
    /// The bodies that planes and quadrics belong to.
    owners: [Vec<u32>; 2],
    #[cfg(target_arch = "x86_64")]
    eights: lanes::Eights,
    grid: Grid,
    /// Whether some bodies overlap, and whether some are islands.
    unions: bool,
    islands: bool,
    /// The same bodies as cells that fill the medulla, for those that come so: much faster.
    cells: Option<Box<Cells>>,
}

/// Mark of a quadric in the number of a face.
const QUADRIC: u32 = 1 << 31;
/// Hops shorter than this are none: where two bodies' faces cross, micrometers.
const LEAST_UM: f64 = 1e-9;
/// Bodies that a ray passes without leaving their union, at most.
const MOST_LINKS: u32 = 10_000;

impl Bodies {
    /// * `half`: half-widths across of a box about the axis that holds all bodies.
    /// * `unions`: whether bodies overlap.
    ///
    /// Every body must be shorter than half the period, so that one image is the nearest.
    pub(super) fn new(convex: Vec<Convex>, period: f64, half: [f64; 2], unions: bool) -> Self {
        let mean = convex.iter().map(|c| c.half).sum::<DVec3>() / convex.len().max(1) as f64;
        let boxes: Vec<(DVec3, DVec3)> = convex
            .iter()
            .map(|c| (c.center - c.half, c.center + c.half))
            .collect();
        // With cells twice as wide more bodies are tested: a twentieth of a hare's bake.
        let size = (0.7 * mean).clamp(DVec3::splat(0.2), DVec3::splat(0.25 * period));
        let grid = Grid::new(half, period, size, &boxes, |index, lo, hi| {
            convex[index].may_touch(lo, hi)
        });
        let mut store = Self {
            period,
            islands: convex.iter().any(|c| c.island),
            bodies: Vec::with_capacity(convex.len()),
            planes: Vec::new(),
            quadrics: Vec::new(),
            owners: [Vec::new(), Vec::new()],
            #[cfg(target_arch = "x86_64")]
            eights: lanes::Eights::new(),
            grid,
            unions,
            cells: None,
        };
        for (index, c) in convex.into_iter().enumerate() {
            let (p, q) = (store.planes.len() as u32, store.quadrics.len() as u32);
            store.planes.extend(&c.planes);
            store.quadrics.extend(&c.quadrics);
            store.owners[0].resize(store.planes.len(), index as u32);
            store.owners[1].resize(store.quadrics.len(), index as u32);
            store.bodies.push(Body {
                center: c.center,
                // A little more for the digits that a difference of squares loses.
                reach2: c.reach2() + 1e-6,
                planes: p..store.planes.len() as u32,
                quadrics: q..store.quadrics.len() as u32,
                #[cfg(target_arch = "x86_64")]
                eights: store.eights.add(&c.planes),
                island: c.island,
            });
        }
        store
    }

    /// Lets rays go from cell to cell. The voids in the cells must be these bodies.
    pub(super) fn with_cells(self, cells: Option<Cells>) -> Self {
        Self {
            cells: cells.map(Box::new),
            ..self
        }
    }

    /// Whether rays go from cell to cell.
    pub(super) fn fill(&self) -> bool {
        self.cells.is_some()
    }

    /// The cells from which to which rays go.
    #[cfg(target_arch = "x86_64")]
    pub(super) fn cells(&self) -> Option<&Cells> {
        self.cells.as_deref()
    }

    /// Number of bodies.
    pub(super) fn len(&self) -> usize {
        self.bodies.len()
    }

    #[inline]
    fn owner(&self, face: u32) -> u32 {
        self.owners[(face >> 31) as usize][(face & !QUADRIC) as usize]
    }

    #[inline]
    fn planes_of(&self, body: &Body) -> &[Plane] {
        &self.planes[body.planes.start as usize..body.planes.end as usize]
    }

    #[inline]
    fn quadrics_of(&self, body: &Body) -> &[Quadric] {
        &self.quadrics[body.quadrics.start as usize..body.quadrics.end as usize]
    }

    /// Center of the image of a body that is nearest in z.
    #[inline]
    fn center_near(&self, body: &Body, z: f64) -> DVec3 {
        nearest_image(body.center, z, self.period)
    }

    /// First void that a ray in keratin enters in `t0..t1`, by the face, or the face of the island that
    /// it leaves.
    ///
    /// * `from`: the face that the ray starts on.
    pub(super) fn enter(
        &self,
        origin: DVec3,
        dir: DVec3,
        t0: f64,
        t1: f64,
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        if let Some(cells) = &self.cells {
            return cells.enter(origin, dir, t0, t1, from);
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(set) = self.eights.set() {
            return self.enter_in_lanes(set, (origin, dir), (t0, t1), from);
        }
        self.enter_by(OneByOne, (origin, dir), (t0, t1), from)
    }

    #[inline(always)]
    fn enter_by(
        &self,
        slabs: impl Slabs,
        (origin, dir): (DVec3, DVec3),
        (t0, t1): (f64, f64),
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        let start = from.map(|face| self.owner(face));
        if self.islands {
            let within = match start {
                Some(index) => self.bodies[index as usize].island.then_some(index),
                None => self.find(origin, true),
            };
            if let Some(index) = within {
                return match self.chord(slabs, index, origin, dir, origin.z, from) {
                    Some(chord) => Some((chord.leave.max(0.0), chord.leave_face)),
                    // A ray that only touches leaves where it is.
                    None => from.map(|face| (0.0, face)),
                };
            }
        }
        let mut met = Met::new(self.period);
        let mut best: Option<(f64, u32)> = None;
        self.grid.walk(
            origin,
            dir,
            t0,
            t1,
            #[inline(always)]
            |members, z| {
                for &index in members {
                    // A convex body that has been left is not met again.
                    if met.before(index, z)
                        || Some(index) == start && self.is_here(index, origin.z, z)
                        || self.bodies[index as usize].island
                    {
                        continue;
                    }
                    let Some(chord) = self.chord(slabs, index, origin, dir, z, None) else {
                        continue;
                    };
                    let t = chord.enter.max(t0);
                    if t < t1 && chord.leave > t + LEAST_UM && best.is_none_or(|(b, _)| t < b) {
                        best = Some((t, chord.enter_face));
                    }
                }
                best
            },
        )
    }

    /// Where a ray in a void leaves it, and the face.
    ///
    /// * `from`: the face that the ray starts on.
    pub(super) fn leave(&self, origin: DVec3, dir: DVec3, from: Option<u32>) -> Option<(f64, u32)> {
        if let Some(cells) = &self.cells {
            return cells.leave(origin, dir, from);
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(set) = self.eights.set() {
            return self.leave_in_lanes(set, origin, dir, from);
        }
        self.leave_by(OneByOne, origin, dir, from)
    }

    #[inline(always)]
    fn leave_by(
        &self,
        slabs: impl Slabs,
        origin: DVec3,
        dir: DVec3,
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        let start = from.map(|face| self.owner(face));
        let (first, on) = match start {
            Some(index) if !self.bodies[index as usize].island => (index, from),
            _ => (self.find(origin, false)?, None),
        };
        let mut end = match self.chord(slabs, first, origin, dir, origin.z, on) {
            Some(chord) => (chord.leave.max(0.0), chord.leave_face),
            // A ray that only touches leaves where it is.
            None => (0.0, on?),
        };
        if self.unions {
            end = self.follow(slabs, origin, dir, end);
        }
        if self.islands {
            let island = self.grid.walk(
                origin,
                dir,
                0.0,
                end.0,
                #[inline(always)]
                |members, z| {
                    let mut best: Option<(f64, u32)> = None;
                    for &index in members {
                        if Some(index) == start && self.is_here(index, origin.z, z)
                            || !self.bodies[index as usize].island
                        {
                            continue;
                        }
                        if let Some(chord) = self.chord(slabs, index, origin, dir, z, None)
                            && chord.leave > 0.0
                            && best.is_none_or(|(b, _)| chord.enter < b)
                        {
                            best = Some((chord.enter.max(0.0), chord.enter_face));
                        }
                    }
                    best
                },
            );
            return island.filter(|hit| hit.0 < end.0).or(Some(end));
        }
        Some(end)
    }

    /// From the end of a chord through all bodies that hold the ray there.
    #[inline(always)]
    fn follow(
        &self,
        slabs: impl Slabs,
        origin: DVec3,
        dir: DVec3,
        mut end: (f64, u32),
    ) -> (f64, u32) {
        for _ in 0..MOST_LINKS {
            let p = origin + end.0 * dir;
            let (mut next, last) = (end, self.owner(end.1));
            for &index in self.grid.around(p) {
                if self.bodies[index as usize].island || index == last {
                    continue;
                }
                if let Some(chord) = self.chord(slabs, index, origin, dir, p.z, None)
                    && chord.enter <= end.0
                    && chord.leave > next.0 + LEAST_UM
                {
                    next = (chord.leave, chord.leave_face);
                }
            }
            if next == end {
                break;
            }
            end = next;
        }
        end
    }

    /// Whether the images of a body nearest to two places are the same.
    fn is_here(&self, index: u32, z0: f64, z1: f64) -> bool {
        let body = &self.bodies[index as usize];
        self.center_near(body, z0).z == self.center_near(body, z1).z
    }

    /// The void body that holds a point.
    pub(super) fn at(&self, p: DVec3) -> Option<u32> {
        if self.islands && self.find(p, true).is_some() {
            return None;
        }
        self.find(p, false)
    }

    fn find(&self, p: DVec3, island: bool) -> Option<u32> {
        self.grid.around(p).iter().copied().find(|&index| {
            let body = &self.bodies[index as usize];
            let q = p - self.center_near(body, p.z);
            body.island == island && holds(q, self.planes_of(body), self.quadrics_of(body))
        })
    }

    /// Outward normal of a face at a point, of any length.
    pub(super) fn gradient(&self, face: u32, p: DVec3) -> DVec3 {
        if let Some(cells) = &self.cells {
            return cells.gradient(face, p);
        }
        let index = (face & !QUADRIC) as usize;
        if face & QUADRIC == 0 {
            return self.planes[index].normal;
        }
        let body = &self.bodies[self.owner(face) as usize];
        let quadric = &self.quadrics[index];
        let q = p - self.center_near(body, p.z) - quadric.center;
        quadric.map.transpose() * (quadric.map * q)
    }
}
