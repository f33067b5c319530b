//! Eight columns at a time against one by one.

use super::super::{Lean, Shade, Streaks};
use crate::fiber::section::Section;
use crate::math::frame::direction;
use crate::math::lanes::Set;
use crate::sampling::Rng;
use glam::DVec3;

#[test]
fn integrals_by_eight_columns_have_the_bits_of_a_walk() {
    let section = Section::new(80.0, 1.4);
    let shades = [
        Shade {
            lean: Lean::EVEN,
            ratio: 0.0,
        },
        Shade {
            lean: Lean {
                base: 1.8,
                rise: 1.2,
                rim: 0.9,
            },
            ratio: 0.4,
        },
    ];
    let (mut by_lanes, mut beyond) = (0, 0);
    // One cell a period, some, and many.
    for period in [20.0, 120.0, 900.0] {
        let streaks = Streaks::new(0.7, [section.a, section.b], 1.0, period, 3);
        for i in 0..4000 {
            let mut rng = Rng::new(5, i);
            let steep = [0.0, 0.6, 1.5, 1.57][i as usize % 4];
            let dir = direction(steep * (2.0 * rng.uniform() - 1.0), 6.3 * rng.uniform());
            let dir = if i % 97 == 0 { DVec3::X } else { dir };
            let place = |u: f64| 1.04 * (2.0 * u - 1.0);
            let x = place(rng.uniform()) * section.a;
            let y = place(rng.uniform()) * section.b;
            let ray = section.unit_ray(DVec3::new(x, y, 2000.0 * rng.uniform()), dir);
            let t0 = 20.0 * rng.uniform();
            let t1 = t0 + 150.0 * rng.uniform().powi(2);
            for shade in &shades {
                let expected = streaks.integral_by_walk(&ray, t0, t1, shade);
                for set in Set::all() {
                    let Some(got) = streaks.integral_in_lanes(set, &ray, (t0, t1), shade) else {
                        beyond += 1;
                        continue;
                    };
                    by_lanes += 1;
                    assert_eq!(
                        got.to_bits(),
                        expected.to_bits(),
                        "{set:?} {ray:?} {t0} {t1}"
                    );
                }
            }
        }
    }
    assert!(
        Set::detect().is_none() || by_lanes > 10_000,
        "{by_lanes} {beyond}"
    );
}
