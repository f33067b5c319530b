//! The photons under way, and their steps.

use super::super::entry::{Entry, Photon};
use super::super::fork::{Fork, fork};
use super::super::microfacet::{Ratio, Turn};
use super::super::{End, Flight};
use super::Packets;
use super::facets::{self, Boundaries, Frames, Walks};
use super::ways::{Group, Lists, Next, UNDER_WAY, Way, after};
use crate::math::lanes::{F64x8, LANES, Mask, Row, Vectors, Wide};
use crate::sampling::{Rng, RngLanes};
use crate::table::PHOTON;
use glam::DVec3;

pub(super) struct Flock<'a, W> {
    pub(super) packets: &'a Packets<'a, W>,
    pub(super) max_events: u32,
    pub(super) ways: Vec<Way>,
    /// Places of ways that have ended.
    pub(super) free: Vec<usize>,
    pub(super) lists: Lists,
}

impl<'a, W: Wide> Flock<'a, W> {
    pub(super) fn new(packets: &'a Packets<'a, W>, max_events: u32) -> Self {
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
                self.start(&photon);
            }
            let Some(next) = self.lists.longest() else {
                break;
            };
            let group = self.lists.take(next);
            match next {
                Next::Enter => self.enter(&group, forked, book),
                Next::Fork => self.fork(&group),
                Next::Rough | Next::Walk | Next::Smooth => self.decide(&group, next, book),
                Next::Outside | Next::Inward | Next::Outward => self.shell(&group, next, book),
                Next::Core => self.void(&group, false, book),
                Next::Void => self.void(&group, true, book),
            }
        }
    }

    /// Sends a photon toward the fiber.
    #[inline(always)]
    fn start(&mut self, photon: &Photon) {
        let fiber = self.packets.fiber;
        let mut rng = Rng::new(photon.seed, photon.stream);
        let (entry, across) = Entry::aim(photon, &mut rng);
        let origin = entry.origin(fiber, across, &mut rng);
        let way = Way {
            line: line(origin, entry.dir, &rng),
            met: Row::default(),
            walk: Row::default(),
            path_um: 0.0,
            events: 0,
            entry,
            tries: 0,
            first: (origin, Row::default()),
            part: PHOTON,
            later: None,
        };
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
        self.lists.push(Next::Enter, id);
    }

    /// Goes on after it has met the fiber for the first time.
    #[inline(always)]
    pub(super) fn entered(&mut self, id: usize, forked: bool) {
        if !forked {
            return self.meets(id);
        }
        let way = &mut self.ways[id];
        way.first = (way.place(), way.met);
        if self.packets.alpha.0[way.side()] > 0.0 {
            self.lists.push(Next::Fork, id);
        } else {
            self.fork_alone(id);
        }
    }

    /// Both ways at the first boundary, for a photon alone.
    fn fork_alone(&mut self, id: usize) {
        let way = &mut self.ways[id];
        let side = way.side();
        let ratio = Ratio {
            eta: self.packets.eta.0[side],
            inverse: self.packets.inverse.0[side],
        };
        let roughness = self.packets.alpha.0[side];
        let mut rng = way.rng();
        let normal = DVec3::from_slice(&way.met.0);
        let Some(both) = fork(way.dir(), normal, ratio, roughness, &mut rng) else {
            return self.meets(id);
        };
        self.forks(id, &both, &rng);
    }

    /// Both ways at the first boundary.
    #[inline(always)]
    fn fork(&mut self, group: &Group) {
        let simd = self.packets.simd;
        let [_, _, _, dx, dy, dz, state, increment] = self.lines(group);
        let (n, boundaries) = self.boundaries(group);
        let mut rng = RngLanes {
            state: state.bits(),
            increment: increment.bits(),
        };
        let frames = Frames::new(simd, n);
        let dir = Vectors::new(dx, dy, dz);
        let alpha = boundaries.alpha;
        let (walks, met) = Walks::begin(simd, group.lanes(simd), dir, &frames, alpha, &mut rng);
        let ([mut back, mut on], share) = walks.fork(simd, met, &boundaries, &mut rng);
        let mut again = rng;
        let lost = back.finish(simd, met, &boundaries, &mut again)
            | on.finish(simd, met, &boundaries, &mut rng);
        let back = Turns::new(back.leave(&frames));
        let on = Turns::new(on.leave(&frames));
        let (lost, met) = (lost.bits(), met.bits());
        let (share, state) = (share.row(), rng.state.array());
        for (lane, id) in group.members() {
            if (lost | !met) >> lane & 1 != 0 {
                self.fork_alone(id);
                continue;
            }
            let both = Fork {
                reflectance: share.0[lane],
                reflected: back.at(lane),
                transmitted: on.at(lane),
            };
            let [_, increment] = self.ways[id].rng().parts();
            self.forks(id, &both, &Rng::of_parts([state[lane], increment]));
        }
    }

    /// Flies one branch and keeps the other for later.
    #[inline(always)]
    fn forks(&mut self, id: usize, fork: &Fork, rng: &Rng) {
        let way = &mut self.ways[id];
        way.line = line(way.place(), way.dir(), rng);
        let part = fork.part();
        let branches = [(part, fork.reflected), (PHOTON - part, fork.transmitted)];
        let mut branches = branches.into_iter().filter(|&(part, _)| part > 0);
        let first = branches.next();
        way.later = branches.next();
        match first {
            Some(branch) => self.begin(id, branch),
            None => self.meets(id),
        }
    }

    /// Goes on from the first boundary as decided.
    fn begin(&mut self, id: usize, (part, turn): (u64, Turn)) {
        let way = &mut self.ways[id];
        way.line = line(way.first.0, turn.dir, &way.rng());
        way.met = way.first.1;
        (way.part, way.path_um, way.events) = (part, 0.0, 1);
        let next = after(way.side(), turn.transmitted);
        self.lists.push(next, id);
    }

    /// Waits for the decision at a boundary.
    #[inline(always)]
    pub(super) fn meets(&mut self, id: usize) {
        let next = match self.packets.alpha.0[self.ways[id].side()] {
            alpha if alpha > 0.0 => Next::Rough,
            _ => Next::Smooth,
        };
        self.lists.push(next, id);
    }

    /// What boundaries do.
    #[inline(always)]
    fn decide(&mut self, group: &Group, kind: Next, book: &mut impl FnMut(u64, Flight)) {
        let simd = self.packets.simd;
        let [x, y, z, dx, dy, dz, state, increment] = self.lines(group);
        let (n, boundaries) = self.boundaries(group);
        let old = Vectors::new(dx, dy, dz);
        let mut rng = RngLanes {
            state: state.bits(),
            increment: increment.bits(),
        };
        let (mut walking, mut lost) = (simd.none(), simd.none());
        let mut walks = None;
        let (dir, transmitted) = if kind == Next::Smooth {
            let ratio = (boundaries.eta, boundaries.inverse);
            facets::smooth(simd, group.lanes(simd), old, n, ratio, &mut rng)
        } else {
            let frames = Frames::new(simd, n);
            let mut all = if kind == Next::Rough {
                let (all, met) = Walks::begin(
                    simd,
                    group.lanes(simd),
                    old,
                    &frames,
                    boundaries.alpha,
                    &mut rng,
                );
                walking = met;
                all
            } else {
                walking = group.lanes(simd);
                let ways = &self.ways;
                Walks::resume(simd, simd.columns(group.ids.map(|id| &ways[id].walk)))
            };
            (walking, lost) = all.step(simd, walking, &boundaries, &mut rng);
            let (dir, transmitted) = all.leave(&frames);
            if walking.any() {
                walks = Some(simd.transposed(all.columns(simd)));
            }
            (old.or(walking, dir), transmitted)
        };
        let state = rng.state.numbers();
        self.set_lines(group, [x, y, z, dir.x, dir.y, dir.z, state, increment]);
        for (lane, id) in group.members() {
            let way = &mut self.ways[id];
            if let Some(walks) = &walks
                && walking.has(lane)
            {
                way.walk = walks[lane].row();
                self.lists.push(Next::Walk, id);
                continue;
            }
            way.events += 1;
            if lost.has(lane) {
                self.end(id, End::Lost, book);
                continue;
            }
            let next = after(way.side(), transmitted.has(lane));
            self.lists.push(next, id);
        }
    }

    /// What a group meets: normals and boundaries.
    #[inline(always)]
    fn boundaries(&self, group: &Group) -> (Vectors<W>, Boundaries<W>) {
        let Packets {
            simd,
            alpha,
            eta,
            inverse,
            ..
        } = self.packets;
        let ways = &self.ways;
        let [x, y, z, side, ..] = simd.columns(group.ids.map(|id| &ways[id].met));
        let side = side.bits();
        let boundaries = Boundaries {
            alpha: simd.load(alpha).pick(side),
            eta: simd.load(eta).pick(side),
            inverse: simd.load(inverse).pick(side),
        };
        (Vectors::new(x, y, z), boundaries)
    }

    #[inline(always)]
    pub(super) fn lines(&self, group: &Group) -> [F64x8<W>; LANES] {
        let lines = group.ids.map(|id| &self.ways[id].line);
        self.packets.simd.columns(lines)
    }

    #[inline(always)]
    fn set_lines(&mut self, group: &Group, lines: [F64x8<W>; LANES]) {
        let rows = self.packets.simd.transposed(lines);
        for (lane, id) in group.members() {
            self.ways[id].line = rows[lane].row();
        }
    }

    pub(super) fn end(&mut self, id: usize, end: End, book: &mut impl FnMut(u64, Flight)) {
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

/// Eight [`Turn`]s in memory.
struct Turns {
    dir: [Row; 3],
    transmitted: u8,
}

impl Turns {
    #[inline(always)]
    fn new<W: Wide>((dir, transmitted): (Vectors<W>, Mask<W>)) -> Self {
        Self {
            dir: [dir.x.row(), dir.y.row(), dir.z.row()],
            transmitted: transmitted.bits(),
        }
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> Turn {
        let [x, y, z] = &self.dir;
        Turn {
            dir: DVec3::new(x.0[lane], y.0[lane], z.0[lane]),
            transmitted: self.transmitted >> lane & 1 != 0,
        }
    }
}

pub(super) fn line(p: DVec3, dir: DVec3, rng: &Rng) -> Row {
    let [state, increment] = rng.parts().map(f64::from_bits);
    Row([p.x, p.y, p.z, dir.x, dir.y, dir.z, state, increment])
}
