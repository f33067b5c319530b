//! What compound follicles promise: who stands where, how many, and that thinned grooms nest.

use super::follicle::Follicle;
use super::tests::{fox, grown};
use super::walk::Ground;
use super::{Groom, GroomSettings};
use crate::progress::{Cancel, Silent};
use crate::skin::{self, Skin};
use crate::species::{Arrangement, CombCurve, Pores, Species};
use glam::{Vec2, Vec3};

const SPREAD_MM: f64 = 0.4;

/// A sparse fox: 12 pores to a square centimeter, with 6 hairs behind each.
fn grouped(arrangement: Arrangement, uneven: f64) -> Species {
    let mut species = fox();
    species.classes[0].groom.density_per_cm2 = 12.0;
    species.classes[1].groom.density_per_cm2 = 72.0;
    species.groom.pores = Some(Pores {
        density_per_cm2: None,
        spread_mm: SPREAD_MM,
        arrangement,
        uneven,
    });
    species
}

/// All hairs of nature.
fn natural(skin: &Skin, species: &Species) -> Groom {
    let settings = GroomSettings::default();
    super::grow(skin, species, &settings, &Silent, &Cancel::default()).unwrap()
}

fn roots(groom: &Groom, class: u8) -> Vec<(usize, Vec3)> {
    let of = (0..groom.strands()).filter(|&i| groom.class[i] == class);
    of.map(|i| (i, groom.strand(i)[0])).collect()
}

/// For each hair of the undercoat the number of the nearest guard hair, and the way from it.
fn groups(groom: &Groom) -> Vec<(usize, Vec3)> {
    let guards = roots(groom, 0);
    let nearest = |root: Vec3| {
        let away = guards.iter().map(|(_, guard)| root - guard).enumerate();
        away.min_by(|a, b| a.1.length().total_cmp(&b.1.length()))
            .unwrap()
    };
    roots(groom, 1)
        .into_iter()
        .map(|(_, root)| nearest(root))
        .collect()
}

#[test]
fn the_undercoat_stands_behind_its_guard_hair() {
    let skin = skin::load("swatch").unwrap();
    for (arrangement, behind) in [
        (Arrangement::Cluster, [0.0, 1.0]),
        (Arrangement::Row, [0.3, 0.5]),
    ] {
        let groom = natural(&skin, &grouped(arrangement, 0.0));
        let guards = roots(&groom, 0);
        let (mut across, mut widest) = (0.0f32, 0.0f32);
        let mut counts = vec![0; guards.len()];
        for (pore, way) in groups(&groom) {
            counts[pore] += 1;
            let root = guards[pore].0;
            // At the border there is no skin to stand on.
            let border = (groom.root_uv[root] - 0.5).abs().max_element();
            if 0.5 - border < SPREAD_MM as f32 / 60.0 {
                continue;
            }
            let triangle = skin.triangles[groom.root_triangle[root] as usize];
            let lay = skin.combing[triangle[0] as usize];
            let normal = skin.normals[triangle[0] as usize];
            let unit = way / (SPREAD_MM as f32 * 1e-3);
            // The skin bends a little over a triangle.
            let back = unit.dot(lay);
            assert!(back > behind[0] - 0.04 && back < behind[1] + 0.04, "{unit}");
            assert!(unit.length() < 1.001, "{unit}");
            across += unit.dot(lay.cross(normal));
            widest = widest.max(unit.dot(lay.cross(normal)).abs());
        }
        assert!((across / groom.strands() as f32).abs() < 0.1 && widest > 0.8);
        // As many as the densities make: six, and the last round one more for some.
        let sum: usize = counts.iter().sum();
        let (least, rest) = (sum / counts.len(), sum % counts.len());
        assert_eq!(least, 6);
        assert_eq!(counts.iter().filter(|&&n| n == 7).count(), rest);
        assert!(counts.iter().all(|n| [6, 7].contains(n)), "{counts:?}");
    }
}

#[test]
fn guard_hairs_stand_as_single_follicles_do() {
    let skin = skin::load("swatch").unwrap();
    let species = grouped(Arrangement::Cluster, 0.3);
    let mut single = species.clone();
    single.groom.pores = None;
    let (grouped, single) = (natural(&skin, &species), natural(&skin, &single));
    assert_eq!(grouped.id, single.id);
    let guards = grouped.class.iter().filter(|&&c| c == 0).count();
    for i in 0..grouped.strands() {
        assert_eq!(grouped.strand(i) == single.strand(i), i < guards);
    }
}

/// Hairs of a group fill their half disc evenly, each in a place of its own, and both pores of a pair that share
/// theirs have as many in the mean.
#[test]
fn hairs_of_a_group_are_spread_evenly() {
    let skin = skin::load("swatch").unwrap();
    let groom = natural(&skin, &grouped(Arrangement::Cluster, 1.0));
    let (roots, groups) = (roots(&groom, 1), groups(&groom));
    let spread = SPREAD_MM as f32 * 1e-3;
    let squares = groups
        .iter()
        .map(|(_, way)| way.length_squared() / (spread * spread));
    let mean = squares.sum::<f32>() / groups.len() as f32;
    assert!((mean - 0.5).abs() < 0.03, "{mean}");
    let mut sorted: Vec<[u32; 3]> = (roots.iter())
        .map(|(_, root)| root.to_array().map(f32::to_bits))
        .collect();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(sorted.len(), roots.len());
    let odd = groups.iter().filter(|(pore, _)| pore % 2 == 1).count();
    let share = odd as f32 / groups.len() as f32;
    assert!((share - 0.5).abs() < 0.05, "{share}");
}

/// The side to which hair lies is that to which it is combed.
#[test]
fn the_undercoat_stands_behind_along_what_combs_it() {
    let skin = skin::load("swatch").unwrap();
    let mut species = grouped(Arrangement::Cluster, 0.0);
    species.groom.comb.curves.push(CombCurve {
        lines: vec![vec![[0.03, 0.0, 0.0], [-0.03, 0.0, 0.0]]],
        is_placed: true,
        radius_mm: 100.0,
        strength: 1.0,
    });
    let groups = groups(&natural(&skin, &species));
    let mean = groups.iter().map(|(_, way)| *way).sum::<Vec3>() / groups.len() as f32;
    // The center of a half disc is 4 / (3 pi) of its radius from its diameter.
    let expected = 4.0 / (3.0 * std::f32::consts::PI) * SPREAD_MM as f32 * 1e-3;
    assert!(-mean.x > 0.8 * expected, "{mean} for {expected}");
}

/// Pores come in pairs, whatever the number of hairs.
#[test]
fn any_number_of_hairs_is_dealt() {
    let skin = skin::load("swatch").unwrap();
    let species = grouped(Arrangement::Row, 1.0);
    for strands in 1..60 {
        assert_eq!(grown(&skin, &species, strands, 1).strands(), strands);
    }
}

#[test]
fn uneven_groups_have_the_same_mean() {
    let skin = skin::load("swatch").unwrap();
    let groom = natural(&skin, &grouped(Arrangement::Cluster, 1.0));
    let mut counts = vec![0.0; roots(&groom, 0).len()];
    for (pore, _) in groups(&groom) {
        counts[pore] += 1.0;
    }
    let n = counts.len() as f64;
    let mean: f64 = counts.iter().sum::<f64>() / n;
    let spread = (counts.iter().map(|c| (c - mean) * (c - mean)).sum::<f64>() / n).sqrt();
    assert!((5.9..6.1).contains(&mean), "{mean}");
    // Halves of pairs that are spread evenly from none to all: 12 / sqrt(12), and chance.
    assert!((3.0..4.6).contains(&spread), "{spread}");
}

/// More pores than guard hairs: every fourth has one, and each has its share of all hairs.
#[test]
fn pores_of_their_own_density_share_all_hairs() {
    let skin = skin::load("swatch").unwrap();
    let mut species = grouped(Arrangement::Cluster, 0.0);
    species.groom.pores.as_mut().unwrap().density_per_cm2 = Some(36.0);
    let groom = natural(&skin, &species);
    let mut pores = fox();
    pores.classes.truncate(1);
    pores.classes[0].groom.density_per_cm2 = 36.0;
    let pores: Vec<Vec3> = roots(&natural(&skin, &pores), 0)
        .iter()
        .map(|r| r.1)
        .collect();
    let reach = 1.05 * SPREAD_MM as f32 * 1e-3;
    let near = |pore: &Vec3, class: u8| {
        let all = roots(&groom, class);
        all.iter()
            .filter(|(_, root)| root.distance(*pore) < reach)
            .count()
    };
    // Half discs of neighbors may meet.
    let two = pores.iter().filter(|pore| near(pore, 1) == 2).count();
    assert!(
        two as f64 > 0.9 * pores.len() as f64,
        "{two} of {}",
        pores.len()
    );
    let guarded: usize = pores.iter().map(|pore| near(pore, 0)).sum();
    assert_eq!(guarded, roots(&groom, 0).len());
}

#[test]
fn thinned_grooms_of_compound_follicles_nest() {
    let skin = skin::load("swatch").unwrap();
    for uneven in [0.0, 0.7] {
        let species = grouped(Arrangement::Cluster, uneven);
        let dense = grown(&skin, &species, 2500, 3);
        let thin = grown(&skin, &species, 601, 3);
        for i in 0..thin.strands() {
            let whole = dense.id.binary_search(&thin.id[i]).unwrap();
            assert_eq!(thin.strand(i), dense.strand(whole));
        }
    }
}

#[test]
fn roots_lie_on_their_triangles() {
    let skin = skin::load("ball").unwrap();
    let groom = grown(&skin, &grouped(Arrangement::Row, 0.3), 3000, 1);
    for i in 0..groom.strands() {
        let [a, b, c] = skin.corners(groom.root_triangle[i] as usize);
        let Vec2 { x: u, y: v } = groom.root_barycentric[i];
        assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + 1e-6);
        let place = a * (1.0 - u - v) + b * u + c * v;
        assert!(place.distance(groom.strand(i)[0]) < 1e-7);
    }
}

/// Four unit squares in a row, each at a right angle to the last, with a seam of vertices between the
/// second and the third.
fn stairs() -> Skin {
    let mut skin = Skin::default();
    let profile = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 1.0], [2.0, 2.0]];
    for side in profile.windows(2) {
        let first = skin.positions.len() as u32;
        let [p, q] = [side[0], side[1]];
        for [x, y] in [p, q] {
            skin.positions
                .extend([Vec3::new(x, y, 0.0), Vec3::new(x, y, 1.0)]);
        }
        skin.triangles.push([first, first + 1, first + 2]);
        skin.triangles.push([first + 2, first + 1, first + 3]);
    }
    skin
}

#[test]
fn ways_go_straight_over_edges_and_end_at_borders() {
    let skin = stairs();
    let ground = Ground::new(&skin);
    let from = Follicle {
        position: Vec3::new(0.25, 0.0, 0.25),
        triangle: 0,
        barycentric: [0.25, 0.25],
    };
    let to = |x: f32, z: f32| {
        let way = Vec3::new(x, 0.0, z);
        ground
            .go(&from, way.normalize_or(Vec3::X), way.length())
            .position
    };
    assert!(to(0.5, 0.25).distance(Vec3::new(0.75, 0.0, 0.5)) < 1e-6);
    // Unfolded, the stairs are a strip: 1.5 along it is half of the first riser.
    assert!(to(1.25, 0.3).distance(Vec3::new(1.0, 0.5, 0.55)) < 1e-6);
    assert!(to(2.5, 0.5).distance(Vec3::new(1.75, 1.0, 0.75)) < 1e-6);
    assert!(to(0.0, 5.0).distance(Vec3::new(0.25, 0.0, 1.0)) < 1e-6);
    assert!(to(0.0, 0.0).distance(from.position) < 1e-6);
    assert!(to(9.0, 0.0).distance(Vec3::new(2.0, 2.0, 0.25)) < 1e-6);
}
