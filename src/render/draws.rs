//! The random numbers of one pixel sample: functions of (seed, pixel, bounce, sample index) alone.

use crate::sampling::{Sobol, hash64};

/// What a group of numbers is for; each gets its own sequence.
#[derive(Clone, Copy, Debug)]
pub(super) enum Purpose {
    /// The cell from which to look at the light.
    Outlook = 0,
    /// Place in the pixel.
    Filter = 1,
    /// Candidates drawn from the scattering model.
    Scatter = 2,
    /// Candidates drawn from the environment.
    Light = 3,
    /// Choice among candidates, and roulette.
    Choice = 4,
    /// The direction in which the path goes on.
    Continue = 5,
    /// Place on the lens.
    Lens = 6,
    /// Lamp, and place on it.
    Lamp = 7,
}

/// The numbers of sample `index` of one pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Draws {
    key: u64,
    index: u32,
}

impl Draws {
    /// * `pixel`: of the full frame, so that crops draw the same numbers.
    pub(super) fn new(seed: u64, pixel: u64, index: u32) -> Self {
        Self {
            key: hash64(hash64(seed).wrapping_add(pixel.wrapping_mul(0x9e37_79b9_7f4a_7c15))),
            index,
        }
    }

    /// Those of another way in which the path goes on from a bounce, counted from 1.
    pub(super) fn copy(&self, bounce: u32, copy: u32) -> Self {
        let way = (u64::from(bounce) << 32) | u64::from(copy);
        Self {
            key: hash64(self.key ^ way.wrapping_mul(0x9e37_79b9_7f4a_7c15)),
            index: self.index,
        }
    }

    /// The scrambled net of a bounce and a purpose.
    pub(super) fn net(&self, bounce: u32, purpose: Purpose) -> Sobol {
        let place = (u64::from(bounce) << 3) | purpose as u64;
        Sobol::new(self.key ^ place.wrapping_mul(0xd6e8_feb8_6659_fd93))
    }

    /// This sample's point of a net.
    #[inline(always)]
    pub(super) fn point(&self, bounce: u32, purpose: Purpose) -> [f32; 4] {
        self.net(bounce, purpose).point(self.index)
    }

    /// The first of `count` (a power of two) points of a net that belong to this sample. They are
    /// an aligned run of the net, so spread evenly by themselves and together with the runs of the
    /// other samples.
    pub(super) fn run(&self, count: u32) -> u32 {
        self.index.wrapping_mul(count)
    }
}
