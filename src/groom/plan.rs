//! How many strands of each class, and how wide.

use super::GroomError;
use crate::skin::Skin;
use crate::species::{ClassGroom, Species};

/// Strands grown when nobody says how many, if the animal has more.
pub const DEFAULT_STRANDS: usize = 250_000;

/// Largest number of strands: offsets of up to 12 control points each stay below 2^32.
pub const MAX_STRANDS: usize = 50_000_000;

/// Largest number of hair classes: they share an id of 32 bits with the rank.
pub const MAX_CLASSES: usize = 16;

/// Share of a class in a thinned groom is the area that its hairs cover in nature to this power, so
/// that guard hair still hides the undercoat: 1 keeps nature's ratio (two or three guard hairs in ten
/// of a mink, whose widths are capped: its pale undercoat shines through), 0 gives every class the
/// same number (no undercoat to look into). Numbers instead of areas would be worse still: nature
/// has one guard hair in 31 there, but they are seven times as thick and cover the rest.
const CLASS_FLATTENING: f64 = 0.5;

/// Layers of hair of one class, counted along the skin's normal, beyond which a coat looks no
/// denser: what shines through is `exp(-layers)`. Fewer and the skin shows, more and the widened
/// hairs look like straw.
const OPAQUE_LAYERS: f64 = 3.5;

/// Limits of compensation: hair wider than this, micrometers, looks like straw, and fine hair that
/// is scaled beyond this factor like felt.
const MAX_WIDTH_UM: f64 = 280.0;
const MAX_WIDTH_SCALE: f64 = 10.0;

/// Strands fewer than by default are as much wider as fewer they are, up to this: a coat a tenth as full has
/// hair of ten times its width, a thinner one shows its skin.
const MAX_WIDENING: f64 = 10.0;

/// What is grown of one class.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClassPlan {
    /// Strands to grow.
    pub(super) strands: usize,
    /// Strands that the living animal has there.
    pub(super) natural: f64,
    /// Factor on the diameter.
    pub(super) width_scale: f64,
}

/// Divides `strands` (or the default) among the classes of `species` on a skin of `area_m2`
/// (weighted by the density factor).
pub(super) fn plan(
    skin: &Skin,
    area_m2: f64,
    species: &Species,
    strands: Option<usize>,
) -> Result<Vec<ClassPlan>, GroomError> {
    if species.classes.len() > MAX_CLASSES || species.classes.is_empty() {
        return Err(GroomError::TooManyClasses {
            classes: species.classes.len(),
            limit: MAX_CLASSES,
        });
    }
    for class in &species.classes {
        check(&class.name, "density_per_cm2", class.groom.density_per_cm2)?;
        check(&class.name, "length_mm", class.groom.length_mm)?;
        check(&class.name, "diameter_um", class.groom.diameter_um)?;
    }
    let natural: Vec<f64> = species
        .classes
        .iter()
        .map(|c| c.groom.density_per_cm2 * 1e4 * area_m2)
        .collect();
    let all: f64 = natural.iter().sum();
    let default = (all.round().max(1.0) as usize).min(DEFAULT_STRANDS);
    let total = strands.unwrap_or(default);
    if total == 0 {
        return Err(GroomError::NoStrands);
    }
    if total > MAX_STRANDS {
        return Err(GroomError::TooManyStrands {
            asked: total,
            limit: MAX_STRANDS,
        });
    }
    check_spacing(skin, area_m2, total)?;
    // Short hair covers less: what the coat leaves of it, and what is left when it is cut.
    let hair = species.coat.as_ref().map_or(1.0, |coat| coat.hair);
    let grown_mm = |groom: &ClassGroom| (hair * groom.length_mm).min(groom.trim_mm);
    let weights: Vec<f64> = (species.classes.iter().zip(&natural))
        .map(|(class, natural)| {
            // Over the coat's factor, which all classes share.
            let length_mm = class.groom.length_mm.min(class.groom.trim_mm / hair);
            let area = length_mm * class.groom.diameter_um;
            (natural * area).powf(CLASS_FLATTENING)
        })
        .collect();
    let of = |total: usize| -> Vec<ClassPlan> {
        let counts = share(&natural, &weights, total);
        let class = |i: usize| {
            let groom = &species.classes[i].groom;
            let layer = grown_mm(groom) * 1e-3 * groom.diameter_um * 1e-6 / area_m2;
            ClassPlan {
                strands: counts[i],
                natural: natural[i],
                width_scale: width_scale(natural[i], counts[i], layer, groom.diameter_um),
            }
        };
        (0..counts.len()).map(class).collect()
    };
    let mut plan = of(total);
    if total < default && !species.groom.keep_widths {
        for (class, full) in plan.iter_mut().zip(of(default)) {
            let fewer = full.strands as f64 / class.strands.max(1) as f64;
            class.width_scale = full.width_scale * fewer.clamp(1.0, MAX_WIDENING);
        }
    }
    Ok(plan)
}

fn check(class: &str, field: &'static str, value: f64) -> Result<(), GroomError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(GroomError::BadClass {
        class: class.to_owned(),
        field,
        value,
        expected: "a finite number above 0",
    })
}

fn check_spacing(skin: &Skin, area_m2: f64, strands: usize) -> Result<(), GroomError> {
    let (lo, hi) = skin.bounds();
    let size = f64::from(lo.abs().max(hi.abs()).max_element());
    let resolution = 8.0 * size * f64::from(f32::EPSILON);
    let spacing = (area_m2 / strands as f64).sqrt();
    if spacing > resolution {
        return Ok(());
    }
    Err(GroomError::TooDense {
        skin: skin.name.clone(),
        strands,
        spacing_um: spacing * 1e6,
        resolution_um: resolution * 1e6,
    })
}

/// Divides `total` in proportion to `weights`, but gives no class more than it has by nature while
/// another has less. Every count grows with `total`, so that grooms nest.
fn share(natural: &[f64], weights: &[f64], total: usize) -> Vec<usize> {
    let all: f64 = natural.iter().sum();
    if total as f64 >= all {
        return round_down_but_last(natural.iter().map(|n| n * total as f64 / all), total);
    }
    let mut counts = vec![None; natural.len()];
    loop {
        let settled: f64 = counts.iter().flatten().sum();
        let open: f64 = (0..natural.len())
            .filter(|&i| counts[i].is_none())
            .map(|i| weights[i])
            .sum();
        let per_weight = (total as f64 - settled) / open;
        let full: Vec<usize> = (0..natural.len())
            .filter(|&i| counts[i].is_none())
            .filter(|&i| natural[i] <= per_weight * weights[i])
            .collect();
        if full.is_empty() {
            let shares = (0..natural.len()).map(|i| counts[i].unwrap_or(per_weight * weights[i]));
            return round_down_but_last(shares, total);
        }
        for i in full {
            counts[i] = Some(natural[i]);
        }
    }
}

/// Whole numbers that sum to `total`: all rounded down, the last class takes the rest. (Rounding
/// each to the nearest would not always grow with the total.)
fn round_down_but_last(shares: impl Iterator<Item = f64>, total: usize) -> Vec<usize> {
    let mut counts: Vec<usize> = shares.map(|s| s as usize).collect();
    if let Some(last) = counts.pop() {
        let rest = total.saturating_sub(counts.iter().sum());
        debug_assert!(rest.abs_diff(last) <= counts.len() + 1);
        counts.push(rest);
    }
    counts
}

/// Factor on the diameter that keeps a coat of `grown` instead of `natural` hairs as opaque as it
/// needs to be. `layer` is the share of the skin's area that one hair of `diameter_um` covers.
///
/// Widening by the full ratio would make a fox's guard hair millimeters wide. But a coat of sixty
/// layers looks no denser than one of three, so only [`OPAQUE_LAYERS`] are kept.
fn width_scale(natural: f64, grown: usize, layer: f64, diameter_um: f64) -> f64 {
    let grown = grown.max(1) as f64;
    let needed = (natural * layer).min(OPAQUE_LAYERS);
    (needed / (grown * layer))
        .min(MAX_WIDTH_UM / diameter_um)
        .clamp(1.0, MAX_WIDTH_SCALE)
        .min((natural / grown).max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::groom::tests::fox;

    #[test]
    fn counts_sum_grow_and_keep_guard_hair() {
        // A fox: guard hair covers a fifth of what the undercoat does.
        let natural = [11_500.0, 288_500.0];
        let weights = [11_500.0 * 50.0 * 75.0, 288_500.0 * 30.0 * 20.0].map(f64::sqrt);
        let mut last = vec![0, 0];
        for total in (1..400_000).step_by(997) {
            let counts = share(&natural, &weights, total);
            assert_eq!(counts.iter().sum::<usize>(), total);
            assert!(counts[0] >= last[0] && counts[1] >= last[1], "{total}");
            last = counts;
        }
        let thin = share(&natural, &weights, 3_000);
        assert!((900..1_100).contains(&thin[0]), "{thin:?}");
        assert_eq!(share(&natural, &weights, 300_000)[0], 11_500);
    }

    /// A thinned coat of cut hair is as wide and as well mixed as one of hair that grows no longer.
    #[test]
    fn cut_hair_is_planned_as_short_hair() {
        let skin = crate::skin::load("swatch").unwrap();
        let planned = |species: &Species| -> Vec<(usize, f64)> {
            let plan = plan(&skin, 0.01, species, Some(60_000)).unwrap();
            plan.iter().map(|c| (c.strands, c.width_scale)).collect()
        };
        let mut whole = fox();
        for coat in ["none", "zebra"] {
            whole.wear(coat).unwrap();
            let hair = whole.coat.as_ref().map_or(1.0, |coat| coat.hair);
            let (mut cut, mut short) = (whole.clone(), whole.clone());
            cut.classes[1].groom.trim_mm = 3.0;
            short.classes[1].groom.length_mm = 3.0 / hair;
            let (whole, cut, short) = (planned(&whole), planned(&cut), planned(&short));
            assert!(cut[1].0 < whole[1].0 && cut[1].1 > whole[1].1, "{cut:?}");
            for (cut, short) in cut.iter().zip(&short) {
                assert_eq!(cut.0, short.0);
                assert!((cut.1 / short.1 - 1.0).abs() < 1e-12, "{cut:?} {short:?}");
            }
        }
    }

    /// Fewer strands than by default are wider by as many as are missing, up to a limit; with `keep_widths` they
    /// are as wide as an opaque coat asks for.
    #[test]
    fn fewer_strands_keep_the_area_of_their_hair() {
        let skin = crate::skin::load("swatch").unwrap();
        let mut species = fox();
        for area_m2 in [0.0036, 0.01, 1.0] {
            let mut planned = |strands, keep_widths| {
                species.groom.keep_widths = keep_widths;
                plan(&skin, area_m2, &species, strands).unwrap()
            };
            let full = planned(None, false);
            let all: usize = full.iter().map(|c| c.strands).sum();
            for part in [1, 2, 4] {
                let thin = planned(Some(all / part), false);
                for (thin, full) in thin.iter().zip(&full) {
                    let area = |c: &ClassPlan| c.strands as f64 * c.width_scale;
                    assert!((area(thin) / area(full) - 1.0).abs() < 1e-9, "{thin:?}");
                }
                let kept = planned(Some(all / part), true);
                let wider = thin.iter().zip(&kept);
                assert!(
                    wider
                        .into_iter()
                        .all(|(t, k)| t.width_scale >= k.width_scale)
                );
            }
            let sparse = planned(Some(all / 100), false);
            for (sparse, full) in sparse.iter().zip(&full) {
                assert_eq!(sparse.width_scale, MAX_WIDENING * full.width_scale);
            }
            // More than by default need no more.
            let more = planned(Some(2 * all), false);
            assert!(
                more.iter()
                    .zip(&full)
                    .all(|(m, f)| m.width_scale <= f.width_scale)
            );
        }
    }

    #[test]
    fn widths_compensate_only_as_far_as_needed() {
        // 10 natural layers, all there: natural width.
        assert_eq!(width_scale(1e6, 1_000_000, 1e-5, 20.0), 1.0);
        // Half of 10 layers is still opaque.
        assert_eq!(width_scale(1e6, 500_000, 1e-5, 20.0), 1.0);
        // A tenth is 1 layer: 3.5 are needed.
        assert!((width_scale(1e6, 100_000, 1e-5, 20.0) - 3.5).abs() < 1e-12);
        // A sparse coat (0.1 layers) keeps its covered area exactly: linear.
        assert!((width_scale(1e4, 5_000, 1e-5, 20.0) - 2.0).abs() < 1e-12);
        // Previews are capped, thick hair sooner.
        assert_eq!(width_scale(1e6, 100, 1e-5, 20.0), MAX_WIDTH_SCALE);
        assert_eq!(width_scale(1e6, 100, 1e-5, 140.0), 2.0);
    }
}
