//! What the shape of hairs promises: each property measured.

use super::clump::Clumps;
use super::tests::{fox, grown};
use super::*;
use crate::sampling::hash64;
use crate::species::ClassGroom;
use std::collections::HashMap;

/// Straight, equal hair but for what `change` sets.
fn plain(change: impl Fn(&mut ClassGroom)) -> Species {
    let mut species = fox();
    for class in &mut species.classes {
        let groom = &mut class.groom;
        groom.length_sigma = 0.0;
        groom.stray_deg = 0.0;
        groom.crimp_mm = 0.0;
        groom.clump = 0.0;
        groom.length_mm = 12.0;
        change(groom);
    }
    species
}

fn swatch(change: impl Fn(&mut ClassGroom)) -> Groom {
    grown(
        &crate::skin::load("swatch").unwrap(),
        &plain(change),
        20_000,
        1,
    )
}

/// What is left of a cut hair is the first part of what it was: bent, pulled to its tuft and straying as far.
#[test]
fn cut_hair_keeps_its_shape() {
    let shaped = |trim_mm: f64| {
        swatch(|groom| {
            groom.bend_deg = 60.0;
            groom.clump = 0.9;
            groom.frizz_mm = 1.0;
            groom.trim_mm = trim_mm;
        })
    };
    let (whole, cut) = (shaped(f64::INFINITY), shaped(4.0));
    assert_eq!(whole.id.len(), cut.id.len());
    let mut most = 0.0f32;
    for i in 0..cut.strands() {
        let Some(k) = whole
            .id
            .iter()
            .position(|id| *id == cut.id[i])
            .filter(|_| i % 37 == 0)
        else {
            continue;
        };
        let way = |points: [Vec3; 2], p: Vec3| {
            let along = points[1] - points[0];
            let t = ((p - points[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            p.distance(points[0] + t * along)
        };
        let line = whole.strand(k).windows(2);
        let off = line.map(|p| way([p[0], p[1]], tip(&cut, i)));
        most = most.max(off.fold(f32::INFINITY, f32::min));
    }
    // Chords of so bent a hair are a tenth of a millimeter from it.
    assert!(most < 3e-4, "{most}");
}

fn tip(groom: &Groom, i: usize) -> Vec3 {
    let points = groom.strand(i);
    points[points.len() - 1]
}

/// Root mean square distance of tips from the mean of their clump's tips: the median over clumps, as a
/// clump on the border of two locks is torn apart.
fn spread(groom: &Groom, size: f32) -> f32 {
    let clumps = Clumps {
        size,
        seed: hash64(1 ^ 0x636c_756d),
    };
    let mut tips: HashMap<[u32; 3], Vec<Vec3>> = HashMap::new();
    for i in 0..groom.strands() {
        let center = clumps.at(groom.strand(i)[0]).center;
        let key = center.to_array().map(f32::to_bits);
        tips.entry(key).or_default().push(tip(groom, i));
    }
    let of_clump = |tips: &Vec<Vec3>| {
        let mean = tips.iter().sum::<Vec3>() / tips.len() as f32;
        let sum: f32 = tips.iter().map(|t| t.distance_squared(mean)).sum();
        (sum / tips.len() as f32).sqrt()
    };
    let mut spreads: Vec<f32> = tips
        .values()
        .filter(|t| t.len() > 5)
        .map(of_clump)
        .collect();
    spreads.sort_by(f32::total_cmp);
    spreads[spreads.len() / 2]
}

/// Two levels: a clump of 0.5 leaves half of the spread of its tips, the lock that it is part of takes
/// 0.35 of it too. What is left is 0.15, and 0.21 in root mean square as pulls differ by up to 0.4 of themselves.
#[test]
fn clumps_and_locks_shrink_the_spread_of_tips() {
    let loose = spread(&swatch(|_| {}), 4e-3);
    let held = spread(&swatch(|g| g.clump = 0.5), 4e-3);
    let left = held / loose;
    assert!((0.08..0.32).contains(&left), "{left} of the spread is left");
}

#[test]
fn wet_hair_lies_lower_and_sticks_together() {
    let (dry, wet) = (swatch(|_| {}), swatch(|g| g.wet = 1.0));
    let height = |groom: &Groom| {
        let skin = crate::skin::load("swatch").unwrap();
        let field = field::Field::new(&skin);
        let tips = (0..groom.strands()).filter_map(|i| field.above(tip(groom, i)));
        let heights: Vec<f32> = tips.map(|a| a.height).collect();
        heights.iter().sum::<f32>() / heights.len() as f32
    };
    assert!(
        height(&wet) < 0.6 * height(&dry),
        "{} {}",
        height(&wet),
        height(&dry)
    );
    assert!(spread(&wet, 12e-3) < 0.35 * spread(&dry, 12e-3));
}

#[test]
fn frizz_wanders_as_far_as_it_says() {
    let (frizzy, smooth) = (swatch(|g| g.frizz_mm = 1.0), swatch(|_| {}));
    let far = |i: usize| tip(&frizzy, i).distance_squared(tip(&smooth, i));
    let mean = (0..smooth.strands()).map(far).sum::<f32>() / smooth.strands() as f32;
    // Two sines at any phase: the root mean square is 1 mm; what would enter the skin is lifted.
    assert!((0.8e-3..1.1e-3).contains(&mean.sqrt()), "{} m", mean.sqrt());
}

#[test]
fn curls_turn_at_their_radius() {
    for pitch in [8.0, 1.0] {
        let curled = swatch(|g| {
            g.curl_mm = 0.5;
            g.curl_pitch_mm = pitch;
        });
        assert_radius(&curled, 0.5e-3);
        // Eleven pieces of 12 mm have a turn in three.
        let is_said = curled
            .warnings
            .iter()
            .any(|w| w.contains("turn once in 3.3 mm and not in 1 mm"));
        assert_eq!(is_said, pitch == 1.0, "{:?}", curled.warnings);
    }
}

fn assert_radius(curled: &Groom, expected: f32) {
    let straight = swatch(|g| g.curl_mm = 1e-9);
    let mut sum = 0.0;
    for i in 0..curled.strands() {
        // Beyond the first turn, where the radius is full.
        let k = curled.strand(i).len() - 1;
        sum += curled.strand(i)[k].distance(straight.strand(i)[k]);
    }
    let radius = sum / curled.strands() as f32;
    // Hair that would curl into the skin is lifted: a little less or more.
    assert!((radius / expected - 1.0).abs() < 0.15, "{radius} m");
}

/// Clumps far wider than hair is long gather it and do not draw it out.
#[test]
fn clumps_do_not_stretch_hair() {
    let gathered = swatch(|g| {
        g.clump = 1.0;
        g.clump_mm = 100.0;
    });
    let loose = swatch(|_| {});
    let longer = gathered
        .length
        .iter()
        .zip(&loose.length)
        .map(|(a, b)| a / b);
    let most = longer.fold(0.0, f32::max);
    assert!((1.02..1.6).contains(&most), "{most}");
}

#[test]
fn trimmed_hair_has_the_length_and_blunt_ends() {
    let (whole, cut) = (swatch(|_| {}), swatch(|g| g.trim_mm = 6.0));
    let longest = cut.length.iter().fold(0.0f32, |a, &b| a.max(b));
    assert!((longest / 6e-3 - 1.0).abs() < 0.05, "{longest} m");
    let tip_width = |g: &Groom, i: usize| g.widths[g.offsets[i + 1] as usize - 1];
    for i in (0..cut.strands()).step_by(101) {
        assert!(tip_width(&cut, i) > 3.0 * tip_width(&whole, i));
    }
}
