//! The photons under way, and their steps.

use super::super::entry::{Entry, Photon};
use super::super::microfacet::Turn;
use super::super::{End, Flight};
use super::facets::{self, Boundaries};
use super::ways::{Group, Lists, Next, UNDER_WAY, Way, after};
use super::Packets;
use crate::fiber::{Rays, Region};
use crate::math::lanes::{F64x8, LANES, Mask, Row, Vectors, transposed};
use crate::sampling::{Rng, RngLanes};
use crate::table::PHOTON;
use glam::DVec3;

pub(super) struct Flock<'a> {
    packets: &'a Packets<'a>,
    max_events: u32,
    ways: Vec<Way>,
    /// Places of ways that have ended.
    free: Vec<usize>,
    lists: Lists,
}

impl<'a> Flock<'a> {
    pub(super) fn new(packets: &'a Packets<'a>, max_events: u32) -> Self {
        Self {
            packets,
            max_events,
            ways: Vec::with_capacity(UNDER_WAY),
            free: Vec::with_capacity(UNDER_WAY),
            lists: Lists::new(),
        }
    }

    #[inline(always)]
    pub(super) fn fly(
        &mut self,
        mut photons: impl Iterator<Item = Photon>,
        forked: bool,
        book: &mut impl FnMut(u64, Flight),
    ) {
        loop {
            while self.ways.len() - self.free.len() < UNDER_WAY {
                let Some(photon) = photons.next() else { break };
                self.start(&photon, forked, book);
            }
            let Some(next) = self.lists.longest() else {
                break;
            };
            let group = self.lists.take(next);
            match next {
                Next::Rough => self.decide(&group, true, book),
                Next::Smooth => self.decide(&group, false, book),
                Next::Outside | Next::Inward | Next::Outward => self.shell(&group, next, book),
                Next::Core => self.core(&group, book),
                Next::Void => {
                    for lane in group.lanes.lanes() {
                        self.search(group.ids[lane], Region::Void, book);
                    }
                }
            }
        }
    }

    fn start(&mut self, photon: &Photon, forked: bool, book: &mut impl FnMut(u64, Flight)) {
        let fiber = self.packets.fiber;
        let mut rng = Rng::new(photon.seed, photon.stream);
        let entry = Entry::find(fiber, photon, &mut rng);
        let Some((p, hit)) = entry.met else {
            return book(PHOTON, entry.missed());
        };
        let fork = if forked {
            entry.fork(fiber, &mut rng)
        } else {
            None
        };
        let mut way = Way {
            line: line(p, entry.dir, &rng),
            met: Row::default(),
            path_um: 0.0,
            events: 0,
            entry,
            part: PHOTON,
            later: None,
        };
        way.meet(&hit);
        let mut first = None;
        if let Some((part, fork)) = fork {
            let branches = [(part, fork.reflected), (PHOTON - part, fork.transmitted)];
            let mut branches = branches.into_iter().filter(|&(part, _)| part > 0);
            first = branches.next();
            way.later = branches.next();
        }
        let id = match self.free.pop() {
            Some(id) => {
                self.ways[id] = way;
                id
            }
            None => {
                self.ways.push(way);
                self.ways.len() - 1
            }
        };
        match first {
            Some(branch) => self.begin(id, branch),
            None => self.meets(id),
        }
    }

    /// Goes on from the first boundary as decided.
    fn begin(&mut self, id: usize, (part, turn): (u64, Turn)) {
        let way = &mut self.ways[id];
        let rng = way.rng();
        if let Some((p, hit)) = way.entry.met {
            way.line = line(p, turn.dir, &rng);
            way.meet(&hit);
        }
        (way.part, way.path_um, way.events) = (part, 0.0, 1);
        let next = after(way.side(), turn.transmitted);
        self.lists.push(next, id);
    }

    /// Waits for the decision at a boundary.
    #[inline(always)]
    fn meets(&mut self, id: usize) {
        let next = match self.packets.alpha.0[self.ways[id].side()] {
            alpha if alpha > 0.0 => Next::Rough,
            _ => Next::Smooth,
        };
        self.lists.push(next, id);
    }

    #[inline(always)]
    fn decide(&mut self, group: &Group, rough: bool, book: &mut impl FnMut(u64, Flight)) {
        let simd = self.packets.simd;
        let [x, y, z, dx, dy, dz, state, increment] = self.lines(group);
        let [nx, ny, nz, side, ..] = simd.columns(group.ids.map(|id| &self.ways[id].met));
        let (dir, n) = (Vectors::new(dx, dy, dz), Vectors::new(nx, ny, nz));
        let side = side.bits();
        let eta = simd.load(&self.packets.eta).pick(side);
        let inverse = simd.load(&self.packets.inverse).pick(side);
        let mut rng = RngLanes {
            state: state.bits(),
            increment: increment.bits(),
        };
        let (dir, transmitted, lost) = if rough {
            let boundaries = Boundaries {
                alpha: simd.load(&self.packets.alpha).pick(side),
                eta,
                inverse,
            };
            let turns = facets::rough(simd, group.lanes, dir, n, &boundaries, &mut rng);
            (turns.dir, turns.transmitted, turns.lost)
        } else {
            let (dir, through) =
                facets::smooth(simd, group.lanes, dir, n, (eta, inverse), &mut rng);
            (dir, through, Mask::NONE)
        };
        let state = rng.state.numbers();
        self.set_lines(group, [x, y, z, dir.x, dir.y, dir.z, state, increment]);
        for lane in group.lanes.lanes() {
            let id = group.ids[lane];
            let way = &mut self.ways[id];
            way.events += 1;
            if lost.has(lane) {
                self.end(id, End::Lost, book);
                continue;
            }
            let next = after(way.side(), transmitted.has(lane));
            self.lists.push(next, id);
        }
    }

    #[inline(always)]
    fn lines(&self, group: &Group) -> [F64x8; LANES] {
        let lines = group.ids.map(|id| &self.ways[id].line);
        self.packets.simd.columns(lines)
    }

    #[inline(always)]
    fn set_lines(&mut self, group: &Group, lines: [F64x8; LANES]) {
        let rows = transposed(lines);
        for lane in group.lanes.lanes() {
            self.ways[group.ids[lane]].line = rows[lane].row();
        }
    }

    /// Through the shell of scales.
    #[inline(always)]
    fn shell(&mut self, group: &Group, kind: Next, book: &mut impl FnMut(u64, Flight)) {
        let simd = self.packets.simd;
        let [x, y, z, dx, dy, dz, state, increment] = self.lines(group);
        let [.., from, _, _, _] = simd.columns(group.ids.map(|id| &self.ways[id].met));
        let rays = Rays {
            lanes: group.lanes,
            origin: Vectors::new(x, y, z),
            dir: Vectors::new(dx, dy, dz),
            from: from.bits(),
        };
        let shell = &self.packets.shell;
        let (region, first_side, hits) = match kind {
            Next::Outside => (Region::Outside, 0, shell.enter(&rays)),
            Next::Inward => (Region::Cortex, 1, shell.inward(&rays)),
            _ => (Region::Cortex, 1, shell.outward(&rays)),
        };
        // Where they are met.
        let p = rays.origin.plus(rays.dir.times(hits.t));
        let p = p.or(hits.met, rays.origin);
        let side = simd
            .all_bits(first_side + 2)
            .or(hits.riser, simd.all_bits(first_side));
        let (n, zero) = (hits.normal, simd.all(0.0));
        let mets = transposed([
            n.x,
            n.y,
            n.z,
            side.numbers(),
            hits.state.numbers(),
            zero,
            zero,
            zero,
        ]);
        let lines = transposed([p.x, p.y, p.z, dx, dy, dz, state, increment]);
        let ways = hits.t.row().0;
        for lane in group.lanes.lanes() {
            let id = group.ids[lane];
            let way = &mut self.ways[id];
            if hits.met.has(lane) {
                if way.events >= self.max_events {
                    self.end(id, End::Truncated, book);
                    continue;
                }
                if region == Region::Cortex {
                    way.path_um += self.packets.pigment_um(way, ways[lane]);
                }
                way.line = lines[lane].row();
                way.met = mets[lane].row();
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

    /// One after another to the next void.
    fn core(&mut self, group: &Group, book: &mut impl FnMut(u64, Flight)) {
        for lane in group.lanes.lanes() {
            let id = group.ids[lane];
            let way = &mut self.ways[id];
            if way.events >= self.max_events {
                self.end(id, End::Truncated, book);
                continue;
            }
            let (p, dir) = (way.place(), way.dir());
            match self.packets.fiber.void_ahead(p, dir, way.state()) {
                None => self.lists.push(Next::Outward, id),
                Some(hit) => {
                    way.path_um += hit.pigment_um;
                    way.go(p, dir, &hit);
                    self.meets(id);
                }
            }
        }
    }

    /// To the next boundary alone.
    fn search(&mut self, id: usize, region: Region, book: &mut impl FnMut(u64, Flight)) {
        let way = &mut self.ways[id];
        let (p, dir) = (way.place(), way.dir());
        let hit = self.packets.fiber.next_hit(p, dir, region, Some(way.state()));
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

    fn end(&mut self, id: usize, end: End, book: &mut impl FnMut(u64, Flight)) {
        let way = &mut self.ways[id];
        let flight = Flight {
            query: way.entry.query,
            path_um: way.path_um,
            share: 1.0,
            events: way.events,
            end,
        };
        book(way.part, way.entry.seen(flight));
        match way.later.take() {
            Some(branch) => self.begin(id, branch),
            None => self.free.push(id),
        }
    }
}

fn line(p: DVec3, dir: DVec3, rng: &Rng) -> Row {
    let [state, increment] = rng.parts().map(f64::from_bits);
    Row([p.x, p.y, p.z, dir.x, dir.y, dir.z, state, increment])
}
