//! What photons say of a map, and how uncertain that is.

use super::desk::SIDE;
use super::{Map, Reconstruction};
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

/// Sums of one kind of light, and of its squares, by texel.
type Kind = fn(&Tally, usize) -> (u64, u64);

impl Reconstruction {
    /// Densities of the cells and a random sign times their standard deviation: of the light that met no
    /// pigment and of that which did.
    pub(super) fn signals(&self, tally: &Tally, half: Half) -> Map {
        let kinds: [Kind; 2] = [Tally::bare, Tally::colored];
        let photons = tally.photons() as f64;
        let cells = self.scales.texels.iter().zip(&self.solid_angle);
        let signals = cells.map(|(&texels, omega)| {
            let [[a, b], [c, d]] =
                kinds.map(|kind| signal(tally, kind, half, texels, photons * omega));
            [a, b, c, d]
        });
        signals.collect()
    }

    /// Densities of the light that met pigment, at all levels: groups of some.
    pub(super) fn densities(&self, tally: &Tally) -> Vec<Map> {
        let unit = 1.0 / (tally.photons() as f64 * PHOTON as f64);
        let levels = tally.levels();
        let cells = self.scales.texels.len();
        let mut groups = vec![vec![[0.0; SIDE]; cells]; levels.div_ceil(SIDE)];
        let all = self.scales.texels.iter().zip(&self.solid_angle);
        for (cell, (&[texel, mirror], omega)) in all.enumerate() {
            if !tally.has(texel) && !tally.has(mirror) {
                continue;
            }
            let runs = tally
                .run(texel)
                .chunks(SIDE)
                .zip(tally.run(mirror).chunks(SIDE));
            for (group, (a, b)) in groups.iter_mut().zip(runs) {
                for (to, (a, b)) in group[cell].iter_mut().zip(a.iter().zip(b)) {
                    *to = (0.5 * (*a as f64 + *b as f64) * unit / omega) as f32;
                }
            }
        }
        groups
    }
}

/// * `per`: photons times the solid angle of a texel.
fn signal(
    tally: &Tally,
    kind: Kind,
    half: Half,
    [texel, mirror]: [usize; 2],
    per: f64,
) -> [f32; 2] {
    let [a, b] = [texel, mirror].map(|texel| kind(tally, texel));
    if a.0 | b.0 == 0 {
        return [0.0; 2];
    }
    let [a, b] = [a, b].map(|(sum, squares)| [sum, squares].map(|v| v as f64 / PHOTON as f64));
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
    let scale = 1.0 / (copies * per);
    let bits = hash64(texel as u64 ^ hash64(sum.to_bits()));
    let sign = if bits & 1 == 0 { -1.0 } else { 1.0 };
    [(sum * scale) as f32, (sign * squares.sqrt() * scale) as f32]
}
