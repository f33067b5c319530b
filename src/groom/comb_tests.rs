//! What combing promises: direction, reach, smoothness.

use super::comb::Comb;
use super::tests::{fox, grown};
use crate::skin::{self, Placing, Skin, Up};
use crate::species::{Comb as Recipe, CombCurve, Hand, Whorl, WhorlCenter};
use glam::Vec3;

/// A level square of 2 x 2 cm about the origin, whose hair lies along X; a second one 1 mm below
/// faces down.
fn sheet() -> Skin {
    let mut skin = Skin::default();
    for (height, normal) in [(0.0, Vec3::Y), (-1e-3, Vec3::NEG_Y)] {
        let first = skin.positions.len() as u32;
        for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            skin.positions.push(Vec3::new(0.01 * x, height, 0.01 * z));
            skin.normals.push(normal);
            skin.combing.push(Vec3::X);
            skin.uvs.push(glam::Vec2::new(x, z));
            skin.length.push(1.0);
            skin.density.push(1.0);
            skin.color.push(Vec3::ONE);
        }
        let [a, b, c, d] = [first, first + 1, first + 2, first + 3];
        let up = [[a, c, b], [a, d, c]];
        let down = up.map(|[a, b, c]| [a, c, b]);
        skin.triangles
            .extend(if normal.y > 0.0 { up } else { down });
    }
    skin
}

fn curve(points: &[[f32; 3]]) -> Recipe {
    Recipe {
        curves: vec![CombCurve {
            lines: vec![points.to_vec()],
            is_placed: false,
            radius_mm: 6.0,
            strength: 1.0,
        }],
        whorls: Vec::new(),
    }
}

fn whorl(hand: Hand, spiral_deg: f64, rim_deg: f64) -> Recipe {
    Recipe {
        curves: Vec::new(),
        whorls: vec![Whorl {
            center: WhorlCenter::Point([0.0; 3]),
            radius_mm: 8.0,
            strength: 1.0,
            hand,
            spiral_deg,
            rim_deg,
        }],
    }
}

fn lay(comb: &Comb, x: f32, z: f32) -> Vec3 {
    comb.lay(Vec3::new(x, 0.0, z), Vec3::Y, Vec3::X, 1.0)
}

#[test]
fn hair_lies_along_a_curve_and_keeps_its_lay_beyond_the_radius() {
    let along_z = curve(&[[0.0, 0.001, -0.009], [0.0, 0.001, 0.009]]);
    let comb = Comb::new(&along_z, &sheet()).unwrap();
    assert_eq!(comb.warnings, Vec::<String>::new());
    assert!(lay(&comb, 0.0, 0.002).distance(Vec3::Z) < 1e-4);
    // Half of the pull is left at 0.54 of the radius: halfway in the sum of two unit vectors.
    let half = lay(&comb, 0.541_2 * 0.006, 0.0);
    assert!(
        (half.z.atan2(half.x).to_degrees() - 45.0).abs() < 1.0,
        "{half}"
    );
    assert_eq!(lay(&comb, 0.0061, 0.0), Vec3::X);
    // The other side of a thin ear has a lay of its own.
    let below = comb.lay(Vec3::new(0.0, -1e-3, 0.0), Vec3::NEG_Y, Vec3::X, 1.0);
    assert_eq!(below, Vec3::X);
    assert_eq!(comb.lay(Vec3::ZERO, Vec3::Y, Vec3::X, 0.0), Vec3::X);
    let quarter = comb.lay(Vec3::ZERO, Vec3::Y, Vec3::X, 0.25);
    assert!(
        (quarter.z / quarter.x - 1.0 / 3.0).abs() < 1e-3,
        "{quarter}"
    );
}

/// At a bend of a curve hair lies between the directions before and after it.
#[test]
fn bends_of_a_curve_are_halfway_between_its_pieces() {
    let bent = curve(&[[-0.009, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.009]]);
    let comb = Comb::new(&bent, &sheet()).unwrap();
    let halfway = Vec3::new(1.0, 0.0, 1.0).normalize();
    assert!(lay(&comb, 0.0, 0.0).dot(halfway) > 0.985);
}

#[test]
fn hair_turns_about_a_whorl_at_its_angle() {
    for (hand, sense) in [(Hand::CounterClockwise, 1.0), (Hand::Clockwise, -1.0)] {
        for spiral in [0.0, 60.0, 90.0, 150.0] {
            let comb = Comb::new(&whorl(hand, spiral, spiral), &sheet()).unwrap();
            for k in 0..12 {
                let (sin, cos) = (k as f32 / 12.0 * std::f32::consts::TAU).sin_cos();
                // Seen from above, from X to -Z is counter-clockwise.
                let out = Vec3::new(cos, 0.0, -sin);
                let round = sense * Vec3::new(-sin, 0.0, -cos);
                let at = 0.0004 * out;
                let direction = lay(&comb, at.x, at.z);
                let angle = direction.dot(round).atan2(direction.dot(out)).to_degrees();
                assert!(
                    (angle - spiral as f32).abs() < 1.0,
                    "{hand:?} {spiral}: {angle}"
                );
            }
        }
    }
    // From a star to circles on the way to the rim; at 0.5 of the radius the skin's own lay has a share.
    let comb = Comb::new(&whorl(Hand::CounterClockwise, 0.0, 90.0), &sheet()).unwrap();
    let near = lay(&comb, 0.0008, 0.0);
    assert!(
        (near.z.atan2(near.x).to_degrees() + 9.0).abs() < 0.5,
        "{near}"
    );
}

#[test]
fn the_lay_changes_smoothly_but_for_single_points() {
    let mut recipe = curve(&[
        [-0.008, 0.0, 0.004],
        [0.0, 0.0, 0.003],
        [0.006, 0.0, -0.008],
    ]);
    recipe.whorls = whorl(Hand::Clockwise, 70.0, 100.0).whorls;
    let comb = Comb::new(&recipe, &sheet()).unwrap();
    let (side, step) = (401, 0.02 / 400.0);
    let at = |i: usize| i as f32 * step - 0.01;
    let mut jumps = 0;
    for i in 1..side {
        for j in 1..side {
            let here = lay(&comb, at(i), at(j));
            assert!((here.length() - 1.0).abs() < 1e-5 && here.y == 0.0);
            let turn = here.distance(lay(&comb, at(i - 1), at(j)));
            jumps += usize::from(turn > 0.5);
        }
    }
    // Around the centers of whorls and where pulls cancel out, and nowhere along lines.
    assert!((1..60).contains(&jumps), "{jumps} jumps");
}

#[test]
fn places_are_those_of_the_file_of_the_skin() {
    let points = [[0.0, 0.9, 0.1], [0.0, -0.9, 0.1]];
    let mut skin = sheet();
    skin.placing = Placing {
        unit_m: 0.01,
        up: Up::Z,
    };
    let comb = Comb::new(&curve(&points), &skin).unwrap();
    assert!(lay(&comb, 0.0, 0.002).distance(Vec3::Z) < 1e-4);
    let mut recipe = curve(&[[0.0, 0.0, -0.009], [0.0, 0.0, 0.009]]);
    recipe.curves[0].is_placed = true;
    let comb = Comb::new(&recipe, &skin).unwrap();
    assert!(lay(&comb, 0.0, 0.002).distance(Vec3::Z) < 1e-4);
}

/// The example beside the library has all kinds of combing and all of it is on its skin.
#[test]
fn the_example_combs_the_ball() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/grooms/whorled-fur.toml"
    );
    let species = crate::species::load(path, &[]).unwrap();
    let recipe = &species.groom.comb;
    assert_eq!((recipe.curves.len(), recipe.whorls.len()), (2, 1));
    assert_eq!(recipe.curves[1].lines.len(), 2);
    let comb = Comb::new(recipe, &skin::load("ball").unwrap()).unwrap();
    assert_eq!(comb.warnings, Vec::<String>::new());
}

#[test]
fn what_is_far_from_the_skin_is_said() {
    let comb = Comb::new(&curve(&[[0.0, 0.1, 0.0], [0.0, 0.1, 0.01]]), &sheet()).unwrap();
    let expected = "combing curve 0 is 100.0 mm from the skin, farther than its radius of 6.0 mm: are its \
                    coordinates those of the skin's file?";
    assert_eq!(comb.warnings, [expected]);
    let mut recipe = whorl(Hand::Clockwise, 60.0, 60.0);
    recipe.whorls[0].center = WhorlCenter::Landmark(skin::Landmark::Ears);
    let comb = Comb::new(&recipe, &sheet()).unwrap();
    assert!(comb.warnings[0].starts_with("whorl 0 has no effect"));
    assert_eq!(lay(&comb, 0.0, 0.0), Vec3::X);
}

/// Strands take the lay, over their whole length, and nothing else of them changes.
#[test]
fn strands_follow_the_comb_and_thinned_grooms_nest() {
    let skin = sheet();
    let mut species = fox();
    for class in &mut species.classes {
        class.groom.length_mm = 3.0;
        class.groom.stray_deg = 0.0;
        class.groom.clump = 0.0;
    }
    let plain = grown(&skin, &species, 4000, 1);
    species.groom.comb = curve(&[[0.0, 0.0, -0.009], [0.0, 0.0, 0.009]]);
    let combed = grown(&skin, &species, 4000, 1);
    assert_eq!(plain.id, combed.id);
    let (mut near, mut beyond) = (0, 0);
    for i in 0..combed.strands() {
        let strand = combed.strand(i);
        let (root, tip) = (strand[0], strand[strand.len() - 1]);
        if root.x.abs() < 0.001 && root.y == 0.0 && root.z < 0.005 {
            let way = tip - root;
            // The slow drift of a coat and its tufts turn hair by some degrees.
            assert!(way.x.atan2(way.z).abs() < 0.6, "{way}");
            near += 1;
        }
        if root.x.abs() > 0.0092 {
            assert_eq!(strand, plain.strand(i));
            beyond += 1;
        }
    }
    assert!(near > 100 && beyond > 100, "{near} {beyond}");
    let thin = grown(&skin, &species, 400, 1);
    for i in 0..thin.strands() {
        let whole = combed.id.binary_search(&thin.id[i]).unwrap();
        assert_eq!(thin.strand(i), combed.strand(whole));
    }
}
