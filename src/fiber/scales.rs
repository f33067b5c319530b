//! The scaled surface as closed geometry: sectors between axial half planes, each with a stack of
//! strips along z.
//!
//! In the unit-circle frame the surface of a strip is `rho = 1 + E(u, z)`, E the shape of the section
//! and the scales on it; `u = a / (a + b)` from the
//! distances a and b to the sector's two half planes, so that neighbors agree on their common plane
//! without any angle. `E` is linear in z and in u. A strip ends at the ruled surface
//! `z = end(u)`; where the next strip's surface is lower or higher the difference is a riser, an
//! exact wall.

pub(super) mod seek;

use super::clearance::Clearance;
use super::pattern::Pattern;
use super::section::{Line, Section, larger, smaller};
use glam::DVec3;

/// One strip of one sector: values on the two half planes. One cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Strip {
    /// Lower end, micrometers: the upper one of the strip below.
    pub(super) begin: [f64; 2],
    /// Upper end, micrometers.
    pub(super) end: [f64; 2],
    /// Height at z = 0 relative to the radius.
    pub(super) height: [f64; 2],
    /// Slope of the height, per micrometer.
    pub(super) slope: [f64; 2],
}

impl Strip {
    /// E at `u` and `z`.
    #[inline]
    pub(super) fn height_at(&self, u: f64, z: f64) -> f64 {
        let e0 = self.height[0] + self.slope[0] * z;
        let e1 = self.height[1] + self.slope[1] * z;
        e0 + u * (e1 - e0)
    }

    /// Whether a straight way from `z0` to `z1` in the strip's sector keeps clear of its ends.
    #[inline]
    pub(super) fn holds(&self, z0: f64, z1: f64) -> bool {
        let low = larger(self.begin[0], self.begin[1]);
        let high = smaller(self.end[0], self.end[1]);
        smaller(z0, z1) > low && larger(z0, z1) < high
    }
}

/// A half plane from the axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) cos: f64,
    pub(super) sin: f64,
}

/// The wedge between two half planes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sector {
    /// Where it begins and ends.
    pub(super) planes: [Plane; 2],
    first: u32,
    count: u32,
}

impl Sector {
    /// The first of its strips and their number.
    #[cfg(target_arch = "x86_64")]
    pub(super) fn strips(&self) -> [u32; 2] {
        [self.first, self.count]
    }

    /// Its strips of all of them.
    fn stack<'a>(&self, strips: &'a [Strip]) -> &'a [Strip] {
        &strips[self.first as usize..][..self.count as usize]
    }
}

/// A cell and the whole periods between its own z and the ray's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) sector: usize,
    pub(super) strip: usize,
    pub(super) shift: f64,
}

/// The scaled surface of one period.
#[derive(Clone, Debug)]
pub(super) struct Scales {
    pub(super) period: f64,
    pub(super) inverse_period: f64,
    pub(super) sectors: Vec<Sector>,
    strips: Vec<Strip>,
    /// The same for rays eight at a time.
    #[cfg(target_arch = "x86_64")]
    pub(super) shell: super::packet::Shell,
    /// For each strip the one of the previous and of the next sector that goes on beyond their common
    /// half plane: the same tile's, as a rule.
    pub(super) beside: Vec<[u16; 2]>,
    /// Strip at the middle of each step of z, sector by sector.
    pub(super) strip_at: Vec<u16>,
    /// Nothing changes along z: a section of any shape without scales.
    pub(super) bare: bool,
    /// Sector that holds the start of each step of the pseudo-angle.
    pub(super) start_of_angle: Vec<u16>,
    /// Radii that enclose the surface, with a margin above rounding.
    pub(super) rho_min: f64,
    pub(super) rho_max: f64,
    /// Squares of radii a little within these, which still enclose the surface: what ends at one of
    /// these circles is past them.
    pub(super) within2: f64,
    pub(super) beyond2: f64,
    /// For sections that are no ellipse.
    pub(super) clearance: Option<Box<Clearance>>,
}

/// How far above rounding the enclosing radii keep from the surface.
const MARGIN: f64 = 1e-9;

impl Scales {
    /// Joins the lines of a pattern.
    pub(super) fn new(pattern: &Pattern, lines: &[Line]) -> Self {
        let plane = |i: usize| Plane {
            cos: lines[i % lines.len()].cos,
            sin: lines[i % lines.len()].sin,
        };
        let (mut strips, mut sectors) = (Vec::new(), Vec::new());
        for i in 0..lines.len() {
            let first = strips.len();
            join(pattern, lines, i, &mut strips);
            sectors.push(Sector {
                planes: [plane(i), plane(i + 1)],
                first: first as u32,
                count: (strips.len() - first) as u32,
            });
        }
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        for s in &strips {
            for side in 0..2 {
                for z in [s.begin[side], s.end[side]] {
                    // The height is bilinear: its extremes on a strip are at corners, but for
                    // strips whose ends slope across u, which the margin below takes in.
                    let height = s.height[side] + s.slope[side] * z;
                    lowest = lowest.min(height);
                    highest = highest.max(height);
                }
            }
        }
        let margin = 0.02 * (highest - lowest) + MARGIN;
        let stacks = sectors.iter().map(|s| s.stack(&strips));
        let stacks: Vec<&[Strip]> = stacks.collect();
        Self {
            beside: seek::beside(&stacks),
            strip_at: seek::strips_at(&stacks, pattern.period_um),
            period: pattern.period_um,
            inverse_period: 1.0 / pattern.period_um,
            bare: strips.len() == sectors.len() && strips.iter().all(|s| s.slope == [0.0; 2]),
            #[cfg(target_arch = "x86_64")]
            shell: super::packet::Shell::new(&sectors, &strips),
            sectors,
            strips,
            start_of_angle: seek::starts_of_angles(lines),
            rho_min: 1.0 + lowest - margin,
            rho_max: 1.0 + highest + margin,
            within2: (1.0 + lowest - margin + 0.5 * MARGIN).powi(2),
            beyond2: (1.0 + highest + margin - 0.5 * MARGIN).powi(2),
            clearance: None,
        }
    }

    /// Lets rays know when they are far from the surface.
    pub(super) fn with_clearance(self) -> Self {
        let clearance = Clearance::new(&self);
        Self {
            clearance: Some(Box::new(clearance)),
            ..self
        }
    }

    /// Bounds of the least and the greatest radius over z on the first half plane of every sector, between
    /// two of which bounds go linearly in `u`.
    pub(super) fn extremes(&self) -> Vec<[f64; 2]> {
        let count = self.sectors.len();
        let mut extremes = vec![[f64::INFINITY, f64::NEG_INFINITY]; count];
        for (i, sector) in self.sectors.iter().enumerate() {
            for strip in sector.stack(&self.strips) {
                // Where its ends slope a strip between the planes has heights that it has on neither.
                let low = smaller(strip.begin[0], strip.begin[1]);
                let high = larger(strip.end[0], strip.end[1]);
                for (u, z) in [(0, low), (0, high), (1, low), (1, high)] {
                    let radius = 1.0 + strip.height_at(u as f64, z);
                    let [least, greatest] = &mut extremes[(i + u) % count];
                    *least = smaller(*least, radius);
                    *greatest = larger(*greatest, radius);
                }
            }
        }
        extremes
    }

    /// Radius of a cylinder about the axis that holds the surface, micrometers.
    ///
    /// * `semi`: semi-axes of the frame.
    pub(super) fn bounding_um(&self, semi: [f64; 2]) -> f64 {
        let highest = |sector: &Sector| {
            let strips = sector.stack(&self.strips);
            let ends = |s: &Strip, side: usize| {
                let at = |z: f64| s.height[side] + s.slope[side] * z;
                at(s.begin[side]).max(at(s.end[side]))
            };
            (0..2)
                .map(|side| {
                    let plane = sector.planes[side];
                    let out = (semi[0] * plane.cos).hypot(semi[1] * plane.sin);
                    let highest = strips.iter().map(|s| ends(s, side));
                    out * (1.0 + highest.fold(f64::NEG_INFINITY, f64::max))
                })
                .fold(0.0, f64::max)
        };
        // Between two planes the surface may bulge by the sagitta, half the angle squared.
        1.002 * self.sectors.iter().map(highest).fold(0.0, f64::max)
    }

    /// The strip of a cell.
    #[inline]
    pub(super) fn strip(&self, cell: Cell) -> &Strip {
        &self.strips[self.sectors[cell.sector].first as usize + cell.strip]
    }

    /// How many strips a sector has.
    #[inline]
    pub(super) fn count(&self, sector: usize) -> usize {
        self.sectors[sector].count as usize
    }

    /// `1 + E` of a cell at `u` and the ray's `z`.
    #[inline]
    pub(super) fn radius(&self, cell: Cell, u: f64, z: f64) -> f64 {
        1.0 + self.strip(cell).height_at(u, z - cell.shift)
    }

    /// Whether a point is inside the surface.
    pub(super) fn contains(&self, p: DVec3) -> bool {
        if let Some(clearance) = &self.clearance {
            let clear = clearance.at(p.x, p.y);
            if clear != 0.0 {
                return clear > 0.0;
            }
        }
        let rho = (p.x * p.x + p.y * p.y).sqrt();
        if rho <= self.rho_min || rho >= self.rho_max {
            return rho <= self.rho_min;
        }
        let cell = self.locate(p);
        rho < self.radius(cell, self.across(cell.sector, p.x, p.y), p.z)
    }

    /// Gradient of `rho - 1 - E` in the unit-circle frame: the outward normal of a face.
    pub(super) fn face_gradient(&self, cell: Cell, p: DVec3) -> DVec3 {
        let s = self.strip(cell);
        let (u, du) = self.across_gradient(cell.sector, p);
        let z = p.z - cell.shift;
        let along_u = s.height[1] - s.height[0] + (s.slope[1] - s.slope[0]) * z;
        let inverse_rho = 1.0 / (p.x * p.x + p.y * p.y).sqrt();
        DVec3::new(
            p.x * inverse_rho - along_u * du[0],
            p.y * inverse_rho - along_u * du[1],
            -(s.slope[0] + u * (s.slope[1] - s.slope[0])),
        )
    }

    /// Gradient of `z - end(u)`: the normal of the riser above a strip, toward the tip.
    pub(super) fn riser_gradient(&self, cell: Cell, p: DVec3) -> DVec3 {
        let end = self.strip(cell).end;
        let (_, du) = self.across_gradient(cell.sector, p);
        let along_u = end[1] - end[0];
        DVec3::new(-along_u * du[0], -along_u * du[1], 1.0)
    }

    /// `u` and its derivatives by x and y.
    fn across_gradient(&self, sector: usize, p: DVec3) -> (f64, [f64; 2]) {
        let [p0, p1] = self.sectors[sector].planes;
        let a = distance(p0, p.x, p.y);
        let w = a - distance(p1, p.x, p.y);
        let (wx, wy) = (p1.sin - p0.sin, p0.cos - p1.cos);
        let inverse = 1.0 / (w * w);
        let du = [
            (-p0.sin * w - a * wx) * inverse,
            (p0.cos * w - a * wy) * inverse,
        ];
        (a / w, du)
    }
}

/// A value between those on the two half planes.
#[inline]
pub(super) fn at(ends: [f64; 2], u: f64) -> f64 {
    ends[0] + u * (ends[1] - ends[0])
}

/// Signed distance of a point from a half plane's plane, positive toward larger angles.
#[inline]
pub(super) fn distance(plane: Plane, x: f64, y: f64) -> f64 {
    plane.cos * y - plane.sin * x
}

/// Appends the strips of sector `i`: the union of what shows on its two lines, in rank order. A tile
/// that shows on one line only narrows to a point on the other.
fn join(pattern: &Pattern, lines: &[Line], i: usize, strips: &mut Vec<Strip>) {
    let pair = [i, (i + 1) % lines.len()];
    let spans = pair.map(|l| &pattern.lines[l]);
    let mut at = [0, 0];
    let mut end = spans.map(|s| s.last().map_or(0.0, |s| s.end_um) - pattern.period_um);
    loop {
        let rank = |side: usize| spans[side].get(at[side]).map_or(u32::MAX, |s| s.tile);
        let tile = rank(0).min(rank(1));
        if tile == u32::MAX {
            return;
        }
        let begin = end;
        for side in 0..2 {
            if rank(side) == tile {
                end[side] = spans[side][at[side]].end_um;
            }
        }
        for side in 0..2 {
            if spans[side].get(at[side]).is_some_and(|s| s.tile == tile) {
                at[side] += 1;
            }
        }
        let tiles = pair.map(|l| (pattern.tile_on(tile, l), lines[l].support_um));
        strips.push(Strip {
            begin,
            end,
            height: std::array::from_fn(|side| {
                let ((height_um, _), support_um) = tiles[side];
                lines[pair[side]].rho - 1.0 + height_um / support_um
            }),
            slope: tiles.map(|((_, slope), support_um)| slope / support_um),
        });
    }
}

impl Section {
    /// How many lines describe a surface well: about one a micrometer, which still shows the
    /// crenation of margins (about 3 um); fewer on fine fibers, bounded to keep the tables in cache.
    ///
    /// * `bare`: without scales the shape alone is to be smooth, and costs one strip a line.
    pub(super) fn line_count(&self, bare: bool) -> usize {
        let least = if bare { 320 } else { 96 };
        (self.circumference().round() as usize).clamp(least, 320)
    }
}
