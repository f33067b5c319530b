//! The first guess: all nodes on one lattice.

use super::desk::{Desk, LANES, SIDE};
use super::field::Field;
use super::lattice::{Lattice, STRIP};
use super::{CAUTION, Map, Reconstruction};
use crate::bake::tally::Tally;
use rayon::prelude::*;
use std::ops::Range;

/// Groups of levels whose photons are put on their lattices together.
const TOGETHER: usize = 3;

impl Reconstruction {
    /// S as it is expected from all nodes: of the kinds of light, then of groups of levels. Nothing where
    /// nodes do not meet.
    ///
    /// * `signals`: of every node; `densities`: groups of levels of every node, or no nodes.
    pub(super) fn guess(
        &self,
        tallies: &[Tally],
        signals: &[Map],
        densities: &[Vec<Map>],
    ) -> Vec<Field<4>> {
        let Some((lattice, pyramid)) = &self.joint else {
            return Vec::new();
        };
        let photons: Vec<f64> = tallies.iter().map(|tally| tally.photons() as f64).collect();
        let exposure = lattice.exposure(&photons);
        let planes = pyramid.planes(exposure.clone());
        let groups = densities.first().map_or(0, Vec::len);
        let ((kinds, gains), levels) = rayon::join(
            || {
                let [mut kinds, squares] = self.gathered(lattice, &photons, |node, cell, scale| {
                    let counts = signals[node][cell].map(|v| v * scale);
                    let [_, bare, _, colored] = counts;
                    [counts, [bare * bare, colored * colored, 0.0, 0.0]]
                });
                kinds.divide(&exposure);
                let gains = |kind: usize| {
                    let (s, squares) = (kinds.lane(2 * kind), squares.lane(kind));
                    pyramid.gains(&planes, &s, squares, CAUTION)
                };
                let gains = rayon::join(|| gains(0), || gains(1));
                (kinds, gains)
            },
            || {
                let firsts = (0..groups).step_by(TOGETHER).collect::<Vec<_>>();
                let sums = firsts
                    .into_par_iter()
                    .with_max_len(1)
                    .flat_map_iter(|first| {
                        let sums = self.gathered(lattice, &photons, |node, cell, scale| {
                            std::array::from_fn::<_, TOGETHER, _>(|group| {
                                let group = densities[node].get(first + group);
                                group.map_or([0.0; SIDE], |map| map[cell].map(|v| v * scale))
                            })
                        });
                        sums.into_iter().take(groups - first)
                    });
                sums.collect::<Vec<_>>()
            },
        );
        let (bare, colored) = &gains;
        let mut fields = vec![kinds];
        fields.extend(levels);
        let all = fields.par_iter_mut().with_max_len(1).enumerate();
        all.for_each(|(group, field)| {
            let gains = match group {
                0 => [bare, colored],
                _ => {
                    field.divide(&exposure);
                    [colored, colored]
                }
            };
            pyramid.apply(&planes, field, gains);
        });
        fields
    }

    /// Counts of all nodes on the lattice.
    ///
    /// * `of`: photons of a node and a cell of its map from what makes counts of densities.
    fn gathered<const K: usize>(
        &self,
        lattice: &Lattice,
        photons: &[f64],
        of: impl Fn(usize, usize, f32) -> [[f32; SIDE]; K],
    ) -> [Field<4>; K] {
        let mut sums = std::array::from_fn(|_| Field::new(lattice.size()));
        for (node, photons) in photons.iter().enumerate() {
            let cells = self.solid_angle.iter().enumerate();
            let counts = cells.map(|(cell, omega)| of(node, cell, (omega * photons) as f32));
            lattice.gather(node, counts, &mut sums);
        }
        sums
    }

    /// Puts on a desk what is expected of some nodes.
    pub(super) fn expect(&self, desk: &mut Desk, nodes: Range<usize>, guess: &[Field<4>]) {
        let Some((lattice, _)) = &self.joint else {
            return;
        };
        let cells = self.scales.texels.len();
        desk.guess.resize(guess.len(), Vec::new());
        for lanes in &mut desk.guess {
            lanes.clear();
            lanes.resize(cells, [0.0; LANES]);
        }
        for (node, lane) in nodes.zip((0..LANES).step_by(SIDE)) {
            let strips = guess.chunks(STRIP / SIDE);
            for (fields, lanes) in strips.zip(desk.guess.chunks_mut(STRIP / SIDE)) {
                lattice.project(node, fields, &mut desk.seen, |cell, seen| {
                    for (lanes, seen) in lanes.iter_mut().zip(seen.chunks_exact(SIDE)) {
                        lanes[cell][lane..lane + SIDE].copy_from_slice(seen);
                    }
                });
            }
        }
    }

    /// Puts on a desk what is expected of the two halves of the photons of one node.
    pub(super) fn expect_halves(&self, desk: &mut Desk, node: usize, guess: &[Field<4>]) {
        let Some((lattice, _)) = &self.joint else {
            return;
        };
        let mut lanes = desk.guess.pop().unwrap_or_default();
        lanes.resize(self.scales.texels.len(), [0.0; LANES]);
        lattice.project(node, guess, &mut desk.seen, |cell, seen| {
            lanes[cell].copy_from_slice(&seen[..LANES]);
        });
        desk.guess.push(lanes);
    }
}
