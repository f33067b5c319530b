//! What photons say of a map, and how uncertain that is.

use super::Reconstruction;
use crate::bake::tally::Tally;
use crate::sampling::{Rng, hash64};
use crate::table::PHOTON;

/// Which photons.
#[derive(Clone, Copy, Debug)]
pub(super) enum Half {
    Both,
    First,
    Second,
}

/// The share of a texel's photons that fall to the first half if each is sent there by chance. A Poisson
/// count so thinned is two independent ones.
fn thinned(texel: usize, [sum, squares]: [f64; 2]) -> f64 {
    if squares <= 0.0 {
        return 0.5;
    }
    // As many equal photons have this sum and these squares.
    let count = (sum * sum / squares).round().max(1.0);
    let mut rng = Rng::new(0x7417, texel as u64 ^ hash64(sum.to_bits()));
    let first = if count <= 64.0 {
        let bits = u64::from(rng.bits()) << 32 | u64::from(rng.bits());
        f64::from((bits >> (64 - count as u32)).count_ones())
    } else {
        (0.5 * count + 0.5 * count.sqrt() * rng.normal_pair().0).clamp(0.0, count)
    };
    first / count
}

/// What left through a texel of one kind, and the sum of its squares.
pub(super) type Kind = fn(&Tally, usize) -> (u64, u64);

impl Reconstruction {
    /// Densities of the cells, and a random sign times their standard deviation.
    pub(super) fn signal(&self, tally: &Tally, kind: Kind, half: Half) -> Vec<[f32; 2]> {
        let photons = tally.photons() as f64;
        let parts = |(sum, squares): (u64, u64)| [sum, squares].map(|v| v as f64 / PHOTON as f64);
        let cells = self.scales.texels.iter().zip(&self.solid_angle);
        cells
            .map(|(&[texel, mirror], omega)| {
                let [a, b] = [texel, mirror].map(|texel| parts(kind(tally, texel)));
                // Sums, and how many times the density of one photon they stand for.
                let ([sum, squares], copies) = match half {
                    Half::Both if texel == mirror => (a, 1.0),
                    Half::Both => ([a[0] + b[0], a[1] + b[1]], 2.0),
                    // The sides of the mirror plane are independent.
                    Half::First if texel != mirror => (a, 1.0),
                    Half::Second if texel != mirror => (b, 1.0),
                    Half::First => (a.map(|v| v * thinned(texel, a)), 0.5),
                    Half::Second => (a.map(|v| v * (1.0 - thinned(texel, a))), 0.5),
                };
                let scale = 1.0 / (copies * photons * omega);
                let bits = hash64(texel as u64 ^ hash64(sum.to_bits()));
                let sign = if bits & 1 == 0 { -1.0 } else { 1.0 };
                [(sum * scale) as f32, (sign * squares.sqrt() * scale) as f32]
            })
            .collect()
    }
}
