//! Many photons under way at once, eight of them a step.
//!
//! A photon waits in the list of what it does next; whenever a list has eight, they do it side by
//! side. Which photons are together is chance, and each has the path, to the bit, that it has alone:
//! its random numbers are its own and every lane rounds as plain numbers do.

mod facets;
mod flock;
mod search;
#[cfg(test)]
mod tests;
mod ways;

use super::Flight;
use super::entry::Photon;
use crate::fiber::{Fiber, Optics, PacketShell, Part, Region};
use crate::math::lanes::{Avx512, Row};
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

/// A fiber all of whose boundaries are dielectrics between clear media, for eight photons at a time.
pub(super) struct Packets<'a> {
    simd: Avx512,
    fiber: &'a Fiber,
    shell: PacketShell<'a>,
    has_voids: bool,
    has_even_pigment: bool,
    /// By side: roughness, index over index, the inverse.
    alpha: Row,
    eta: Row,
    inverse: Row,
}

impl<'a> Packets<'a> {
    /// `None` where the processor lacks AVX-512 or the fiber has something that is followed one photon at a
    /// time: a mesh, other boundaries than dielectrics, media that scatter or absorb.
    pub(super) fn new(fiber: &'a Fiber) -> Option<Self> {
        let simd = Avx512::detect()?;
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

    /// Flies photons; see [`super::entry::fly`] and [`super::entry::fly_forked`].
    ///
    /// * `book`: gets what becomes of each, or of each branch, and its part of the photon, in any order.
    pub(super) fn fly(
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
