//! Closed forms, determinism, refusals.

use super::*;
use crate::progress::Silent;
use crate::species::load;
use glam::DVec3;

fn with_subject<T>(name: &str, set: &[&str], f: impl FnOnce(&Subject) -> T) -> T {
    let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
    let species = load(name, &set).unwrap();
    let class = &species.classes[0];
    let station = class.stations.last().unwrap();
    let fiber = Fiber::build(&station.structure, 0).unwrap();
    f(&Subject {
        fiber: &fiber,
        species: &species,
        class,
        station,
    })
}

fn shot(width: usize, height: usize, samples: u32) -> Shot {
    Shot {
        size: (width, height),
        samples,
        legend: Legend::None,
    }
}

fn picture(view: View, subject: &Subject, shot: &Shot) -> Canvas {
    draw(view, subject, shot, &Silent, &Cancel::default()).unwrap()
}

/// Linear brightness in row `y`, the mean over the left half.
fn row_mean(canvas: &Canvas, y: usize) -> f64 {
    let half = canvas.width() / 2;
    let sum: f32 = (0..half)
        .map(|x| crate::color::linear_from_srgb(canvas.get(x, y).x))
        .sum();
    f64::from(sum) / half as f64
}

fn microscope(mount: f64) -> View {
    View::Light(Microscope {
        mount,
        ..Microscope::default()
    })
}

#[test]
fn a_cylinder_in_its_own_medium_is_invisible() {
    with_subject("glass-cylinder", &["structure.ior=1.52"], |subject| {
        let canvas = picture(microscope(1.52), subject, &shot(96, 64, 16));
        let field = canvas.get(0, 0);
        let even = |i: usize| canvas.get(i % 48, i / 48) == field;
        assert!((0..48 * 64).all(even));
    });
}

/// A cylinder in air is a strong lens: the middle sends light to the condenser, the sides do not.
/// By ray transfer at offset h = sin(i) the whole deviation is 2(i - t), sin t = h / n; what exceeds
/// both cones is dark. The middle loses two reflections, (1 - r)^2 with r = ((n-1)/(n+1))^2.
#[test]
fn a_cylinder_in_air_has_dark_edges_and_a_bright_middle() {
    with_subject("glass-cylinder", &["structure.ior=1.55"], |subject| {
        let narrow = View::Light(Microscope {
            mount: 1.0,
            objective: 0.05,
            condenser: 0.3,
            focus_um: 0.0,
            lamp_ev: Some(0.0),
        });
        let canvas = picture(narrow, subject, &shot(96, 64, 256));
        let field = row_mean(&canvas, 0);
        let r = (0.55f64 / 2.55).powi(2);
        let middle = row_mean(&canvas, 32) / field;
        assert!((middle - (1.0 - r).powi(2)).abs() < 0.02, "{middle}");
        // The fiber fills 0.8 of the height. A deviation of asin(0.3) +- asin(0.05) is reached
        // at offsets between 0.30 and 0.42 of the radius.
        let radius = 0.5 * 0.8 * 64.0;
        for y in 2..62 {
            let h = ((y as f64 + 0.5 - 32.0) / radius).abs();
            let share = row_mean(&canvas, y) / field;
            if (0.48..0.95).contains(&h) {
                assert!(share < 0.03, "row {y} offset {h}: {share}");
            } else if h < 0.24 {
                assert!(share > 0.85, "row {y} offset {h}: {share}");
            }
        }
    });
}

/// Beer's law down the middle of a matched, pigmented cylinder.
#[test]
fn pigment_absorbs_along_the_path() {
    let set = [
        "structure.ior=1.52",
        "fiber.pigment.0.eumelanin=1",
        "fiber.pigment.0.pheomelanin=0",
    ];
    let class = load("glass-cylinder", &[]).unwrap().classes[0].name.clone();
    let set: Vec<String> = set
        .iter()
        .map(|s| s.replace("fiber.", &format!("{class}.")))
        .collect();
    let set: Vec<&str> = set.iter().map(String::as_str).collect();
    with_subject("glass-cylinder", &set, |subject| {
        let axial = Microscope {
            mount: 1.52,
            objective: 0.02,
            condenser: 0.02,
            focus_um: 0.0,
            lamp_ev: Some(0.0),
        };
        let absorption = DVec3::from_array(absorption_at(subject.class, subject.station));
        let fiber = subject.fiber.clone().mounted_in(1.52);
        let mut sample = raster::Sample {
            x: 0.0,
            y: 0.0,
            pair: [0.5, 0.5],
            rng: crate::sampling::Rng::new(1, 2),
        };
        let got = light::light(&fiber, &axial, absorption, DVec3::ZERO, &mut sample);
        let diameter = subject.station.structure.diameter_um;
        let expected = (-diameter * absorption).exp();
        assert!(
            (got - expected).abs().max_element() < 1e-4,
            "{got} {expected}"
        );
        assert!(expected.z < 0.9 * expected.x);
    });
}

#[test]
fn air_in_the_medulla_is_dark_and_resin_is_not() {
    let mean_of_middle = |ior: &str| {
        let set = format!("guard.structure.medulla.void_ior={ior}");
        with_subject("polar-bear", &[&set], |subject| {
            let canvas = picture(microscope(1.52), subject, &shot(96, 64, 16));
            row_mean(&canvas, 32) / row_mean(&canvas, 0)
        })
    };
    let (air, resin) = (mean_of_middle("1.0003"), mean_of_middle("1.55"));
    assert!(air < 0.3 && resin > 0.85, "air {air}, resin {resin}");
}

/// Seen straight on, the mean of two points mirrored at the axis has the yield of the secant law;
/// the detector's side drops out but for its share toward the viewer.
#[test]
fn a_bare_cylinder_under_electrons_is_smooth_and_follows_the_secant_law() {
    with_subject("glass-cylinder", &[], |subject| {
        let canvas = picture(View::Sem { tilt: 0.0 }, subject, &shot(96, 64, 16));
        for y in 0..64 {
            let first = canvas.get(0, y).x;
            let even = |x: usize| (canvas.get(x, y).x - first).abs() < 0.04;
            assert!((0..96).all(even), "{y}");
        }
        let signal = |y: usize| -(1.0 - row_mean(&canvas, y)).ln();
        let middle = 0.5 * (signal(31) + signal(32));
        for y in 6..32 {
            let h = (32.0 - y as f64 - 0.5) / (0.5 * 0.92 * 64.0);
            let cos = (1.0 - h * h).sqrt();
            let expected = (0.7 + 0.147 * cos) / (0.847 * cos);
            let got = 0.5 * (signal(y) + signal(63 - y)) / middle;
            assert!((got / expected - 1.0).abs() < 0.02, "{y}: {got} {expected}");
        }
        assert!(signal(0) < 0.1 * middle);
    });
}

#[test]
fn pictures_do_not_depend_on_threads() {
    with_subject("red-fox", &[], |subject| {
        for view in [View::SEM, microscope(1.52), View::Section, View::Cutaway] {
            let one = rayon::ThreadPoolBuilder::new()
                .num_threads(1)
                .build()
                .unwrap();
            let three = rayon::ThreadPoolBuilder::new()
                .num_threads(3)
                .build()
                .unwrap();
            let shot = shot(96, 64, 2);
            let a = one.install(|| picture(view, subject, &shot));
            let b = three.install(|| picture(view, subject, &shot));
            assert_eq!(a.to_rgb8(), b.to_rgb8(), "{view:?}");
        }
    });
}

#[test]
fn pictures_have_the_size_asked_for() {
    with_subject("red-fox", &[], |subject| {
        for legend in [Legend::Caption, Legend::Bar, Legend::None] {
            let shot = Shot {
                size: (333, 201),
                samples: 1,
                legend,
            };
            for view in [View::SEM, View::Section, View::Cutaway, View::Plate] {
                let canvas = picture(view, subject, &shot);
                assert_eq!((canvas.width(), canvas.height()), (333, 201));
            }
        }
    });
}

#[test]
fn settings_out_of_range_are_refused() {
    let good = shot(96, 64, 1);
    assert!(check(View::SEM, &good).is_ok());
    assert!(check(View::Plate, &good).is_err());
    assert!(check(View::SEM, &shot(8, 64, 1)).is_err());
    assert!(check(View::SEM, &shot(96, 9000, 1)).is_err());
    assert!(check(View::SEM, &shot(96, 64, 0)).is_err());
    assert!(check(View::Sem { tilt: f64::NAN }, &good).is_err());
    for (mount, aperture) in [(0.9, 0.4), (f64::NAN, 0.4), (1.0, 1.0), (1.5, 0.0)] {
        let view = View::Light(Microscope {
            mount,
            objective: aperture,
            condenser: aperture,
            focus_um: 0.0,
            lamp_ev: Some(0.0),
        });
        assert!(check(view, &good).is_err(), "{mount} {aperture}");
    }
}

#[test]
fn canceled_is_not_a_picture() {
    with_subject("red-fox", &[], |subject| {
        let cancel = Cancel::default();
        cancel.cancel();
        let result = draw(View::SEM, subject, &shot(96, 64, 1), &Silent, &cancel);
        assert!(matches!(result, Err(MicrographError::Stopped)));
    });
}
