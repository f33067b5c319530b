//! Maps as square tiles: six faces, or three where the mirror image azimuth -> -azimuth is left out.
//!
//! A folded map keeps the directions of `y > 0`: the right halves of the faces +X and -X side by side
//! in one square, all of +Y, and the lower halves of +Z and -Z one above the other in one square.

/// How texels of a unicube lie in tiles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::table) struct Layout {
    /// Texels along a face edge, a power of two, at least 2 if folded.
    pub(in crate::table) res: usize,
    /// Whether only one half is kept.
    pub(in crate::table) folded: bool,
}

impl Layout {
    /// Tiles of a map, each `res x res`.
    pub(in crate::table) fn tiles(self) -> usize {
        if self.folded { 3 } else { 6 }
    }

    /// Numbers of a map.
    pub(in crate::table) fn len(self) -> usize {
        self.tiles() * self.res * self.res
    }

    /// The texel at place `i` of the tiles.
    pub(in crate::table) fn texel(self, i: usize) -> usize {
        if !self.folded {
            return i;
        }
        let n = self.res;
        let (tile, row, column) = (i / (n * n), i / n % n, i % n);
        let half = n / 2;
        let (face, v, u) = match tile {
            0 => (column / half, row, half + column % half),
            1 => (2, row, column),
            _ => (4 + row / half, half + row % half, column),
        };
        (face * n + v) * n + u
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::unicube::Unicube;

    #[test]
    fn a_folded_map_and_its_mirror_image_are_all_of_it() {
        for res in [2, 8, 64] {
            let cube = Unicube::new(res);
            let layout = Layout { res, folded: true };
            let mut seen = vec![0; cube.texels()];
            for i in 0..layout.len() {
                let texel = layout.texel(i);
                let (w, _) = cube.direction(texel, 0.5, 0.5);
                assert!(w.y > 0.0);
                seen[texel] += 1;
                seen[cube.mirrored(texel)] += 1;
            }
            assert!(seen.iter().all(|&n| n == 1));
        }
    }
}
