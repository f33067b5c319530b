//! Colors asked for: how much the hair of a coat has to absorb to show them.
//!
//! What a coat shows depends on all of it: scales and medullae, how hairs lie and how dense they stand, the skin, and
//! the shape under it, whose hollows are darker and whose rims are paler. So the coat is looked at as it is: grown
//! where it is wanted, dyed evenly, rendered in a white room from the side from which the skin looks best. Some of
//! fifteen absorptions give a curve, and every color is looked up in it, channel by channel. The coat is then looked at
//! with what was found, longer, and looked up again for what it missed by.

use super::{AssemblyError, StationTables};
use crate::bake::BakeError;
use crate::bsdf::HairMaterial;
use crate::color::Rgb;
use crate::groom::{self, GroomSettings};
use crate::progress::{Cancel, Progress, Silent};
use crate::render::{RenderJob, Sampler};
use crate::scene::{Backdrop, Environment, Scene, SceneParts, View};
use crate::skin::Skin;
use crate::species::{Dye, PigmentBand, REFERENCE_RADIUS_UM, Species};
use crate::table::TableError;
use glam::Vec3;

/// Absorption on the reference radius that is tried: with fewer, dark colors are 5 % off. Beyond the last nothing gets darker, below the first but one the
/// curve is straight.
const DEPTHS: [f64; 15] = [
    0.0, 0.004, 0.012, 0.03, 0.07, 0.15, 0.3, 0.55, 0.9, 1.4, 2.0, 2.8, 4.0, 8.0, 40.0,
];

/// Most strands that are grown to be looked at: more are thinner, and look the same to some percent.
const MOST_STRANDS: usize = 1_000_000;

/// Side of the picture, pixels.
const SIDE: u32 = 40;

/// Samples a pixel, of pale and of dark coats. Paths in dark fur are short, and their mean has to be known to a smaller
/// amount: sixteen for all leave some colors 2.5 % off.
const SAMPLES: [u32; 2] = [24, 96];

/// Samples a pixel of the coat as it was found: with 96 dark channels are 0.9 % off by noise.
const SAMPLES_AT_LAST: u32 = 384;

/// Absorption on the reference radius from which a coat is dark.
const DARK: f64 = 0.25;

/// A channel that is off by more than this share of it, and this much, is said.
const TOLERANCE: [f64; 2] = [0.02, 0.002];

/// Gives every dye of a species the strength at which its coat shows the color; returns what cannot be
/// shown, a sentence each. A species without dyes costs nothing.
///
/// * `skin`, `grown`: what the fur grows on, and how.
///
/// # Errors
/// A coat that cannot be grown or dyed, or [`BakeError::Stopped`].
pub fn match_colors(
    species: &mut Species,
    tables: &StationTables<'_>,
    skin: &Skin,
    grown: &GroomSettings,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Vec<String>, AssemblyError> {
    if !species.is_dyed() {
        return Ok(Vec::new());
    }
    let mut even = species.clone();
    even.coat = None;
    let grown = GroomSettings {
        strands: grown.strands.map(|n| n.min(MOST_STRANDS)),
        ..grown.clone()
    };
    let groom = groom::grow(skin, &even, &grown, &Silent, cancel)?;
    let color = Vec3::from_array(species.skin_color.map(|c| c as f32));
    let dye = |depths: [f64; 3]| {
        let mut dyed = even.clone();
        for class in &mut dyed.classes {
            let absorption = depths.map(|depth| depth / REFERENCE_RADIUS_UM);
            class.pigment = vec![PigmentBand::absorbing(absorption)];
        }
        tables.materials(&dyed)
    };
    let scene = Scene::build(SceneParts {
        groom: &groom,
        // Any: they say whether hairs have sides.
        materials: dye([DEPTHS[DEPTHS.len() / 2]; 3])?,
        skin: Some((skin, color)),
        environment: Environment::white(),
        lamps: &[],
        backdrop: Backdrop::Plain(Rgb::ZERO),
        ground: None,
        view: View::from_direction(skin.view),
    })?;
    let mut probe = Probe {
        scene,
        job: RenderJob {
            resolution: [SIDE; 2],
            // Every ray that leaves finds the same light, so that none has to be sent for it.
            sampler: Sampler::Bsdf,
            ..RenderJob::default()
        },
        dye: &dye,
        shown: Default::default(),
        progress,
        cancel,
    };
    progress.begin("matching colors", DEPTHS.len() as u64, "absorptions");
    let mut out_of_reach = Vec::new();
    let mut known: Vec<Dye> = Vec::new();
    for dye in species.dyes_mut() {
        // All classes and bands of a coat have one color, as a rule.
        if let Some(same) = known.iter().find(|known| known.color == dye.color) {
            *dye = *same;
            continue;
        }
        let (depths, shown) = probe.depths(dye.color)?;
        // Curves through so few points are 2 % off at worst.
        let seen = probe.look(depths, SAMPLES_AT_LAST)?;
        let aim = std::array::from_fn(|c| dye.color[c].powi(2) / f64::from(seen[c]).max(1e-6));
        let (depths, _) = probe.depths(aim)?;
        dye.absorption_per_um = depths.map(|depth| depth / REFERENCE_RADIUS_UM);
        let [share, least] = TOLERANCE;
        let is_off = |c: usize| (shown[c] - dye.color[c]).abs() > share * dye.color[c] + least;
        if (0..3).any(is_off) {
            let [r, g, b] = dye.color.map(|c| (1e3 * c).round() / 1e3);
            let [x, y, z] = shown;
            let why = match (0..3).any(|c| is_off(c) && shown[c] < dye.color[c]) {
                true => "without pigment it is no brighter",
                false => "whatever its pigment, its surface reflects as much",
            };
            let sentence = format!(
                "this coat cannot show {r} {g} {b} (linear), but {x:.3} {y:.3} {z:.3}: {why}"
            );
            if !out_of_reach.contains(&sentence) {
                out_of_reach.push(sentence);
            }
        }
        known.push(*dye);
    }
    progress.finish();
    Ok(out_of_reach)
}

/// A coat to be looked at in a white room, and what it shows at those of [`DEPTHS`] that were tried.
struct Probe<'a> {
    scene: Scene,
    job: RenderJob,
    dye: &'a dyn Fn([f64; 3]) -> Result<Vec<HairMaterial>, TableError>,
    shown: [Option<Rgb>; DEPTHS.len()],
    progress: &'a dyn Progress,
    cancel: &'a Cancel,
}

impl Probe<'_> {
    /// What the coat shows at one of [`DEPTHS`].
    fn shown(&mut self, i: usize) -> Result<Rgb, AssemblyError> {
        if let Some(shown) = self.shown[i] {
            return Ok(shown);
        }
        let spp = SAMPLES[usize::from(DEPTHS[i] > DARK)];
        let shown = self.look([DEPTHS[i]; 3], spp)?;
        self.shown[i] = Some(shown);
        self.progress.advance(1);
        Ok(shown)
    }

    /// What the coat shows with an absorption on the reference radius for each channel.
    fn look(&mut self, depths: [f64; 3], spp: u32) -> Result<Rgb, AssemblyError> {
        self.scene.materials = (self.dye)(depths)?;
        self.job.spp = spp;
        let film = self.job.run(&self.scene, &Silent, self.cancel)?;
        if !film.report.complete {
            return Err(BakeError::Stopped.into());
        }
        // The backdrop is black.
        let radiance: Rgb = film.pixels.iter().map(|p| p.radiance).sum();
        Ok(radiance / film.pixels.iter().map(|p| p.alpha).sum::<f32>())
    }

    fn of_channel(&mut self, i: usize, channel: usize) -> Result<f64, AssemblyError> {
        Ok(f64::from(self.shown(i)?[channel]))
    }

    /// Absorptions on the reference radius at which the channels have the values of a color, and the values; the nearest
    /// where they never have.
    fn depths(&mut self, color: [f64; 3]) -> Result<([f64; 3], [f64; 3]), AssemblyError> {
        let (mut depths, mut values) = ([0.0; 3], [0.0; 3]);
        for c in 0..3 {
            [depths[c], values[c]] = self.depth(color[c], c)?;
        }
        Ok((depths, values))
    }

    /// Absorption on the reference radius at which a channel has a value, and the value; the nearest where it never has.
    fn depth(&mut self, color: f64, channel: usize) -> Result<[f64; 2], AssemblyError> {
        let last = DEPTHS.len() - 1;
        let (mut below, mut above) = (0, last);
        while above - below > 1 {
            let middle = usize::midpoint(below, above);
            if self.of_channel(middle, channel)? > color {
                below = middle;
            } else {
                above = middle;
            }
        }
        let (a, b) = (
            self.of_channel(below, channel)?,
            self.of_channel(above, channel)?,
        );
        if color >= a {
            return Ok([DEPTHS[below], a]);
        }
        if color <= b {
            return Ok([DEPTHS[above], b]);
        }
        let around = [below.saturating_sub(1), below, above, (above + 1).min(last)];
        let at = around.map(|i| even(DEPTHS[i]));
        let mut values = [0.0; 4];
        for (value, i) in values.iter_mut().zip(around) {
            *value = self.of_channel(i, channel)?;
        }
        Ok([uneven(crossing(at, values, color)), color])
    }
}

/// A scale of absorption on which colors fall evenly: what many clear hairs send back goes down with its root, what
/// dark ones do with its logarithm.
fn even(depth: f64) -> f64 {
    (1.0 + EVEN * depth.sqrt()).ln()
}

/// The inverse of [`even`].
fn uneven(x: f64) -> f64 {
    (x.exp_m1() / EVEN).powi(2)
}

const EVEN: f64 = 10.0;

/// Where a falling curve through four points, of which the outer two may be the same as their neighbors, has a value between
/// those of the middle two: the cubic of Fritsch and Butland (1984), which never turns between its points.
fn crossing(at: [f64; 4], values: [f64; 4], value: f64) -> f64 {
    let span = [at[1] - at[0], at[2] - at[1], at[3] - at[2]];
    let rise = |i: usize| (values[i + 1] - values[i]) / span[i];
    let slope = |left: usize, right: usize| {
        if span[left] == 0.0 || span[right] == 0.0 {
            return rise(1);
        }
        let (a, b) = (rise(left), rise(right));
        if a * b <= 0.0 {
            return 0.0;
        }
        let (before, after) = (
            2.0 * span[right] + span[left],
            span[right] + 2.0 * span[left],
        );
        (before + after) / (before / a + after / b)
    };
    let (from, to) = (span[1] * slope(0, 1), span[1] * slope(1, 2));
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let t: f64 = 0.5 * (low + high);
        let u = 1.0 - t;
        let here = u * u * ((1.0 + 2.0 * t) * values[1] + t * from)
            + t * t * ((1.0 + 2.0 * u) * values[2] - u * to);
        if here > value {
            low = t;
        } else {
            high = t;
        }
    }
    at[1] + low * span[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_turned_around() {
        // What a deep coat of smooth hair shows, half a percent off at most where it is tried so rarely.
        let shown = DEPTHS.map(crate::species::coat_color);
        for i in 1..DEPTHS.len() - 2 {
            let pick = |values: [f64; DEPTHS.len()]| std::array::from_fn(|k| values[i + k - 1]);
            let (at, values) = (pick(DEPTHS.map(even)), pick(shown));
            for share in [0.01, 0.3, 0.5, 0.8] {
                let depth = uneven(at[1] + share * (at[2] - at[1]));
                let color = crate::species::coat_color(depth);
                let found = uneven(crossing(at, values, color));
                let off = crate::species::coat_color(found) / color - 1.0;
                assert!(off.abs() < 0.006, "{depth}: {color} off by {off}");
            }
        }
        // At the ends neighbors are missing.
        let (at, values) = ([0.0, 0.0, 1.0, 2.0], [1.0, 1.0, 0.5, 0.25]);
        let near = crossing(at, values, 0.99);
        assert!((0.0..0.05).contains(&near), "{near}");
        assert!((crossing(at, values, 0.5 + 1e-9) - 1.0).abs() < 1e-6);
    }
}
