//! The cells of the shell in which eight rays are: [`Scales`]' own search for them, lane by lane.

use super::super::march::Side;
use super::super::scales::seek::{ANGLE_STEPS, Z_STEPS};
use super::super::scales::{Scales, Sector, Strip};
use crate::math::lanes::{F64x8, LANES, Mask, Row, U64x8, Vectors, Wide};

/// Sectors and strips as lines of the cache.
#[derive(Clone, Debug)]
pub(in crate::fiber) struct Shell {
    /// Cosine and sine of both planes, the bits of the first strip and of their number.
    sectors: Vec<Row>,
    /// Begin, end, height and slope on both planes.
    strips: Vec<Row>,
}

impl Shell {
    pub(in crate::fiber) fn new(sectors: &[Sector], strips: &[Strip]) -> Self {
        let sectors = sectors.iter().map(|s| {
            let [p, q] = s.planes;
            let [first, count] = s.strips().map(|k| f64::from_bits(u64::from(k)));
            Row([p.cos, p.sin, q.cos, q.sin, first, count, 0.0, 0.0])
        });
        let strips = strips.iter().map(|s| {
            let [begin, end, height, slope] = [s.begin, s.end, s.height, s.slope];
            Row([
                begin[0], begin[1], end[0], end[1], height[0], height[1], slope[0], slope[1],
            ])
        });
        Self {
            sectors: sectors.collect(),
            strips: strips.collect(),
        }
    }
}

/// A number on both half planes of a sector.
pub(super) type Pair<W> = [F64x8<W>; 2];

/// Cells, each with what is in the tables of it.
pub(super) struct Cells<'a, W: Wide> {
    simd: W,
    scales: &'a Scales,
    pub(super) sector: U64x8<W>,
    pub(super) strip: U64x8<W>,
    pub(super) shift: F64x8<W>,
    /// Cosines and sines of the planes.
    pub(super) cos: Pair<W>,
    pub(super) sin: Pair<W>,
    first: U64x8<W>,
    count: U64x8<W>,
    pub(super) begin: Pair<W>,
    pub(super) end: Pair<W>,
    pub(super) height: Pair<W>,
    pub(super) slope: Pair<W>,
}

impl<'a, W: Wide> Cells<'a, W> {
    /// The cells of strips of sectors, in the first period.
    #[inline(always)]
    pub(super) fn new(simd: W, scales: &'a Scales, sector: U64x8<W>, strip: U64x8<W>) -> Self {
        let zero = simd.all(0.0);
        let mut cells = Self {
            simd,
            scales,
            sector,
            strip,
            shift: zero,
            cos: [zero; 2],
            sin: [zero; 2],
            first: sector,
            count: sector,
            begin: [zero; 2],
            end: [zero; 2],
            height: [zero; 2],
            slope: [zero; 2],
        };
        cells.look_up_sectors();
        cells.look_up_strips();
        cells
    }

    /// The cells that hold points. See [`Scales::locate`].
    #[inline(always)]
    pub(super) fn locate(simd: W, scales: &'a Scales, p: Vectors<W>) -> Self {
        let x = p.x / (p.x.abs() + p.y.abs());
        let pseudo = 2.0 - (1.0 + x).with_sign_of(p.y);
        let angle = (pseudo * (ANGLE_STEPS as f64 / 4.0)).whole().array();
        let starts = angle.map(|a| {
            let sector = scales.start_of_angle[(a as usize).min(ANGLE_STEPS - 1)];
            f64::from_bits(u64::from(sector))
        });
        let zero = simd.all_bits(0);
        let mut cells = Self::new(simd, scales, simd.load(&Row(starts)).bits(), zero);
        let one = simd.all_bits(1);
        let last = simd.all_bits(scales.sectors.len() as u64 - 1);
        loop {
            let beyond = cells.distance(1, p.x, p.y).ge(simd.all(0.0))
                & (cells.cos[1] * p.x + cells.sin[1] * p.y).gt(simd.all(0.0))
                & cells.sector.lt(last);
            if !beyond.any() {
                break;
            }
            cells.sector = cells.sector.plus(one).or(beyond, cells.sector);
            cells.look_up_sectors();
        }
        cells.shift = scales.period * (p.z * scales.inverse_period).floor();
        let step = (p.z - cells.shift) * scales.inverse_period * (Z_STEPS as f64);
        let (step, sector) = (step.whole().array(), cells.sector.array());
        let strips = std::array::from_fn(|i| {
            let step = (step[i] as usize).min(Z_STEPS - 1);
            let strip = scales.strip_at[sector[i] as usize * Z_STEPS + step];
            f64::from_bits(u64::from(strip))
        });
        cells.strip = simd.load(&Row(strips)).bits();
        cells.look_up_strips();
        let u = cells.across(p);
        cells.settle(simd.every(), u, p.z);
        cells
    }

    #[inline(always)]
    pub(super) fn look_up_sectors(&mut self) {
        let index = self.sector.array();
        let rows: [&Row; LANES] =
            std::array::from_fn(|i| &self.scales.shell.sectors[index[i] as usize]);
        let [c0, s0, c1, s1, first, count, ..] = self.simd.columns(rows);
        (self.cos, self.sin) = ([c0, c1], [s0, s1]);
        (self.first, self.count) = (first.bits(), count.bits());
    }

    #[inline(always)]
    pub(super) fn look_up_strips(&mut self) {
        let index = self.first.plus(self.strip).array();
        let rows: [&Row; LANES] =
            std::array::from_fn(|i| &self.scales.shell.strips[index[i] as usize]);
        let [b0, b1, e0, e1, h0, h1, s0, s1] = self.simd.columns(rows);
        (self.begin, self.end) = ([b0, b1], [e0, e1]);
        (self.height, self.slope) = ([h0, h1], [s0, s1]);
    }

    /// Into the cells above; the strips are still to be looked up.
    #[inline(always)]
    pub(super) fn up(&mut self, lanes: Mask<W>) {
        let (zero, one) = (self.simd.all_bits(0), self.simd.all_bits(1));
        let next = self.strip.plus(one);
        let over = next.is(self.count);
        self.strip = zero.or(over, next).or(lanes, self.strip);
        self.shift = (self.shift + self.scales.period).or(lanes & over, self.shift);
    }

    /// Into the cells below; the strips are still to be looked up.
    #[inline(always)]
    pub(super) fn down(&mut self, lanes: Mask<W>) {
        let (zero, one) = (self.simd.all_bits(0), self.simd.all_bits(1));
        let under = self.strip.is(zero);
        let next = self.count.or(under, self.strip).minus(one);
        self.strip = next.or(lanes, self.strip);
        self.shift = (self.shift - self.scales.period).or(lanes & under, self.shift);
    }

    /// Into the sectors beyond the second plane (`second`) or the first; strips are those that as a rule go
    /// on there, sectors and strips are still to be looked up.
    #[inline(always)]
    pub(super) fn aside(&mut self, lanes: Mask<W>, second: Mask<W>) {
        let (index, sector) = (self.first.plus(self.strip).array(), self.sector.array());
        let (mut sectors, mut strips) = (self.sector.numbers().row(), self.strip.numbers().row());
        for lane in lanes.lanes() {
            let plane = usize::from(second.has(lane));
            let beside = self.scales.beside[index[lane] as usize][plane];
            let sector = self.scales.neighbor(sector[lane] as usize, plane);
            sectors.0[lane] = f64::from_bits(sector as u64);
            strips.0[lane] = f64::from_bits(u64::from(beside));
        }
        self.sector = self.simd.load(&sectors).bits();
        self.strip = self.simd.load(&strips).bits();
    }

    /// From near strips to those that hold `z` at `u`. See [`Scales::settle`].
    #[inline(always)]
    pub(super) fn settle(&mut self, lanes: Mask<W>, u: F64x8<W>, z: F64x8<W>) {
        loop {
            let above = lanes & (z - self.shift).gt(at(self.end, u));
            if !above.any() {
                break;
            }
            self.up(above);
            self.look_up_strips();
        }
        loop {
            let below = lanes & (z - self.shift).le(at(self.begin, u));
            if !below.any() {
                break;
            }
            self.down(below);
            self.look_up_strips();
        }
    }

    /// Distance from the first or the second plane.
    #[inline(always)]
    pub(super) fn distance(&self, plane: usize, x: F64x8<W>, y: F64x8<W>) -> F64x8<W> {
        self.cos[plane] * y - self.sin[plane] * x
    }

    /// Positions between the half planes.
    #[inline(always)]
    pub(super) fn across(&self, p: Vectors<W>) -> F64x8<W> {
        let a = self.distance(0, p.x, p.y);
        a / (a - self.distance(1, p.x, p.y))
    }

    /// `1 + E` at `u` and the rays' `z`.
    #[inline(always)]
    pub(super) fn radius(&self, u: F64x8<W>, z: F64x8<W>) -> F64x8<W> {
        let z = z - self.shift;
        let e0 = self.height[0] + self.slope[0] * z;
        let e1 = self.height[1] + self.slope[1] * z;
        1.0 + (e0 + u * (e1 - e0))
    }

    /// `u` and its derivatives by x and y.
    #[inline(always)]
    fn across_gradient(&self, p: Vectors<W>) -> (F64x8<W>, Pair<W>) {
        let a = self.distance(0, p.x, p.y);
        let w = a - self.distance(1, p.x, p.y);
        let (wx, wy) = (self.sin[1] - self.sin[0], self.cos[0] - self.cos[1]);
        let inverse = 1.0 / (w * w);
        let du = [
            (-self.sin[0] * w - a * wx) * inverse,
            (self.cos[0] * w - a * wy) * inverse,
        ];
        (a / w, du)
    }

    /// See `Scales::is_clear`.
    #[inline(always)]
    pub(super) fn is_clear(&self, rho2: F64x8<W>, side: Side) -> Mask<W> {
        match side {
            Side::Inside => rho2.le(self.simd.all(self.scales.within2)),
            Side::Outside => rho2.ge(self.simd.all(self.scales.beyond2)),
        }
    }

    /// See [`Scales::face_gradient`].
    #[inline(always)]
    pub(super) fn face_gradient(&self, p: Vectors<W>) -> Vectors<W> {
        let (u, du) = self.across_gradient(p);
        let z = p.z - self.shift;
        let (height, slope) = (self.height, self.slope);
        let along_u = height[1] - height[0] + (slope[1] - slope[0]) * z;
        let inverse_rho = 1.0 / (p.x * p.x + p.y * p.y).sqrt();
        Vectors::new(
            p.x * inverse_rho - along_u * du[0],
            p.y * inverse_rho - along_u * du[1],
            -(slope[0] + u * (slope[1] - slope[0])),
        )
    }

    /// See [`Scales::riser_gradient`]. * `end`: the upper end of the strip below the riser.
    #[inline(always)]
    pub(super) fn riser_gradient(&self, end: Pair<W>, p: Vectors<W>) -> Vectors<W> {
        let (_, du) = self.across_gradient(p);
        let along_u = end[1] - end[0];
        Vectors::new(-along_u * du[0], -along_u * du[1], self.simd.all(1.0))
    }
}

/// A number between those on the two half planes.
#[inline(always)]
pub(super) fn at<W: Wide>(ends: Pair<W>, u: F64x8<W>) -> F64x8<W> {
    ends[0] + u * (ends[1] - ends[0])
}
