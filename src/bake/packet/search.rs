//! From boundary to boundary.

use super::super::entry::ENTRY_TRIES;
use super::super::{End, Flight};
use super::flock::{Flock, line};
use super::ways::{Group, Next};
use crate::fiber::{Hits, Rays, Region};
use crate::math::lanes::{F64x8, LANES, Mask, Row, Vectors, Wide};
use crate::table::PHOTON;
use glam::DVec3;

/// Lines and boundaries of photons at a boundary, a photon each.
struct Went<W: Wide> {
    lines: [F64x8<W>; LANES],
    mets: [F64x8<W>; LANES],
}

impl<W: Wide> Flock<'_, W> {
    /// From far away to the fiber.
    #[inline(always)]
    pub(super) fn enter(
        &mut self,
        group: &Group,
        forked: bool,
        book: &mut impl FnMut(u64, Flight),
    ) {
        let rays = self.rays(group);
        let hits = self.packets.shell.arrive(&rays);
        let went = self.go(&rays, group, &hits, 0);
        for (lane, id) in group.members() {
            let way = &mut self.ways[id];
            if hits.met.has(lane) {
                (way.line, way.met) = (went.lines[lane].row(), went.mets[lane].row());
                self.entered(id, forked);
                continue;
            }
            let fiber = self.packets.fiber;
            let (p, dir) = (way.place(), way.dir());
            if !hits.through.has(lane)
                && let Some(hit) = fiber.next_hit(p, dir, Region::Outside, None)
            {
                way.go(p, dir, &hit);
                self.entered(id, forked);
                continue;
            }
            way.tries += 1;
            if way.tries >= ENTRY_TRIES {
                let missed = way.entry.missed();
                self.free.push(id);
                book(PHOTON, missed);
                continue;
            }
            let mut rng = way.rng();
            let across = 2.0 * rng.uniform() - 1.0;
            let origin = way.entry.origin(fiber, across, &mut rng);
            way.line = line(origin, dir, &rng);
            self.lists.push(Next::Enter, id);
        }
    }

    /// Through the shell of scales.
    #[inline(always)]
    pub(super) fn shell(&mut self, group: &Group, kind: Next, book: &mut impl FnMut(u64, Flight)) {
        let rays = self.rays(group);
        let shell = &self.packets.shell;
        let (region, first_side, hits) = match kind {
            Next::Outside => (Region::Outside, 0, shell.enter(&rays)),
            Next::Inward => (Region::Cortex, 1, shell.inward(&rays)),
            _ => (Region::Cortex, 1, shell.outward(&rays)),
        };
        let went = self.go(&rays, group, &hits, first_side);
        let pigment = match region {
            Region::Cortex => self.pigment_um(&rays, hits.met, hits.t).row(),
            _ => Row::default(),
        };
        for (lane, id) in group.members() {
            let way = &mut self.ways[id];
            if hits.met.has(lane) {
                if way.events >= self.max_events {
                    self.end(id, End::Truncated, book);
                    continue;
                }
                way.path_um += pigment.0[lane];
                (way.line, way.met) = (went.lines[lane].row(), went.mets[lane].row());
                self.meets(id);
            } else if !hits.through.has(lane) {
                self.search(id, region, book);
            } else if region == Region::Cortex {
                let next = match self.packets.has_voids {
                    true => Next::Core,
                    false => Next::Outward,
                };
                self.lists.push(next, id);
            } else {
                let end = End::Escaped(way.dir());
                self.end(id, end, book);
            }
        }
    }

    /// Into voids or out of them: the search is that of single rays, what follows is not.
    #[inline(always)]
    pub(super) fn void(&mut self, group: &Group, inside: bool, book: &mut impl FnMut(u64, Flight)) {
        let simd = self.packets.simd;
        let (mut met, mut t) = (0, Row::default());
        let (mut gradients, mut states) = ([Row::default(); 3], Row::default());
        for (lane, id) in group.members() {
            let way = &self.ways[id];
            if way.events >= self.max_events {
                self.end(id, End::Truncated, book);
                continue;
            }
            let found =
                self.packets
                    .fiber
                    .next_void(way.place(), way.dir(), way.state(), inside, simd);
            match found {
                Some((way, gradient, state)) => {
                    met |= 1 << lane;
                    t.0[lane] = way;
                    states.0[lane] = f64::from_bits(state.bits());
                    for (row, part) in gradients.iter_mut().zip(gradient.to_array()) {
                        row.0[lane] = part;
                    }
                }
                None if inside => self.search(id, Region::Void, book),
                None => self.lists.push(Next::Outward, id),
            }
        }
        if met == 0 {
            return;
        }
        let rays = Rays {
            lanes: simd.lanes(met),
            ..self.rays(group)
        };
        let gradient = Vectors::new(
            simd.load(&gradients[0]),
            simd.load(&gradients[1]),
            simd.load(&gradients[2]),
        );
        let (t, state) = (simd.load(&t), simd.load(&states).bits());
        let hits = self.packets.shell.void_hits(&rays, t, gradient, state);
        let went = self.go(&rays, group, &hits, if inside { 5 } else { 4 });
        let pigment = match inside {
            true => Row::default(),
            false => self.pigment_um(&rays, rays.lanes, t).row(),
        };
        for lane in rays.lanes.lanes() {
            let id = group.ids[lane];
            let way = &mut self.ways[id];
            way.path_um += pigment.0[lane];
            (way.line, way.met) = (went.lines[lane].row(), went.mets[lane].row());
            self.meets(id);
        }
    }

    /// The rays of a group.
    #[inline(always)]
    fn rays(&self, group: &Group) -> Rays<W> {
        let simd = self.packets.simd;
        let [x, y, z, dx, dy, dz, ..] = self.lines(group);
        let ways = &self.ways;
        let [.., from, _, _, _] = simd.columns(group.ids.map(|id| &ways[id].met));
        Rays {
            lanes: group.lanes(simd),
            origin: Vectors::new(x, y, z),
            dir: Vectors::new(dx, dy, dz),
            from: from.bits(),
        }
    }

    /// What a group's photons are where they have met a boundary.
    ///
    /// * `side`: of [`super::SIDES`], two more at a riser.
    #[inline(always)]
    fn go(&self, rays: &Rays<W>, group: &Group, hits: &Hits<W>, side: u64) -> Went<W> {
        let simd = self.packets.simd;
        let [.., state, increment] = self.lines(group);
        let (p, d) = (rays.origin.plus(rays.dir.times(hits.t)), rays.dir);
        let side = simd
            .all_bits(side + 2)
            .or(hits.riser, simd.all_bits(side))
            .numbers();
        let (n, zero, from) = (hits.normal, simd.all(0.0), hits.state.numbers());
        Went {
            lines: simd.transposed([p.x, p.y, p.z, d.x, d.y, d.z, state, increment]),
            mets: simd.transposed([n.x, n.y, n.z, side, from, zero, zero, zero]),
        }
    }

    /// Ways through the cortex times the pigment along them.
    #[inline(always)]
    fn pigment_um(&self, rays: &Rays<W>, lanes: Mask<W>, t: F64x8<W>) -> F64x8<W> {
        let packets = self.packets;
        if packets.has_even_pigment || !lanes.any() {
            return t;
        }
        let (sum, sure) = packets.shell.pigment_um(rays, lanes, t);
        let unsure = lanes & !sure;
        if !unsure.any() {
            return sum;
        }
        let (mut sum, t) = (sum.row(), t.row());
        let (p, d) = (rays.origin, rays.dir);
        let parts = [
            p.x.row(),
            p.y.row(),
            p.z.row(),
            d.x.row(),
            d.y.row(),
            d.z.row(),
        ];
        for lane in unsure.lanes() {
            let [x, y, z, dx, dy, dz] = parts.map(|row| row.0[lane]);
            let (p, dir) = (DVec3::new(x, y, z), DVec3::new(dx, dy, dz));
            sum.0[lane] = packets.fiber.pigment_um(p, dir, Region::Cortex, t.0[lane]);
        }
        packets.simd.load(&sum)
    }

    /// To the next boundary alone.
    fn search(&mut self, id: usize, region: Region, book: &mut impl FnMut(u64, Flight)) {
        let way = &mut self.ways[id];
        let (p, dir) = (way.place(), way.dir());
        let hit = self
            .packets
            .fiber
            .next_hit(p, dir, region, Some(way.state()));
        let spent = way.events >= self.max_events;
        let end = match hit {
            None if region == Region::Outside => End::Escaped(dir),
            _ if spent => End::Truncated,
            None => End::Lost,
            Some(hit) => {
                if region != Region::Outside {
                    way.path_um += hit.pigment_um;
                }
                way.go(p, dir, &hit);
                return self.meets(id);
            }
        };
        self.end(id, end, book);
    }
}
