//! What varies over the skin does so where and as far as asked.

use super::Groom;
use super::tests::{fox, grown};
use crate::io::Picture;
use crate::skin;
use crate::species::{Vary, VaryBy, VaryWhat};
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

/// Varies by a picture that is black on the left and white on the right.
fn halves(what: VaryWhat, from: f64, to: f64) -> Vary {
    // Many pixels: between the last black and the first white one it is blended.
    let values = (0..32).map(|i| f32::from(u8::from(i >= 16))).collect();
    let picture = Arc::new(Picture::new(32, 1, values).unwrap());
    Vary {
        what,
        by: VaryBy::Map { picture },
        from,
        to,
    }
}

/// A swatch of straight hair, without and with something that varies.
fn pair(vary: Vary) -> (Groom, Groom) {
    let skin = skin::load("swatch").unwrap();
    let mut species = fox();
    for class in &mut species.classes {
        class.groom.curl_mm = 1.0;
        class.groom.frizz_mm = 1.0;
    }
    let plain = grown(&skin, &species, 4_000, 5);
    for class in &mut species.classes {
        class.groom.vary = vec![vary.clone()];
    }
    (plain, grown(&skin, &species, 4_000, 5))
}

/// Mean of a number of each strand over the middles of the black and of the white half.
fn means(groom: &Groom, of: impl Fn(usize) -> f32) -> [f32; 2] {
    [0.2..0.3, 0.7..0.8].map(|half| {
        let strands = 0..groom.strands();
        let here: Vec<f32> = (strands.filter(|&i| half.contains(&groom.root_uv[i].x)))
            .map(&of)
            .collect();
        here.iter().sum::<f32>() / here.len() as f32
    })
}

#[test]
fn lengths_widths_and_curls_have_their_factor() {
    let (plain, groom) = pair(halves(VaryWhat::Length, 0.25, 1.5));
    assert_eq!(plain.id, groom.id);
    let ratio = |i: usize| groom.length[i] / plain.length[i];
    let [black, white] = means(&groom, ratio);
    // Waves are a little shorter by the length of their wave.
    assert!((black - 0.25).abs() < 0.1, "{black}");
    assert!((white - 1.5).abs() < 0.1, "{white}");

    let (plain, groom) = pair(halves(VaryWhat::Width, 0.5, 2.0));
    let ratio = |i: usize| {
        let k = groom.offsets[i] as usize + 2;
        groom.widths[k] / plain.widths[k]
    };
    let [black, white] = means(&groom, ratio);
    assert!((black - 0.5).abs() < 1e-3 && (white - 2.0).abs() < 1e-3);

    for what in [
        VaryWhat::Curl,
        VaryWhat::Frizz,
        VaryWhat::Clump,
        VaryWhat::Tilt,
    ] {
        let (plain, groom) = pair(halves(what, 0.3, 1.0));
        let moved = |i: usize| {
            let (a, b) = (groom.strand(i), plain.strand(i));
            a[a.len() - 1].distance(b[b.len() - 1])
        };
        let [black, white] = means(&groom, moved);
        assert!(black > 1e-4 && white < 1e-6, "{what:?}: {black} {white}");
    }
}

#[test]
fn the_lay_turns_by_its_angle() {
    let (plain, groom) = pair(halves(VaryWhat::Turn, 0.0, 90.0));
    let skin = skin::load("swatch").unwrap();
    let turned = |i: usize| {
        let normal = skin.normals[skin.triangles[groom.root_triangle[i] as usize][0] as usize];
        let lay = |groom: &Groom| {
            let points = groom.strand(i);
            let way = points[points.len() - 1] - points[0];
            (way - normal * way.dot(normal)).normalize()
        };
        let (from, to) = (lay(&plain), lay(&groom));
        from.cross(to).dot(normal).atan2(from.dot(to))
    };
    let [black, white] = means(&groom, turned);
    assert!(black.abs() < 0.01, "{black}");
    assert!((white - FRAC_PI_2).abs() < 0.2, "{white}");
}

#[test]
fn hairs_that_do_not_grow_are_counted_and_the_others_stay() {
    let (plain, groom) = pair(halves(VaryWhat::Density, 0.0, 1.0));
    let gone = plain.strands() - groom.strands();
    assert!((1_500..2_500).contains(&gone), "{gone}");
    let black = groom.root_uv.iter().filter(|uv| (0.2..0.3).contains(&uv.x));
    assert_eq!(black.count(), 0);
    let said = groom.warnings.join("\n");
    let count: usize = (said.lines())
        .map(|line| line.split(' ').next().unwrap().parse::<usize>().unwrap())
        .sum();
    assert_eq!(count, gone, "{said}");
    assert!(said.contains("strands of `guard` did not grow") && said.contains("density"));
    // The same hairs, where they were.
    let mut all = plain.id.iter().enumerate();
    for (i, id) in groom.id.iter().enumerate() {
        let (k, _) = all.find(|(_, other)| *other == id).unwrap();
        assert_eq!(groom.strand(i), plain.strand(k));
    }

    let (_, groom) = pair(halves(VaryWhat::Length, 0.0, 1.0));
    let said = groom.warnings.join("\n");
    assert!(said.contains("would be shorter than thick"), "{said}");
    assert!(groom.length.iter().all(|&length| length > 20e-6));

    let (_, groom) = pair(halves(VaryWhat::Width, 0.0, 1.0));
    let said = groom.warnings.join("\n");
    assert!(said.contains("would have no width"), "{said}");
    let roots = (0..groom.strands()).map(|i| groom.widths[groom.range(i).start]);
    assert!(roots.min_by(f32::total_cmp) > Some(0.0));
}

#[test]
fn noise_reaches_both_ends_and_does_not_depend_on_threads() {
    let noise = Vary {
        what: VaryWhat::Width,
        by: VaryBy::Noise {
            size_mm: 8.0,
            rough: 0.4,
            seed: 1,
        },
        from: 0.0,
        to: 1.0,
    };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| pair(noise.clone()))
    };
    let (plain, groom) = on(1);
    assert!(groom == on(3).1);
    let ratio = |i: usize| groom.widths[i * 12 + 2] / plain.widths[i * 12 + 2];
    let ratios: Vec<f32> = (0..groom.strands()).map(ratio).collect();
    let below = ratios.iter().filter(|r| **r < 0.25).count();
    let above = ratios.iter().filter(|r| **r > 0.75).count();
    assert!(below > 100 && above > 100, "{below} {above}");
}

/// Sheets that lie on each other have room for the hair of one.
#[test]
fn strands_without_room_are_counted() {
    let mut skin = skin::load("swatch").unwrap();
    let one = skin.clone();
    for layer in 1..30 {
        let first = skin.positions.len() as u32;
        let up = 1e-7 * layer as f32;
        let lifted = one.positions.iter().zip(&one.normals);
        skin.positions.extend(lifted.map(|(p, n)| *p + *n * up));
        skin.normals.extend(&one.normals);
        skin.uvs.extend(&one.uvs);
        skin.combing.extend(&one.combing);
        skin.length.extend(&one.length);
        skin.density.extend(&one.density);
        skin.color.extend(&one.color);
        let corners = one.triangles.iter().map(|t| t.map(|v| v + first));
        skin.triangles.extend(corners);
    }
    let groom = grown(&skin, &fox(), 6_000, 1);
    assert_eq!(groom.strands(), 6_000);
    let said = groom.warnings.join("\n");
    assert!(
        said.contains("had no room") && said.contains("`under`"),
        "{said}"
    );
    assert!(grown(&one, &fox(), 6_000, 1).warnings.is_empty());
}
