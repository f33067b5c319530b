use super::*;
use crate::bsdf::HairMaterial;
use crate::color::Rgb;
use crate::groom::Groom;
use crate::sampling::Rng;
use crate::scene::{Backdrop, Ray, Scene, SceneParts, StrandHit, View};
use glam::Vec2;

/// Straight strands that go up from a square of 20 mm, random places and lengths.
fn meadow(strands: u32, width_um: f32) -> Scene {
    meadow_in(Environment::studio(), strands, width_um)
}

fn meadow_in(environment: Environment, strands: u32, width_um: f32) -> Scene {
    let mut groom = Groom {
        offsets: vec![0],
        classes: vec!["guard".into()],
        ..Groom::default()
    };
    let mut rng = Rng::new(5, 0);
    for id in 0..strands {
        let root = 0.02 * Vec3::new(rng.uniform_f32(), 0.0, rng.uniform_f32());
        let length = 0.008 + 0.004 * rng.uniform_f32();
        for step in 0..9 {
            groom
                .points
                .push(root + Vec3::Y * length * step as f32 / 8.0);
            groom.widths.push(1e-6 * width_um);
        }
        groom.offsets.push(groom.points.len() as u32);
        groom.class.push(0);
        groom.id.push(id);
        groom.root_uv.push(Vec2::ZERO);
        groom.length.push(length);
    }
    Scene::build(SceneParts {
        groom: &groom,
        materials: vec![HairMaterial::Isotropic(Rgb::ONE)],
        skin: None,
        environment,
        lamps: &[],
        backdrop: Backdrop::Plain(Rgb::ZERO),
        ground: None,
        view: View::default(),
    })
    .unwrap()
}

/// Light of each bin that comes to a place, by rays.
fn by_rays(scene: &Scene, place: Vec3, rng: &mut Rng) -> Vec<f32> {
    let rays = 64;
    let mut seen = |bin: usize, share: f32| {
        let mut open = 0;
        for _ in 0..rays {
            let u = [rng.uniform_f32(), rng.uniform_f32()];
            let dir = scene.environment.sample_in(bin, u).unwrap().dir;
            let origin = place;
            open += u32::from(!scene.occluded(&Ray { origin, dir }, f32::INFINITY, None));
        }
        share * open as f32 / rays as f32
    };
    let shares = scene.environment.bins().iter().enumerate();
    shares.map(|(bin, &share)| seen(bin, share)).collect()
}

/// How much light comes to places in a meadow, and where from, is about what rays say; both are far from what
/// nothing in the way would give.
#[test]
fn sights_are_what_rays_see() {
    let scene = meadow(10_000, 30.0);
    let outlook = scene.outlook.as_ref().unwrap();
    let shares = scene.environment.bins();
    let mut rng = Rng::new(6, 0);
    let (mut seen, mut by_ray, mut off, mut unguided, n) = (0.0, 0.0, 0.0, 0.0, 40);
    for _ in 0..n {
        let [x, y, z] = std::array::from_fn(|_| rng.uniform_f32());
        // Below the tips, where it is neither open nor dark.
        let place = Vec3::new(3.0 + 14.0 * x, 4.0 + 4.0 * y, 3.0 + 14.0 * z);
        let light = by_rays(&scene, place, &mut rng);
        let all: f32 = light.iter().sum();
        let u = std::array::from_fn(|_| rng.uniform_f32());
        let sight = outlook.look(place, u).unwrap().sight;
        (seen, by_ray) = (seen + sight.seen(), by_ray + all);
        for (bin, (&light, &share)) in light.iter().zip(shares).enumerate() {
            off += (sight.share(bin) - light / all.max(1e-6)).abs() / n as f32;
            unguided += (share - light / all.max(1e-6)).abs() / n as f32;
        }
    }
    // Too much, since what a cell blocks itself is left out: half a cell is a quarter of a mean free path here, and more
    // where light comes from the side.
    assert!((1.0..1.7).contains(&(seen / by_ray)), "{seen} {by_ray}");
    assert!(by_ray < 0.5 * n as f32);
    assert!(off < 0.75 * unguided, "{off} {unguided}");
}

/// Bins come as often as their shares say, what is left of the number is even, and all is one.
#[test]
fn bins_are_chosen_by_their_shares() {
    let mut rng = Rng::new(7, 0);
    for count in [2, 9, BINS - 1, BINS] {
        let shares = vec![1.0 / count as f32; count];
        for dark in [false, true] {
            let light: Vec<f32> = (0..count)
                .map(|_| {
                    if dark {
                        0.0
                    } else {
                        rng.uniform_f32().powi(4) / count as f32
                    }
                })
                .collect();
            let sight = Sight::new(&shares, |bin| light[bin]);
            assert!((sight.seen() - light.iter().sum::<f32>()).abs() < 1e-4);
            let (mut came, n) = (vec![(0.0, 0.0); count], 1 << 18);
            for i in 0..n {
                let (bin, rest) = sight.choose((i as f32 + 0.5) / n as f32);
                assert!((0.0..1.0).contains(&rest));
                came[bin].0 += 1.0 / n as f32;
                came[bin].1 += rest / n as f32;
            }
            for (bin, &(came, rest)) in came.iter().enumerate() {
                assert!((came - sight.share(bin)).abs() < 2e-5);
                assert!((rest - 0.5 * came).abs() < 2e-5);
                if dark {
                    assert!((came - shares[bin]).abs() < 1e-4);
                }
            }
        }
    }
}

/// Light falls off through an even block as `e^-depth` along the axes, and as a slanted way asks for between them.
#[test]
fn light_falls_off_through_a_block() {
    let scene = meadow(40_000, 7.5);
    let grid = Grid::new(Vec3::ZERO, Vec3::new(20.0, 8.0, 20.0), SIDE);
    let fur = Fur::new(&grid, &scene.strands, None);
    let mut sweep = Sweep::new(&grid);
    // Strands on a square millimeter, times their width.
    let density = 40_000.0 / 400.0 * 7.5e-3;
    let cells = 6.0;
    let depth = density * cells * grid.step;
    for slant in [-0.4f32, 0.0, 0.4] {
        sweep.run(&grid, &fur, Vec3::new(slant, 0.0, -1.0).normalize());
        let mut sum = 0.0;
        for x in 8..24 {
            let at = |z: f32| {
                let place = grid.step * Vec3::new(x as f32 + 0.5, 4.0, z + 0.5);
                sweep.light[grid.cell(place, Vec3::ZERO).unwrap()]
            };
            assert!(at(0.0) == 1.0);
            sum += at(cells) / 16.0;
        }
        let expected = depth * (1.0 + slant * slant).sqrt();
        assert!(
            (-sum.ln() / expected - 1.0).abs() < 0.1,
            "{slant}: {sum} {expected}"
        );
    }
    // Along the strands nothing is in the way.
    sweep.run(&grid, &fur, Vec3::Y);
    assert!(sweep.light.iter().all(|&light| light > 0.95));
}

/// How bright it is at places in a meadow is about what walks between its strands say; direct light alone is not.
#[test]
fn glow_is_what_walks_bring() {
    let lit = |i: usize| if i % 32 < 16 { Rgb::ONE } else { Rgb::ZERO };
    let half_black = Environment::from_texels(32, 16, (0..512).map(lit).collect());
    let scene = meadow_in(half_black, 10_000, 30.0);
    let outlook = scene.outlook.as_ref().unwrap();
    let mut rng = Rng::new(8, 0);
    let (mut glow, mut direct, mut by_walks) = (0.0, 0.0, 0.0);
    for _ in 0..40 {
        let [x, y, z] = std::array::from_fn(|_| rng.uniform_f32());
        let place = Vec3::new(3.0 + 14.0 * x, 1.0 + 7.0 * y, 3.0 + 14.0 * z);
        let look = outlook.look(place, [0.5; 3]).unwrap();
        (glow, direct) = (glow + look.glow, direct + look.sight.seen());
        for _ in 0..256 {
            by_walks += walk(&scene, place, &mut rng) / 256.0;
        }
    }
    // Direct light is too much, as above.
    let ratio = glow / by_walks;
    assert!((0.9..1.4).contains(&ratio), "{glow} {direct} {by_walks}");
    assert!(direct < 0.8 * glow, "{glow} {direct} {by_walks}");
}

/// Light that a walk from a place brings, over the mean of all light, where strands send on what `glow` thinks they do.
fn walk(scene: &Scene, mut origin: Vec3, rng: &mut Rng) -> f32 {
    let (mut left, mut leaving): (f32, Option<StrandHit>) = (1.0, None);
    while left > 1e-3 {
        let height = 1.0 - 2.0 * rng.uniform_f32();
        let (sin, cos) = (std::f32::consts::TAU * rng.uniform_f32()).sin_cos();
        let flat = (1.0 - height * height).sqrt();
        let dir = Vec3::new(flat * cos, height, flat * sin);
        let from = leaving.as_ref().map(|from| from.departure().along(dir));
        let Some(hit) = scene
            .strands
            .closest(&Ray { origin, dir }, f32::INFINITY, from)
        else {
            return left * scene.environment.eval(dir).0.x / scene.environment.mean().x;
        };
        origin += hit.t * dir;
        leaving = Some(hit);
        left *= glow::ALBEDO;
    }
    0.0
}
