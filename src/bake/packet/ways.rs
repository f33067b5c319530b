//! Photons under way and the lists in which they wait.

use super::super::entry::Entry;
use super::super::microfacet::Turn;
use super::SIDES;
use crate::fiber::{Hit, HitState, Region};
use crate::math::lanes::{LANES, Mask, Row, Wide};
use crate::sampling::Rng;
use glam::DVec3;

/// Photons under way. With fewer no list may have eight; with more they leave the nearest cache.
pub(super) const UNDER_WAY: usize = 96;

/// What a photon does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// Comes to the fiber from far away.
    Enter,
    /// Both ways at its first boundary, a rough one.
    Fork,
    /// A rough boundary.
    Rough,
    /// Another facet of a rough boundary.
    Walk,
    /// A smooth boundary.
    Smooth,
    /// Leaves the fiber.
    Outside,
    /// Goes on in the cortex from the outer surface.
    Inward,
    /// In the cortex within all scales, where voids may be.
    Core,
    /// In the cortex past all voids.
    Outward,
    /// Goes on in a void.
    Void,
}

/// How many there are.
const KINDS: usize = 10;

/// The lists in which photons wait, by what they do next.
pub(super) struct Lists {
    ids: [[u8; UNDER_WAY]; KINDS],
    counts: [usize; KINDS],
}

/// Photons that do something together: as many lanes as there are, the others repeat the first.
pub(super) struct Group {
    pub(super) ids: [usize; LANES],
    pub(super) count: usize,
}

impl Group {
    /// Those in use, with the photons in them.
    #[inline(always)]
    pub(super) fn members(&self) -> impl Iterator<Item = (usize, usize)> {
        self.ids.into_iter().take(self.count).enumerate()
    }

    /// The lanes in use.
    #[inline(always)]
    pub(super) fn lanes<W: Wide>(&self, simd: W) -> Mask<W> {
        simd.first(self.count)
    }
}

impl Lists {
    pub(super) fn new() -> Self {
        Self {
            ids: [[0; UNDER_WAY]; KINDS],
            counts: [0; KINDS],
        }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, next: Next, id: usize) {
        let count = &mut self.counts[next as usize];
        self.ids[next as usize][*count] = id as u8;
        *count += 1;
    }

    /// The longest list.
    #[inline(always)]
    pub(super) fn longest(&self) -> Option<Next> {
        const ALL: [Next; KINDS] = [
            Next::Enter,
            Next::Fork,
            Next::Rough,
            Next::Walk,
            Next::Smooth,
            Next::Outside,
            Next::Inward,
            Next::Core,
            Next::Outward,
            Next::Void,
        ];
        let next = ALL.into_iter().max_by_key(|&n| self.counts[n as usize])?;
        (self.counts[next as usize] > 0).then_some(next)
    }

    /// Up to eight of a list that is not empty.
    #[inline(always)]
    pub(super) fn take(&mut self, next: Next) -> Group {
        let (list, count) = (&self.ids[next as usize], &mut self.counts[next as usize]);
        let taken = (*count).min(LANES);
        *count -= taken;
        let mut ids = [usize::from(list[*count]); LANES];
        for (k, id) in ids.iter_mut().enumerate().take(taken) {
            *id = usize::from(list[*count + k]);
        }
        Group { ids, count: taken }
    }
}

/// A photon under way.
pub(super) struct Way {
    /// Place, direction, and the bits of the random numbers' state and increment.
    pub(super) line: Row,
    /// Normal of the boundary that it meets, against it; bits of the side, an index of [`SIDES`]; bits of the
    /// state to go on from.
    pub(super) met: Row,
    /// The walk on a rough boundary, where it meets several facets.
    pub(super) walk: Row,
    pub(super) path_um: f64,
    pub(super) events: u32,
    pub(super) entry: Entry,
    /// How often it has missed the fiber.
    pub(super) tries: u32,
    /// Where the fiber was first met, and the boundary.
    pub(super) first: (DVec3, Row),
    /// The part of a photon that it is.
    pub(super) part: u64,
    /// The other branch, which begins when this one has ended.
    pub(super) later: Option<(u64, Turn)>,
}

impl Way {
    pub(super) fn place(&self) -> DVec3 {
        DVec3::from_slice(&self.line.0)
    }

    pub(super) fn dir(&self) -> DVec3 {
        DVec3::from_slice(&self.line.0[3..])
    }

    pub(super) fn rng(&self) -> Rng {
        Rng::of_parts([self.line.0[6].to_bits(), self.line.0[7].to_bits()])
    }

    /// The side of the boundary that it meets.
    #[inline(always)]
    pub(super) fn side(&self) -> usize {
        (self.met.0[3].to_bits() & 7) as usize
    }

    pub(super) fn state(&self) -> HitState {
        HitState::of_bits(self.met.0[4].to_bits())
    }

    /// Goes straight to a boundary.
    pub(super) fn go(&mut self, from: DVec3, dir: DVec3, hit: &Hit) {
        let p = from + hit.t * dir;
        let line = &mut self.line.0;
        [line[0], line[1], line[2]] = p.to_array();
        [line[3], line[4], line[5]] = dir.to_array();
        self.meet(hit);
    }

    /// Has got to a boundary.
    pub(super) fn meet(&mut self, hit: &Hit) {
        let n = hit.normal;
        let side = SIDES
            .iter()
            .position(|&(part, _, far)| (part, far) == (hit.part, hit.to));
        let side = f64::from_bits(side.unwrap_or(0) as u64);
        let state = f64::from_bits(hit.state.bits());
        self.met = Row([n.x, n.y, n.z, side, state, 0.0, 0.0, 0.0]);
    }
}

/// What a photon does after a boundary.
#[inline(always)]
pub(super) fn after(side: usize, transmitted: bool) -> Next {
    let (_, near, far) = SIDES[side];
    match if transmitted { far } else { near } {
        Region::Outside => Next::Outside,
        Region::Void => Next::Void,
        _ if side < 4 => Next::Inward,
        _ => Next::Core,
    }
}
