//! A convex body as triangles whose edges are where its faces meet.
//!
//! Rays from a point inside, evenly in the frame in which the body is as wide as it is high, find its
//! faces; where two rays next to each other find different ones, the place between is found where the
//! face changes, and the piece between four rays is cut along it.

use super::Weld;
use crate::fiber::bodies::Shape;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Halvings of the angle between two rays: to a millionth of it.
const HALVINGS: u32 = 20;

/// A place on the surface and the face it is on.
#[derive(Clone, Copy)]
struct Place {
    at: DVec3,
    face: u32,
}

/// Rays at even steps of the polar angle and of the azimuth.
struct Rays<'a> {
    shape: &'a Shape<'a>,
    round: usize,
    poles: usize,
}

/// Adds a body to a part; islands face inward.
///
/// * `round`: rays once round, a multiple of 4.
/// * `to_unit`: from micrometers to the frame of the part.
pub(super) fn add(
    weld: &mut Weld,
    shape: &Shape<'_>,
    round: usize,
    to_unit: impl Fn(DVec3) -> DVec3,
) {
    let poles = round / 2;
    let rays = Rays {
        shape,
        round,
        poles,
    };
    let places: Vec<Vec<Place>> = (0..=poles)
        .map(|i| (0..round).map(|j| rays.place(i as f64, j as f64)).collect())
        .collect();
    // Where faces change on the way to the next ray round and to the next toward the lower pole.
    let change = |i: usize, j: usize, di: usize, dj: usize| {
        let [from, to] = [places[i][j], places[i + di][(j + dj) % round]];
        let is_pole = di == 0 && (i == 0 || i == poles);
        (from.face != to.face && !is_pole).then(|| rays.change([i, j], [di, dj], from.face))
    };
    let all = |di: usize, dj: usize| -> Vec<Vec<Option<DVec3>>> {
        let row = |i: usize| (0..round).map(|j| change(i, j, di, dj)).collect();
        (0..=poles - di).map(row).collect()
    };
    let (along, down) = (all(0, 1), all(1, 0));
    for i in 0..poles {
        for j in 0..round {
            let next = (j + 1) % round;
            // Round the piece, counterclockwise seen from outside.
            let ring = [
                (Some(places[i + 1][j].at), false),
                (along[i + 1][j], true),
                (Some(places[i + 1][next].at), false),
                (down[i][next], true),
                (Some(places[i][next].at), false),
                (along[i][j], true),
                (Some(places[i][j].at), false),
                (down[i][j], true),
            ];
            let ring = ring.iter().filter_map(|&(p, kink)| p.map(|p| (p, kink)));
            let ring: Vec<(DVec3, bool)> = ring.collect();
            for polygon in rays.split(&ring, &to_unit) {
                add_polygon(weld, &polygon, shape.island);
            }
        }
    }
}

fn add_polygon(weld: &mut Weld, polygon: &[DVec3], inward: bool) {
    if inward {
        let turned: Vec<DVec3> = polygon.iter().rev().copied().collect();
        weld.polygon(&turned);
    } else {
        weld.polygon(polygon);
    }
}

impl Rays<'_> {
    fn place(&self, i: f64, j: f64) -> Place {
        // The poles are one point, not a rounding apart.
        let end = i == 0.0 || i == self.poles as f64;
        let j = if end { 0.0 } else { j % self.round as f64 };
        let (theta, phi) = (PI * i / self.poles as f64, TAU * j / self.round as f64);
        let (sin, cos) = theta.sin_cos();
        let dir = self.shape.half * DVec3::new(sin * phi.cos(), sin * phi.sin(), cos);
        let (at, face) = self.shape.surface(dir.normalize());
        Place { at, face }
    }

    /// Where on the way from one ray to the next the face is another.
    fn change(&self, [i, j]: [usize; 2], [di, dj]: [usize; 2], face: u32) -> DVec3 {
        let at =
            |share: f64| self.place(i as f64 + share * di as f64, j as f64 + share * dj as f64);
        let (mut same, mut other) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (same + other);
            if at(middle).face == face {
                same = middle;
            } else {
                other = middle;
            }
        }
        at(same).at
    }

    /// A piece cut where faces meet: along a line from one change to the other, or, where more meet, from
    /// a place between the changes to all of the rim. Seen from the middle of the body the pieces lie side
    /// by side, so that none goes through another.
    fn split(&self, ring: &[(DVec3, bool)], to_unit: &impl Fn(DVec3) -> DVec3) -> Vec<Vec<DVec3>> {
        let n = ring.len();
        let kinks: Vec<usize> = (0..n).filter(|&k| ring[k].1).collect();
        let part = |from: usize, to: usize| -> Vec<DVec3> {
            let length = (to + n - from) % n;
            (0..=length)
                .map(|k| to_unit(ring[(from + k) % n].0))
                .collect()
        };
        match kinks[..] {
            [] => vec![part(0, n - 1)],
            [a, b] => vec![part(a, b), part(b, a)],
            _ => {
                let is_between = |k: &usize| kinks.len() == 1 || ring[*k].1;
                let between: Vec<DVec3> = (0..n).filter(is_between).map(|k| ring[k].0).collect();
                let mean = between.iter().sum::<DVec3>() / between.len() as f64;
                let dir = (mean - self.shape.middle()).normalize_or_zero();
                let middle = to_unit(self.shape.surface(dir).0);
                let rim = |k: usize| to_unit(ring[k % n].0);
                (0..n).map(|k| vec![middle, rim(k), rim(k + 1)]).collect()
            }
        }
    }
}
