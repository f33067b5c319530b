//! Lanes hold what plain numbers give, whatever the instruction set, for hostile numbers too.

use super::{Avx2, Avx512, F64x8, LANES, Mask, Merge, Row, Singles, U64x8, Wide};
use crate::sampling::Rng;
use std::array::from_fn;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs a test with each instruction set that the processor has.
macro_rules! with_each {
    ($test:ident) => {
        #[test]
        fn $test() {
            let (avx2, avx512) = (Avx2::detect(), Avx512::detect());
            if let Some(simd) = avx2 {
                Tests(simd).$test();
            }
            if let Some(simd) = avx512 {
                Tests(simd).$test();
            }
            println!("AVX2 {}, AVX-512 {}", avx2.is_some(), avx512.is_some());
        }
    };
}

with_each!(numbers_are_those_of_plain_formulas);
with_each!(comparisons_and_choices_are_plain);
with_each!(whole_numbers_are_plain);
with_each!(conversions_are_plain);
with_each!(lanes_go_where_they_belong);
with_each!(masks_are_bits);
with_each!(sixteen_short_numbers_are_plain);

const HOSTILE: [f64; 24] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.1,
    -2.5,
    1e300,
    -1e300,
    f64::MAX,
    f64::MIN,
    f64::MIN_POSITIVE,
    5e-324,
    -5e-324,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
    4_503_599_627_370_495.5,
    -4_503_599_627_370_496.5,
    9_007_199_254_740_993.0,
    0.499_999_999_999_999_94,
    2_147_483_647.9,
    2_147_483_648.0,
    -0.9,
    1e-17,
];

const HOSTILE_BITS: [u64; 12] = [
    0,
    1,
    2,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x1_0000_0000,
    0x7fff_ffff_ffff_ffff,
    0x8000_0000_0000_0000,
    0xffff_ffff_ffff_ffff,
    0xdead_beef_0123_4567,
    0x0000_0001_ffff_fffe,
];

/// Eights of hostile numbers and of random bits.
fn numbers(seed: u64) -> impl Iterator<Item = [f64; LANES]> {
    whole(seed).enumerate().map(move |(k, bits)| {
        from_fn(|i| match bits[i] % 3 {
            0 => HOSTILE[(k + 7 * i + seed as usize) % HOSTILE.len()],
            1 => f64::from_bits(bits[i]),
            _ => (bits[i] >> 40) as f64 / 1e4 - 500.0,
        })
    })
}

fn whole(seed: u64) -> impl Iterator<Item = [u64; LANES]> {
    let mut rng = Rng::new(seed, 0);
    (0..20_000).map(move |k| {
        from_fn(|i| {
            let bits = u64::from(rng.bits()) << 32 | u64::from(rng.bits());
            match bits % 4 {
                0 => HOSTILE_BITS[(k + 5 * i) % HOSTILE_BITS.len()],
                1 => bits >> (bits >> 58),
                _ => bits,
            }
        })
    })
}

/// Bits, but that what is undefined is all alike.
fn bits(x: f64) -> u64 {
    if x.is_nan() { u64::MAX } else { x.to_bits() }
}

fn same<W: Wide>(what: &str, found: F64x8<W>, plain: [f64; LANES]) {
    assert_eq!(found.row().0.map(bits), plain.map(bits), "{what}");
}

fn of<W: Wide>(simd: W, x: [u64; LANES]) -> U64x8<W> {
    simd.load(&Row(x.map(f64::from_bits))).bits()
}

fn chosen(plain: impl Fn(usize) -> bool) -> u8 {
    (0..LANES).fold(0, |bits, i| bits | u8::from(plain(i)) << i)
}

struct Tests<W>(W);

impl<W: Wide> Tests<W> {
    fn numbers_are_those_of_plain_formulas(self) {
        let simd = self.0;
        for (a, b) in numbers(1).zip(numbers(2)) {
            let (x, y) = (simd.load(&Row(a)), simd.load(&Row(b)));
            same("a + b", x + y, from_fn(|i| a[i] + b[i]));
            same("a - b", x - y, from_fn(|i| a[i] - b[i]));
            same("a * b", x * y, from_fn(|i| a[i] * b[i]));
            same("a / b", x / y, from_fn(|i| a[i] / b[i]));
            same("a + 3", x + 3.0, a.map(|a| a + 3.0));
            same("3 - a", 3.0 - x, a.map(|a| 3.0 - a));
            same("-a", -x, a.map(|a| -a));
            same("|a|", x.abs(), a.map(f64::abs));
            same("root", x.sqrt(), a.map(f64::sqrt));
            same("floor", x.floor(), a.map(f64::floor));
            same("sign", x.with_sign_of(y), from_fn(|i| a[i].copysign(b[i])));
            let (least, most) = (x.min(y), x.max(y));
            let second = |i: usize, first: bool| if first { a[i] } else { b[i] };
            same("min", least, from_fn(|i| second(i, a[i] < b[i])));
            same("max", most, from_fn(|i| second(i, a[i] > b[i])));
        }
    }

    fn comparisons_and_choices_are_plain(self) {
        let simd = self.0;
        for (a, b) in numbers(3).zip(numbers(4)) {
            // Some are alike.
            let b = from_fn(|i| if a[i].to_bits() % 5 == 0 { a[i] } else { b[i] });
            let (x, y) = (simd.load(&Row(a)), simd.load(&Row(b)));
            let less = x.lt(y);
            assert_eq!(less.bits(), chosen(|i| a[i] < b[i]));
            assert_eq!(x.le(y).bits(), chosen(|i| a[i] <= b[i]));
            assert_eq!(x.gt(y).bits(), chosen(|i| a[i] > b[i]));
            assert_eq!(x.ge(y).bits(), chosen(|i| a[i] >= b[i]));
            assert_eq!(x.is(y).bits(), chosen(|i| a[i] == b[i]));
            let choice = from_fn(|i| if a[i] < b[i] { a[i] } else { b[i] });
            same("choice", x.or(less, y), choice);
        }
    }

    fn whole_numbers_are_plain(self) {
        let simd = self.0;
        for (a, b) in whole(1).zip(whole(2)) {
            let b = from_fn(|i| if a[i] % 7 == 0 { a[i] } else { b[i] });
            let (x, y) = (of(simd, a), of(simd, b));
            assert_eq!(x.array(), a);
            assert_eq!(x.plus(y).array(), from_fn(|i| a[i].wrapping_add(b[i])));
            assert_eq!(x.minus(y).array(), from_fn(|i| a[i].wrapping_sub(b[i])));
            assert_eq!(x.times(y).array(), from_fn(|i| a[i].wrapping_mul(b[i])));
            assert_eq!(x.and(y).array(), from_fn(|i| a[i] & b[i]));
            assert_eq!(x.xor(y).array(), from_fn(|i| a[i] ^ b[i]));
            assert_eq!(x.right::<18>().array(), a.map(|a| a >> 18));
            assert_eq!(x.right::<59>().array(), a.map(|a| a >> 59));
            assert_eq!(x.left::<32>().array(), a.map(|a| a << 32));
            assert_eq!(x.lt(y).bits(), chosen(|i| a[i] < b[i]));
            assert_eq!(x.is(y).bits(), chosen(|i| a[i] == b[i]));
            let choice = x.or(x.lt(y), y).array();
            assert_eq!(choice, from_fn(|i| a[i].min(b[i])));
            let by = b.map(|b| b % 32);
            let turned = x.low_turned_right(of(simd, by)).array();
            let plain = from_fn(|i| (a[i] as u32).rotate_right(by[i] as u32));
            assert_eq!(turned.map(|a| a as u32), plain);
        }
    }

    fn conversions_are_plain(self) {
        let simd = self.0;
        for a in whole(3) {
            let low = a.map(|a| a >> 12);
            same("real", of(simd, low).to_f64(), low.map(|a| a as f64));
            let signed = a.map(|a| a as i64 >> 12);
            let x = of(simd, signed.map(|a| a as u64));
            same("signed", x.signed_to_f64(), signed.map(|a| a as f64));
        }
        for a in numbers(5) {
            let found = simd.load(&Row(a)).whole().array();
            for (found, a) in found.into_iter().zip(a) {
                if (0.0..2_147_483_648.0).contains(&a) || (-1.0 < a && a <= 0.0) {
                    assert_eq!(found, a as u64, "{a}");
                } else {
                    assert!(found >= 1 << 31, "{a}");
                }
            }
        }
    }

    fn lanes_go_where_they_belong(self) {
        let simd = self.0;
        let rows: [Row; LANES] = from_fn(|i| Row(from_fn(|k| (10 * i + k) as f64)));
        let columns: [[f64; LANES]; LANES] = from_fn(|k| from_fn(|i| rows[i].0[k]));
        for (k, found) in simd.columns(rows.each_ref()).into_iter().enumerate() {
            same("column", found, columns[k]);
        }
        let all = rows.each_ref().map(|row| simd.load(row));
        for (k, found) in simd.transposed(all).into_iter().enumerate() {
            same("column", found, columns[k]);
        }
        let table: Vec<[f64; 2]> = (0..37).map(|k| [f64::from(k), -f64::from(k)]).collect();
        for a in whole(6) {
            let entries = simd.load(&rows[3]);
            let picked = entries.pick(of(simd, a));
            same("entry", picked, a.map(|a| rows[3].0[(a % 8) as usize]));
            let index = a.map(|a| a % 37);
            let [x, y] = simd.pairs(&table, of(simd, index));
            same("first", x, index.map(|k| k as f64));
            same("second", y, index.map(|k| -(k as f64)));
        }
        for beyond in [37, 1 << 32, 1 << 60, u64::MAX] {
            let index = of(simd, [0, 36, 5, 6, beyond, 0, 0, 0]);
            let found = catch_unwind(AssertUnwindSafe(|| simd.pairs(&table, index)[0].row()));
            assert!(found.is_err(), "{beyond}");
        }
        same("one", simd.all(0.3), [0.3; LANES]);
        assert_eq!(simd.all_bits(u64::MAX).array(), [u64::MAX; LANES]);
    }

    fn masks_are_bits(self) {
        let simd = self.0;
        for a in 0..=u8::MAX {
            let mask = simd.lanes(a);
            assert_eq!(mask.bits(), a);
            assert_eq!(mask.any(), a != 0);
            assert_eq!((!mask).bits(), !a);
            assert!(mask.lanes().eq((0..LANES).filter(|i| a >> i & 1 != 0)));
            assert!((0..LANES).all(|i| mask.has(i) == (a >> i & 1 != 0)));
            for b in (0..=u8::MAX).step_by(13) {
                let other: Mask<W> = simd.lanes(b);
                assert_eq!((mask & other).bits(), a & b);
                assert_eq!((mask | other).bits(), a | b);
                assert_eq!((mask ^ other).bits(), a ^ b);
            }
        }
        for count in 0..=LANES {
            assert_eq!(simd.first(count).bits(), chosen(|i| i < count));
        }
        assert_eq!((simd.none().bits(), simd.every().bits()), (0, u8::MAX));
    }

    fn sixteen_short_numbers_are_plain(self) {
        let simd = self.0;
        let mut rng = Rng::new(9, 9);
        for _ in 0..20_000 {
            let mut next = || match rng.bits() % 4 {
                0 => [0.0, -0.0, f32::INFINITY, 1e-40, 3.0, -1e30][rng.bits() as usize % 6],
                _ => rng.uniform_f32() * 8.0 - 4.0,
            };
            let (a, b): ([f32; 16], [f32; 16]) = (from_fn(|_| next()), from_fn(|_| next()));
            let (x, y) = (
                simd.load_singles(&Singles(a)),
                simd.load_singles(&Singles(b)),
            );
            for (found, plain) in [
                (x + y, from_fn(|i| a[i] + b[i])),
                (x - y, from_fn(|i| a[i] - b[i])),
                (x * y, from_fn(|i| a[i] * b[i])),
                (x / y, from_fn(|i| a[i] / b[i])),
                (
                    x.where_less(x, y, y),
                    from_fn(|i| if a[i] < b[i] { a[i] } else { b[i] }),
                ),
            ] {
                let plain: [f32; 16] = plain;
                if plain.iter().all(|p| !p.is_nan()) {
                    let least = plain.iter().fold(f32::INFINITY, |l, &p| l.min(p));
                    let lane = plain.iter().position(|&p| p == least).unwrap_or(0);
                    assert_eq!(found.least(), (least, lane), "{plain:?}");
                }
                let low: [f32; LANES] = from_fn(|i| plain[i]);
                let wide = simd.widened(&low).row().0.map(f64::to_bits);
                let plain_wide = low.map(|x| f64::from(x).to_bits());
                if low.iter().all(|p| !p.is_nan()) {
                    assert_eq!(wide, plain_wide);
                }
                // A lane is seen when all others are infinite.
                let lane = rng.bits() as usize % 16;
                if plain[lane] < f32::INFINITY {
                    let only = Singles(from_fn(|i| if i == lane { -1.0 } else { 1.0 }));
                    let [zero, none] = [0.0, f32::INFINITY].map(|x| simd.all_single(x));
                    let alone = found.where_less(simd.load_singles(&only), zero, none);
                    assert_eq!(alone.least(), (plain[lane], lane));
                }
            }
        }
    }
}

#[test]
fn two_rows_are_merged_in_order() {
    let endless = f64::INFINITY;
    let rows = [
        ([0.0, 0.1], [0.3, 0.7]),
        ([-2.0, 1.0], [1.0, 0.5]),
        ([endless, 0.25], [endless, 0.1]),
        ([4.0, endless], [0.1, endless]),
    ];
    for (mut next, steps) in rows {
        let mut merge = Merge::new(next, steps);
        for _ in 0..1000 {
            let first = next[0] <= next[1];
            let row = usize::from(!first);
            assert_eq!(merge.pop(), (next[row], usize::from(first)));
            next[row] += steps[row];
        }
    }
}
