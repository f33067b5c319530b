//! Eight rays through the cells of the shell: `fiber::march` lane by lane, with the same bits.

use super::super::crossing::LAST_STEP;
use super::super::march::{AXIAL, Side};
use super::cells::{Cells, Pair};
use super::rays::UnitRays;
use crate::math::lanes::{Avx512, F64x8, Mask, U64x8, Vectors};

/// Cells in one march of eight. Longer ones are left to the march of single rays.
const MOST_CELLS: usize = 64;

/// What rays start on.
#[derive(Clone, Copy)]
pub(super) struct StartOn {
    pub(super) face: Mask,
    pub(super) lower: Mask,
    pub(super) upper: Mask,
}

impl StartOn {
    pub(super) const NOTHING: Self = Self {
        face: Mask::NONE,
        lower: Mask::NONE,
        upper: Mask::NONE,
    };
}

/// What a march came to.
pub(super) struct Marched {
    pub(super) t: F64x8,
    /// In the unit-circle frame, of any length and sign.
    pub(super) gradient: Vectors,
    pub(super) sector: U64x8,
    pub(super) strip: U64x8,
    /// Those that met a face, a riser, and of these the ones whose lower strip is the higher.
    pub(super) face: Mask,
    pub(super) riser: Mask,
    pub(super) solid_below: Mask,
    /// Those that came to the limit. What is in none of these is left to the march of single rays.
    pub(super) through: Mask,
}

/// `c + 2 b t + a t^2`; see [`super::super::crossing::Quadratic`].
struct Quadratics {
    a: F64x8,
    b: F64x8,
    c: F64x8,
}

impl Quadratics {
    #[inline(always)]
    fn falling_root(&self, simd: Avx512) -> F64x8 {
        let zero = simd.all(0.0);
        let root = (self.b * self.b - self.a * self.c).max(zero).sqrt();
        let q = root - self.b;
        let early = (self.c / q).or(q.gt(zero), zero);
        early.or(self.b.le(zero), -(self.b + root) / self.a)
    }

    /// Those that turn negative up to `limit`, and where.
    #[inline(always)]
    fn turn_negative(&self, simd: Avx512, limit: F64x8) -> (Mask, F64x8) {
        let zero = simd.all(0.0);
        let end = self.c + limit * (2.0 * self.b + limit * self.a);
        let falls = end.lt(zero)
            | (self.a.gt(zero)
                & self.b.lt(zero)
                & (-self.b).lt(limit * self.a)
                & (self.b * self.b).gt(self.a * self.c));
        let at_once = self.c.is(zero) & self.b.le(zero);
        let root = self.falling_root(simd).max(zero).min(limit);
        (falls, zero.or(at_once, root))
    }
}

/// Where each ray goes on or has stopped.
struct State {
    t: F64x8,
    p: Vectors,
    c0: F64x8,
    r0: F64x8,
}

/// Follows rays from `t` on one side of the surface up to `limit`.
///
/// * `start`: the cells in which they are, and what of these they start on.
#[inline(always)]
pub(super) fn march(
    simd: Avx512,
    lanes: Mask,
    ray: &UnitRays,
    t: F64x8,
    start: (Cells<'_>, StartOn),
    side: Side,
    limit: F64x8,
) -> Marched {
    let (mut cells, mut on) = start;
    let (zero, one) = (simd.all(0.0), simd.all(1.0));
    let sign = if side == Side::Outside { 1.0 } else { -1.0 };
    // Which way round the axis a ray goes. See Turn.
    let turn = ray.at.x * ray.by.y - ray.at.y * ray.by.x;
    let second = turn.gt(zero);
    let turn_sign = zero.or(turn.is(zero), -one.with_sign_of(turn));
    let turn_u = one.or(second, zero);

    let p = ray.at(t);
    let c0 = p.x * p.x + p.y * p.y;
    let mut at = State {
        t,
        p,
        c0,
        r0: c0.sqrt().or(on.face, cells.radius(cells.across(p), p.z)),
    };
    let mut walking = lanes;
    let mut through = Mask::NONE;
    // Faces met within a cell; the way through it and the radius at its end.
    let (mut crossed, mut length_of, mut r1_of) = (Mask::NONE, zero, zero);
    // Faces and risers met on the boundary of two cells.
    let (mut stepped, mut riser, mut riser_up) = (Mask::NONE, Mask::NONE, Mask::NONE);
    let (mut riser_end, mut riser_strip): (Pair, U64x8) = ([zero; 2], cells.strip);
    for _ in 0..MOST_CELLS {
        let State { t, p, c0, r0 } = at;
        let z = p.z - cells.shift;
        let rest = (limit - t).max(zero);
        // Out of the sector?
        let (cos, sin) = (
            cells.cos[1].or(second, cells.cos[0]),
            cells.sin[1].or(second, cells.sin[0]),
        );
        let way = turn_sign * (cos * p.y - sin * p.x);
        let rate = -turn_sign * (cos * ray.by.y - sin * ray.by.x);
        let mut sideways = rate.gt(zero) & way.lt(rate * rest);
        let mut length = (way.max(zero) / rate).or(sideways, rest);
        let (mut up, mut down) = (Mask::NONE, Mask::NONE);
        // Out of the strip?
        let z1 = z + length * ray.by.z;
        let low = cells.begin[0].max(cells.begin[1]);
        let high = cells.end[0].min(cells.end[1]);
        let held = z.min(z1).gt(low) & z.max(z1).lt(high);
        let unheld = walking & !held;
        if unheld.any() {
            let ends = ends(simd, &cells, ray, p, z, on, length);
            length = ends.0.or(unheld, length);
            (up, down) = (ends.1 & unheld, ends.2 & unheld);
            sideways = sideways & !up & !down;
        }
        let limited = !(sideways | up | down);
        // What single rays take for endless is left to them.
        walking = walking & length.lt(simd.all(AXIAL));
        let end = ray.at(t + length);
        let c_end = end.x * end.x + end.y * end.y;
        let clear = cells.is_clear(c_end, side);
        let passes = walking & limited & on.face & clear;
        through = through | passes;
        walking = walking & !passes;
        if !walking.any() {
            break;
        }
        let u1 = turn_u.or(sideways, cells.across(end));
        let r1 = cells.radius(u1, end.z);
        let odd = (sign * (c_end - r1 * r1)).lt(zero);
        let c = zero.or(on.face, (sign * (c0 - r0 * r0)).max(zero));
        let chord = chord(sign, ray, p, length, r0, r1, c);
        let pair = chord.b.lt(zero)
            & (-chord.b).lt(chord.a)
            & (chord.b * chord.b).gt(chord.a * chord.c)
            & length.gt(zero)
            & !on.face;
        let meets = walking & (odd | pair);
        crossed = crossed | meets;
        length_of = length.or(meets, length_of);
        r1_of = r1.or(meets, r1_of);
        walking = walking & !meets;
        let passes = walking & limited;
        through = through | passes;
        walking = walking & !passes;
        if !walking.any() {
            break;
        }
        // Into the next cell.
        (up, down, sideways) = (up & walking, down & walking, sideways & walking);
        let (old_end, old_strip) = (cells.end, cells.strip);
        cells.up(up);
        cells.down(down);
        if sideways.any() {
            cells.aside(sideways, second);
            cells.look_up_sectors();
        }
        cells.look_up_strips();
        let u = (1.0 - u1).or(sideways, u1);
        cells.settle(sideways, u, end.z);
        on = StartOn {
            face: on.face & !walking,
            lower: (on.lower & !walking) | up,
            upper: (on.upper & !walking) | down,
        };
        let r0 = cells.radius(u, end.z);
        let stop = walking & (sign * (c_end - r0 * r0)).lt(zero);
        at = State {
            t: (t + length).or(walking, t),
            p: end.or(walking, p),
            c0: c_end.or(walking, c0),
            r0: r0.or(walking, at.r0),
        };
        riser = riser | (stop & (up | down));
        riser_up = riser_up | (stop & up);
        let ends = [
            old_end[0].or(up, cells.end[0]),
            old_end[1].or(up, cells.end[1]),
        ];
        riser_end = [
            ends[0].or(stop, riser_end[0]),
            ends[1].or(stop, riser_end[1]),
        ];
        riser_strip = old_strip.or(up, cells.strip).or(stop, riser_strip);
        stepped = stepped | (stop & sideways);
        walking = walking & !stop;
        if !walking.any() {
            break;
        }
    }
    let mut t = at.t;
    if crossed.any() {
        let c = zero.or(on.face, (sign * (at.c0 - at.r0 * at.r0)).max(zero));
        let chord = chord(sign, ray, at.p, length_of, at.r0, r1_of, c);
        let (way, sure) = first(simd, crossed, sign, ray, &cells, &at, length_of, &chord);
        t = (at.t + way).or(crossed, at.t);
        crossed = crossed & sure;
    }
    let face = crossed | stepped;
    let p = ray.at(t).or(crossed, at.p);
    let mut gradient = cells.face_gradient(p);
    if riser.any() {
        gradient = cells.riser_gradient(riser_end, at.p).or(riser, gradient);
    }
    Marched {
        t,
        gradient,
        sector: cells.sector,
        strip: riser_strip.or(riser, cells.strip),
        face,
        riser,
        solid_below: match side {
            Side::Outside => riser & !riser_up,
            Side::Inside => riser & riser_up,
        },
        through,
    }
}

/// How far rays stay between the ends of their strips, up to `length`, and which leave upward and downward.
/// See `Window::ends`.
#[inline(always)]
fn ends(
    simd: Avx512,
    cells: &Cells<'_>,
    ray: &UnitRays,
    p: Vectors,
    z: F64x8,
    on: StartOn,
    length: F64x8,
) -> (F64x8, Mask, Mask) {
    let zero = simd.all(0.0);
    let (a, b) = (cells.distance(0, p.x, p.y), -cells.distance(1, p.x, p.y));
    let (da, db) = (
        cells.distance(0, ray.by.x, ray.by.y),
        -cells.distance(1, ray.by.x, ray.by.y),
    );
    let window = (a, b, da, db, z, ray.by.z);
    let mut above = below(window, cells.end);
    above.c = zero.or(on.upper, above.c.max(zero));
    let (up, way) = above.turn_negative(simd, length);
    let length = way.or(up, length);
    let under = below(window, cells.begin);
    let under = Quadratics {
        a: -under.a,
        b: -under.b,
        c: zero.or(on.lower, (-under.c).max(zero)),
    };
    let (down, way) = under.turn_negative(simd, length);
    (way.or(down, length), up & !down, down)
}

/// `(a + b) (end(u) - z)`: positive below the end. See `Window::below`.
#[inline(always)]
fn below(
    (a, b, da, db, z, dz): (F64x8, F64x8, F64x8, F64x8, F64x8, F64x8),
    end: Pair,
) -> Quadratics {
    let (w, dw) = (a + b, da + db);
    let (e0, e1) = (end[0] - z, end[1] - z);
    Quadratics {
        a: -dz * dw,
        b: 0.5 * (e0 * db + e1 * da - dz * w),
        c: e0 * b + e1 * a,
    }
}

/// f with E replaced by its chord. See `Crossing::chord`.
#[inline(always)]
fn chord(
    sign: f64,
    ray: &UnitRays,
    p: Vectors,
    length: F64x8,
    r0: F64x8,
    r1: F64x8,
    c: F64x8,
) -> Quadratics {
    let rise = r1 - r0;
    let c1 = p.x * ray.by.x + p.y * ray.by.y;
    Quadratics {
        a: sign * (ray.a * length * length - rise * rise),
        b: sign * (c1 * length - r0 * rise),
        c,
    }
}

/// Ways to the first crossing, and for which they are sure. See `Crossing::first`.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "what a crossing is of")]
fn first(
    simd: Avx512,
    lanes: Mask,
    sign: f64,
    ray: &UnitRays,
    cells: &Cells<'_>,
    at: &State,
    length: F64x8,
    chord: &Quadratics,
) -> (F64x8, Mask) {
    let (zero, one) = (simd.all(0.0), simd.all(1.0));
    let none = length.le(zero);
    let on_face = zero.or(
        !(chord.b.gt(zero) & chord.a.lt(zero)),
        -2.0 * chord.b / chord.a,
    );
    let x = chord.falling_root(simd).or(chord.c.gt(zero), on_face);
    let x = x.max(zero).min(one);

    let p = at.p;
    let (wa, wb) = (cells.distance(0, p.x, p.y), -cells.distance(1, p.x, p.y));
    let (da, db) = (
        cells.distance(0, ray.by.x, ray.by.y),
        -cells.distance(1, ray.by.x, ray.by.y),
    );
    let z = p.z - cells.shift;
    let (h, s, dz) = (cells.height, cells.slope, ray.by.z);
    let e0 = 1.0 + h[0] + s[0] * z;
    let e1 = 1.0 + h[1] + s[1] * z;
    let (de0, de1) = (s[0] * dz, s[1] * dz);
    let (w0, w1) = (wa + wb, da + db);
    let (s0, s1, s2) = (
        e0 * wb + e1 * wa,
        e0 * db + e1 * da + de0 * wb + de1 * wa,
        de0 * db + de1 * da,
    );
    let (b, a) = (p.x * ray.by.x + p.y * ray.by.y, ray.a);

    let (mut t, mut last) = (x * length, 0.5 * length);
    let (mut searching, mut found) = (lanes & !none, Mask::NONE);
    for _ in 0..4 {
        let w = w0 + t * w1;
        let (s, ds) = (s0 + t * (s1 + t * s2), s1 + 2.0 * t * s2);
        let rho2 = at.c0 + t * (2.0 * b + t * a);
        let f = rho2 * (w * w) - s * s;
        let half_slope = (b + t * a) * (w * w) + rho2 * w * w1 - s * ds;
        let move_by = -0.5 * f / half_slope;
        let next = t + move_by;
        let steps = (sign * half_slope).lt(zero)
            & move_by.abs().le(0.1 * last)
            & next.ge(zero)
            & next.le(length);
        searching = searching & steps;
        t = next.or(searching, t);
        last = move_by.abs().or(searching, last);
        let there = searching & (move_by * move_by * a).le(simd.all(LAST_STEP * LAST_STEP));
        found = found | there;
        searching = searching & !there;
        if !searching.any() {
            break;
        }
    }
    (zero.or(none, t), found | none)
}
