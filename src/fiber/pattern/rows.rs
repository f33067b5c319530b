//! Rows of scales that go round the fiber.

use super::covering::visible;
use super::rise::Rise;
use super::{Builder, Pattern, Scale};

impl Builder<'_> {
    /// Rows a pitch apart; each ends at the margin curve over its upper end.
    pub(super) fn rows(&self) -> Pattern {
        let rise = Rise::new(self.recipe.rise, 1.0);
        let ends: Vec<f64> = (0..self.rows)
            .map(|row| row as f64 + 0.1 * self.jitter(1, row))
            .collect();
        // All of a scale is plane along the hair, however its margin runs: tilted round the fiber as
        // well, deep chevrons would turn the light sideways, which no reader of a plate expects.
        let scales: Vec<Scale> = ends
            .iter()
            .map(|end| Scale {
                base: end - 1.0,
                pivot: 0.0,
            })
            .collect();
        let pieces = self.pieces();
        let shown = self
            .lines
            .iter()
            .map(|line| {
                let all: Vec<f64> = (0..self.rows)
                    .map(|row| ends[row] + self.edge.at(row, row, line.turn))
                    .collect();
                let worn = |row: usize| self.is_worn(row * pieces + self.piece(row, line.turn));
                self.unless_bare(&all, worn)
            })
            .map(|ends| {
                let shows = visible(&ends, self.rows as f64);
                shows.into_iter().map(|row| (row, ends[row])).collect()
            })
            .collect();
        let lifts = self.lifted_pieces(&ends);
        // Deep margins reach many times the height up and down; there the slopes must agree.
        self.assemble(&scales, &rise, self.edge.reach().max(1.0), shown, lifts)
    }
}
