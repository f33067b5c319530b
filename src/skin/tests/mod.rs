//! What skins promise.

use super::*;
use std::collections::HashMap;

mod files;

/// The signed volume that the triangles enclose.
fn volume(skin: &Skin, triangles: std::ops::Range<usize>) -> f64 {
    triangles
        .map(|i| {
            let [a, b, c] = skin.corners(i).map(|p| p.as_dvec3());
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

#[test]
fn built_in_skins_are_sound() {
    for name in BUILT_IN {
        let skin = load(name).unwrap();
        assert_eq!(skin.name, name);
        assert!(skin.warnings.is_empty());
        let n = skin.positions.len();
        assert_eq!(
            [
                skin.normals.len(),
                skin.uvs.len(),
                skin.combing.len(),
                skin.length.len(),
                skin.density.len(),
                skin.color.len()
            ],
            [n; 6]
        );
        for i in 0..n {
            assert!(skin.positions[i].is_finite() && skin.uvs[i].is_finite());
            assert!((skin.normals[i].length() - 1.0).abs() < 1e-4, "{name}");
            assert!((skin.combing[i].length() - 1.0).abs() < 1e-4, "{name}");
            assert!(skin.density[i] >= 0.0 && skin.length[i] >= 0.0);
            if skin.density[i] > 0.0 {
                let lift = skin.normals[i].dot(skin.combing[i]);
                assert!(
                    lift.abs() < 1e-3,
                    "{name}: combing leaves the skin by {lift}"
                );
            }
        }
        for (i, triangle) in skin.triangles.iter().enumerate() {
            assert!(triangle.iter().all(|&v| (v as usize) < n));
            let [a, b, c] = skin.corners(i);
            let outward = (b - a).cross(c - a);
            let normals: Vec3 = triangle.iter().map(|&v| skin.normals[v as usize]).sum();
            assert!(
                outward.dot(normals) > 0.0,
                "{name}: triangle {i} looks inward"
            );
        }
    }
}

#[test]
fn the_body_is_closed_and_outward() {
    let skin = load("body").unwrap();
    // Eyes and nose are grids with a seam of doubled vertices: join equal positions.
    let mut ids = HashMap::new();
    let id: Vec<usize> = skin
        .positions
        .iter()
        .map(|p| {
            let next = ids.len();
            *ids.entry(p.to_array().map(|c| (c * 1e7).round() as i64))
                .or_insert(next)
        })
        .collect();
    let mut edges: HashMap<(usize, usize), i32> = HashMap::new();
    for t in &skin.triangles {
        let t = t.map(|v| id[v as usize]);
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            *edges.entry((a, b)).or_default() += 1;
        }
    }
    let open = edges
        .iter()
        .filter(|((a, b), count)| **count != 1 || edges.get(&(*b, *a)) != Some(&1))
        .count();
    assert_eq!(open, 0, "of {} half edges", edges.len());
    let liters = 1e3 * volume(&skin, 0..skin.triangles.len());
    assert!((8.0..14.0).contains(&liters), "{liters} l");
    let (lo, hi) = skin.bounds();
    assert!((0.6..0.7).contains(&(hi.x - lo.x)), "{lo} {hi}");
    assert!(lo.y > -0.002);
}

#[test]
fn the_ball_has_the_volume_and_area_of_a_ball() {
    let skin = load("ball").unwrap();
    let r = 0.08f64;
    let exact = 4.0 / 3.0 * std::f64::consts::PI * r.powi(3);
    assert!((volume(&skin, 0..skin.triangles.len()) / exact - 1.0).abs() < 0.005);
    assert!((skin.area() / (4.0 * std::f64::consts::PI * r * r) - 1.0).abs() < 0.005);
}
