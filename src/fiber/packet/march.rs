//! Eight rays through the cells of the shell: `fiber::march` lane by lane, with the same bits.

use super::super::crossing::LAST_STEP;
use super::super::march::{AXIAL, Side};
use super::cells::{Cells, Pair};
use super::quadratic::{Quadratics, Window};
use super::rays::UnitRays;
use crate::math::lanes::{F64x8, Mask, U64x8, Vectors, Wide};

/// Cells in one march of eight. Longer ones are left to the march of single rays.
const MOST_CELLS: usize = 64;

/// What rays start on.
#[derive(Clone, Copy)]
pub(super) struct StartOn<W: Wide> {
    pub(super) face: Mask<W>,
    pub(super) lower: Mask<W>,
    pub(super) upper: Mask<W>,
}

impl<W: Wide> StartOn<W> {
    #[inline(always)]
    pub(super) fn nothing(simd: W) -> Self {
        Self {
            face: simd.none(),
            lower: simd.none(),
            upper: simd.none(),
        }
    }
}

/// What a march came to.
pub(super) struct Marched<W: Wide> {
    pub(super) t: F64x8<W>,
    /// In the unit-circle frame, of any length and sign.
    pub(super) gradient: Vectors<W>,
    pub(super) sector: U64x8<W>,
    pub(super) strip: U64x8<W>,
    /// Those that met a face, a riser, and of these the ones whose lower strip is the higher.
    pub(super) face: Mask<W>,
    pub(super) riser: Mask<W>,
    pub(super) solid_below: Mask<W>,
    /// Those that came to the limit. What is in none of these is left to the march of single rays.
    pub(super) through: Mask<W>,
}

/// Where each ray goes on or has stopped.
struct State<W: Wide> {
    t: F64x8<W>,
    p: Vectors<W>,
    c0: F64x8<W>,
    r0: F64x8<W>,
}

/// Follows rays from `t` on one side of the surface up to `limit`.
///
/// * `start`: the cells in which they are, and what of these they start on.
#[inline(always)]
pub(super) fn march<W: Wide>(
    simd: W,
    lanes: Mask<W>,
    ray: &UnitRays<W>,
    t: F64x8<W>,
    start: (Cells<'_, W>, StartOn<W>),
    side: Side,
    limit: F64x8<W>,
) -> Marched<W> {
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
    let mut through = simd.none();
    // Faces met within a cell; the way through it and the radius at its end.
    let (mut crossed, mut length_of, mut r1_of) = (simd.none(), zero, zero);
    // Faces and risers met on the boundary of two cells.
    let (mut stepped, mut riser, mut riser_up) = (simd.none(), simd.none(), simd.none());
    let (mut riser_end, mut riser_strip): (Pair<W>, U64x8<W>) = ([zero; 2], cells.strip);
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
        let (mut up, mut down) = (simd.none(), simd.none());
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
fn ends<W: Wide>(
    simd: W,
    cells: &Cells<'_, W>,
    ray: &UnitRays<W>,
    p: Vectors<W>,
    z: F64x8<W>,
    on: StartOn<W>,
    length: F64x8<W>,
) -> (F64x8<W>, Mask<W>, Mask<W>) {
    let zero = simd.all(0.0);
    let (a, b) = (cells.distance(0, p.x, p.y), -cells.distance(1, p.x, p.y));
    let (da, db) = (
        cells.distance(0, ray.by.x, ray.by.y),
        -cells.distance(1, ray.by.x, ray.by.y),
    );
    let dz = ray.by.z;
    let window = Window {
        a,
        b,
        da,
        db,
        z,
        dz,
    };
    let mut above = window.below(cells.end);
    above.c = zero.or(on.upper, above.c.max(zero));
    let (up, way) = above.turn_negative(simd, length);
    let length = way.or(up, length);
    let under = window.below(cells.begin);
    let under = Quadratics {
        a: -under.a,
        b: -under.b,
        c: zero.or(on.lower, (-under.c).max(zero)),
    };
    let (down, way) = under.turn_negative(simd, length);
    (way.or(down, length), up & !down, down)
}

/// f with E replaced by its chord. See `Crossing::chord`.
#[inline(always)]
fn chord<W: Wide>(
    sign: f64,
    ray: &UnitRays<W>,
    p: Vectors<W>,
    length: F64x8<W>,
    r0: F64x8<W>,
    r1: F64x8<W>,
    c: F64x8<W>,
) -> Quadratics<W> {
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
fn first<W: Wide>(
    simd: W,
    lanes: Mask<W>,
    sign: f64,
    ray: &UnitRays<W>,
    cells: &Cells<'_, W>,
    at: &State<W>,
    length: F64x8<W>,
    chord: &Quadratics<W>,
) -> (F64x8<W>, Mask<W>) {
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
    let (mut searching, mut found) = (lanes & !none, simd.none());
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
