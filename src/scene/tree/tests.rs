use super::*;
use crate::sampling::Rng;
use crate::scene::ribbon::Segment;
use glam::{Vec3, Vec4Swizzles};

fn point(rng: &mut Rng) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| 2.0 * rng.uniform_f32() - 1.0))
}

/// Strands of some joints, cut into runs.
fn runs(strands: &[Vec<Vec4>]) -> (Vec<Vec4>, Vec<Run>) {
    let (mut joints, mut runs) = (Vec::new(), Vec::new());
    for strand in strands {
        for first in (0..strand.len() - 1).step_by(2) {
            runs.push(Run {
                joint: (joints.len() + first) as u32,
                segments: (strand.len() - 1 - first).min(2) as u8,
                is_last: first + 3 >= strand.len(),
            });
        }
        joints.extend_from_slice(strand);
    }
    (joints, runs)
}

/// Furs that trees find hard, each with a name.
fn furs(rng: &mut Rng) -> Vec<(&'static str, Vec<Vec<Vec4>>)> {
    let mut strand = |n: usize, start: Vec3, dir: Vec3, bend: f32, width: f32| -> Vec<Vec4> {
        let mut at = start;
        (0..n)
            .map(|_| {
                let joint = at.extend(width * (0.2 + rng.uniform_f32()));
                at += dir + bend * point(rng);
                joint
            })
            .collect()
    };
    let spread = |i: usize, k: f32| {
        let h = |m: u64| (crate::sampling::hash64(i as u64 * 3 + m) % 10_007) as f32 / 10_007.0;
        k * Vec3::new(h(0), h(1), h(2))
    };
    let few = |n: usize, f: &mut dyn FnMut(usize) -> Vec<Vec4>| (0..n).map(f).collect::<Vec<_>>();
    let slant = Vec3::new(1.0, 0.7, -0.4);
    vec![
        (
            "tangle",
            few(150, &mut |i| {
                strand(2 + i % 7, spread(i, 10.0), Vec3::ZERO, 1.0, 0.1)
            }),
        ),
        (
            "combed",
            few(300, &mut |i| {
                strand(2 + i % 5, spread(i, 8.0), slant, 0.05, 0.03)
            }),
        ),
        (
            "upright",
            few(300, &mut |i| strand(4, spread(i, 8.0), Vec3::Y, 0.0, 0.03)),
        ),
        (
            "star",
            few(200, &mut |i| {
                let tip = spread(i, 2.0) - 1.0;
                vec![
                    (-5.0 * tip).extend(0.01),
                    Vec3::ZERO.extend(0.02),
                    (5.0 * tip).extend(0.01),
                ]
            }),
        ),
        (
            "far",
            few(100, &mut |i| {
                strand(
                    5,
                    Vec3::splat(9e5) + spread(i, 200.0),
                    20.0 * slant,
                    5.0,
                    2.0,
                )
            }),
        ),
        (
            "scales",
            few(200, &mut |i| {
                let size = 10f32.powi(i as i32 % 7 - 4);
                strand(3, spread(i, 3.0), size * slant, 0.5 * size, 0.2 * size)
            }),
        ),
        (
            "thin",
            few(200, &mut |i| {
                strand(5, spread(i, 4.0), 0.3 * slant, 0.3, 0.0)
            }),
        ),
        (
            "same",
            few(60, &mut |_| {
                vec![Vec4::new(0.0, 0.0, 0.0, 0.1), Vec4::new(1.0, 0.0, 0.0, 0.1)]
            }),
        ),
        (
            "one",
            few(1, &mut |_| strand(2, Vec3::ONE, slant, 0.0, 0.1)),
        ),
    ]
}

/// By a test of every segment.
fn every(tree: &Tree, runs: &[Run], ray: &Ray, limit: f32, ignored: &Ignored) -> Option<Found> {
    let mut best: Option<Found> = None;
    for (run, of) in (0..).zip(runs) {
        for half in 0..u32::from(of.segments) {
            let segment = Segment {
                root: tree.joint(run, half as usize),
                tip: tree.joint(run, half as usize + 1),
            };
            let Some((t, _)) = segment.intersect(ray.origin, ray.dir) else {
                continue;
            };
            let is_ignored = t < ignored.clear && (ignored.first..ignored.end).contains(&run);
            if t > 0.0 && t <= limit && !is_ignored && best.is_none_or(|b| t < b.t) {
                let place = tree.places[run as usize];
                best = Some(Found {
                    t,
                    run,
                    half,
                    place,
                });
            }
        }
    }
    best
}

#[test]
fn every_ray_meets_to_the_bit_what_a_test_of_all_segments_finds() {
    let mut rng = Rng::new(4, 0);
    for (name, strands) in furs(&mut rng) {
        let (joints, runs) = runs(&strands);
        let tree = Tree::build(&joints, &runs, &[]);
        let size = joints
            .iter()
            .fold(0.0f32, |a, j| a.max(j.xyz().distance(joints[0].xyz())));
        let mut hits = 0;
        for i in 0..1_500 {
            let joint = joints[rng.bits() as usize % joints.len()];
            // Within, or at the rim.
            let off = match i % 3 {
                0 => point(&mut rng).normalize_or_zero(),
                _ => 1.5 * point(&mut rng),
            };
            let target = joint.xyz() + joint.w * off;
            let away = match i % 4 {
                0 => 1e-3,
                1 => 1.0,
                2 => 2.0 * size,
                _ => 2_000.0 * size,
            };
            let dir = match i % 5 {
                0 => Vec3::AXES[i % 3],
                // Along the strand.
                1 => (joints[(i + 1) % joints.len()] - joints[i % joints.len()])
                    .xyz()
                    .normalize_or(Vec3::X),
                _ => point(&mut rng).normalize_or(Vec3::X),
            };
            let ray = Ray {
                origin: target - away * dir,
                dir,
            };
            let run = rng.bits() % runs.len() as u32;
            let ignored = Ignored {
                first: run,
                end: run + 3,
                clear: away,
            };
            for (limit, ignored) in [(f32::INFINITY, None), (2.0 * away, Some(ignored))] {
                let plain = Ignored {
                    first: 0,
                    end: 0,
                    clear: 0.0,
                };
                let want = every(&tree, &runs, &ray, limit, &ignored.unwrap_or(plain));
                assert_eq!(
                    tree.closest(&ray, limit, ignored, |_| ()),
                    want,
                    "{name}, ray {i}: {ray:?}"
                );
                assert_eq!(
                    tree.any(&ray, limit, ignored),
                    want.is_some(),
                    "{name}, ray {i}"
                );
                let line = Line {
                    origin: ray.origin,
                    dir,
                };
                let walk =
                    tree.walk::<Plain, false>(&line, limit, &ignored.unwrap_or(plain), |_| ());
                assert_eq!(walk, want, "{name}, ray {i}, without AVX2");
                if let Some(found) = want {
                    hits += 1;
                    // The limit itself is within.
                    assert_eq!(tree.closest(&ray, found.t, ignored, |_| ()), want);
                    assert!(!tree.any(&ray, found.t.next_down(), ignored));
                }
            }
        }
        assert!(hits > 150 || name == "thin", "{name}: {hits}");
    }
}

#[test]
fn joints_are_where_they_were() {
    let mut rng = Rng::new(5, 0);
    for (name, strands) in furs(&mut rng) {
        let (joints, runs) = runs(&strands);
        let tree = Tree::build(&joints, &runs, &[]);
        // No leaf is larger than the fur.
        let size = |axis: usize| {
            let all = joints.iter().map(|j| j[axis]);
            all.clone().fold(f32::MIN, f32::max) - all.fold(f32::MAX, f32::min)
        };
        let near = size(0).max(size(1)).max(size(2)) / 60_000.0;
        for (number, run) in (0..).zip(&runs) {
            for k in 0..=usize::from(run.segments) {
                let (kept, given) = (tree.joint(number, k), joints[run.joint as usize + k]);
                let off = (kept - given).abs();
                assert!(
                    off.xyz().max_element() <= near + 1e-6 * given.abs().max_element(),
                    "{name}: {kept} for {given}"
                );
                assert!(off.w <= 2e-5 * joints.iter().fold(0.0f32, |a, j| a.max(j.w)));
            }
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_tree() {
    let mut rng = Rng::new(6, 0);
    let strands: Vec<Vec<Vec4>> = (0..4_000)
        .map(|_| {
            let start = 30.0 * point(&mut rng);
            (0..5)
                .map(|k| (start + k as f32 * point(&mut rng)).extend(0.02))
                .collect()
        })
        .collect();
    let (joints, runs) = runs(&strands);
    let bytes = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let tree = pool.install(|| Tree::build(&joints, &runs, &[]));
        let nodes: Vec<String> = (0..tree.nodes.len())
            .map(|i| format!("{:?}", tree.nodes[i]))
            .collect();
        (nodes, tree.places)
    };
    assert!(bytes(1) == bytes(3));
}
