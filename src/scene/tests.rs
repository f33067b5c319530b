use super::*;
use crate::sampling::Rng;
use glam::{Vec2, Vec4};

fn unit(rng: &mut Rng) -> Vec3 {
    let z = 1.0 - 2.0 * rng.uniform_f32();
    let (sin, cos) = (std::f32::consts::TAU * rng.uniform_f32()).sin_cos();
    let flat = (1.0 - z * z).sqrt();
    Vec3::new(flat * cos, flat * sin, z)
}

/// Random walks in a cube of 20 mm.
fn tangle(strands: u32, step_mm: f32) -> Groom {
    let mut groom = Groom {
        offsets: vec![0],
        classes: vec!["guard".into()],
        ..Groom::default()
    };
    for i in 0..strands {
        let mut rng = Rng::new(3, u64::from(i));
        let corner = Vec3::from_array(std::array::from_fn(|_| rng.uniform_f32()));
        let (mut at, mut dir) = (corner * 0.02, unit(&mut rng));
        for _ in 0..5 {
            groom.points.push(at);
            groom.widths.push(1e-4 + 4e-4 * rng.uniform_f32());
            at += dir * step_mm * 1e-3;
            dir = (dir + 0.4 * unit(&mut rng)).normalize();
        }
        groom.offsets.push(groom.points.len() as u32);
        groom.class.push(0);
        groom.id.push(i);
        groom.root_uv.push(Vec2::ZERO);
        groom.length.push(4e-3 * step_mm);
    }
    groom
}

/// Strands of odd and of even numbers of segments.
#[test]
fn leaves_have_each_joint_once() {
    for strands in [1, 7, 900] {
        let strands = Strands::build(&tangle(strands, 2.0)).unwrap();
        let bits = |joint: Vec4| joint.to_array().map(f32::to_bits);
        let mut of_leaves: Vec<_> = (strands.tree().joints(0..strands.tree().leaves()))
            .map(bits)
            .collect();
        let mut of_strands: Vec<_> = strands.joints().map(|(_, joint)| bits(joint)).collect();
        of_leaves.sort_unstable();
        of_strands.sort_unstable();
        assert!(of_leaves == of_strands);
    }
}

#[test]
fn the_tree_finds_what_a_search_of_all_segments_finds() {
    let mut groom = tangle(400, 2.0);
    for without_length in [0, 5, 6, 399] {
        let points = groom.range(without_length);
        groom.points[points].fill(Vec3::ONE);
    }
    let strands = Strands::build(&groom).unwrap();
    let joints: Vec<(u32, Vec4)> = strands.joints().collect();
    let first: Vec<usize> = (0..400)
        .map(|s| joints.partition_point(|j| j.0 < s))
        .collect();
    let mut rng = Rng::new(8, 0);
    let mut hits = 0;
    for _ in 0..4_000 {
        let origin = Vec3::from_array(std::array::from_fn(|_| 30.0 * rng.uniform_f32() - 5.0));
        let ray = Ray {
            origin,
            dir: unit(&mut rng),
        };
        let mut best: Option<(f32, usize)> = None;
        for j in 0..joints.len() - 1 {
            if joints[j].0 != joints[j + 1].0 {
                continue;
            }
            let segment = strands.piece(joints[j].0, (j - first[joints[j].0 as usize]) as u32);
            if let Some((t, _)) = segment.intersect(ray.origin, ray.dir)
                && t > 2e-4
                && best.is_none_or(|(b, _)| t < b)
            {
                best = Some((t, j));
            }
        }
        let found = strands.closest(&ray, f32::INFINITY, None);
        assert_eq!(strands.occluded(&ray, f32::INFINITY, None), best.is_some());
        match (found, best) {
            (Some(hit), Some((t, j))) => {
                // Rounded otherwise: along the ray, not in the scene.
                assert!((hit.t - t).abs() < 1e-4, "{} for {t}", hit.t);
                assert_eq!(strands.joint_of(&hit), j);
                let strand: Vec<Vec3> = (joints.iter())
                    .filter(|joint| joint.0 == hit.strand)
                    .map(|joint| joint.1.xyz())
                    .collect();
                let way = |joints: &[Vec3]| -> f32 {
                    joints.windows(2).map(|p| p[0].distance(p[1])).sum()
                };
                let (before, whole) = (j - first[hit.strand as usize], way(&strand));
                let [from, to] = [before, before + 1].map(|k| way(&strand[..=k]) / whole);
                assert!((from - 1e-4..to + 1e-4).contains(&hit.at));
                assert!((hit.tip_mm - (1.0 - hit.at) * whole).abs() < 1e-3);
                let chord = (strand[before + 1] - strand[before]).normalize();
                assert!(hit.tangent.is_normalized() && hit.tangent.dot(chord) > 0.9);
                assert!(!strands.occluded(&ray, 0.999 * t, None));
                hits += 1;
            }
            (None, None) => {}
            other => panic!("{other:?}"),
        }
    }
    assert!(hits > 1_000, "{hits}");
}

#[test]
fn a_ray_never_meets_the_straight_strand_it_leaves() {
    let points: Vec<Vec3> = (0..9)
        .map(|i| Vec3::new(0.0, 1e-3 * i as f32, 0.0))
        .collect();
    let groom = Groom {
        widths: vec![3e-4; points.len()],
        offsets: vec![0, points.len() as u32],
        points,
        class: vec![0],
        ..Groom::default()
    };
    let strands = Strands::build(&groom).unwrap();
    let mut rng = Rng::new(2, 0);
    let (mut hits, mut again) = (0, 0);
    for _ in 0..20_000 {
        let target = Vec3::new(
            0.15 * (2.0 * rng.uniform_f32() - 1.0),
            8.0 * rng.uniform_f32(),
            0.0,
        );
        let dir = unit(&mut rng);
        let ray = Ray {
            origin: target - 50.0 * dir,
            dir,
        };
        let Some(hit) = strands.closest(&ray, f32::INFINITY, None) else {
            continue;
        };
        hits += 1;
        let origin = ray.origin + hit.t * ray.dir;
        let out = unit(&mut rng);
        let next = Ray { origin, dir: out };
        let leaving = hit.departure().along(out);
        assert!(
            strands
                .closest(&next, f32::INFINITY, Some(leaving))
                .is_none()
        );
        again += u32::from(strands.closest(&next, f32::INFINITY, None).is_some());
    }
    // Without it, the strand would often be met again.
    assert!(hits > 10_000 && again > hits / 10);
}

#[test]
fn coincident_strands_neither_hang_nor_matter() {
    let one = tangle(1, 2.0);
    let mut many = one.clone();
    for i in 1..20_000u32 {
        many.points.extend_from_slice(&one.points);
        many.widths.extend_from_slice(&one.widths);
        many.offsets.push(many.points.len() as u32);
        many.class.push(0);
        many.id.push(i);
        many.root_uv.push(Vec2::ZERO);
        many.length.push(one.length[0]);
    }
    let strands = Strands::build(&many).unwrap();
    let single = Strands::build(&one).unwrap();
    assert_eq!(strands.segments(), single.segments());
    let ray = Ray {
        origin: one.points[2] * 1e3 - Vec3::X * 10.0,
        dir: Vec3::X,
    };
    let hit = strands.closest(&ray, f32::INFINITY, None).unwrap();
    assert_eq!(hit.strand, 0);
}

#[test]
fn crowds_and_bad_numbers_are_refused() {
    let crowd: Vec<(Vec3, Vec3)> = vec![(Vec3::ZERO, Vec3::ONE); 65];
    let error = SceneError::from(crate::accel::Accel::build(&crowd).err().unwrap());
    assert!(matches!(error, SceneError::Coincident { count: 65, .. }));

    let good = tangle(3, 1.0);
    for bad in [f32::NAN, f32::INFINITY, 2e3] {
        let mut groom = good.clone();
        groom.points[7].y = bad;
        let error = Strands::build(&groom).err().unwrap();
        assert!(matches!(error, SceneError::Point { index: 7, .. }));
        assert_eq!(error.blame(), Blame::Input);
    }
    let mut groom = good.clone();
    groom.widths[2] = -1.0;
    assert!(Strands::build(&groom).is_err());
    let mut groom = good.clone();
    groom.offsets[1] = 9_999;
    assert!(matches!(
        Strands::build(&groom).err(),
        Some(SceneError::Groom { .. })
    ));
}

#[test]
fn strands_without_length_are_left_out_and_nothing_is_refused() {
    let mut groom = tangle(2, 1.0);
    for p in &mut groom.points[..5] {
        *p = Vec3::ONE * 0.001;
    }
    let strands = Strands::build(&groom).unwrap();
    assert!(strands.joints().count() > 0 && strands.joints().all(|(strand, _)| strand == 1));
    let parts = SceneParts {
        groom: &Groom {
            offsets: vec![0],
            ..Groom::default()
        },
        materials: vec![],
        skin: None,
        environment: Environment::white(),
        lamps: &[],
        backdrop: Backdrop::default(),
        ground: None,
        view: View::default(),
    };
    assert!(matches!(Scene::build(parts).err(), Some(SceneError::Empty)));
}

/// A closed surface hides what is inside from every direction, edges and corners too.
#[test]
fn a_closed_skin_does_not_leak() {
    let mut skin = Skin::default();
    let (n, m) = (24u32, 12u32);
    for j in 0..=m {
        for i in 0..n {
            let (theta, phi) = (
                std::f32::consts::PI * j as f32 / m as f32,
                std::f32::consts::TAU * i as f32 / n as f32,
            );
            let d = Vec3::new(
                theta.sin() * phi.cos(),
                theta.cos(),
                theta.sin() * phi.sin(),
            );
            skin.positions.push(0.01 * d);
            skin.normals.push(d);
            skin.color.push(Vec3::ONE);
        }
    }
    for j in 0..m {
        for i in 0..n {
            let at = |j: u32, i: u32| j * n + i % n;
            skin.triangles
                .push([at(j, i), at(j + 1, i), at(j + 1, i + 1)]);
            skin.triangles
                .push([at(j, i), at(j + 1, i + 1), at(j, i + 1)]);
        }
    }
    let surface = Surface::build(&skin, |_| Rgb::ONE).unwrap();
    let mut rng = Rng::new(6, 0);
    for k in 0..20_000 {
        // Half of the rays aim at points on edges.
        let triangle = skin.triangles[k % skin.triangles.len()];
        let [a, b, _] = triangle.map(|i| 1e3 * skin.positions[i as usize]);
        let origin = 2.0 * unit(&mut rng);
        let dir = if k % 2 == 0 {
            (a.lerp(b, rng.uniform_f32()) - origin).normalize()
        } else {
            unit(&mut rng)
        };
        let ray = Ray { origin, dir };
        let hit = surface.closest(&ray, f32::INFINITY).unwrap();
        assert!(hit.facing.dot(dir) <= 0.0 && surface.occluded(&ray, f32::INFINITY));
        assert!(((origin + hit.t * dir).length() - 10.0).abs() < 0.3);
    }
}

#[test]
fn environment_files_round_trip_and_bad_ones_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let color = |x: usize, y: usize| (x as f32 * 0.25, y as f32, 2.0);
    exr::prelude::write_rgb_file(path("good.exr"), 8, 4, color).unwrap();
    let env = load_environment(&path("good.exr")).unwrap();
    // The texel in the middle of the picture's right half, lower row, looks down and to +X.
    let dir = Vec3::new(1.0, -0.3, 0.0).normalize();
    assert_eq!(env.eval(dir).0, Rgb::new(1.5, 2.0, 2.0));

    let fails = |name: &str| load_environment(&path(name)).err().unwrap();
    assert!(fails("none.exr").to_string().contains("none.exr"));
    std::fs::write(path("broken.exr"), b"v/1\x01 not an image").unwrap();
    assert!(matches!(
        fails("broken.exr"),
        EnvironmentError::Broken { .. }
    ));
    std::fs::write(path("some.jpg"), b"").unwrap();
    assert!(matches!(fails("some.jpg"), EnvironmentError::Kind { .. }));
    exr::prelude::write_rgb_file(path("wide.exr"), 9, 4, color).unwrap();
    assert!(fails("wide.exr").to_string().contains("9 x 4"));
    let nan = |x: usize, _: usize| (if x == 3 { f32::NAN } else { 0.0 }, 0.0, 0.0);
    exr::prelude::write_rgb_file(path("nan.exr"), 8, 4, nan).unwrap();
    assert!(fails("nan.exr").to_string().contains("(3, 0)"));
    for name in ["none.exr", "broken.exr", "some.jpg", "wide.exr", "nan.exr"] {
        assert_eq!(fails(name).blame(), Blame::Input);
    }
    // A cut file, at every length.
    let whole = std::fs::read(path("good.exr")).unwrap();
    for n in (0..whole.len() - 1).step_by(7) {
        std::fs::write(path("cut.exr"), &whole[..n]).unwrap();
        assert!(load_environment(&path("cut.exr")).is_err());
    }
}

/// Along a helix a frame that does not twist turns about the tangent by minus the torsion (Bishop 1975).
#[test]
fn sides_are_carried_without_twisting() {
    let (radius, rise, turns) = (2e-3f32, 1e-3f32, 1.5f32);
    let n = 120;
    let angle = |i: usize| std::f32::consts::TAU * turns * i as f32 / n as f32;
    let points: Vec<Vec3> = (0..=n)
        .map(|i| {
            let (sin, cos) = angle(i).sin_cos();
            Vec3::new(radius * cos, radius * sin, rise * angle(i))
        })
        .collect();
    let tangent = |i: usize| {
        let (sin, cos) = angle(i).sin_cos();
        Vec3::new(-radius * sin, radius * cos, rise).normalize()
    };
    // Frenet's normal points to the axis.
    let inward = |i: usize| {
        let (sin, cos) = angle(i).sin_cos();
        Vec3::new(-cos, -sin, 0.0)
    };
    let groom = Groom {
        widths: vec![2e-5; points.len()],
        offsets: vec![0, points.len() as u32],
        normal: vec![inward(0)],
        points: points.clone(),
        class: vec![0],
        ..Groom::default()
    };
    let mut strands = Strands::build(&groom).unwrap();
    let meet = |strands: &Strands, i: usize| {
        let dir = -Vec3::Z.cross(tangent(i)).normalize();
        let origin = points[i] * 1e3 - 0.5 * dir;
        strands.closest(&Ray { origin, dir }, 1.0, None).unwrap()
    };
    assert_eq!(meet(&strands, 60).side, Vec3::ZERO);
    strands.carry_sides(&groom);
    let torsion = rise / radius.hypot(rise);
    for i in [3, 40, 77, 117] {
        let hit = meet(&strands, i);
        assert!(hit.side.is_normalized() && hit.side.dot(hit.tangent).abs() < 1e-5);
        // The major axis: the normal of the groom is the minor one.
        let minor = hit.tangent.cross(hit.side);
        let frenet = inward(i);
        let found = minor
            .dot(hit.tangent.cross(frenet))
            .atan2(minor.dot(frenet));
        let off = found + torsion * angle(i);
        let off = off.sin().atan2(off.cos());
        assert!(off.abs() < 0.03, "{i}: {found}, off by {off}");
    }
}
