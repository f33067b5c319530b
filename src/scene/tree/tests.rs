use super::line::Line;
use super::*;
use crate::accel::lanes::{Lanes, Plain};
use crate::sampling::Rng;
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

/// By a test of every leaf.
fn every(tree: &Tree, ray: &Ray, limit: f32, ignored: &Ignored) -> Option<Found> {
    let line = Line::new(ray, &tree.ball);
    let mut best: Option<Found> = None;
    for number in 0..tree.leaves.len() {
        let leaf = &tree.leaves[number];
        let (met, t) = leaf.meets::<Plain>(&line, limit);
        let t = Plain::eight(t);
        for lane in (0..8).filter(|lane| met >> lane & 1 == 1) {
            let (run, half, t) = (leaf.run(lane), lane as u32 / 4, t[lane]);
            let is_ignored = t < ignored.clear && (ignored.first..ignored.end).contains(&run);
            let is_first = best.is_none_or(|b| (t, run, half) < (b.t, b.run, b.half));
            if !is_ignored && is_first {
                best = Some(Found {
                    t,
                    run,
                    half,
                    place: (number * leaf::RUNS + lane % leaf::RUNS) as u32,
                });
            }
        }
    }
    best
}

#[test]
fn every_ray_meets_to_the_bit_what_a_test_of_all_leaves_finds() {
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
            let away = match i % 7 {
                0 => 1e-3,
                1 => 1.0,
                2 | 3 => 2.0 * size,
                4 | 5 => 2_000.0 * size,
                _ => 2e5 * size,
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
                let want = every(&tree, &ray, limit, &ignored.unwrap_or(plain));
                assert_eq!(
                    tree.closest(&ray, limit, ignored),
                    want,
                    "{name}, ray {i}: {ray:?}"
                );
                assert_eq!(
                    tree.any(&ray, limit, ignored),
                    want.is_some(),
                    "{name}, ray {i}"
                );
                for (processor, met) in search::on_each_processor(&tree, &ray, limit, ignored) {
                    assert_eq!(met, want, "{name}, ray {i}, {processor}");
                }
                if let Some(found) = want {
                    hits += 1;
                    // The limit itself is within.
                    assert_eq!(tree.closest(&ray, found.t, ignored), want);
                    assert!(!tree.any(&ray, found.t.next_down(), ignored));
                }
            }
        }
        assert!(hits > 150 || name == "thin", "{name}: {hits}");
    }
}

/// In single precision along the ray and in double precision across the scene: the same, but where a ray just touches.
#[test]
fn a_leaf_meets_what_its_segments_do() {
    let mut rng = Rng::new(7, 0);
    let (mut hits, mut others) = (0, 0);
    for (name, strands) in furs(&mut rng) {
        let (joints, runs) = runs(&strands);
        let tree = Tree::build(&joints, &runs, &[]);
        for i in 0..4_000 {
            let leaf = rng.bits() as usize % tree.leaves.len();
            let (k, run) = tree.leaves[leaf].numbers().next().unwrap();
            let (root, tip) = (tree.joint(run, 0), tree.joint(run, 1));
            let target = root.lerp(tip, rng.uniform_f32());
            let dir = point(&mut rng).normalize_or(Vec3::X);
            let size = root.w.max(tip.w).max((tip - root).xyz().length());
            let origin = target.xyz() + 1.5 * target.w * point(&mut rng) - size * dir;
            let ray = Ray { origin, dir };
            let line = Line::new(&ray, &tree.ball);
            let (met, t) = tree.leaves[leaf].meets::<Plain>(&line, f32::INFINITY);
            let t = f64::from(Plain::eight(t)[k]);

            let [root, tip] = [root, tip].map(|joint| joint.as_dvec4());
            let (o, d) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
            let (to_root, axis) = (root.truncate() - o, (tip - root).truncate());
            let (depth, slope) = (to_root.dot(d), axis.dot(d));
            let (flat_root, flat) = (to_root - depth * d, axis - slope * d);
            let at = (-flat_root.dot(flat) / flat.length_squared().max(1e-300)).clamp(0.0, 1.0);
            let distance = (flat_root + at * flat).length();
            let radius = root.w + at * (tip.w - root.w);
            let depth = depth + at * slope;
            // Places are rounded where the fur is far from the origin of the scene.
            let rounding =
                8.0 * f64::from(f32::EPSILON) * o.abs().max_element() + 1e-4 * f64::from(size);
            if (distance - radius).abs() < rounding || depth < rounding {
                continue;
            }
            let is_met = met >> k & 1 == 1;
            assert_eq!(is_met, distance < radius, "{name}, ray {i}: {ray:?}");
            if is_met {
                hits += 1;
                // Along the axis one place is as good as the next.
                if flat.length() > 0.1 * f64::from(size) && radius < 0.1 * flat.length() {
                    assert!((t - depth).abs() < 20.0 * rounding, "{name}, ray {i}");
                    others += 1;
                }
            }
        }
    }
    assert!(hits > 5_000 && others > 1_000, "{hits} {others}");
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
