//! What varies over the skin does so where and as far as asked.

use super::Groom;
use super::clump::{Clumps, Tufts};
use super::noise::Symmetry;
use super::tests::{fox, grown};
use super::vary::Variation;
use crate::io::Picture;
use crate::sampling::hash64;
use crate::skin;
use crate::species::{ClassGroom, Species, Vary, VaryBy, VaryWhat};
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

/// Varies by a picture that is black on the left and white on the right.
fn halves(what: VaryWhat, from: f64, to: f64) -> Vary {
    // Many pixels: between the last black and the first white one it is blended.
    let values = (0..32).map(|i| f32::from(u8::from(i >= 16))).collect();
    let picture = Arc::new(Picture::new(32, 1, values).unwrap());
    Vary {
        what,
        by: VaryBy::Map { picture },
        from,
        to,
    }
}

/// A swatch of straight hair, without and with something that varies.
fn pair(vary: Vary) -> (Groom, Groom) {
    let skin = skin::load("swatch").unwrap();
    let mut species = fox();
    for class in &mut species.classes {
        class.groom.curl_mm = 1.0;
        class.groom.frizz_mm = 1.0;
    }
    let plain = grown(&skin, &species, 4_000, 5);
    for class in &mut species.classes {
        class.groom.vary = vec![vary.clone()];
    }
    (plain, grown(&skin, &species, 4_000, 5))
}

/// Mean of a number of each strand over the middles of the black and of the white half.
fn means(groom: &Groom, of: impl Fn(usize) -> f32) -> [f32; 2] {
    [0.2..0.3, 0.7..0.8].map(|half| {
        let strands = 0..groom.strands();
        let here: Vec<f32> = (strands.filter(|&i| half.contains(&groom.root_uv[i].x)))
            .map(&of)
            .collect();
        here.iter().sum::<f32>() / here.len() as f32
    })
}

#[test]
fn lengths_widths_and_curls_have_their_factor() {
    let (plain, groom) = pair(halves(VaryWhat::Length, 0.25, 1.5));
    assert_eq!(plain.id, groom.id);
    let ratio = |i: usize| groom.length[i] / plain.length[i];
    let [black, white] = means(&groom, ratio);
    // Waves are a little shorter by the length of their wave.
    assert!((black - 0.25).abs() < 0.1, "{black}");
    assert!((white - 1.5).abs() < 0.1, "{white}");

    let (plain, groom) = pair(halves(VaryWhat::Width, 0.5, 2.0));
    let ratio = |i: usize| {
        let k = groom.offsets[i] as usize + 2;
        groom.widths[k] / plain.widths[k]
    };
    let [black, white] = means(&groom, ratio);
    assert!((black - 0.5).abs() < 1e-3 && (white - 2.0).abs() < 1e-3);

    for what in [
        VaryWhat::Curl,
        VaryWhat::Frizz,
        VaryWhat::Clump,
        VaryWhat::Tilt,
    ] {
        let (plain, groom) = pair(halves(what, 0.3, 1.0));
        let moved = |i: usize| {
            let (a, b) = (groom.strand(i), plain.strand(i));
            a[a.len() - 1].distance(b[b.len() - 1])
        };
        let [black, white] = means(&groom, moved);
        assert!(black > 1e-4 && white < 1e-6, "{what:?}: {black} {white}");
    }
}

/// Hair of all kinds of waves, wet and cut: every number does something.
fn adorned() -> Species {
    let mut species = fox();
    for class in &mut species.classes {
        let groom = &mut class.groom;
        groom.crimp_mm = 0.3;
        groom.curl_mm = 1.0;
        // Long enough for the points of a strand.
        groom.curl_pitch_mm = 40.0;
        groom.frizz_mm = 1.0;
        groom.roll_deg = 30.0;
        groom.trim_mm = 0.8 * groom.length_mm;
        groom.wet = 0.5;
    }
    species
}

/// The number of a class by a factor, as if it were written so.
fn scaled(groom: &mut ClassGroom, what: VaryWhat, factor: f64) {
    match what {
        VaryWhat::Length => groom.length_mm *= factor,
        VaryWhat::LengthSpread => groom.length_sigma *= factor,
        VaryWhat::Width => groom.diameter_um *= factor,
        VaryWhat::WidthSpread => groom.diameter_sigma *= factor,
        VaryWhat::Stalk => groom.stalk *= factor,
        VaryWhat::Shield => groom.shield = groom.shield.map(|at| at * factor),
        VaryWhat::Taper => groom.taper_from *= factor,
        VaryWhat::Tilt => groom.emergence_deg *= factor,
        VaryWhat::Bend => groom.bend_deg *= factor,
        VaryWhat::Gravity => groom.gravity *= factor,
        VaryWhat::Stray => groom.stray_deg *= factor,
        VaryWhat::Roll => groom.roll_deg *= factor,
        VaryWhat::Crimp => groom.crimp_mm *= factor,
        VaryWhat::CrimpWavelength => groom.crimp_wavelength_mm *= factor,
        VaryWhat::Curl => groom.curl_mm *= factor,
        VaryWhat::CurlPitch => groom.curl_pitch_mm *= factor,
        VaryWhat::Frizz => groom.frizz_mm *= factor,
        VaryWhat::Trim => groom.trim_mm *= factor,
        VaryWhat::Wet => groom.wet *= factor,
        VaryWhat::Clump => groom.clump *= factor,
        VaryWhat::ClumpSize => groom.clump_mm *= factor,
        VaryWhat::Density | VaryWhat::Comb | VaryWhat::Turn => {
            unreachable!("{what:?} is no factor on a number of a class")
        }
    }
}

/// Strands of a groom by their id: points, widths where nothing is widened, normal.
type ById = HashMap<u32, (Vec<Vec3>, Vec<f32>, Vec3)>;

fn by_id(groom: &Groom) -> ById {
    let strand = |i: usize| {
        let scale = groom.width_scale[usize::from(groom.class[i])];
        let widths = groom.widths[groom.range(i)].iter().map(|w| w / scale);
        (groom.strand(i).to_vec(), widths.collect(), groom.normal[i])
    };
    let ids = groom.id.iter().enumerate();
    ids.map(|(i, &id)| (id, strand(i))).collect()
}

/// Share of a groom's strands in a part of the map that are not those of another groom, to the rounding of
/// single precision.
fn apart(groom: &Groom, want: &ById, here: &dyn Fn(f32) -> bool) -> f32 {
    let strands = by_id(groom);
    let (mut compared, mut apart) = (0, 0);
    for (i, id) in groom.id.iter().enumerate() {
        let Some(want) = want.get(id).filter(|_| here(groom.root_uv[i].x)) else {
            continue;
        };
        let is = &strands[id];
        let points = is.0.iter().zip(&want.0);
        let widths = is.1.iter().zip(&want.1);
        let near = points.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max) < 2e-6
            && widths.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f32::max) < 1e-4
            && is.2.distance(want.2) < 1e-3;
        compared += 1;
        apart += usize::from(!near);
    }
    assert!(compared > 250, "{compared}");
    apart as f32 / compared as f32
}

/// Where a map is black hair is that of a class whose number is by the first factor another, where it is white
/// by the second, to the rounding of single precision; and a map of one value is that number everywhere.
#[test]
fn every_number_is_where_a_map_says_what_a_constant_says() {
    let skin = skin::load("swatch").unwrap();
    let others = [VaryWhat::Density, VaryWhat::Comb, VaryWhat::Turn];
    for what in VaryWhat::ALL.into_iter().filter(|w| !others.contains(w)) {
        let factors = match what {
            VaryWhat::CrimpWavelength | VaryWhat::CurlPitch | VaryWhat::ClumpSize => [0.5, 2.0],
            VaryWhat::Shield | VaryWhat::Stalk => [0.25, 1.0],
            VaryWhat::Taper => [1.25, 1.0],
            VaryWhat::Length | VaryWhat::Width | VaryWhat::Trim | VaryWhat::Tilt => [0.5, 1.0],
            // Hair without curls has fewer points.
            VaryWhat::Curl => [0.5, 1.0],
            _ => [0.0, 1.0],
        };
        let of = |change: &dyn Fn(&mut ClassGroom)| {
            let mut species = adorned();
            for class in &mut species.classes {
                change(&mut class.groom);
            }
            grown(&skin, &species, 1_500, 5)
        };
        let constants = factors.map(|factor| by_id(&of(&|groom| scaled(groom, what, factor))));
        let map = halves(what, factors[0], factors[1]);
        let everywhere = Vary {
            from: factors[0],
            to: factors[0],
            ..map.clone()
        };
        let varied = of(&|groom| groom.vary = vec![map.clone()]);
        let even = of(&|groom| groom.vary = vec![everywhere.clone()]);
        assert!(
            varied.warnings.is_empty(),
            "{what:?}: {:?}",
            varied.warnings
        );
        // Hair on the border of two tufts may be in the other one by rounding.
        let [black, white] = &constants;
        assert!(
            apart(&varied, black, &|x| (0.05..0.45).contains(&x)) < 2e-3,
            "{what:?} black"
        );
        assert!(
            apart(&varied, white, &|x| (0.55..0.95).contains(&x)) < 2e-3,
            "{what:?} white"
        );
        assert!(apart(&even, black, &|_| true) < 2e-3, "{what:?} everywhere");
        // It is seen.
        assert!(
            apart(&varied, white, &|x| (0.05..0.45).contains(&x)) > 0.3,
            "{what:?} is seen"
        );
    }
}

/// Half of a tress hangs, the other half keeps its lay.
#[test]
fn gravity_is_painted_on_skins_that_hair_hangs_from() {
    let skin = skin::load("tress").unwrap();
    let of = |gravity: f64, vary: Vec<Vary>| {
        let mut species = adorned();
        for class in &mut species.classes {
            class.groom.gravity = gravity;
            class.groom.vary = vary.clone();
        }
        grown(&skin, &species, 2_000, 5)
    };
    let varied = of(1.0, vec![halves(VaryWhat::Gravity, 0.0, 1.0)]);
    let [lying, hanging] = [0.0, 1.0].map(|gravity| by_id(&of(gravity, Vec::new())));
    let [black, white] = [0.05..0.45, 0.55..0.95];
    assert!(apart(&varied, &lying, &|x| black.contains(&x)) < 2e-3);
    assert!(apart(&varied, &hanging, &|x| white.contains(&x)) < 2e-3);
    // How far down tips are, in lengths.
    let down = |strands: &ById| {
        let drop = strands.values().map(|(points, ..)| {
            let way: f32 = points.windows(2).map(|p| p[0].distance(p[1])).sum();
            (points[0] - points[points.len() - 1]).y / way
        });
        drop.sum::<f32>() / strands.len() as f32
    };
    assert!(down(&hanging) > down(&lying) + 0.1);
}

/// A size of tufts between two others: hairs of either, as many as the size is near.
#[test]
fn tufts_of_two_sizes_mix_where_their_size_is_between() {
    let [least, most] = [0.002f32, 0.004];
    let tufts = Tufts::new([least, most], 7);
    let sole = [least, most].map(|size| Clumps { size, seed: 7 });
    let at = Vec3::new(0.011, 0.003, -0.007);
    for share in [0.0f32, 0.25, 0.5, 1.0] {
        let size = least * (most / least).powf(share);
        let centers = (0..4_000u64).map(|luck| tufts.at(at, size, hash64(luck)).center);
        let large = centers.filter(|c| *c == sole[1].at(at).center).count();
        assert!(
            (large as f32 / 4_000.0 - share).abs() < 0.03,
            "{share}: {large}"
        );
    }
    // Ends that are far apart have grids between them.
    let wide = Tufts::new([0.001, 0.1], 7);
    let between = wide.at(at, 0.008, 0).center;
    assert!(between != sole[0].at(at).center && between.distance(at) < 0.02);
}

#[test]
fn entries_without_effect_are_said() {
    let skin = skin::load("swatch").unwrap();
    let mut species = fox();
    species.classes[1].groom.vary = [VaryWhat::Wet, VaryWhat::Comb, VaryWhat::Crimp]
        .map(|what| halves(what, 0.0, 1.0))
        .to_vec();
    let said = grown(&skin, &species, 300, 1).warnings;
    assert_eq!(
        said,
        [
            "`vary` of `wet` changes nothing of `under`: its `wet` is 0",
            "`vary` of `comb` changes nothing of `under`: there are no combing curves or whorls",
        ]
    );
}

/// Hair that a map shaves does not grow.
#[test]
fn hair_cut_to_nothing_is_counted() {
    let skin = skin::load("swatch").unwrap();
    let mut species = adorned();
    species.classes[0].groom.vary = vec![halves(VaryWhat::Trim, 0.0, 1.0)];
    let groom = grown(&skin, &species, 4_000, 5);
    assert!(groom.accounts[0].short > 0 && groom.accounts[1].short == 0);
    let guard = (0..groom.strands()).filter(|&i| groom.class[i] == 0);
    let black = guard.filter(|&i| (0.05..0.45).contains(&groom.root_uv[i].x));
    assert_eq!(black.count(), 0);
}

#[test]
fn the_lay_turns_by_its_angle() {
    let (plain, groom) = pair(halves(VaryWhat::Turn, 0.0, 90.0));
    let skin = skin::load("swatch").unwrap();
    let turned = |i: usize| {
        let normal = skin.normals[skin.triangles[groom.root_triangle[i] as usize][0] as usize];
        let lay = |groom: &Groom| {
            let points = groom.strand(i);
            let way = points[points.len() - 1] - points[0];
            (way - normal * way.dot(normal)).normalize()
        };
        let (from, to) = (lay(&plain), lay(&groom));
        from.cross(to).dot(normal).atan2(from.dot(to))
    };
    let [black, white] = means(&groom, turned);
    assert!(black.abs() < 0.01, "{black}");
    assert!((white - FRAC_PI_2).abs() < 0.2, "{white}");
}

#[test]
fn hairs_that_do_not_grow_are_counted_and_the_others_stay() {
    let (plain, groom) = pair(halves(VaryWhat::Density, 0.0, 1.0));
    let gone = plain.strands() - groom.strands();
    assert!((1_500..2_500).contains(&gone), "{gone}");
    let black = groom.root_uv.iter().filter(|uv| (0.2..0.3).contains(&uv.x));
    assert_eq!(black.count(), 0);
    let said = groom.warnings.join("\n");
    let count: usize = (said.lines())
        .filter(|line| line.contains("did not grow"))
        .map(|line| line.split(' ').next().unwrap().parse::<usize>().unwrap())
        .sum();
    assert_eq!(count, gone, "{said}");
    assert!(said.contains("strands of `guard` did not grow") && said.contains("density"));
    // The same hairs, where they were.
    let mut all = plain.id.iter().enumerate();
    for (i, id) in groom.id.iter().enumerate() {
        let (k, _) = all.find(|(_, other)| *other == id).unwrap();
        assert_eq!(groom.strand(i), plain.strand(k));
    }

    let (_, groom) = pair(halves(VaryWhat::Length, 0.0, 1.0));
    let said = groom.warnings.join("\n");
    assert!(said.contains("would be shorter than thick"), "{said}");
    assert!(groom.length.iter().all(|&length| length > 20e-6));

    let (_, groom) = pair(halves(VaryWhat::Width, 0.0, 1.0));
    let said = groom.warnings.join("\n");
    assert!(said.contains("would have no width"), "{said}");
    let roots = (0..groom.strands()).map(|i| groom.widths[groom.range(i).start]);
    assert!(roots.min_by(f32::total_cmp) > Some(0.0));
}

#[test]
fn noise_reaches_both_ends_and_does_not_depend_on_threads() {
    let noise = Vary {
        what: VaryWhat::Width,
        by: VaryBy::Noise {
            size_mm: 8.0,
            rough: 0.4,
            seed: 1,
        },
        from: 0.0,
        to: 1.0,
    };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| pair(noise.clone()))
    };
    let (plain, groom) = on(1);
    assert!(groom == on(3).1);
    let ratio = |i: usize| groom.widths[i * 12 + 2] / plain.widths[i * 12 + 2];
    let ratios: Vec<f32> = (0..groom.strands()).map(ratio).collect();
    let below = ratios.iter().filter(|r| **r < 0.25).count();
    let above = ratios.iter().filter(|r| **r > 0.75).count();
    assert!(below > 100 && above > 100, "{below} {above}");
}

/// Noise on both sides of a body: its own, half of it the mirror image's, the mirror image's.
#[test]
fn noise_is_as_symmetric_as_asked_for() {
    let skin = skin::load("ball").unwrap();
    let list = [Vary {
        what: VaryWhat::Length,
        by: VaryBy::Noise {
            size_mm: 30.0,
            rough: 0.4,
            seed: 0,
        },
        from: 0.0,
        to: 1.0,
    }];
    let at = |amount: f32, p: Vec3| {
        let symmetry = Symmetry {
            mirror: skin.mirror.as_ref(),
            amount,
        };
        Variation::new(&list, symmetry, 9).at(p, Vec2::ZERO)[VaryWhat::Length]
    };
    let mut apart = 0;
    for &p in skin.positions.iter().filter(|p| p.x > 0.01).step_by(11) {
        let image = p * Vec3::new(-1.0, 1.0, 1.0);
        let [one, own, half, same] = [(0.0, p), (0.0, image), (0.5, image), (1.0, image)]
            .map(|(amount, place)| at(amount, place));
        assert_eq!(one, at(1.0, p));
        assert!((one - same).abs() < 1e-6);
        // Noise is cut at its ends after it is blended.
        if [one, own, half].iter().all(|v| *v > 0.0 && *v < 1.0) {
            assert!((half - 0.5 * (one + own)).abs() < 1e-5);
        }
        apart += usize::from((one - own).abs() > 0.05);
    }
    assert!(apart > 20, "{apart}");
}

/// Sheets that lie on each other have room for the hair of one.
#[test]
fn strands_without_room_are_counted() {
    let mut skin = skin::load("swatch").unwrap();
    let one = skin.clone();
    for layer in 1..30 {
        let first = skin.positions.len() as u32;
        let up = 1e-7 * layer as f32;
        let lifted = one.positions.iter().zip(&one.normals);
        skin.positions.extend(lifted.map(|(p, n)| *p + *n * up));
        skin.normals.extend(&one.normals);
        skin.uvs.extend(&one.uvs);
        skin.combing.extend(&one.combing);
        skin.length.extend(&one.length);
        skin.density.extend(&one.density);
        skin.color.extend(&one.color);
        let corners = one.triangles.iter().map(|t| t.map(|v| v + first));
        skin.triangles.extend(corners);
    }
    let groom = grown(&skin, &fox(), 6_000, 1);
    assert_eq!(groom.strands(), 6_000);
    let said = groom.warnings.join("\n");
    assert!(
        said.contains("had no room") && said.contains("`under`"),
        "{said}"
    );
    assert!(grown(&one, &fox(), 6_000, 1).warnings.is_empty());
}
