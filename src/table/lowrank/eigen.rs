//! Eigenvectors of small symmetric matrices by Jacobi rotations (Golub, Van Loan, Matrix
//! Computations, 8.5).

/// Eigenvalues, descending, and their unit eigenvectors: `vectors[k * n + i]` is component `i` of the
/// `k`-th.
///
/// * `matrix`: `n x n`, symmetric, row by row. * Every vector has its largest component positive, so
///   that the same matrix gives the same signs.
pub(in crate::table) fn symmetric(matrix: &[f64], n: usize) -> (Vec<f64>, Vec<f64>) {
    /// Sweeps after which all matrices of some hundred rows have long converged; 8 to 12 are usual.
    const SWEEPS: usize = 40;
    let mut a = matrix.to_vec();
    let mut v = vec![0.0; n * n];
    for i in 0..n {
        v[i * n + i] = 1.0;
    }
    let scale: f64 = a.iter().map(|x| x * x).sum();
    for _ in 0..SWEEPS {
        let off: f64 = (0..n)
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .map(|(i, j)| a[i * n + j] * a[i * n + j])
            .sum();
        if off <= 1e-26 * scale {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                rotate(&mut a, &mut v, n, p, q);
            }
        }
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| a[j * n + j].total_cmp(&a[i * n + i]));
    let values = order.iter().map(|&k| a[k * n + k]).collect();
    let vectors = order.iter().flat_map(|&k| {
        let column: Vec<f64> = (0..n).map(|i| v[i * n + k]).collect();
        let largest = column
            .iter()
            .fold(0.0f64, |m, &x| if x.abs() > m.abs() { x } else { m });
        let sign = if largest < 0.0 { -1.0 } else { 1.0 };
        column.into_iter().map(move |x| sign * x)
    });
    (values, vectors.collect())
}

/// Takes out the element `(p, q)`.
fn rotate(a: &mut [f64], v: &mut [f64], n: usize, p: usize, q: usize) {
    let apq = a[p * n + q];
    if apq == 0.0 {
        return;
    }
    let tau = (a[q * n + q] - a[p * n + p]) / (2.0 * apq);
    let t = tau.signum() / (tau.abs() + (1.0 + tau * tau).sqrt());
    let c = 1.0 / (1.0 + t * t).sqrt();
    let s = t * c;
    for k in 0..n {
        let (x, y) = (a[k * n + p], a[k * n + q]);
        a[k * n + p] = c * x - s * y;
        a[k * n + q] = s * x + c * y;
    }
    for k in 0..n {
        let (x, y) = (a[p * n + k], a[q * n + k]);
        a[p * n + k] = c * x - s * y;
        a[q * n + k] = s * x + c * y;
        let (x, y) = (v[k * n + p], v[k * n + q]);
        v[k * n + p] = c * x - s * y;
        v[k * n + q] = s * x + c * y;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    #[test]
    fn a_matrix_is_put_together_again() {
        let n = 12;
        let mut rng = Rng::new(1, 1);
        let x: Vec<f64> = (0..n * n).map(|_| rng.uniform() - 0.5).collect();
        let at = |i: usize, j: usize| (0..n).map(|k| x[i * n + k] * x[j * n + k]).sum::<f64>();
        let a: Vec<f64> = (0..n * n).map(|i| at(i / n, i % n)).collect();
        let (values, vectors) = symmetric(&a, n);
        assert!(values.is_sorted_by(|a, b| a >= b));
        for i in 0..n {
            for j in 0..n {
                let sum: f64 = (0..n)
                    .map(|k| values[k] * vectors[k * n + i] * vectors[k * n + j])
                    .sum();
                assert!((sum - a[i * n + j]).abs() < 1e-12);
                let dot: f64 = (0..n)
                    .map(|k| vectors[i * n + k] * vectors[j * n + k])
                    .sum();
                assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn known_eigenvalues() {
        let (values, vectors) = symmetric(&[2.0, 1.0, 1.0, 2.0], 2);
        assert!((values[0] - 3.0).abs() < 1e-14 && (values[1] - 1.0).abs() < 1e-14);
        assert!((vectors[0] - 0.5f64.sqrt()).abs() < 1e-14);
    }
}
