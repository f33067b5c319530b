use super::ray::Line;
use super::search::{Met, on_each_processor};
use super::*;
use crate::fiber::triangles::shear::Meeting;
use crate::sampling::Rng;
use std::f64::consts::TAU;

type Corners = [DVec3; 3];

const STEP: f64 = 1.0 / (1u64 << 27) as f64;
const PERIOD: f64 = 1.5;

fn snapped(p: DVec3) -> DVec3 {
    (p / STEP).round() * STEP
}

fn point(rng: &mut Rng) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| 2.0 * rng.uniform() - 1.0))
}

/// A closed tube or ball of rings, whose points are at `at(around, along)`, both in turns.
fn rings(around: u32, along: u32, at: impl Fn(f64, f64) -> DVec3) -> Vec<Corners> {
    let p = |i: u32, j: u32| {
        let (i, j) = (f64::from(i % around), f64::from(j));
        snapped(at(i / f64::from(around), j / f64::from(along)))
    };
    let quad = |i, j| {
        let [a, b, c, d] = [p(i, j), p(i + 1, j), p(i + 1, j + 1), p(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..along)
        .flat_map(|j| (0..around).flat_map(move |i| quad(i, j)))
        .filter(|[a, b, c]| (*b - *a).cross(*c - *a).length() > 0.0)
        .collect()
}

/// Meshes that trees find hard, each with a name.
fn meshes(rng: &mut Rng) -> Vec<(&'static str, Vec<Corners>)> {
    let polar = |r: f64, turns: f64, z: f64| {
        let (sin, cos) = (TAU * turns).sin_cos();
        DVec3::new(r * cos, r * sin, z)
    };
    let mut soup = |count: usize, size: &dyn Fn(usize) -> f64| -> Vec<Corners> {
        (0..count)
            .map(|k| {
                let middle = point(rng) * DVec3::new(0.7, 0.7, 0.5) + 0.75 * DVec3::Z;
                std::array::from_fn(|_| snapped(middle + size(k) * point(rng)))
            })
            .collect()
    };
    vec![
        ("soup", soup(400, &|_| 0.2)),
        ("sizes", soup(300, &|k| 10f64.powi(-(k as i32 % 6)))),
        ("few", soup(3, &|_| 0.5)),
        ("one", soup(1, &|_| 0.5)),
        (
            "slender",
            rings(180, 3, |u, v| polar(1.0 - 0.1 * v, u, PERIOD * v)),
        ),
        (
            "long",
            rings(24, 1, |u, v| polar(0.9, u, 3.0 * PERIOD * (v - 0.3))),
        ),
        (
            "balls",
            (0..12)
                .flat_map(|k| {
                    let middle = polar(0.5, f64::from(k) / 12.0, 0.1 + 0.1 * f64::from(k));
                    rings(16, 8, move |u, v| {
                        let (sin, cos) = (0.5 * TAU * v).sin_cos();
                        middle + polar(0.12 * sin, u, -0.2 * cos)
                    })
                })
                .collect(),
        ),
        (
            "flat",
            rings(9, 40, |u, v| {
                DVec3::new((2.0 * u - 1.0).abs(), 0.0, PERIOD * v)
            }),
        ),
    ]
}

fn label(k: usize) -> Label {
    let regions = [
        Region::Outside,
        Region::Cuticle,
        Region::Cortex,
        Region::Medulla,
        Region::Void,
    ];
    let hash = crate::sampling::hash64(k as u64) as usize;
    Label {
        source: k as u32,
        sides: [regions[hash % 5], regions[hash / 5 % 5]],
        bound: Bound::ALL[hash / 25 % 4],
        part: Part::Scale,
    }
}

fn tree_of(triangles: &[Corners]) -> Tree {
    let (mut tree, places) = Tree::new(triangles, STEP, PERIOD).unwrap();
    tree.label(|place| label(places[place] as usize));
    tree
}

/// Rays that graze edges, run through corners, along the axis and in the planes of triangles, and start on all of them.
fn hostile(triangles: &[Corners], i: usize, rng: &mut Rng) -> (DVec3, DVec3) {
    let one = |rng: &mut Rng| triangles[rng.bits() as usize % triangles.len()];
    let [a, b, c] = one(rng);
    let on = |rng: &mut Rng, kind: usize| match kind % 4 {
        0 => a,
        1 => a.lerp(b, rng.uniform()),
        2 => a.lerp(b, 0.5),
        _ => a + rng.uniform() * 0.5 * (b - a) + rng.uniform() * 0.5 * (c - a),
    };
    let target = on(rng, i);
    let dir = match i / 4 % 6 {
        0 => [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::Z][i / 24 % 4],
        // Along an edge, and in the plane.
        1 => (c - b).normalize_or(DVec3::X),
        2 => (on(rng, i / 3) - one(rng)[1]).normalize_or(DVec3::Y),
        3 => (DVec3::Z + 1e-9 * point(rng)).normalize(),
        _ => point(rng).normalize_or(DVec3::X),
    };
    // Started on it, a hair before or behind it, or far off.
    let away = [0.0, 1e-12, -1e-9, 1e-4, 0.3, 1.0][i / 24 % 6];
    let within = target.clamp(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, PERIOD));
    (within - away * dir, dir)
}

/// What a ray meets, by a test of every triangle.
fn every(triangles: &[Corners], ray: &Shear, limit: f64, kind: Kind) -> Met {
    let is_of = |label: Label, enters: bool| {
        let side = label.sides[usize::from(!enters)];
        let is_layer = label.bound == Bound::Void || side == Region::Void;
        kind == Kind::ALL
            || kind == Kind::around(side)
            || (kind == Kind::layers(Bound::Void) && is_layer)
    };
    (triangles.iter().enumerate())
        .filter_map(|(k, corners)| {
            let Meeting { t, enters } = ray.meet(corners)?;
            let counts = t >= 0.0 && t <= limit && is_of(label(k), enters);
            counts.then_some(((t + 0.0).to_bits(), k as u32, enters))
        })
        .collect()
}

#[test]
fn every_ray_is_shown_to_the_bit_what_a_test_of_all_triangles_finds() {
    let mut rng = Rng::new(11, 0);
    let around = [Region::Outside, Region::Cortex, Region::Void].map(Kind::around);
    let layers = Kind::layers(Bound::Void);
    for (name, triangles) in meshes(&mut rng) {
        let tree = tree_of(&triangles);
        let mut hits = 0;
        for i in 0..3_000 {
            let (origin, dir) = hostile(&triangles, i, &mut rng);
            let ray = Shear::new(origin, dir);
            let kind = [Kind::ALL, around[0], around[1], around[2], layers][i % 5];
            for limit in [0.5, 4.0] {
                let mut want = every(&triangles, &ray, limit, kind);
                want.sort_unstable();
                hits += want.len();
                for nearest in [false, true] {
                    // Of the nearest ones all that are as near: which of them counts, the caller decides.
                    let least = want.first().map(|w| w.0);
                    let wanted = want.iter().filter(|w| !nearest || Some(w.0) == least);
                    let wanted: Met = wanted.copied().collect();
                    for (processor, met) in on_each_processor(&tree, &ray, limit, kind, nearest) {
                        assert_eq!(met, wanted, "{name}, ray {i}, {processor}: {origin} {dir}");
                    }
                }
            }
        }
        assert!(hits > 300, "{name}: {hits}");
    }
}

/// What is decided at one time is the same to the bit whatever decides it.
#[test]
#[cfg(target_arch = "x86_64")]
fn leaves_and_normals_are_met_alike_by_every_processor() {
    use crate::accel::lanes::{Lanes, Plain, Task, on_avx2, on_avx512};
    #[derive(Clone, Copy)]
    struct All<'a>(&'a Leaf, &'a Node, &'a Line);
    impl Task for All<'_> {
        type Output = (u32, [u32; 2]);

        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            let Self(leaf, node, line) = self;
            let kinds =
                [Kind::ALL.0, Region::Void as usize].map(|kind| leaf.meets::<L>(line, kind));
            (kinds[0] | kinds[1] << 8, node.faces::<L>(line))
        }
    }
    let mut rng = Rng::new(12, 0);
    let (mut met, mut turned_away, mut seen) = (0, 0, 0);
    for (name, triangles) in meshes(&mut rng) {
        let tree = tree_of(&triangles);
        let mut some = 0;
        for i in 0..4_000 {
            let (origin, dir) = hostile(&triangles, i, &mut rng);
            let line = Line::new(&Shear::new(origin, dir), &tree.grid, tree.step, tree.room);
            let leaf = &tree.leaves[rng.bits() as usize % tree.leaves.len()];
            let node = &tree.nodes[rng.bits() as usize % tree.nodes.len()];
            let all = All(leaf, node, &line);
            let want = all.run::<Plain>();
            some += usize::from(want.0 != 0);
            turned_away += (!want.1[0] & 0xff).count_ones();
            seen += want.1[0].count_ones();
            for quick in [on_avx2(all), on_avx512(all)].into_iter().flatten() {
                assert_eq!(quick, want, "{name}, ray {i}");
            }
        }
        met += some;
    }
    assert!(met > 1_000, "{met}");
    assert!(turned_away > 1_000 && seen > 1_000, "{turned_away} {seen}");
}

#[test]
fn corners_are_where_they_were_and_turn() {
    let mut rng = Rng::new(13, 0);
    for (name, triangles) in meshes(&mut rng) {
        let (mut tree, places) = Tree::new(&triangles, STEP, PERIOD).unwrap();
        for turned in [false, true] {
            for (number, leaf) in tree.leaves.entries().iter().enumerate() {
                for k in 0..leaf.count() {
                    let [a, b, c] = triangles[places[SIZE * number + k] as usize];
                    let want = if turned { [a, c, b] } else { [a, b, c] };
                    assert_eq!(leaf.corners(k, STEP), want, "{name}");
                }
            }
            tree.turn(|_| true);
        }
    }
}

/// Slender triangles of a strip share corners: more of them than two make a leaf.
#[test]
fn leaves_are_full() {
    let triangles = rings(720, 4, |u, v| {
        let (sin, cos) = (TAU * u).sin_cos();
        DVec3::new(cos, sin, PERIOD * v)
    });
    let tree = tree_of(&triangles);
    let places: usize = tree.leaves.entries().iter().map(Leaf::count).sum();
    let mean = places as f64 / tree.leaves.len() as f64;
    assert!(mean > 3.5, "{mean}");
}
