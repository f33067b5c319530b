//! Grids against closed forms.

use super::*;
use crate::progress::Silent;
use glam::{DVec3, IVec3};
use std::f64::consts::{PI, TAU};

fn settings(fields: &[Field], voxel: f64) -> VolumeSettings {
    VolumeSettings {
        fields: fields.to_vec(),
        voxel: Some(voxel),
        ..VolumeSettings::default()
    }
}

fn moments(curves: &Curves<'_>, voxel: f64) -> Vec<(IVec3, Vec<Moments>)> {
    let listing = Listing::new(curves, voxel, &Silent, &Cancel::default()).unwrap();
    let keep = |origin, voxels: &[Moments]| (origin, voxels.to_vec());
    listing
        .map(curves, &Silent, &Cancel::default(), keep)
        .unwrap()
}

fn total(all: &[(IVec3, Vec<Moments>)]) -> Moments {
    let mut sum = Moments::default();
    for m in all.iter().flat_map(|(_, voxels)| voxels) {
        sum.area += m.area;
        sum.length += m.length;
        sum.volume += m.volume;
        sum.tangent += m.tangent;
        sum.color += m.color;
    }
    sum
}

#[test]
fn a_straight_cone_leaves_its_area_volume_and_color() {
    let (a, b) = (
        Vec3::new(-0.013, 0.002, 0.03),
        Vec3::new(0.021, 0.017, -0.008),
    );
    let curves = Curves {
        points: &[a, a.lerp(b, 0.5), b],
        widths: &[80e-6, 50e-6, 20e-6],
        offsets: &[0, 3],
        colors: &[Vec3::X, Vec3::splat(0.5), Vec3::Y],
    };
    let length = f64::from((b - a).length());
    let area = length * 50e-6;
    let volume = length * PI / 12.0 * (80e-6f64.powi(2) + 80e-6 * 20e-6 + 20e-6f64.powi(2));
    for voxel in [0.0003, 0.001, 0.05] {
        let sum = total(&moments(&curves, voxel));
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 2e-6;
        assert!(close(sum.length, length) && close(sum.area, area) && close(sum.volume, volume));
        let along = (b - a).as_dvec3().normalize();
        assert!((sum.tangent / sum.area).distance(along) < 1e-6);
        // More of the area is near the root: integral of (1 - t) (80 - 60 t) over that of 80 - 60 t.
        let red = sum.color.x / sum.area;
        let blue = sum.color.z / sum.area;
        let off = (red - 0.6).abs().max((blue - 0.25).abs());
        assert!(off < 0.05 * voxel / 0.001, "{red} {blue}");
    }
}

#[test]
fn a_bent_strand_keeps_its_length_over_many_voxels() {
    // A quarter of a circle of radius 2 cm through 13 points.
    let points: Vec<Vec3> = (0..13)
        .map(|i| (TAU / 48.0 * f64::from(i)).sin_cos())
        .map(|(s, c)| DVec3::new(0.02 * c, 0.02 * s, 0.004).as_vec3())
        .collect();
    let curves = Curves {
        points: &points,
        widths: &[1e-4; 13],
        offsets: &[0, 13],
        colors: &[],
    };
    for voxel in [0.0002, 0.002] {
        let all = moments(&curves, voxel);
        let length = 0.02 * TAU / 4.0;
        let sum = total(&all);
        assert!(
            (sum.length / length - 1.0).abs() < 2e-3,
            "{}",
            sum.length / length
        );
        // Where it is, the tangent is that of the circle.
        for (origin, voxels) in &all {
            for (i, m) in voxels.iter().enumerate().filter(|(_, m)| m.area > 0.0) {
                let at = Leaf::new(*origin, 0.0f32).voxel(i).as_dvec3() * voxel;
                let tangent = DVec3::new(-at.y, at.x, 0.0).normalize();
                let off = (m.tangent / m.area).distance(tangent);
                assert!(off < 0.08 + 1.5 * voxel / 0.02, "{off}");
            }
        }
    }
}

fn many() -> (Vec<Vec3>, Vec<f32>, Vec<u32>) {
    let mut rng = crate::sampling::Rng::new(1, 0);
    let mut points = Vec::new();
    for _ in 0..3000 {
        let root = Vec3::new(rng.uniform_f32(), 0.0, rng.uniform_f32()) * 0.05;
        let lean = Vec3::new(0.3 * rng.uniform_f32(), 1.0, 0.2 * rng.uniform_f32());
        let wave = 0.002 * rng.uniform_f32();
        points.extend(
            (0..6).map(|k| root + lean * 0.004 * k as f32 + Vec3::X * wave * (k % 2) as f32),
        );
    }
    let widths = (0..points.len())
        .map(|i| 3e-5 + 1e-5 * (i % 5) as f32)
        .collect();
    let offsets = (0..=3000).map(|i| 6 * i).collect();
    (points, widths, offsets)
}

fn file(threads: usize) -> (Vec<u8>, Vec<Written>) {
    let (points, widths, offsets) = many();
    let colors: Vec<Vec3> = points
        .iter()
        .map(|p| Vec3::new(0.2, p.x * 10.0, 0.7))
        .collect();
    let curves = Curves {
        points: &points,
        widths: &widths,
        offsets: &offsets,
        colors: &colors,
    };
    let (positions, triangles) = ball(0.01);
    let skin = Mesh {
        name: "ball",
        positions: &positions,
        triangles: &triangles,
    };
    let settings = settings(&Field::ALL, 0.002);
    let (progress, cancel) = (Silent, Cancel::default());
    let work = || {
        let plan = plan(&curves, &settings, &progress, &cancel).unwrap();
        let out = std::io::Cursor::new(Vec::new());
        write(out, &curves, &skin, &plan, &settings, &progress, &cancel).unwrap()
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    let (out, written) = pool.install(work);
    (out.into_inner(), written)
}

#[test]
fn bytes_do_not_depend_on_threads_and_the_integral_is_that_of_the_strands() {
    let (one, written) = file(1);
    let (three, _) = file(3);
    assert!(one == three);
    let (points, widths, offsets) = many();
    let curves = Curves {
        points: &points,
        widths: &widths,
        offsets: &offsets,
        colors: &[],
    };
    let (mut area, mut joints) = (0.0, Vec::new());
    for curve in 0..curves.len() {
        for span in curves.spans(curve) {
            curves.joints(span, curve, 1e-5, &mut joints);
            let pieces = joints.windows(2);
            area += pieces
                .map(|p| p[0].at.distance(p[1].at) * 0.5 * (p[0].width + p[1].width))
                .sum::<f64>();
        }
    }
    let density = written.iter().find(|w| w.field == Field::Density).unwrap();
    assert!(
        (density.integral / area - 1.0).abs() < 2e-3,
        "{}",
        density.integral / area
    );
    let of = |field| written.iter().find(|w| w.field == field).unwrap();
    assert_eq!(of(Field::Width).active, density.active);
    assert!(of(Field::Color).active > density.active);
}

#[test]
fn the_voxel_follows_the_coat_and_the_memory() {
    let (points, widths, offsets) = many();
    let curves = Curves {
        points: &points,
        widths: &widths,
        offsets: &offsets,
        colors: &[],
    };
    let cancel = Cancel::default();
    let range = range(1.0);
    let stats = statistics(&curves, range, &cancel).unwrap();
    // 3000 hairs of about 2.2 cm on 5 x 5 cm: 1.2e6 per square meter.
    assert!((0.6e6..2.4e6).contains(&stats.length_density), "{stats:?}");
    let chosen = stats.voxel(range);
    assert!((0.001..0.004).contains(&chosen), "{chosen}");
    let free = VolumeSettings::default();
    let plan_of = |s: &VolumeSettings| plan(&curves, s, &Silent, &cancel);
    let wide = plan_of(&free).unwrap();
    assert_eq!(wide.voxel, chosen);
    let tight = VolumeSettings {
        memory: wide.memory / 3,
        ..free.clone()
    };
    assert!(plan_of(&tight).unwrap().voxel > 1.2 * chosen);
    let asked = VolumeSettings {
        voxel: Some(chosen),
        ..tight
    };
    assert!(matches!(plan_of(&asked), Err(VolumeError::Memory { .. })));
    let absurd = settings(&[Field::Density], 1e-6);
    assert!(matches!(plan_of(&absurd), Err(VolumeError::Voxel { .. })));
}

#[test]
fn the_range_of_voxels_is_one_in_any_unit() {
    // Strands of 22 cm, and the same in a unit that scales them without rounding.
    let (points, widths, offsets) = many();
    let of = |unit: f32| {
        let points: Vec<Vec3> = points.iter().map(|p| *p * 10.0 / unit).collect();
        let widths: Vec<f32> = widths.iter().map(|w| *w * 10.0 / unit).collect();
        let curves = Curves {
            points: &points,
            widths: &widths,
            offsets: &offsets,
            colors: &[],
        };
        let unit = f64::from(unit);
        let settings = |mm: f64| VolumeSettings {
            meters_per_unit: unit,
            ..settings(&[Field::Density], mm * 1e-3 / unit)
        };
        let plan = |mm: f64| plan(&curves, &settings(mm), &Silent, &Cancel::default());
        let refused = [plan(1001.0), plan(1e-9)].map(|refused| refused.unwrap_err().to_string());
        let found = plan(20.0).unwrap();
        let stats = found.statistics;
        let density = stats.length_density / unit.powi(2);
        (found.leaves, stats.mean_length * unit, density, refused)
    };
    let (leaves, length, density, [meters, fine]) = of(1.0);
    assert!(meters.contains("must be 0.02 to 1000"), "{meters}");
    assert!(fine.contains("must be 0.02 to 1000"), "{fine}");
    let (same, as_long, as_dense, [large, _]) = of(1.0 / 128.0);
    assert_eq!((same, as_long, as_dense), (leaves, length, density));
    assert!(large.contains("must be 0.00015625 to 1000"), "{large}");
}

#[test]
fn broken_strands_are_refused() {
    let of = |at: f32| {
        let points = [Vec3::ZERO, Vec3::splat(at)];
        let curves = Curves {
            points: &points,
            widths: &[1e-4; 2],
            offsets: &[0, 2],
            colors: &[],
        };
        plan(
            &curves,
            &settings(&[Field::Density], 0.001),
            &Silent,
            &Cancel::default(),
        )
        .map(|p| p.leaves)
    };
    assert!(of(0.01).is_ok());
    for at in [f32::NAN, f32::INFINITY, 1e30, 1e6, 0.0] {
        assert!(of(at).is_err(), "{at}");
    }
}

/// A ball of triangles: its vertices lie on it, and meet at the poles without being shared.
fn ball(radius: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (across, down) = (192u32, 96u32);
    let mut positions = Vec::new();
    for i in 0..=down {
        for j in 0..=across {
            // The seam and the poles are exactly where they meet.
            let (s, c) = (std::f32::consts::TAU * (j % across) as f32 / across as f32).sin_cos();
            let (sin, cos) = match i {
                0 => (0.0, 1.0),
                _ if i == down => (0.0, -1.0),
                _ => (std::f32::consts::PI * i as f32 / down as f32).sin_cos(),
            };
            positions.push(radius * Vec3::new(sin * c, cos, sin * s));
        }
    }
    let mut triangles = Vec::new();
    for i in 0..down {
        for j in 0..across {
            let a = i * (across + 1) + j;
            let (b, c, d) = (a + 1, a + across + 1, a + across + 2);
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    (positions, triangles)
}

/// Also far inside, where there are tiles.
#[test]
fn the_distance_from_a_ball_is_that_of_the_ball() {
    let (positions, triangles) = ball(0.08);
    let mesh = Mesh {
        name: "ball",
        positions: &positions,
        triangles: &triangles,
    };
    assert_eq!(mesh.open_edges(), 0);
    let radius = 0.08;
    let voxel = 0.0017;
    let tree = signed_distance(&mesh, voxel, 0.0, &Silent, &Cancel::default()).unwrap();
    let mut active = 0;
    for leaf in tree.leaves() {
        for (i, value) in leaf.values.iter().enumerate() {
            let at = leaf.voxel(i).as_dvec3() * voxel;
            let exact = at.length() - radius;
            let value = f64::from(*value);
            if leaf.is_active(i) {
                active += 1;
                // The mesh lies inside the ball by the height of its faces.
                assert!(
                    value - exact > -1e-6 && value - exact < 1.5e-4,
                    "{value} {exact}"
                );
            } else {
                assert!(exact.abs() > 2.9 * voxel && value.signum() == exact.signum());
            }
        }
    }
    let band = 4.0 * PI * (radius / voxel).powi(2) * 6.0;
    assert!((f64::from(active) / band - 1.0).abs() < 0.02);
}

#[test]
fn open_skins_have_no_inside_but_may_be_plates() {
    let positions = [
        [-1.0, 0.0, -1.0],
        [1.0, 0.0, -1.0],
        [1.0, 0.01, 1.0],
        [-1.0, 0.0, 1.0],
    ];
    let positions = positions.map(|p| Vec3::from_array(p) * 0.04);
    let mesh = Mesh {
        name: "swatch",
        positions: &positions,
        triangles: &[[0, 3, 2], [0, 2, 1]],
    };
    let cancel = Cancel::default();
    let open = signed_distance(&mesh, 0.001, 0.0, &Silent, &cancel);
    assert!(matches!(open, Err(VolumeError::Open { open, .. }) if open > 0));
    let plate = signed_distance(&mesh, 0.001, 0.002, &Silent, &cancel).unwrap();
    let least = plate.leaves().iter().flat_map(|l| l.values.iter());
    let least = least.fold(f32::INFINITY, |a, b| a.min(*b));
    assert!((-0.0011..-0.0004).contains(&least), "{least}");
}

#[test]
fn a_thick_plate_is_filled() {
    let positions = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let positions = positions.map(|[x, z]| 0.03 * Vec3::new(x, 0.0, z));
    let mesh = Mesh {
        name: "plate",
        positions: &positions,
        triangles: &[[0, 3, 2], [0, 2, 1]],
    };
    let voxel = 0.001;
    let plate = signed_distance(&mesh, voxel, 0.02, &Silent, &Cancel::default()).unwrap();
    let value = |at: IVec3| {
        let leaf = plate.leaves().iter().find(|leaf| leaf.origin == at & !7);
        leaf.map_or(plate.background(), |l| l.values[Leaf::<f32>::offset(at)])
    };
    // Through the plate, whose faces are ten voxels from the mesh.
    for x in [-12, 1, 20] {
        for y in -24..=24i32 {
            let exact = (f64::from(y.abs()) - 10.0).clamp(-3.0, 3.0) * voxel;
            let found = f64::from(value(IVec3::new(x, y, 5)));
            assert!((found - exact).abs() < 1e-8, "{x} {y}: {found} {exact}");
        }
    }
}
