//! Many photons under way at once, eight of them a step.
//!
//! A photon waits in the list of what it does next; whenever a list has eight, they do it side by
//! side. Which photons are together is chance, and each has the path, to the bit, that it has alone:
//! its random numbers are its own and every lane rounds as plain numbers do.

mod depths;
mod facets;
mod flock;
mod search;
#[cfg(test)]
mod tests;
mod ways;

use super::Flight;
use super::entry::Photon;
use crate::fiber::{Fiber, Optics, PacketShell, Part, Region};
use crate::math::lanes::{Avx2, Avx512, Row, Set, Wide};
use flock::Flock;

/// Boundaries that a photon may meet, each from both sides: the second of a pair from inside.
const SIDES: [(Part, Region, Region); 6] = [
    (Part::Scale, Region::Outside, Region::Cortex),
    (Part::Scale, Region::Cortex, Region::Outside),
    (Part::Riser, Region::Outside, Region::Cortex),
    (Part::Riser, Region::Cortex, Region::Outside),
    (Part::Void, Region::Cortex, Region::Void),
    (Part::Void, Region::Void, Region::Cortex),
];

/// A fiber whose photons fly in company, by the instruction set that the processor has.
pub(super) struct Company<'a>(With<'a>);

enum With<'a> {
    Avx512(Packets<'a, Avx512>),
    Avx2(Packets<'a, Avx2>),
}

impl<'a> Company<'a> {
    /// `None` where the processor has neither set, or photons of the fiber fly alone: see [`Packets::new`].
    pub(super) fn new(fiber: &'a Fiber) -> Option<Self> {
        let packets = match Set::detect()? {
            Set::Avx512(simd) => With::Avx512(Packets::new(simd, fiber)?),
            Set::Avx2(simd) => With::Avx2(Packets::new(simd, fiber)?),
        };
        Some(Self(packets))
    }

    /// Flies photons; see [`super::entry::fly`] and [`super::entry::fly_forked`].
    ///
    /// * `book`: gets what becomes of each, or of each branch, and its part of the photon, in any order.
    pub(super) fn fly(
        &self,
        photons: impl Iterator<Item = Photon>,
        forked: bool,
        max_events: u32,
        book: impl FnMut(u64, Flight),
    ) {
        match &self.0 {
            With::Avx512(packets) => packets.fly(photons, forked, max_events, book),
            With::Avx2(packets) => packets.fly(photons, forked, max_events, book),
        }
    }
}

/// A fiber all of whose boundaries are dielectrics between clear media, for eight photons at a time.
struct Packets<'a, W> {
    simd: W,
    fiber: &'a Fiber,
    shell: PacketShell<'a, W>,
    has_voids: bool,
    has_even_pigment: bool,
    /// By side: roughness, index over index, the inverse.
    alpha: Row,
    eta: Row,
    inverse: Row,
}

impl<'a, W: Wide> Packets<'a, W> {
    /// `None` where the fiber has something that is followed one photon at a time: a mesh, other boundaries than
    /// dielectrics, media that scatter or absorb.
    fn new(simd: W, fiber: &'a Fiber) -> Option<Self> {
        let clear = |&(_, near, far): &(Part, Region, Region)| {
            let medium = fiber.medium(near);
            medium.scattering_per_um == 0.0
                && medium.absorption_per_um == 0.0
                && fiber.eta(near, far) != 1.0
        };
        let shell = fiber.packet_shell(simd)?;
        if !SIDES.iter().all(clear) {
            return None;
        }
        let mut packets = Self {
            simd,
            fiber,
            shell,
            has_voids: fiber.has_voids(),
            has_even_pigment: fiber.has_even_pigment(),
            alpha: Row::default(),
            eta: Row::default(),
            inverse: Row::default(),
        };
        for (k, &(part, near, far)) in SIDES.iter().enumerate() {
            let Optics::Dielectric { roughness } = *fiber.optics(part) else {
                return None;
            };
            packets.alpha.0[k] = roughness;
            packets.eta.0[k] = fiber.eta(near, far);
            packets.inverse.0[k] = fiber.eta(far, near);
        }
        Some(packets)
    }

    /// See [`Company::fly`].
    fn fly(
        &self,
        photons: impl Iterator<Item = Photon>,
        forked: bool,
        max_events: u32,
        mut book: impl FnMut(u64, Flight),
    ) {
        let simd = self.simd;
        simd.run(
            #[inline(always)]
            || Flock::new(self, max_events).fly(photons, forked, &mut book),
        );
    }
}
