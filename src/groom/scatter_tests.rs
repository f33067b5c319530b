//! How evenly pores are spread, on a flat square where that can be told by theory.

use super::follicle::Surface;
use super::tests::nearest_distances;
use crate::progress::{Cancel, Silent};
use crate::skin::Skin;
use glam::{Vec2, Vec3};
use std::f64::consts::TAU;

/// A unit square in the plane y = 0, of `n` x `n` cells of two triangles.
fn square(n: usize) -> Skin {
    let corners: Vec<Vec2> = (0..(n + 1) * (n + 1))
        .map(|i| Vec2::new((i % (n + 1)) as f32, (i / (n + 1)) as f32) / n as f32)
        .collect();
    let triangles = (0..n * n).flat_map(|i| {
        let a = (i / n * (n + 1) + i % n) as u32;
        let b = a + n as u32 + 1;
        [[a, b, b + 1], [a, b + 1, a + 1]]
    });
    let count = corners.len();
    Skin {
        name: "square".to_owned(),
        triangles: triangles.collect(),
        positions: corners.iter().map(|c| Vec3::new(c.x, 0.0, c.y)).collect(),
        uvs: corners,
        normals: vec![Vec3::Y; count],
        combing: vec![Vec3::X; count],
        length: vec![1.0; count],
        density: vec![1.0; count],
        color: vec![Vec3::ONE; count],
        ..Skin::default()
    }
}

fn points(skin: &Skin, count: usize) -> Vec<Vec3> {
    let surface = Surface::new(skin).unwrap();
    let scattered = surface.scatter(3, count, &Silent, &Cancel::default());
    let follicles = scattered.unwrap().follicles;
    follicles.iter().map(|f| f.position).collect()
}

/// Mean power of the points at the frequencies of a ring, over that of random points. Frequencies are whole
/// numbers of waves in the square, where an even cover has no power.
fn power(points: &[Vec3], ring: [f64; 2]) -> f64 {
    let reach = ring[1] as i32;
    // Half a plane: the other half is the same.
    let waves =
        (0..=reach).flat_map(|x| (-reach..=reach).map(move |y| Vec2::new(x as f32, y as f32)));
    let waves: Vec<Vec2> = waves
        .filter(|w| (ring[0]..ring[1]).contains(&f64::from(w.length())))
        .collect();
    let sum: f64 = (waves.iter())
        .map(|wave| {
            let sums = points.iter().fold([0.0, 0.0], |[c, s], p| {
                let (sin, cos) = (TAU * f64::from(wave.x * p.x + wave.y * p.z)).sin_cos();
                [c + cos, s + sin]
            });
            (sums[0] * sums[0] + sums[1] * sums[1]) / points.len() as f64
        })
        .sum();
    sum / waves.len() as f64
}

/// Blue noise has little power at low frequencies, a peak where its spacing is and that of random points
/// beyond; large triangles or small ones, all points or the first of them.
#[test]
fn pores_have_the_spectrum_and_the_distances_of_blue_noise() {
    for n in [4, 150] {
        let all = points(&square(n), 4_000);
        for count in [400, 1_500, 4_000] {
            let points = &all[..count];
            let hexagonal = (2.0 / 3f64.sqrt() / count as f64).sqrt();
            let principal = 2.0 / 3f64.sqrt() / hexagonal;
            let [low, middle, peak] = [[0.05, 0.3], [0.3, 0.5], [0.85, 1.1]]
                .map(|ring| power(points, ring.map(|share| share * principal)));
            // Two waves across the square: the last points of a prefix are everywhere.
            let lowest = power(points, [0.9, 2.1]);
            let distances = nearest_distances(points, 1.5 * hexagonal as f32);
            let distances: Vec<f64> = (distances.iter())
                .map(|d| f64::from(*d) / hexagonal)
                .collect();
            let least = distances.iter().fold(f64::INFINITY, |a, b| a.min(*b));
            let mean = distances.iter().sum::<f64>() / count as f64;
            println!(
                "{n} {count}: power {low:.3} {middle:.3} {peak:.3}, distances {least:.3} {mean:.3}"
            );
            assert!(lowest < 0.4, "{n} {count}: {lowest}");
            assert!(low < 0.2, "{n} {count}: {low}");
            assert!(middle < 0.25, "{n} {count}: {middle}");
            assert!(peak > 1.2, "{n} {count}: {peak}");
            assert!(least > 0.6 && mean > 0.76, "{n} {count}: {least} {mean}");
        }
    }
}
