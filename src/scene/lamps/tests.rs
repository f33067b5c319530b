use super::*;
use crate::sampling::{Rng, Sobol};

/// Lamps of all shapes, near and far, around a subject of radius 2 at (1, 0, -1).
fn lamps() -> Vec<Emitter> {
    let lamp = |shape, yaw_deg, pitch_deg| Lamp {
        shape,
        yaw_deg,
        pitch_deg,
        strength: Rgb::new(1.0, 0.5, 0.25),
    };
    let rect = |distance, size| LampShape::Rect { distance, size };
    let sphere = |distance, radius| LampShape::Sphere { distance, radius };
    [
        lamp(rect(1.5, [2.0, 1.0]), 30.0, 40.0),
        lamp(rect(40.0, [0.2, 3.0]), 200.0, -10.0),
        lamp(rect(3.0, [50.0, 50.0]), -90.0, 0.0),
        lamp(sphere(2.0, 0.5), 120.0, 5.0),
        lamp(sphere(500.0, 0.1), -30.0, 89.0),
        lamp(LampShape::Sun { diameter_deg: 0.53 }, 75.0, 20.0),
        lamp(
            LampShape::Sun {
                diameter_deg: 120.0,
            },
            10.0,
            0.0,
        ),
    ]
    .map(|lamp| Emitter::new(&lamp, CENTER, 2.0).unwrap())
    .to_vec()
}

const CENTER: Vec3 = Vec3::new(1.0, 0.0, -1.0);

/// Planes through points near the subject: facing the lamps, away from them, and grazing.
fn planes() -> Vec<(Vec3, Vec3)> {
    let mut rng = Rng::new(3, 0);
    let mut number = || 2.0 * rng.uniform_f32() - 1.0;
    (0..40)
        .map(|_| {
            let point = CENTER + Vec3::new(number(), number(), number());
            (point, Vec3::new(number(), number(), number()).normalize())
        })
        .collect()
}

/// Directions drawn to a single lamp give its irradiance in closed form, horizon and all, and each meets the
/// lamp at the distance told.
#[test]
fn samples_give_the_irradiance_in_closed_form() {
    for (i, lamp) in lamps().iter().enumerate() {
        let one = [*lamp];
        for (j, (point, normal)) in planes().into_iter().enumerate() {
            let choice = LampChoice::new(&one, point);
            let exact = lamp.irradiance(point, normal).x;
            let (net, n) = (Sobol::new((i * 100 + j) as u64), 4096);
            let (mut sum, mut most) = (0.0f64, 0.0f32);
            for k in 0..n {
                let [a, b, c, _] = net.point(k);
                let Some(sample) = choice.sample([a, b, c]) else {
                    continue;
                };
                let term = sample.radiance.x * normal.dot(sample.dir).max(0.0) / sample.pdf;
                sum += f64::from(term);
                most = most.max(sample.radiance.x / sample.pdf);
                let ray = Ray {
                    origin: point,
                    dir: sample.dir,
                };
                assert!((sample.dir.length() - 1.0).abs() < 1e-5);
                // Directions have 24 bits, and a lamp's edge is met by chance.
                let inward = choice.met(&ray, f32::INFINITY, |_| 1.0);
                let short = choice.met(&ray, 0.999 * sample.distance.min(1e6), |_| 1.0);
                if k % 64 == 0 && (0.1..0.9).contains(&a) && (0.1..0.9).contains(&b) && i != 4 {
                    assert_eq!(inward, lamp.radiance, "lamp {i}");
                    assert_eq!(short, Rgb::ZERO, "lamp {i}");
                }
            }
            let mean = (sum / f64::from(n)) as f32;
            assert!(
                (mean - exact).abs() < 2e-3 * most + 1e-6,
                "lamp {i} on plane {j}: {mean} is not {exact} of {most}"
            );
        }
    }
}

/// The closed forms themselves against a fine grid of directions.
#[test]
fn irradiance_is_the_integral_of_radiance_and_cosine() {
    for (i, lamp) in lamps().iter().enumerate() {
        // The small ones fall between the points of a grid.
        if matches!(i, 1 | 4 | 5) {
            continue;
        }
        for (point, normal) in planes().into_iter().take(8) {
            let (rows, columns) = (800, 1600);
            let mut sum = 0.0f64;
            for y in 0..rows {
                let cos = 1.0 - 2.0 * (f64::from(y) + 0.5) / f64::from(rows);
                let sin = (1.0 - cos * cos).sqrt();
                for x in 0..columns {
                    let (s, c) = (std::f64::consts::TAU * (f64::from(x) + 0.5)
                        / f64::from(columns))
                    .sin_cos();
                    let dir = DVec3::new(sin * c, cos, sin * s);
                    if lamp.place.hit(point.as_dvec3(), dir).is_some() {
                        sum += dir.dot(normal.as_dvec3()).max(0.0);
                    }
                }
            }
            let mean = sum * 4.0 * std::f64::consts::PI / f64::from(rows * columns);
            let exact = lamp.irradiance(point, normal).x / lamp.radiance.x;
            let error = (mean as f32 - exact).abs();
            assert!(error < 4e-3, "lamp {i}: {mean} is not {exact}");
        }
    }
}

/// Where several lamps shine, what is drawn gives the light of all.
#[test]
fn all_lamps_are_drawn() {
    let all = lamps();
    for (point, normal) in planes() {
        let choice = LampChoice::new(&all, point);
        let exact: Rgb = all.iter().map(|l| l.irradiance(point, normal)).sum();
        let (net, n) = (Sobol::new(9), 1 << 15);
        let mut sum = Rgb::ZERO;
        for k in 0..n {
            let [a, b, c, _] = net.point(k);
            if let Some(s) = choice.sample([a, b, c]) {
                sum += s.radiance * (normal.dot(s.dir).max(0.0) / s.pdf);
            }
        }
        let mean = sum / n as f32;
        assert!(
            (mean - exact).abs().max_element() < 0.02 * exact.max_element() + 0.02,
            "{mean} is not {exact}"
        );
        let chances: f32 = choice.chance.iter().sum();
        assert!((chances - 1.0).abs() < 1e-5);
    }
}

#[test]
fn strength_is_the_light_in_the_middle() {
    for lamp in lamps() {
        let toward = LampChoice::new(&[lamp], CENTER).sample([0.5; 3]);
        // The middle of each lamp is where its square of numbers has its middle, but for the cones.
        let facing = match lamp.place {
            Place::Rect(_) => toward.unwrap().dir,
            Place::Sphere { center, .. } => (center.as_vec3() - CENTER).normalize(),
            Place::Sun(cone) => cone.axis().as_vec3(),
        };
        let paint = lamp.irradiance(CENTER, facing) / PI;
        let error = (paint - Rgb::new(1.0, 0.5, 0.25)).abs().max_element();
        assert!(error < 2e-3, "{paint}");
    }
}

/// The rectangle looks at the subject, and its halves turn to where it shines.
#[test]
fn rectangles_face_the_subject() {
    for lamp in lamps() {
        if let EmitterShape::Rect {
            center,
            half: [across, up],
            facing,
        } = lamp.shape()
        {
            let normal = across.cross(up).normalize();
            assert!(normal.distance(facing) < 1e-5, "{normal} {facing}");
            assert!((CENTER - center).normalize().distance(facing) < 1e-5);
            assert!(up.y >= 0.0, "{up}");
        }
    }
}

#[test]
fn lamps_without_size_or_around_the_subject_are_refused() {
    let placed = |shape| {
        let lamp = Lamp {
            shape,
            yaw_deg: 0.0,
            pitch_deg: 0.0,
            strength: Rgb::ONE,
        };
        Emitter::new(&lamp, Vec3::ZERO, 1.0).is_some()
    };
    let rect = |distance, size| LampShape::Rect { distance, size };
    let sphere = |distance, radius| LampShape::Sphere { distance, radius };
    assert!(placed(rect(1.0, [1.0, 1.0])) && placed(sphere(1.0, 0.9)));
    assert!(!placed(rect(1.0, [0.0, 1.0])) && !placed(rect(0.0, [1.0, 1.0])));
    assert!(!placed(sphere(1.0, 1.1)) && !placed(sphere(f32::NAN, 0.1)));
    assert!(!placed(LampShape::Sun { diameter_deg: 0.0 }));
}
