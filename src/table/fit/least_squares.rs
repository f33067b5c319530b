//! Levenberg-Marquardt with differences for derivatives, parameters kept inside their ranges.

/// Rounds at most; fits of ten parameters take 10 to 30.
const ROUNDS: usize = 60;

/// A fit has converged when a round takes off less than this share of the squared error.
const ENOUGH: f64 = 1e-6;

/// The parameters inside `ranges` that make the sum of squares of `residuals` least, from `start`, and
/// that sum. Returns the start itself if it cannot be improved.
pub(super) fn minimize(
    start: &[f64],
    ranges: &[[f64; 2]],
    residuals: impl Fn(&[f64]) -> Vec<f64>,
) -> (Vec<f64>, f64) {
    // Free variables: the logit of the place in the range. Starts keep off the ends, where it is infinite.
    let inside = |x: f64, [lo, hi]: [f64; 2]| lo + (hi - lo) / (1.0 + (-x).exp());
    let mut free: Vec<f64> = start
        .iter()
        .zip(ranges)
        .map(|(&p, [lo, hi])| {
            let place = ((p - lo) / (hi - lo)).clamp(0.003, 0.997);
            (place / (1.0 - place)).ln()
        })
        .collect();
    let parameters = |free: &[f64]| -> Vec<f64> {
        free.iter()
            .zip(ranges)
            .map(|(&x, &range)| inside(x, range))
            .collect()
    };
    let square = |r: &[f64]| r.iter().map(|x| x * x).sum::<f64>();
    let mut rest = residuals(&parameters(&free));
    let mut least = square(&rest);
    let mut damping = 1e-2;
    for _ in 0..ROUNDS {
        let columns: Vec<Vec<f64>> = (0..free.len())
            .map(|k| {
                const STEP: f64 = 1e-4;
                let mut moved = free.clone();
                moved[k] += STEP;
                let there = residuals(&parameters(&moved));
                there
                    .iter()
                    .zip(&rest)
                    .map(|(b, a)| (b - a) / STEP)
                    .collect()
            })
            .collect();
        let before = least;
        for _ in 0..8 {
            let step = solve(&columns, &rest, damping);
            let trial: Vec<f64> = free
                .iter()
                .zip(&step)
                .map(|(x, s)| (x - s.clamp(-1.5, 1.5)).clamp(-8.0, 8.0))
                .collect();
            let there = residuals(&parameters(&trial));
            let sum = square(&there);
            if sum < least {
                (free, rest, least) = (trial, there, sum);
                damping = (0.3 * damping).max(1e-9);
                break;
            }
            damping *= 4.0;
        }
        if before - least <= ENOUGH * before {
            break;
        }
    }
    (parameters(&free), least)
}

/// The step of the damped normal equations, by Cholesky.
fn solve(columns: &[Vec<f64>], rest: &[f64], damping: f64) -> Vec<f64> {
    let n = columns.len();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let mut a = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            a[i * n + j] = dot(&columns[i], &columns[j]);
        }
    }
    let largest = (0..n).map(|i| a[i * n + i]).fold(0.0, f64::max);
    let mut x: Vec<f64> = columns.iter().map(|c| dot(c, rest)).collect();
    for i in 0..n {
        // Parameters without any effect stay where they are.
        a[i * n + i] += damping * a[i * n + i] + 1e-12 * largest + f64::MIN_POSITIVE;
    }
    for i in 0..n {
        for j in 0..=i {
            let sum = a[i * n + j] - (0..j).map(|k| a[i * n + k] * a[j * n + k]).sum::<f64>();
            a[i * n + j] = if i == j {
                sum.max(f64::MIN_POSITIVE).sqrt()
            } else {
                sum / a[j * n + j]
            };
        }
    }
    for i in 0..n {
        let known: f64 = (0..i).map(|k| a[i * n + k] * x[k]).sum();
        x[i] = (x[i] - known) / a[i * n + i];
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| a[k * n + i] * x[k]).sum();
        x[i] = (x[i] - known) / a[i * n + i];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_valley_of_rosenbrock_is_followed() {
        let residuals = |p: &[f64]| vec![1.0 - p[0], 10.0 * (p[1] - p[0] * p[0])];
        let (p, least) = minimize(&[-1.2, 1.0], &[[-3.0, 3.0]; 2], residuals);
        assert!(
            (p[0] - 1.0).abs() < 1e-3 && (p[1] - 1.0).abs() < 2e-3,
            "{p:?} {least}"
        );
    }

    #[test]
    fn ranges_hold() {
        let (p, _) = minimize(&[0.5, 0.5], &[[0.0, 1.0]; 2], |p| vec![p[0] - 7.0, 1.0]);
        assert!(p[0] > 0.99 && p[0] <= 1.0, "{p:?}");
    }
}
