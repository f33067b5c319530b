//! Maps as sums of few images: the rank-k factorization of a table.
//!
//! On the grid of [`aligned`] the maps of all nodes and channels fall together, and a fiber's
//! scattering is nearly a product of a function of the direction and one of the node: a few images
//! and a weight a map are enough. Not aligned, eight images leave 30 to 80 % of error; aligned, 1 to 2 %
//! on fibers whose light follows the cone.
//!
//! Moving maps to the grid and back blurs them by about a texel, which is 5 to 15 % of a sharp cone. So the
//! factors are not those of the moved maps: what the factors fail to give back is moved again and added,
//! until they give back the maps themselves (Van Cittert's iteration, projected to the rank each time).
//! The same steps fill in the part of the grid that a node does not see.

mod aligned;
mod eigen;

pub(in crate::table) use aligned::Grid;
pub(in crate::table) use eigen::symmetric;

use super::pack::Layout;
use rayon::prelude::*;

/// Rounds of refinement. Four leave a third of the blur, eight amplify noise more than they sharpen.
const ROUNDS: usize = 6;

/// Maps as sums of images.
#[derive(Clone, Debug)]
pub(in crate::table) struct Factors {
    /// Where the images live.
    pub(in crate::table) grid: Grid,
    /// `images[k]`.
    pub(in crate::table) images: Vec<Vec<f32>>,
    /// `weights[row * images + k]`.
    pub(in crate::table) weights: Vec<f32>,
}

/// Rows of maps to factorize.
pub(in crate::table) struct Rows<'a> {
    /// How the numbers of a map lie.
    pub(in crate::table) layout: Layout,
    /// Inclinations of the nodes, radians.
    pub(in crate::table) thetas: &'a [f64],
    /// `maps[node * channels + channel]`: densities.
    pub(in crate::table) maps: &'a [Vec<f32>],
    /// What each row's error counts, relative to the others.
    pub(in crate::table) importance: &'a [f64],
}

impl Factors {
    /// Factors of the rows: `rank` images.
    pub(in crate::table) fn new(rows: &Rows<'_>, rank: usize) -> Self {
        let grid = Grid::new(rows.layout);
        let channels = rows.maps.len() / rows.thetas.len();
        let sources: Vec<_> = rows
            .thetas
            .par_iter()
            .map(|&theta| grid.sources(rows.layout, theta))
            .collect();
        let footprints: Vec<_> = rows
            .thetas
            .par_iter()
            .map(|&theta| grid.footprints(rows.layout, theta))
            .collect();
        let mut stack: Vec<Vec<f32>> = vec![vec![0.0; grid.len()]; rows.maps.len()];
        let mut rest: Vec<Vec<f32>> = rows.maps.to_vec();
        let mut factors = Self {
            grid,
            images: Vec::new(),
            weights: Vec::new(),
        };
        for _ in 0..ROUNDS {
            let moved = stack.par_iter_mut().zip(&rest).enumerate();
            moved.for_each(|(row, (image, rest))| {
                for (cell, source) in image.iter_mut().zip(&sources[row / channels]) {
                    if let Some((place, cosine)) = source {
                        *cell += rest[*place as usize] * cosine;
                    }
                }
            });
            factors.fit(&stack, rows.importance, rank);
            stack = (0..stack.len())
                .into_par_iter()
                .map(|row| factors.image(row))
                .collect();
            rest = (0..stack.len())
                .into_par_iter()
                .map(|row| {
                    let back = footprints[row / channels].apply(&stack[row]);
                    rows.maps[row]
                        .iter()
                        .zip(&back)
                        .map(|(m, b)| m - b)
                        .collect()
                })
                .collect();
        }
        factors
    }

    /// The best factors of a stack of images: eigenvectors of the rows' products.
    fn fit(&mut self, stack: &[Vec<f32>], importance: &[f64], rank: usize) {
        let n = stack.len();
        let pairs: Vec<(usize, usize)> =
            (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).collect();
        let products: Vec<f64> = pairs
            .par_iter()
            .map(|&(i, j)| importance[i] * importance[j] * dot(&stack[i], &stack[j]))
            .collect();
        let mut gram = vec![0.0; n * n];
        for (&(i, j), &product) in pairs.iter().zip(&products) {
            gram[i * n + j] = product;
            gram[j * n + i] = product;
        }
        let (_, vectors) = symmetric(&gram, n);
        let keep = rank.clamp(1, n);
        self.images = (0..keep)
            .into_par_iter()
            .map(|k| {
                let mut image = vec![0.0f32; self.grid.len()];
                for (i, row) in stack.iter().enumerate() {
                    let w = (vectors[k * n + i] * importance[i]) as f32;
                    image.iter_mut().zip(row).for_each(|(x, r)| *x += w * r);
                }
                image
            })
            .collect();
        self.weights = (0..n * keep)
            .map(|i| (vectors[i % keep * n + i / keep] / importance[i / keep]) as f32)
            .collect();
    }

    /// The image of one row.
    fn image(&self, row: usize) -> Vec<f32> {
        let count = self.images.len();
        let mut sum = vec![0.0f32; self.grid.len()];
        for (image, &w) in self.images.iter().zip(&self.weights[row * count..]) {
            sum.iter_mut().zip(image).for_each(|(s, x)| *s += w * x);
        }
        sum
    }

    /// The maps of all rows.
    pub(in crate::table) fn maps(&self, layout: Layout, thetas: &[f64]) -> Vec<Vec<f32>> {
        let rows = self.weights.len() / self.images.len().max(1);
        let channels = rows / thetas.len();
        let maps = thetas
            .par_iter()
            .enumerate()
            .flat_map_iter(|(node, &theta)| {
                let footprints = self.grid.footprints(layout, theta);
                let row = move |c: usize| footprints.apply(&self.image(node * channels + c));
                (0..channels).map(row)
            });
        maps.collect()
    }
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(&x, &y)| f64::from(x) * f64::from(y))
        .sum()
}

#[cfg(test)]
mod tests;
