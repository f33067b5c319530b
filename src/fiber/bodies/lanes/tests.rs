//! Eight planes at a time against one after another.

use super::super::Bodies;
use super::super::chord::OneByOne;
use crate::fiber::convex::{Convex, Plane, Quadric};
use crate::math::frame;
use crate::math::lanes::Set;
use crate::sampling::Rng;
use glam::DVec3;
use std::f64::consts::TAU;

fn direction(rng: &mut Rng) -> DVec3 {
    let sin = 2.0 * rng.uniform() - 1.0;
    frame::direction(sin.asin(), TAU * rng.uniform())
}

/// Prisms of 3 to 17 sides, some of them rounded, that overlap here and there.
fn bodies() -> Bodies {
    let mut rng = Rng::new(3, 3);
    let prism = |k: u32| {
        let sides = 3 + k % 15;
        let mut planes: Vec<Plane> = (0..sides)
            .map(|i| {
                let (sin, cos) = (TAU * f64::from(i) / f64::from(sides)).sin_cos();
                Plane {
                    normal: DVec3::new(cos, sin, 0.0),
                    offset: 2.0 + rng.uniform(),
                }
            })
            .collect();
        planes.extend([DVec3::Z, DVec3::NEG_Z].map(|normal| Plane {
            normal,
            offset: 2.0,
        }));
        let round = Quadric::ellipsoid(DVec3::ZERO, DVec3::new(4.0, 3.5, 3.0));
        let at = DVec3::new(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform());
        Convex {
            center: at * DVec3::new(30.0, 30.0, 60.0),
            half: DVec3::new(6.0, 6.0, 2.0),
            planes,
            quadrics: if k.is_multiple_of(3) {
                vec![round]
            } else {
                Vec::new()
            },
            island: false,
        }
    };
    Bodies::new((0..200).map(prism).collect(), 60.0, [22.0, 22.0], true)
}

#[test]
fn bodies_by_eight_planes_are_met_and_left_as_by_one() {
    let bodies = bodies();
    for set in Set::all() {
        let (mut entered, mut left) = (0, 0);
        for i in 0..3000 {
            let mut rng = Rng::new(7, i);
            let mut dir = direction(&mut rng);
            dir.x = dir.x.abs();
            // Along walls and across them.
            if i.is_multiple_of(11) {
                dir = [DVec3::Z, DVec3::X, DVec3::NEG_Y][i as usize % 3];
            }
            let mut at = DVec3::new(-20.0, 40.0 * rng.uniform() - 20.0, 90.0 * rng.uniform());
            let mut from = None;
            for _ in 0..30 {
                let expected = bodies.enter_by(OneByOne, (at, dir), (0.0, 50.0), from);
                assert_eq!(
                    bodies.enter_in_lanes(set, (at, dir), (0.0, 50.0), from),
                    expected
                );
                let Some((t, face)) = expected else { break };
                entered += 1;
                (at, from) = (at + t * dir, Some(face));
                // Back through the face that it lies on.
                let expected = bodies.leave_by(OneByOne, at, -dir, from);
                assert_eq!(bodies.leave_in_lanes(set, at, -dir, from), expected);
                let expected = bodies.leave_by(OneByOne, at, dir, from);
                assert_eq!(bodies.leave_in_lanes(set, at, dir, from), expected);
                let Some((t, face)) = expected else { break };
                left += 1;
                (at, from) = (at + t * dir, Some(face));
                // On from the wall another way.
                let turned = direction(&mut rng);
                let outward = bodies.gradient(face, at);
                dir = turned * turned.dot(outward).signum();
            }
        }
        assert!(entered > 2000 && left > 2000, "{entered} {left}");
    }
}
