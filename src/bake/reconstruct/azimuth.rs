//! Rows of azimuth in scales: a row and, behind one another, what is left of it on half as many cells,
//! on a quarter, and so on. Rows are even at both ends.

use super::field::TAPS;

/// Cells that a row and all its scales have.
pub(super) fn cells(row: usize, depth: usize) -> usize {
    (0..=depth).map(|step| row >> step).sum()
}

/// Where each scale begins, and where the last one ends.
#[inline(always)]
pub(super) fn segments(row: usize, depth: usize) -> impl DoubleEndedIterator<Item = [usize; 2]> {
    (0..=depth).map(move |step| {
        let start = cells(row, step) - (row >> step);
        [start, start + (row >> step)]
    })
}

/// Takes a row apart: the first `row` cells hold it before and its finest band after, the others its other
/// bands.
#[inline(always)]
pub(super) fn split<const N: usize>(bands: &mut [[f32; N]], row: usize, depth: usize) {
    let (mut rest, mut n) = (bands, row);
    for _ in 0..depth {
        let (fine, coarse) = rest.split_at_mut(n);
        n /= 2;
        narrow(fine, &mut coarse[..n]);
        add_wide(fine, -1.0, &coarse[..n]);
        rest = coarse;
    }
}

/// Puts bands together again.
#[inline(always)]
pub(super) fn join<const N: usize>(bands: &mut [[f32; N]], row: usize, depth: usize) {
    let mut end = cells(row, depth);
    for step in (0..depth).rev() {
        let n = row >> step;
        let start = end - n / 2 - n;
        let (fine, coarse) = bands[start..end].split_at_mut(n);
        add_wide(fine, 1.0, coarse);
        end -= n / 2;
    }
}

/// Half as many cells.
#[inline(always)]
pub(super) fn narrow<const N: usize>(from: &[[f32; N]], to: &mut [[f32; N]]) {
    let (half, last) = (to.len(), from.len() - 1);
    let sum = |from: [&[f32; N]; 4]| {
        std::array::from_fn(|lane| {
            let [a, b, c, d] = from.map(|v| v[lane]);
            TAPS[0] * a + TAPS[1] * b + TAPS[2] * c + TAPS[3] * d
        })
    };
    for i in [0, half - 1] {
        let at = |tap: usize| &from[(2 * i + tap).saturating_sub(1).min(last)];
        to[i] = sum([at(0), at(1), at(2), at(3)]);
    }
    if half > 2 {
        let pairs = from[1..].chunks_exact(2).zip(from[3..].chunks_exact(2));
        for (to, (a, b)) in to[1..half - 1].iter_mut().zip(pairs) {
            *to = sum([&a[0], &a[1], &b[0], &b[1]]);
        }
    }
}

/// Adds `sign` times half as many cells, linear between their centers.
#[inline(always)]
pub(super) fn add_wide<const N: usize>(to: &mut [[f32; N]], sign: f32, from: &[[f32; N]]) {
    let half = from.len();
    let add = |to: &mut [f32; N], near: &[f32; N], next: &[f32; N]| {
        for ((to, near), next) in to.iter_mut().zip(near).zip(next) {
            *to += sign * (0.75 * near + 0.25 * next);
        }
    };
    for i in if half > 1 { [0, half - 1] } else { [0, 0] }
        .into_iter()
        .take(half.min(2))
    {
        add(&mut to[2 * i], &from[i], &from[i.saturating_sub(1)]);
        add(&mut to[2 * i + 1], &from[i], &from[(i + 1).min(half - 1)]);
    }
    if half > 2 {
        let pairs = to[2..2 * half - 2].chunks_exact_mut(2);
        for (to, from) in pairs.zip(from.windows(3)) {
            let (low, high) = to.split_at_mut(1);
            add(&mut low[0], &from[1], &from[0]);
            add(&mut high[0], &from[1], &from[2]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_are_put_together_again_and_a_constant_is_in_the_coarsest() {
        for (row, depth) in [(64, 5), (8, 2), (4, 1), (2, 0)] {
            let values = |i: usize| [(i * i % 7) as f32, 3.0];
            let mut bands = vec![[0.0; 2]; cells(row, depth)];
            for (i, v) in bands[..row].iter_mut().enumerate() {
                *v = values(i);
            }
            split(&mut bands, row, depth);
            for (step, [start, end]) in segments(row, depth).enumerate() {
                let expected = if step == depth { 3.0 } else { 0.0 };
                let all = &bands[start..end];
                assert!(all.iter().all(|v| (v[1] - expected).abs() < 1e-6));
            }
            join(&mut bands, row, depth);
            for (i, v) in bands[..row].iter().enumerate() {
                assert!((v[0] - values(i)[0]).abs() < 1e-5, "{row} {i}");
            }
        }
    }
}
