//! A plot shows what the table holds.

use super::*;
use crate::math::unicube::Unicube;
use crate::table::{Ledger, Mode, Nodes, Provenance};

/// A red lobe about the specular cone, brightest at azimuth 180.
fn maps(res: usize) -> ScatterMaps {
    let nodes = Nodes::new(Mode::Cone, 8);
    let cube = Unicube::new(res);
    let mut rgb = Vec::new();
    for &center in &nodes.centers {
        for texel in 0..cube.texels() {
            let (w, _) = cube.direction(texel, 0.5, 0.5);
            let off = frame::theta_of(w) + center;
            let f = (-50.0 * off * off).exp() * (1.2 - w.x) * cube.solid_angle(texel) * 0.2;
            rgb.push([f as f32, (0.4 * f) as f32, (0.2 * f) as f32]);
        }
    }
    ScatterMaps {
        error: vec![0.1; rgb.len()],
        ledger: vec![Ledger::default(); nodes.len()],
        nodes,
        res,
        rgb,
        absorption_per_um: [0.0; 3],
        radius_um: 40.0,
        provenance: Provenance::default(),
    }
}

fn plot(maps: &ScatterMaps) -> Plot<'_> {
    Plot {
        maps,
        gray: false,
        incidence_deg: 30.0,
        title: "made up".into(),
        subtitle: "a lobe".into(),
        size: (800, 500),
    }
}

#[test]
fn the_map_is_bright_on_the_cone_and_dark_off_it() {
    let maps = maps(16);
    let canvas = plot(&maps).draw().unwrap();
    assert_eq!((canvas.width(), canvas.height()), (800, 500));
    // Warm pixels of the left half are the map's bright band: below the middle, since the light
    // leaves at -30 degrees.
    let bright = |x: usize, y: usize| {
        let c = canvas.get(x, y);
        c.x > 0.5 && c.x - c.z > 0.15
    };
    let rows: Vec<usize> = (0..500)
        .filter(|&y| (0..400).any(|x| bright(x, y)))
        .collect();
    let dark = |y: usize| {
        (0..400)
            .filter(|&x| canvas.get(x, y).element_sum() < 0.5)
            .count()
    };
    assert!(!rows.is_empty());
    let first = rows[0];
    assert!(dark(first - 40) > 150, "above the band it is dark");
}

#[test]
fn impossible_plots_are_refused() {
    let maps = maps(16);
    for change in [
        |p: &mut Plot| p.incidence_deg = 91.0,
        |p: &mut Plot| p.incidence_deg = f64::NAN,
        |p: &mut Plot| p.size = (0, 0),
        |p: &mut Plot| p.size = (100_000, 500),
    ] {
        let mut plot = plot(&maps);
        change(&mut plot);
        assert!(matches!(plot.draw(), Err(TableError::Request(_))));
    }
    let odd = self::maps(6);
    assert!(plot(&odd).draw().is_err());
}
