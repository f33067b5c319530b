//! No strand passes through the skin, on skins that are not kind to hair.

use super::tests::{fox, grown};
use super::{Account, Groom};
use crate::skin::{self, Skin};
use crate::species::{Collision, Species};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// A sheet 3 cm wide along Z, folded along the line of its section, meters in X and Y. Hair lies along it.
fn folded(name: &str, section: &[Vec2]) -> Skin {
    let mut skin = Skin {
        name: name.to_owned(),
        ..Skin::default()
    };
    let last = section.len() - 1;
    for z in [-0.015, 0.015] {
        for (i, p) in section.iter().enumerate() {
            let way = section[(i + 1).min(last)] - section[i.saturating_sub(1)];
            let way = way.normalize();
            skin.positions.push(p.extend(z));
            skin.normals.push(way.perp().extend(0.0));
            skin.combing.push(way.extend(0.0));
            skin.uvs.push(Vec2::new(p.x, z));
        }
    }
    for i in 0..last as u32 {
        let over = i + last as u32 + 1;
        skin.triangles.push([i, over, i + 1]);
        skin.triangles.push([i + 1, over, over + 1]);
    }
    plain(skin)
}

/// Hair of the species' length and density everywhere.
fn plain(mut skin: Skin) -> Skin {
    let count = skin.positions.len();
    skin.length = vec![1.0; count];
    skin.density = vec![1.0; count];
    skin.color = vec![Vec3::ONE; count];
    skin
}

/// Grooves 3 mm wide and 4 mm deep, whose walls are 41 degrees apart.
fn grooves() -> Skin {
    let zigzag = (0..=20).map(|i| {
        let height = if i % 2 == 0 { 0.004 } else { 0.0 };
        Vec2::new(0.0015 * (i - 10) as f32, height)
    });
    folded("grooves", &zigzag.collect::<Vec<_>>())
}

/// Plates as thin as 0.2 mm and 5 mm high that stand upright on a floor, 3 mm apart.
fn plates() -> Skin {
    let plates = (0..8).flat_map(|i| {
        let x = 0.0032 * (i - 4) as f32;
        let corners = [(0.0, 0.0), (0.003, 0.0), (0.003, 0.005), (0.0032, 0.005)];
        corners.map(|(dx, y)| Vec2::new(x + dx, y))
    });
    folded("plates", &plates.collect::<Vec<_>>())
}

/// Slits of a hundredth of a millimeter between plates, which leave no room for hair.
fn slits() -> Skin {
    let slits = (0..5).flat_map(|i| {
        let x = 0.004 * (i - 2) as f32;
        let corners = [(-5e-6, 0.005), (-4e-6, 0.0), (4e-6, 0.0), (5e-6, 0.005)];
        corners.map(|(dx, y)| Vec2::new(x + dx, y))
    });
    folded("slits", &slits.collect::<Vec<_>>())
}

/// A ball and one of a third of its size that sinks into it: a sharp ring of a groove.
fn snowman() -> Skin {
    let mut skin = skin::load("ball").unwrap();
    let small = skin.clone();
    let first = skin.positions.len() as u32;
    let moved = (small.positions.iter()).map(|p| 0.33 * *p + Vec3::new(0.0, 0.02, 0.09));
    skin.positions.extend(moved);
    skin.normals.extend(&small.normals);
    skin.combing.extend(&small.combing);
    skin.uvs.extend(&small.uvs);
    let moved = small.triangles.iter().map(|t| t.map(|v| v + first));
    skin.triangles.extend(moved);
    skin.name = "snowman".to_owned();
    plain(skin)
}

/// The inside of a cube of this edge, where hair grows inward.
fn hollow(edge: f32) -> Skin {
    let mut skin = Skin {
        name: "hollow".to_owned(),
        ..Skin::default()
    };
    for side in 0..6 {
        let axis = |k: usize| Vec3::AXES[(side + k) % 3];
        let sign = if side < 3 { 1.0 } else { -1.0 };
        let (out, across, along) = (axis(0) * sign, axis(1) * sign, axis(2));
        let first = skin.positions.len() as u32;
        for corner in [
            -across - along,
            across - along,
            across + along,
            along - across,
        ] {
            skin.positions.push(0.5 * edge * (out + corner));
            skin.normals.push(-out);
            skin.combing.push(along);
            skin.uvs.push(Vec2::ZERO);
        }
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| first + k);
        skin.triangles.extend([[a, c, b], [a, d, c]]);
    }
    plain(skin)
}

/// A ball whose surface is turned in at steep dents, a centimeter wide and as deep.
fn dented() -> Skin {
    let mut skin = skin::load("ball").unwrap();
    let radius = skin.positions[0].length();
    let dents: Vec<Vec3> = (0..60)
        .map(|i| {
            let (y, turn) = (1.0 - (i as f32 + 0.5) / 30.0, 2.399_963 * i as f32);
            let flat = (1.0 - y * y).sqrt();
            Vec3::new(flat * turn.cos(), y, flat * turn.sin())
        })
        .collect();
    for p in &mut skin.positions {
        let out = p.normalize();
        let near = (dents.iter().map(|d| d.distance(out) * radius)).fold(1.0, f32::min);
        *p -= out * (0.01 * (1.0 - (near / 0.005).powi(2)).max(0.0));
    }
    let mut normals = vec![Vec3::ZERO; skin.positions.len()];
    for t in 0..skin.triangles.len() {
        let [a, b, c] = skin.corners(t);
        for v in skin.triangles[t] {
            normals[v as usize] += (b - a).cross(c - a);
        }
    }
    skin.normals = normals
        .into_iter()
        .map(|n| n.normalize_or(Vec3::Y))
        .collect();
    for (lay, normal) in skin.combing.iter_mut().zip(&skin.normals) {
        *lay = lay
            .reject_from(*normal)
            .normalize_or(normal.any_orthonormal_vector());
    }
    skin.name = "dents".to_owned();
    plain(skin)
}

fn fur(collision: Collision) -> Species {
    let mut species = fox();
    species.groom.collision = collision;
    for class in &mut species.classes {
        class.groom.length_mm = 8.0;
        class.groom.emergence_deg = 25.0;
        class.groom.stray_deg = 15.0;
    }
    species
}

/// Strands of which the drawn curve or a line between control points passes through a triangle, farther than
/// a micrometer from the root, by a test of its own: every triangle of the skin is met by the cubic where
/// its height above the triangle's plane changes sign.
fn passing(groom: &Groom, skin: &Skin) -> usize {
    let bounds = |points: &[DVec3]| {
        let start = (points[0], points[0]);
        (points.iter()).fold(start, |b, &p| (b.0.min(p), b.1.max(p)))
    };
    let triangles: Vec<_> = (0..skin.triangles.len())
        .map(|t| skin.corners(t).map(|p| p.as_dvec3()))
        .map(|corners| (bounds(&corners), corners))
        .collect();
    let passes = |strand: &[Vec3]| {
        let strand: Vec<DVec3> = strand.iter().map(|p| p.as_dvec3()).collect();
        let (first, last) = (2.0 * strand[0] - strand[1], strand.len() - 1);
        let mut ends = vec![first];
        ends.extend(&strand);
        ends.push(2.0 * strand[last] - strand[last - 1]);
        // Powers of the parameter.
        let mut cubics: Vec<[DVec3; 4]> = (ends.windows(4))
            .map(|p| {
                [
                    p[1],
                    0.5 * (p[2] - p[0]),
                    p[0] - 2.5 * p[1] + 2.0 * p[2] - 0.5 * p[3],
                    1.5 * (p[1] - p[2]) + 0.5 * (p[3] - p[0]),
                ]
            })
            .collect();
        let lines = strand.windows(2);
        cubics.extend(lines.map(|p| [p[0], p[1] - p[0], DVec3::ZERO, DVec3::ZERO]));
        // A spline stays within a length of a piece from its points.
        let longest = (lines_of(&strand)).fold(0.0, f64::max);
        let (lo, hi) = bounds(&strand);
        let (lo, hi) = (lo - longest, hi + longest);
        triangles.iter().any(|((from, to), corners)| {
            (from.x <= hi.x && from.y <= hi.y && from.z <= hi.z)
                && (to.x >= lo.x && to.y >= lo.y && to.z >= lo.z)
                && (cubics.iter()).any(|cubic| crosses(cubic, corners, strand[0]))
        })
    };
    let strands = (0..groom.strands()).into_par_iter();
    strands.filter(|&i| passes(groom.strand(i))).count()
}

fn lines_of(strand: &[DVec3]) -> impl Iterator<Item = f64> {
    strand.windows(2).map(|p| p[0].distance(p[1]))
}

/// Whether a cubic passes through a triangle, but for places within a micrometer of a root.
fn crosses(cubic: &[DVec3; 4], &[a, b, c]: &[DVec3; 3], root: DVec3) -> bool {
    let normal = (b - a).cross(c - a).normalize();
    let [k0, k1, k2, k3] = [0, 1, 2, 3].map(|k| cubic[k].dot(normal));
    let height = |t: f64| k0 - a.dot(normal) + t * (k1 + t * (k2 + t * k3));
    // Between these the height only rises or only falls.
    let mut stops = vec![0.0, 1.0];
    let inner = k2 * k2 - 3.0 * k3 * k1;
    if inner >= 0.0 {
        let q = -(k2 + inner.sqrt().copysign(k2));
        stops.extend([q / (3.0 * k3), k1 / q]);
    }
    stops.retain(|t: &f64| (0.0..=1.0).contains(t));
    stops.sort_by(f64::total_cmp);
    stops.windows(2).any(|range| {
        let (mut from, mut to) = (range[0], range[1]);
        if height(from).signum() == height(to).signum() {
            return false;
        }
        let rising = height(to) > height(from);
        for _ in 0..60 {
            let middle = 0.5 * (from + to);
            if (height(middle) > 0.0) == rising {
                to = middle;
            } else {
                from = middle;
            }
        }
        let point = cubic[0] + from * (cubic[1] + from * (cubic[2] + from * cubic[3]));
        let inside = |p: DVec3, q: DVec3| (q - p).cross(point - p).dot(normal) >= 0.0;
        inside(a, b) && inside(b, c) && inside(c, a) && point.distance(root) > 1e-6
    })
}

fn sum(groom: &Groom) -> Account {
    let mut all = Account::default();
    for account in &groom.accounts {
        all.asked += account.asked;
        all.buried += account.buried;
        all.bent += account.bent;
        all.cut += account.cut;
    }
    all
}

#[test]
fn no_strand_passes_through_hostile_skins() {
    let body = skin::load("body").unwrap();
    for (skin, strands, least) in [
        (grooves(), 2000, 0.2),
        (plates(), 2000, 0.2),
        (slits(), 2000, 0.2),
        (hollow(0.006), 1000, 0.2),
        (snowman(), 600, 0.001),
        (dented(), 600, 0.01),
        (body, 100, 0.0),
    ] {
        let near = grown(&skin, &fur(Collision::Near), strands, 1);
        let exact = grown(&skin, &fur(Collision::Exact), strands, 1);
        let (name, was) = (&skin.name, passing(&near, &skin));
        assert!(was as f64 >= least * strands as f64, "{name} is no trial");
        assert_eq!(passing(&exact, &skin), 0, "{name}");

        let account = sum(&exact);
        assert_eq!(sum(&near).bent, 0);
        assert_eq!(exact.strands() + account.buried, strands);
        let places: HashMap<u32, usize> = near.id.iter().copied().zip(0..).collect();
        let was = |i: usize| near.strand(places[&exact.id[i]]);
        let moved = (0..exact.strands()).filter(|&i| exact.strand(i) != was(i));
        assert_eq!(moved.count(), account.bent + account.cut, "{name}");
        let said = exact.warnings.join("\n");
        let first = exact.accounts[0];
        let collided = format!(
            "{} of {} strands of `guard` would have entered the skin: {} lie on it, {} end before it",
            first.bent + first.cut,
            first.grown(),
            first.bent,
            first.cut
        );
        assert_eq!(
            said.contains(&collided),
            first.bent + first.cut > 0,
            "{said}"
        );
    }
}

#[test]
fn hair_without_room_does_not_grow_and_is_counted() {
    // Wider than its fine hair is thick, narrower than its guard hair.
    let skin = hollow(5e-5);
    let exact = grown(&skin, &fur(Collision::Exact), 400, 1);
    let buried = exact.accounts[0].buried;
    assert!(
        buried == exact.accounts[0].asked && exact.strands() > 100,
        "{:?}",
        exact.accounts
    );
    assert_eq!(passing(&exact, &skin), 0);
    let said = exact.warnings.join("\n");
    assert!(
        said.contains(&format!("{buried} have no room between folds of the skin")),
        "{said}"
    );
    let n = exact.strands();
    assert_eq!(n, exact.accounts.iter().map(Account::grown).sum::<usize>());
    let lengths = [
        exact.id.len(),
        exact.normal.len(),
        exact.root_triangle.len(),
        exact.coat.len(),
    ];
    assert_eq!((lengths, exact.offsets.len()), ([n; 4], n + 1));
    assert_eq!(exact.points.len(), exact.widths.len());
    assert_eq!(exact.points.len(), exact.offsets[n] as usize);
    for i in 0..n {
        let [a, b, c] = skin.corners(exact.root_triangle[i] as usize);
        let [u, v] = exact.root_barycentric[i].to_array();
        let (strand, root) = (exact.strand(i), a * (1.0 - u - v) + b * u + c * v);
        assert!(strand[0].distance(root) < 1e-7, "strands keep their roots");
        let along = (strand[1] - strand[0]).normalize();
        assert!(exact.normal[i].dot(along).abs() < 1e-3 && exact.normal[i].is_normalized());
    }
}

/// A block whose lower side is a hundredth of a millimeter above the ground.
#[test]
fn what_is_cut_is_no_longer_and_not_below_the_ground() {
    let mut skin = hollow(0.02);
    skin.normals.iter_mut().for_each(|n| *n = -*n);
    skin.triangles.iter_mut().for_each(|t| t.reverse());
    skin.floor = Some(-0.01001);
    let near = grown(&skin, &fur(Collision::Near), 400, 1);
    let exact = grown(&skin, &fur(Collision::Exact), 400, 1);
    assert!(sum(&exact).buried > 20, "{:?}", exact.accounts);
    let places: HashMap<u32, usize> = near.id.iter().copied().zip(0..).collect();
    for i in 0..exact.strands() {
        let was = near.length[places[&exact.id[i]]];
        assert!(exact.length[i] < 1.2 * was, "{was} {}", exact.length[i]);
        assert!(exact.strand(i).iter().all(|p| p.y >= -0.01001));
    }
}

#[test]
fn what_is_bent_keeps_its_length() {
    let skin = grooves();
    let near = grown(&skin, &fur(Collision::Near), 4000, 1);
    let exact = grown(&skin, &fur(Collision::Exact), 4000, 1);
    let mut shares: Vec<f32> = (0..exact.strands())
        .filter(|&i| near.strand(i) != exact.strand(i))
        .map(|i| exact.length[i] / near.length[i])
        .collect();
    shares.sort_by(f32::total_cmp);
    let account = sum(&exact);
    assert_eq!(account.buried, 0);
    assert!(
        account.bent > 10 * account.cut,
        "most are bent: {account:?}"
    );
    // The bent ones are the longest.
    let median = shares[account.cut + account.bent / 2];
    assert!((0.9..1.1).contains(&median), "{median}");
}

#[test]
fn collisions_do_not_depend_on_threads_or_the_number_of_strands() {
    for skin in [grooves(), hollow(5e-5)] {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.unwrap()
                .install(|| grown(&skin, &fur(Collision::Exact), 3000, 1))
        };
        let dense = on(1);
        assert!(dense == on(5));
        let thin = grown(&skin, &fur(Collision::Exact), 300, 1);
        for i in 0..thin.strands() {
            let whole = dense.id.binary_search(&thin.id[i]).unwrap();
            assert_eq!(thin.strand(i), dense.strand(whole));
        }
    }
}

#[test]
fn skins_that_no_tree_is_built_over_are_refused() {
    let mut skin = grooves();
    let first = skin.triangles[0];
    skin.triangles.extend(std::iter::repeat_n(first, 100));
    let settings = super::GroomSettings {
        strands: Some(10),
        seed: 0,
    };
    let refused = super::grow(
        &skin,
        &fur(Collision::Exact),
        &settings,
        &crate::progress::Silent,
        &Default::default(),
    );
    let said = refused.unwrap_err().to_string();
    assert!(
        said.contains("102 of its triangles lie in the same box"),
        "{said}"
    );
}
