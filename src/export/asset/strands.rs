//! Some strands of a groom as arrays of a file.

use super::curves::Curves;
use super::frame::Frame;
use crate::export::usd::{Array, Rows};
use crate::groom::Groom;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::{Add, Mul};
use std::sync::Arc;

/// Strands of one hair class, as they are to be written.
#[derive(Clone)]
pub(super) struct Strands<'a> {
    groom: &'a Groom,
    /// Which strands, in order.
    index: Arc<[u32]>,
    /// Factor on their widths.
    widening: f32,
    curves: Curves,
    frame: Frame,
    /// Number of control points as written.
    elements: usize,
}

impl<'a> Strands<'a> {
    /// * `index`: which strands, in order. * `widening`: factor on their widths.
    pub(super) fn new(
        groom: &'a Groom,
        index: Arc<[u32]>,
        widening: f32,
        curves: Curves,
        frame: Frame,
    ) -> Self {
        let count = |&i: &u32| curves.count(groom.strand(i as usize).len());
        Self {
            elements: index.iter().map(count).sum(),
            groom,
            index,
            widening,
            curves,
            frame,
        }
    }

    /// Number of strands.
    pub(super) fn count(&self) -> usize {
        self.index.len()
    }

    /// The groom's number of a strand.
    fn strand(&self, row: usize) -> usize {
        self.index[row] as usize
    }

    /// `curveVertexCounts`.
    pub(super) fn counts(&self) -> Array<'a> {
        let this = self.clone();
        Array::Int(Rows::each(self.count(), move |row| {
            this.curves.count(this.groom.strand(this.strand(row)).len()) as i32
        }))
    }

    /// `points`.
    pub(super) fn points(&self) -> Array<'a> {
        let this = self.clone();
        Array::Vec3(Rows::new(self.count(), self.elements, move |rows, out| {
            let mut points = Vec::new();
            for row in rows {
                points.clear();
                this.place(row, &mut points);
                out.extend(points.iter().map(Vec3::to_array));
            }
        }))
    }

    /// Appends the control points of a strand as written.
    fn place(&self, row: usize, out: &mut Vec<Vec3>) {
        let start = out.len();
        let points = self.groom.strand(self.strand(row));
        self.curves.points(points, out);
        for point in &mut out[start..] {
            *point = self.frame.point(*point);
        }
    }

    /// `widths`: diameters.
    pub(super) fn widths(&self) -> Array<'a> {
        let this = self.clone();
        Array::Float(self.vertex(move |strand, out: &mut Vec<f32>| {
            let widths = this.groom.widths[this.groom.range(strand)].iter();
            out.extend(widths.map(|w| this.frame.length(w * this.widening)));
        }))
    }

    /// One value a strand; `of` is told the groom's number of the strand.
    pub(super) fn uniform<T>(&self, of: impl Fn(usize) -> T + Send + Sync + 'a) -> Rows<'a, T> {
        let this = self.clone();
        Rows::each(self.count(), move |row| of(this.strand(row)))
    }

    /// One value a control point; `of` appends those of the groom's own control points of a strand.
    pub(super) fn vertex<T>(
        &self,
        of: impl Fn(usize, &mut Vec<T>) + Send + Sync + 'a,
    ) -> Rows<'a, T>
    where
        T: Copy + Add<Output = T> + Mul<f32, Output = T>,
    {
        let this = self.clone();
        Rows::new(self.count(), self.elements, move |rows, out| {
            let mut values = Vec::new();
            for row in rows {
                values.clear();
                of(this.strand(row), &mut values);
                this.curves.values(&values, out);
            }
        })
    }

    /// [`Strands::vertex`] of what `part` takes of three numbers.
    pub(super) fn vertex_of<T>(
        &self,
        of: impl Fn(usize, &mut Vec<Vec3>) + Send + Sync + 'a,
        part: impl Fn(&Vec3) -> T + Send + Sync + 'a,
    ) -> Rows<'a, T> {
        let rows = self.vertex(of);
        Rows::new(rows.rows(), rows.elements(), move |range, out| {
            let mut values = Vec::new();
            rows.fill(range, &mut values);
            out.extend(values.iter().map(&part));
        })
    }

    /// Corners of the box around all control points and half the widest width.
    pub(super) fn extent(&self) -> [[f32; 3]; 2] {
        let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY, 0.0f32);
        let (lo, hi, widest) = (0..self.count())
            .into_par_iter()
            .with_min_len(4096)
            .fold(
                || (empty, Vec::new()),
                |((mut lo, mut hi, mut widest), mut points), row| {
                    points.clear();
                    self.place(row, &mut points);
                    for &p in &points {
                        (lo, hi) = (lo.min(p), hi.max(p));
                    }
                    let range = self.groom.range(self.strand(row));
                    for &width in &self.groom.widths[range] {
                        widest = widest.max(self.frame.length(width * self.widening));
                    }
                    ((lo, hi, widest), points)
                },
            )
            .map(|(bounds, _)| bounds)
            .reduce(|| empty, |a, b| (a.0.min(b.0), a.1.max(b.1), a.2.max(b.2)));
        let half = Vec3::splat(0.5 * widest);
        [(lo - half).to_array(), (hi + half).to_array()]
    }
}
