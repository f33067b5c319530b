//! Sections that are no ellipse: their radius over that of the ellipse of equal area and aspect.
//!
//! In the frame in which that ellipse is the unit circle a section is `rho(psi)` about 1, so that rays
//! march through it as they march through scales.

use super::FiberError;
use crate::species;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Radius by angle in the unit-circle frame; the mean square is 1, so that the area is the ellipse's.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    radii: Vec<f64>,
}

/// Angles at which the radius is kept: a linear course between them is off by less than 1e-5.
const STEPS: usize = 2048;
/// Width of a bean's dent, radians squared (estimate: about a third of the flat side).
const DENT_WIDTH: f64 = 0.3;
/// Least radius: below it the walls of the dent nearly meet and rays from the axis graze them.
const LEAST_RADIUS: f64 = 0.35;

impl Outline {
    /// `None` for an ellipse.
    ///
    /// # Errors
    /// A section bent so far that a ray from its center leaves it more than once.
    pub(super) fn new(shape: species::Section, aspect: f64) -> Result<Option<Self>, FiberError> {
        let radii: Vec<f64> = match shape {
            species::Section::Ellipse => return Ok(None),
            species::Section::Superellipse { squareness: q } => {
                by_angle(|psi| (psi.cos().abs().powf(q) + psi.sin().abs().powf(q)).powf(-1.0 / q))
            }
            species::Section::DumbBell => by_angle(|psi| cassini(psi, aspect)),
            species::Section::ConcavoConvex { bend } => bent(bend * aspect)?,
            species::Section::Bean { dent } => by_angle(|psi| {
                let off = (psi - FRAC_PI_2).powi(2) / DENT_WIDTH;
                1.0 - dent * (-off).exp()
            }),
        };
        let square = radii.iter().map(|r| r * r).sum::<f64>() / STEPS as f64;
        let scale = 1.0 / square.sqrt();
        let radii: Vec<f64> = radii.iter().map(|r| r * scale).collect();
        if radii.iter().any(|&r| !r.is_finite() || r < LEAST_RADIUS) {
            return Err(FiberError::SectionFolds);
        }
        Ok(Some(Self { radii }))
    }

    /// Radius in units of the ellipse's.
    pub(super) fn at(&self, psi: f64) -> f64 {
        let x = (psi / TAU).rem_euclid(1.0) * STEPS as f64;
        let (i, f) = (x as usize, x.fract());
        let [a, b] = [i, i + 1].map(|k| self.radii[k % STEPS]);
        a + f * (b - a)
    }
}

fn by_angle(radius: impl Fn(f64) -> f64) -> Vec<f64> {
    let psi = |k: usize| TAU * k as f64 / STEPS as f64;
    (0..STEPS).map(|k| radius(psi(k))).collect()
}

/// Cassini's oval `r^2 = c^2 cos 2 phi + sqrt(b^4 - c^4 sin^2 2 phi)`; its axes are `sqrt(b^2 +- c^2)`,
/// so the aspect gives c over b. Waisted beyond an aspect of sqrt 3.
fn cassini(psi: f64, aspect: f64) -> f64 {
    let c2 = (aspect * aspect - 1.0) / (aspect * aspect + 1.0);
    let (x, y) = (psi.cos() * aspect, psi.sin());
    let phi = y.atan2(x);
    let (sin, cos) = (2.0 * phi).sin_cos();
    let r2 = c2 * cos + (1.0 - (c2 * sin).powi(2)).sqrt();
    r2.max(0.0).sqrt() / x.hypot(y)
}

/// The circle sheared by `y + bend x^2` about its center of area.
fn bent(bend: f64) -> Result<Vec<f64>, FiberError> {
    // Finer than the table, so that its angles fall between near neighbors.
    const FINE: usize = 4 * STEPS;
    let point = |i: usize| {
        let (sin, cos) = (TAU * i as f64 / FINE as f64).sin_cos();
        (cos, sin + bend * (cos * cos - 0.25))
    };
    let angle = |(x, y): (f64, f64)| y.atan2(x);
    let start = angle(point(0));
    let (mut radii, mut before) = (
        Vec::with_capacity(STEPS),
        (0.0, point(0).0.hypot(point(0).1)),
    );
    let mut passed = 0.0;
    for i in 1..=FINE {
        let p = point(i);
        let turned = (angle(p) - start - passed + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
        if turned <= 0.0 {
            return Err(FiberError::SectionFolds);
        }
        passed += turned;
        let now = (passed, p.0.hypot(p.1));
        while radii.len() < STEPS && TAU * radii.len() as f64 / STEPS as f64 <= now.0 {
            let psi = TAU * radii.len() as f64 / STEPS as f64;
            let f = (psi - before.0) / (now.0 - before.0);
            radii.push(before.1 + f * (now.1 - before.1));
        }
        before = now;
    }
    radii.resize(STEPS, before.1);
    // The table begins at the angle of the first point: turn it to begin at 0.
    let turned = Outline { radii };
    Ok(by_angle(|psi| turned.at(psi - start)))
}
