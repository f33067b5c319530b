//! What coats promise, on plain skins.

use super::layers::Painter;
use super::turing::{self, Wanted};
use super::*;
use crate::groom::tests::{fox, grown};
use crate::io::Picture;
use crate::skin;
use crate::species::{CoatLayer, CoatZone, Lay, Turing};
use std::sync::Arc;

/// Each side is its own.
const OWN: Symmetry<'static> = Symmetry {
    mirror: None,
    amount: 0.0,
};

fn zone() -> CoatZone {
    CoatZone {
        name: "dark".to_owned(),
        guard: Vec::new(),
        under: Vec::new(),
        hair: 1.0,
    }
}

fn recipe(pattern: CoatPattern) -> CoatRecipe {
    CoatRecipe {
        name: "test".to_owned(),
        summary: "test".to_owned(),
        body_mm: 0.0,
        hair: 1.0,
        zones: vec![zone()],
        layers: vec![CoatLayer {
            zone: 1,
            pattern,
            strength: 1.0,
            edge: 0.0,
            seed: 0,
            limits: Vec::new(),
        }],
    }
}

fn stripes(wavelength_mm: f64, balance: f64, order: f64) -> CoatPattern {
    CoatPattern::Turing(Turing {
        wavelength_mm,
        balance,
        order,
        lay: Lay::Across,
        cover: None,
        fine: 1.0,
    })
}

fn painted(skin: &Skin, pattern: CoatPattern) -> Coat {
    Coat::paint(skin, &recipe(pattern), OWN, 3, &Cancel::default()).unwrap()
}

/// Stripes asked for are as far apart as asked for, and run across the lay of the hair.
#[test]
fn stripes_have_their_wavelength_and_direction() {
    let skin = skin::load("swatch").unwrap();
    for wavelength_mm in [6.0, 10.0] {
        let coat = painted(&skin, stripes(wavelength_mm, 0.0, 1.0));
        // Changes between neighbors on lines along and across the lay: along it two a wavelength.
        let dark = |p: Vec3| {
            // Onto the curved skin, and between its points: their grain is not the pattern's.
            let near = coat.net.nearest(p).unwrap();
            let (at, normal) = (coat.net.positions[near], coat.net.normals[near]);
            let p = p - normal * (p - at).dot(normal);
            let mut weights = Vec::new();
            coat.net.weights(p, normal, &mut weights);
            let share = |&(i, w): &(u32, f32)| w * coat.shares[i as usize][1];
            weights.iter().map(share).sum::<f32>() > 0.5
        };
        let middle = skin.positions[skin.positions.len() / 2];
        let lay = skin.combing[skin.combing.len() / 2];
        let side = lay.cross(skin.normals[skin.normals.len() / 2]);
        let changes = |direction: Vec3, other: Vec3| {
            let mut changes = 0;
            for line in -6..=6 {
                let from = middle + other * (0.003 * line as f32);
                let row: Vec<bool> = (-80..=80)
                    .map(|k| dark(from + direction * (0.00025 * k as f32)))
                    .collect();
                changes += row.windows(2).filter(|w| w[0] != w[1]).count();
            }
            changes as f64 / 13.0
        };
        let (along, across) = (changes(lay, side), changes(side, lay));
        let expected = 2.0 * 40.0 / wavelength_mm;
        assert!(
            (along / expected - 1.0).abs() < 0.2,
            "{wavelength_mm} mm: {along} changes for {expected}"
        );
        assert!(across < 0.45 * along, "{across} across, {along} along");
    }
}

/// Spots cover little, nets much, and a cover that is asked for is met.
#[test]
fn balance_and_cover_say_how_much_is_painted() {
    let skin = skin::load("swatch").unwrap();
    let share = |pattern| {
        let coat = painted(&skin, pattern);
        let dark: f32 = coat.shares.iter().map(|s| s[1]).sum();
        f64::from(dark) / coat.shares.len() as f64
    };
    let [spots, lines, net] = [-0.8, 0.0, 0.8].map(|balance| share(stripes(8.0, balance, 0.0)));
    assert!(spots < 0.4 && spots > 0.05, "spots {spots}");
    assert!((0.4..0.6).contains(&lines), "lines {lines}");
    assert!(net > 0.6 && net < 0.95, "net {net}");
    for cover in [0.2, 0.7] {
        let patches = CoatPattern::Patches {
            size_mm: 15.0,
            cover,
            rough: 0.3,
        };
        assert!((share(patches) - cover).abs() < 0.02);
    }
}

/// A hair's zone is drawn with the shares at its root: half a share, half the hairs.
#[test]
fn hairs_mix_in_proportion_to_the_shares() {
    let skin = skin::load("swatch").unwrap();
    let mut species = fox();
    let mut coat = recipe(CoatPattern::Plain);
    coat.layers[0].strength = 0.3;
    species.coat = Some(coat);
    let groom = grown(&skin, &species, 20_000, 1);
    let dark = groom.coat.iter().filter(|&&zone| zone == 1).count();
    // Four standard deviations of a binomial.
    assert!((dark as f64 - 6_000.0).abs() < 260.0, "{dark} of 20000");
    assert_eq!(groom.coats, ["own", "dark"]);
    // A thinner groom keeps the zones of the hairs that it keeps.
    let thin = grown(&skin, &species, 2_000, 1);
    let zone_of = |g: &crate::groom::Groom, id: u32| {
        g.id.iter()
            .position(|&other| other == id)
            .map(|i| g.coat[i])
    };
    for (i, id) in thin.id.iter().enumerate().step_by(7) {
        assert_eq!(Some(thin.coat[i]), zone_of(&groom, *id));
    }
}

/// Hair that its zone makes shorter than it is thick does not grow, and is counted.
#[test]
fn stubs_of_a_zone_are_counted() {
    let skin = skin::load("swatch").unwrap();
    let mut species = fox();
    let mut coat = recipe(CoatPattern::Plain);
    coat.layers[0].strength = 0.3;
    coat.zones[0].hair = 0.0025;
    species.coat = Some(coat);
    for class in &mut species.classes {
        class.groom.length_mm = 400.0 * 1e-3 * class.groom.diameter_um / 2.0;
        class.groom.vary.clear();
    }
    let groom = grown(&skin, &species, 20_000, 1);
    assert!(groom.coat.iter().all(|&zone| zone == 0));
    let short: usize = groom.accounts.iter().map(|account| account.short).sum();
    assert!((short as f64 - 6_000.0).abs() < 260.0, "{short} of 20000");
}

/// A picture takes as many points as there are, but whether a pattern beside it is too fine is still said.
#[test]
fn patterns_too_fine_are_named_beside_pictures() {
    let picture = Arc::new(Picture::new(1, 1, vec![1.0]).unwrap());
    let mut coat = recipe(CoatPattern::Map { picture });
    let needed = |coat: &CoatRecipe| {
        let mut warnings = Vec::new();
        let (count, _) = points(1.0, coat, 1e-3, &mut warnings);
        (count, warnings.join(" "))
    };
    assert_eq!(needed(&coat), (MOST_POINTS as usize, String::new()));
    let layer = CoatLayer {
        pattern: stripes(0.01, 0.0, 0.0),
        ..coat.layers[0].clone()
    };
    coat.layers.push(layer);
    let (count, said) = needed(&coat);
    assert_eq!(count, MOST_POINTS as usize);
    assert!(said.contains("coarser than asked for"), "{said}");
}

/// A picture over the texture coordinates paints where it is bright.
#[test]
fn maps_paint_by_texture_coordinates() {
    let skin = skin::load("swatch").unwrap();
    let picture = Picture::new(2, 1, vec![0.0, 1.0]).unwrap();
    let mut species = fox();
    species.coat = Some(recipe(CoatPattern::Map {
        picture: Arc::new(picture),
    }));
    let groom = grown(&skin, &species, 10_000, 2);
    let (mut left, mut right) = ([0.0f64; 2], [0.0f64; 2]);
    for (uv, &zone) in groom.root_uv.iter().zip(&groom.coat) {
        // Away from the middle and the rims, where the picture is blended.
        let side = match uv.x {
            x if (0.2..0.3).contains(&x) => &mut left,
            x if (0.7..0.8).contains(&x) => &mut right,
            _ => continue,
        };
        side[usize::from(zone)] += 1.0;
    }
    let dark = |side: [f64; 2]| side[1] / (side[0] + side[1]);
    assert!(dark(left) < 0.12, "{left:?}");
    assert!(dark(right) > 0.88, "{right:?}");
}

/// With symmetry the field at a place is that at its mirror image; without, it has nothing to do with it, and
/// between the two it is the more alike the more is asked for.
#[test]
fn sides_are_as_alike_as_asked_for() {
    let skin = skin::load("ball").unwrap();
    let patches = CoatPattern::Patches {
        size_mm: 20.0,
        cover: 0.5,
        rough: 0.3,
    };
    let turing = |coat: &CoatPattern, amount: f32| {
        let symmetry = Symmetry {
            mirror: skin.mirror.as_ref(),
            amount,
        };
        let mut recipe = recipe(coat.clone());
        recipe.layers[0].edge = 0.8;
        let coat = Coat::paint(&skin, &recipe, symmetry, 3, &Cancel::default()).unwrap();
        let mut near = Vec::new();
        let mut at = |p: Vec3| {
            coat.weights(p, p.normalize(), &mut near);
            let share = |&(i, w): &(u32, f32)| w * coat.shares[i as usize][1];
            near.iter().map(share).sum::<f32>()
        };
        // Correlation of both sides, and the mean difference.
        let flip = Vec3::new(-1.0, 1.0, 1.0);
        let places = skin.positions.iter().filter(|p| p.x > 0.015);
        let pairs: Vec<[f32; 2]> = places.map(|&p| [at(p), at(p * flip)]).collect();
        let mean =
            |of: &dyn Fn(&[f32; 2]) -> f32| pairs.iter().map(of).sum::<f32>() / pairs.len() as f32;
        let (a, b) = (mean(&|p| p[0]), mean(&|p| p[1]));
        let spread = |k: usize, m: f32| mean(&|p| (p[k] - m).powi(2)).sqrt();
        let both = mean(&|p| (p[0] - a) * (p[1] - b)) / (spread(0, a) * spread(1, b));
        (both, mean(&|p| (p[0] - p[1]).abs()))
    };
    for pattern in [stripes(25.0, 0.0, 0.0), stripes(25.0, -0.7, 0.0), patches] {
        let [none, half, most, all] = [0.0, 0.5, 0.9, 1.0].map(|a| turing(&pattern, a));
        println!("{none:?} {half:?} {most:?} {all:?}");
        assert!(none.0.abs() < 0.35, "{none:?}");
        assert!(all.1 < 1e-4, "{all:?}");
        assert!(none.0 + 0.1 < half.0 && half.0 < most.0 && most.0 < all.0);
    }
}

#[test]
fn coats_do_not_depend_on_threads() {
    let skin = skin::load("ball").unwrap();
    let mut species = fox();
    species.coat = Some(recipe(stripes(30.0, -0.3, 0.5)));
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| grown(&skin, &species, 5_000, 1))
    };
    let one = on(1);
    assert!(one.coat.contains(&0) && one.coat.contains(&1));
    assert!(one == on(3));
}

/// The way along the skin, not through it: from pole to pole of a ball half its girth.
#[test]
fn distances_go_round_the_body() {
    let skin = skin::load("ball").unwrap();
    let surface = Surface::even(&skin).unwrap();
    let spacing = (surface.weighted_area() / 5_000.0 / 0.866).sqrt() as f32;
    let follicles = surface
        .scatter(1, 5_000, &Silent, &Cancel::default())
        .unwrap()
        .follicles;
    let net = Net::new(&surface, &follicles, spacing);
    let top = 0.08 * Vec3::Y;
    let distances = net.distances(&[top]);
    let bottom = net.nearest(-top).unwrap();
    let girth = std::f32::consts::PI * 0.08;
    let found = distances[bottom];
    assert!(
        (0.99..1.1).contains(&(found / girth)),
        "{found} for {girth}"
    );
}

/// Landmarks that a skin does not have leave their layers out, and say so.
#[test]
fn layers_without_their_landmark_are_named() {
    let skin = skin::load("ball").unwrap();
    let mut species = crate::species::load("cat", &["coat=siamese".to_owned()]).unwrap();
    species.classes[1].groom.density_per_cm2 = 100.0;
    let groom = grown(&skin, &species, 1_000, 0);
    let said = groom.warnings.join("\n");
    assert!(
        said.contains("skin `ball`") && said.contains("paws"),
        "{said}"
    );
}

/// Without pushes a field that nobody disturbs stays finite, whatever the settings.
#[test]
fn extreme_settings_stay_finite() {
    let skin = skin::load("swatch").unwrap();
    let surface = Surface::even(&skin).unwrap();
    let follicles = surface
        .scatter(1, 2_000, &Silent, &Cancel::default())
        .unwrap()
        .follicles;
    let spacing = (surface.weighted_area() / 2_000.0 / 0.866).sqrt() as f32;
    let net = Net::new(&surface, &follicles, spacing);
    let scale = vec![1.0; net.len()];
    for (wavelength, balance, order) in [(1e-6, 1.0, 1.0), (10.0, -1.0, 0.0)] {
        let wanted = Wanted {
            wavelength,
            balance,
            order,
            across: false,
            scale: &scale,
            push: &[],
            symmetry: OWN,
            seed: 1,
        };
        let field = turing::grow(&net, &wanted, &Cancel::default()).unwrap();
        assert!(field.iter().all(|v| v.is_finite() && v.abs() <= 1.0));
    }
    let painter = Painter::new(&skin, &surface, &follicles, &net, 1e-3, OWN, 1);
    let mut warnings = Vec::new();
    let mut everything = recipe(stripes(5.0, 0.0, 0.5));
    everything.layers[0].strength = 1.0;
    let shares = painter
        .paint(&everything, &mut warnings, &Cancel::default())
        .unwrap();
    for s in shares {
        assert!((s.iter().sum::<f32>() - 1.0).abs() < 1e-5);
    }
}
