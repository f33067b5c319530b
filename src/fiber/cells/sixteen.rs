//! Faces sixteen at a time: a cell has about so many.

use super::faces::{Block, Fours, Tester};
use super::{Cells, Room};
use crate::math::lanes::{F32x16, Singles, Wide};
use glam::{Vec3, Vec4};

/// The faces of four blocks, first those in their first lanes: of two that are met at once the one is taken
/// that [`super::faces::Least`] takes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Faces {
    x: Singles,
    y: Singles,
    z: Singles,
    void: Singles,
    cell: Singles,
}

impl Faces {
    /// * `blocks`: up to four.
    pub(super) fn new(blocks: &[Block]) -> Self {
        let none = Block::new(&[]);
        let of = |part: fn(&Block) -> Vec4| {
            Singles(std::array::from_fn(|k| {
                part(blocks.get(k % 4).unwrap_or(&none))[k / 4]
            }))
        };
        Self {
            x: of(|b| b.x),
            y: of(|b| b.y),
            z: of(|b| b.z),
            void: of(|b| b.void),
            cell: of(|b| b.cell),
        }
    }

    #[inline(always)]
    fn dot<W: Wide>(&self, simd: W, v: Vec3) -> F32x16<W> {
        simd.load_singles(&self.x) * simd.all_single(v.x)
            + simd.load_singles(&self.y) * simd.all_single(v.y)
            + simd.load_singles(&self.z) * simd.all_single(v.z)
    }
}

/// Sixteen faces at a time.
#[derive(Clone, Copy)]
pub(in crate::fiber) struct Sixteens<W>(pub(in crate::fiber) W);

impl<W: Wide> Sixteens<W> {
    #[inline(always)]
    fn faces<'a>(self, cells: &'a Cells, room: &Room) -> &'a [Faces] {
        let count = (room.end - room.first).div_ceil(4);
        &cells.sixteens[room.first_sixteen as usize..][..count as usize]
    }
}

/// Cells of so many faces or fewer are tested four at a time: one step less to the least of them.
const FEW: u32 = 8;

impl Room {
    #[inline(always)]
    fn is_small(&self) -> bool {
        self.end - self.first <= FEW / 4
    }
}

/// The least of all so far and its slot.
struct Nearest(f32, usize);

impl Nearest {
    #[inline(always)]
    fn take<W: Wide>(&mut self, room: &Room, k: usize, values: F32x16<W>) {
        let (value, lane) = values.least();
        if value < self.0 {
            let block = room.first as usize + 4 * k + lane % 4;
            *self = Self(value, 4 * block + lane / 4);
        }
    }
}

impl<W: Wide> Tester for Sixteens<W> {
    #[inline(always)]
    fn void(
        self,
        cells: &Cells,
        room: &Room,
        at: Vec3,
        dir: Vec3,
        least: f32,
    ) -> Option<(f32, usize)> {
        if room.is_small() {
            return Fours.void(cells, room, at, dir, least);
        }
        let simd = self.0;
        let (zero, none) = (simd.all_single(0.0), simd.all_single(f32::INFINITY));
        let mut enter = Nearest(f32::INFINITY, 4 * room.first as usize);
        let mut leave = f32::INFINITY;
        for (k, faces) in self.faces(cells, room).iter().enumerate() {
            let rate = faces.dot(simd, dir);
            let t = (simd.load_singles(&faces.void) - faces.dot(simd, at)) / rate;
            leave = leave.min(t.where_less(zero, rate, none).least().0);
            // The greatest is the least of the negative.
            let back = (zero - t).where_less(rate, zero, none);
            enter.take(room, k, back);
        }
        let Nearest(enter, slot) = enter;
        (leave + enter.min(0.0) > least).then_some((-enter, slot))
    }

    #[inline(always)]
    fn way_out(self, cells: &Cells, room: &Room, at: Vec3, dir: Vec3, whole: bool) -> (f32, usize) {
        if room.is_small() {
            return Fours.way_out(cells, room, at, dir, whole);
        }
        let simd = self.0;
        let (zero, none) = (simd.all_single(0.0), simd.all_single(f32::INFINITY));
        let mut nearest = Nearest(f32::INFINITY, 4 * room.first as usize);
        for (k, faces) in self.faces(cells, room).iter().enumerate() {
            let rate = faces.dot(simd, dir);
            let offset = simd.load_singles(if whole { &faces.cell } else { &faces.void });
            let t = (offset - faces.dot(simd, at)) / rate;
            nearest.take(room, k, t.where_less(zero, rate, none));
        }
        (nearest.0, nearest.1)
    }

    #[inline(always)]
    fn room_left(self, cells: &Cells, room: &Room, at: Vec3) -> (f32, usize) {
        if room.is_small() {
            return Fours.room_left(cells, room, at);
        }
        let simd = self.0;
        let mut nearest = Nearest(f32::INFINITY, 4 * room.first as usize);
        for (k, faces) in self.faces(cells, room).iter().enumerate() {
            let left = simd.load_singles(&faces.cell) - faces.dot(simd, at);
            nearest.take(room, k, left);
        }
        (nearest.0, nearest.1)
    }
}
