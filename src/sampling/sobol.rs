//! Owen-scrambled Sobol points with a 32-bit index, by hashing (Burley 2020, JCGT 9(4)).

use super::hash64;

/// Direction numbers of the first four Sobol dimensions (Joe and Kuo 2008): one degree-d primitive
/// polynomial and d initial numbers each; dimension 0 is the van der Corput sequence.
const POLYNOMIALS: [(u32, u32, [u32; 3]); 3] =
    [(1, 0, [1, 0, 0]), (2, 1, [1, 3, 0]), (3, 1, [1, 3, 1])];

const fn matrix(dim: usize) -> [u32; 32] {
    let mut m = [0u32; 32];
    let mut i = 0;
    if dim == 0 {
        while i < 32 {
            m[i] = 1 << (31 - i);
            i += 1;
        }
        return m;
    }
    let (degree, inner, initial) = POLYNOMIALS[dim - 1];
    let d = degree as usize;
    while i < 32 {
        if i < d {
            m[i] = initial[i] << (31 - i);
        } else {
            let mut x = m[i - d] ^ (m[i - d] >> degree);
            let mut k = 1;
            while k < d {
                if (inner >> (d - 1 - k)) & 1 == 1 {
                    x ^= m[i - k];
                }
                k += 1;
            }
            m[i] = x;
        }
        i += 1;
    }
    m
}

/// For each byte of an index and each value of it the sum of its columns, bits reversed.
const fn sums(dim: usize) -> [[u32; 256]; 4] {
    let m = matrix(dim);
    let mut sums = [[0; 256]; 4];
    let mut byte = 0;
    while byte < 4 {
        let mut value = 1usize;
        while value < 256 {
            let lowest = value.trailing_zeros() as usize;
            sums[byte][value] =
                sums[byte][value & (value - 1)] ^ m[8 * byte + lowest].reverse_bits();
            value += 1;
        }
        byte += 1;
    }
    sums
}

static SUMS: [[[u32; 256]; 4]; 3] = [sums(1), sums(2), sums(3)];

/// A number of the sequence, bits reversed, as scrambling wants it.
#[inline(always)]
fn reversed_sobol(index: u32, dim: usize) -> u32 {
    if dim == 0 {
        return index;
    }
    let [a, b, c, d] = index.to_le_bytes().map(usize::from);
    let sums = &SUMS[dim - 1];
    sums[0][a] ^ sums[1][b] ^ sums[2][c] ^ sums[3][d]
}

/// Owen scrambling of a bit-reversed value by a hash in which bits only affect higher ones
/// (Laine and Karras 2011, constants by Vegdahl 2021).
fn scramble_reversed(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x
}

fn scramble(x: u32, seed: u32) -> u32 {
    scramble_reversed(x.reverse_bits(), seed).reverse_bits()
}

/// One scrambled four-dimensional Sobol sequence. Sequences of different keys are independent, so
/// more dimensions are had by padding with new keys.
#[derive(Clone, Copy, Debug)]
pub struct Sobol {
    key: u64,
}

impl Sobol {
    /// The sequence of `key`, for instance a hash of (seed, pixel, bounce).
    pub fn new(key: u64) -> Self {
        Self { key: hash64(key) }
    }

    /// Point `index`, four numbers in `[0, 1)`. Every aligned run of `2^k` points is a (0, 2)-net in
    /// its first two dimensions.
    ///
    /// Inlined so that numbers nobody asks for are not worked out.
    #[inline(always)]
    pub fn point(&self, index: u32) -> [f32; 4] {
        let index = scramble(index, self.key as u32);
        let mut out = [0.0; 4];
        for (dim, value) in out.iter_mut().enumerate() {
            let seed = hash64(self.key ^ (dim as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
            let bits = scramble_reversed(reversed_sobol(index, dim), seed as u32).reverse_bits();
            *value = (bits >> 8) as f32 * (1.0 / 16_777_216.0);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_elementary_interval_holds_one_point() {
        for key in [1, 99, 12_345] {
            let points: Vec<_> = (0..1024).map(|i| Sobol::new(key).point(i)).collect();
            for log_x in 0..=10 {
                let (nx, ny) = (1usize << log_x, 1usize << (10 - log_x));
                let mut seen = vec![false; nx * ny];
                for p in &points {
                    let cell = (p[0] * nx as f32) as usize * ny + (p[1] * ny as f32) as usize;
                    assert!(!std::mem::replace(&mut seen[cell], true));
                }
            }
        }
    }

    /// Bit for bit by the definition: columns of the matrix are added for the bits of the index.
    #[test]
    fn sums_of_bytes_are_sums_of_bits() {
        for dim in 0..4 {
            for i in 0..20_000u32 {
                let index = i.wrapping_mul(0x9e37_79b9);
                let bits = (0..32).filter(|b| index >> b & 1 == 1);
                let sum = bits.fold(0, |x, b| x ^ matrix(dim)[b]);
                assert_eq!(reversed_sobol(index, dim).reverse_bits(), sum);
            }
        }
    }

    #[test]
    fn single_points_are_uniform_over_keys() {
        let mut mean = [0.0f64; 4];
        let n = 50_000;
        for key in 0..n {
            for (m, v) in mean.iter_mut().zip(Sobol::new(key).point(5)) {
                *m += f64::from(v);
            }
        }
        for m in mean {
            assert!((m / n as f64 - 0.5).abs() < 4.0 * (1.0 / 12.0f64).sqrt() / (n as f64).sqrt());
        }
    }
}
