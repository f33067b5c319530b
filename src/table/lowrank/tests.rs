//! Products come back.

use super::*;
use crate::math::frame;
use crate::math::unicube::Unicube;
use crate::table::{Mode, Nodes};

const LAYOUT: Layout = Layout {
    res: 32,
    folded: true,
};

/// Maps of a cone whose width and azimuth vary with the node: two products.
fn cone(nodes: &Nodes) -> Vec<Vec<f32>> {
    let cube = Unicube::new(LAYOUT.res);
    let maps = nodes.centers.iter().map(|&center| {
        let density = |i: usize| {
            let (w, _) = cube.direction(LAYOUT.texel(i), 0.5, 0.5);
            let theta = frame::theta_of(w);
            let off = theta + center;
            let cosine = theta.cos().max(0.05);
            let azimuth = w.x / w.x.hypot(w.y).max(1e-9);
            let (narrow, wide) = ((-80.0 * off * off).exp(), (-6.0 * off * off).exp());
            (narrow * (1.2 - azimuth) + 0.2 * center.cos() * wide) / cosine
        };
        (0..LAYOUT.len()).map(|i| density(i) as f32).collect()
    });
    maps.collect()
}

/// Relative distance over nodes below 60 degrees and directions clear of the poles.
fn distance(nodes: &Nodes, a: &[Vec<f32>], b: &[Vec<f32>]) -> f64 {
    let cube = Unicube::new(LAYOUT.res);
    let (mut apart, mut square) = (0.0, 0.0);
    for (node, center) in nodes.centers.iter().enumerate() {
        if center.abs() > 1.05 {
            continue;
        }
        for i in 0..LAYOUT.len() {
            let (w, _) = cube.direction(LAYOUT.texel(i), 0.5, 0.5);
            if frame::theta_of(w).abs() < 1.25 {
                apart += f64::from(a[node][i] - b[node][i]).powi(2);
                square += f64::from(b[node][i]).powi(2);
            }
        }
    }
    (apart / square).sqrt()
}

fn factors(nodes: &Nodes, maps: &[Vec<f32>], rank: usize) -> Factors {
    let rows = Rows {
        layout: LAYOUT,
        thetas: &nodes.centers,
        maps,
        importance: &vec![1.0; maps.len()],
    };
    Factors::new(&rows, rank)
}

#[test]
fn two_images_hold_a_sum_of_two_products() {
    let nodes = Nodes::new(Mode::Cone, 12);
    let maps = cone(&nodes);
    let factors = factors(&nodes, &maps, 3);
    let back = factors.maps(LAYOUT, &nodes.centers);
    let off = distance(&nodes, &back, &maps);
    assert!(off < 0.02, "{off}");
}
