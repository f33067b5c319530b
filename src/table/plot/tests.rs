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
        error: vec![[0.1; 3]; rgb.len()],
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
        closed_form: None,
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
    // A column through the map: dark above, the bright band of the cone below the middle since the
    // light leaves at -30 degrees, dark again.
    let x = 200;
    let night: Vec<usize> = (0..320)
        .filter(|&y| canvas.get(x, y).element_sum() < 0.4)
        .collect();
    let warmth = |y: usize| canvas.get(x, y).x - canvas.get(x, y).z;
    let brightest = (0..320)
        .max_by(|&a, &b| warmth(a).total_cmp(&warmth(b)))
        .unwrap();
    let above = night.iter().filter(|&&y| y < brightest).count();
    let below = night.iter().filter(|&&y| y > brightest).count();
    assert!(
        above > 2 * below && below > 10,
        "{above} rows above, {below} below"
    );
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
}

#[test]
fn poles_have_no_spikes() {
    // One bright texel beside each pole of an even table, as a single photon leaves it.
    let mut maps = maps(32);
    let cube = Unicube::new(32);
    let nodes = maps.nodes.len();
    for (i, rgb) in maps.rgb.iter_mut().enumerate() {
        *rgb = [(cube.solid_angle(i % cube.texels()) * 0.05) as f32; 3];
    }
    for node in 0..nodes {
        for z in [1.0, -1.0] {
            let texel = cube.texel(DVec3::new(0.01, 0.02, z).normalize());
            maps.rgb[node * cube.texels() + texel] = [0.0005; 3];
        }
    }
    let table = ScatterTable::new(maps.nodes.clone(), maps.res, maps.rgb.clone());
    // Between two nodes, so that both are shifted.
    let theta = 0.5 * (maps.nodes.centers[4] + maps.nodes.centers[5]);
    let field = Field::new(&table, theta, 1e4);
    let mut worst = [0.0f32; 2];
    for i in 0..2000 {
        let polar = 0.25 * f64::from(i % 50) / 50.0 + 1e-4;
        let phi = f64::from(i) * 0.157;
        for side in [1.0, -1.0] {
            let w = frame::direction(side * (std::f64::consts::FRAC_PI_2 - polar), phi);
            let raw = field.density(w).x;
            worst[0] = worst[0].max(raw);
            worst[1] = worst[1].max(field.gray(w));
        }
    }
    assert!(worst[0] > 2.0, "{worst:?}");
    assert!(worst[1] < 0.8, "{worst:?}");
}
