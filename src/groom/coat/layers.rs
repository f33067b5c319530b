//! Layers of a recipe, one painted over the other.

use super::net::Net;
use super::turing::{self, Diffusion, POINTS_A_WAVE, Wanted};
use super::{GroomError, Shares};
use crate::groom::follicle::{Follicle, Surface};
use crate::groom::noise::{Fractal, Symmetry};
use crate::math::ease::smoothstep;
use crate::progress::Cancel;
use crate::sampling::hash64;
use crate::skin::{Landmark, Skin};
use crate::species::{
    CoatLayer, CoatLimit, CoatPattern, CoatRecipe, Extent, Join, Lay, MAX_ZONES, Side, Turing,
};
use glam::Vec3;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// Wavelength of the spots that a rosette's ring breaks into, over that of the rosettes.
pub(super) const FRAGMENT: f64 = 0.42;
/// Least points of a net that a pattern grows on.
const MIN_POINTS: usize = 3_000;
/// Where ends of the body begin to be ends: the share of a body within which patterns get finer.
const ENDS_M: f32 = 0.3;

/// What a field is grown from, pattern and seed, and its value at each point.
type Grown = (Turing, u64, Rc<[f32]>);

/// Paints over one skin.
pub(super) struct Painter<'a> {
    skin: &'a Skin,
    surface: &'a Surface<'a>,
    /// The points of the net: of these any first ones are evenly spread too.
    follicles: &'a [Follicle],
    net: &'a Net,
    /// Meters in a millimeter of the recipe.
    scale: f32,
    seed: u64,
    symmetry: Symmetry<'a>,
    /// Way along the skin from each landmark that was asked for.
    distances: RefCell<BTreeMap<Landmark, Rc<[f32]>>>,
    /// Fields that were grown, by what they are grown from: both parts of a rosette have the same.
    fields: RefCell<Vec<Grown>>,
}

impl<'a> Painter<'a> {
    pub(super) fn new(
        skin: &'a Skin,
        surface: &'a Surface<'a>,
        follicles: &'a [Follicle],
        net: &'a Net,
        scale: f32,
        symmetry: Symmetry<'a>,
        seed: u64,
    ) -> Self {
        Self {
            skin,
            surface,
            follicles,
            net,
            scale,
            seed,
            symmetry,
            distances: RefCell::default(),
            fields: RefCell::default(),
        }
    }

    /// Shares of the zones at each point.
    pub(super) fn paint(
        &self,
        recipe: &CoatRecipe,
        warnings: &mut Vec<String>,
        cancel: &Cancel,
    ) -> Result<Vec<Shares>, GroomError> {
        let mut bare = [0.0; MAX_ZONES + 1];
        bare[0] = 1.0;
        let mut shares = vec![bare; self.net.len()];
        let mut left_out = 0;
        let mut unknown = BTreeSet::new();
        for layer in &recipe.layers {
            let near = layer.limits.iter().filter_map(|limit| match limit.extent {
                Extent::Near { landmark, .. } => Some(landmark),
                Extent::Facing { .. } => None,
            });
            let nowhere: Vec<_> = near.filter(|l| self.places(*l).is_none()).collect();
            if !nowhere.is_empty() {
                left_out += 1;
                unknown.extend(nowhere);
                continue;
            }
            let limits = self.limits(&layer.limits);
            let pattern = self.pattern(layer, cancel).ok_or(GroomError::Cancelled)?;
            for (i, shares) in shares.iter_mut().enumerate() {
                let painted = (layer.strength as f32 * limits[i] * pattern[i]).clamp(0.0, 1.0);
                for share in shares.iter_mut() {
                    *share *= 1.0 - painted;
                }
                shares[layer.zone] += painted;
            }
        }
        if left_out > 0 {
            let names: Vec<&str> = unknown.into_iter().map(Landmark::name).collect();
            warnings.push(format!(
                "{left_out} of {} layers of the coat are left out: where skin `{}` has its {} is not known",
                recipe.layers.len(),
                self.skin.name,
                names.join(", ")
            ));
        }
        Ok(shares)
    }

    /// Where a landmark is, if the skin says so.
    fn places(&self, landmark: Landmark) -> Option<&'a [Vec3]> {
        let mut all = self.skin.landmarks.iter();
        let (_, points) = all.find(|(l, _)| *l == landmark)?;
        Some(points)
    }

    /// Way from a landmark to each point, meters; infinite where the skin does not say where it is.
    fn distance(&self, landmark: Landmark) -> Rc<[f32]> {
        let mut known = self.distances.borrow_mut();
        let found = known.entry(landmark).or_insert_with(|| {
            let places = self.places(landmark).unwrap_or_default();
            self.net.distances(places).into()
        });
        Rc::clone(found)
    }

    /// How much of a layer each point gets, 0..1.
    fn limits(&self, limits: &[CoatLimit]) -> Vec<f32> {
        let mut all = vec![1.0; self.net.len()];
        for (k, limit) in limits.iter().enumerate() {
            let one = self.extent(&limit.extent);
            for (sum, value) in all.iter_mut().zip(one) {
                *sum = match limit.join {
                    Join::And => *sum * value,
                    // The first limit is no addition to everywhere.
                    Join::Or if k == 0 => value,
                    Join::Or => sum.max(value),
                    Join::Not => *sum * (1.0 - value),
                };
            }
        }
        all
    }

    fn extent(&self, extent: &Extent) -> Vec<f32> {
        match *extent {
            Extent::Near {
                landmark,
                within_mm,
                soft_mm,
                ragged_mm,
            } => {
                let [within, soft, ragged] =
                    [within_mm, soft_mm, ragged_mm].map(|mm| mm as f32 * self.scale);
                let half = (0.5 * soft).max(1e-6);
                // Bays and tongues are some times as long as they are deep.
                let size = 5.0 * ragged.max(1e-3);
                let stray = self.noise(hash64(landmark as u64), size, 0.35);
                let distance = self.distance(landmark);
                (0..self.net.len())
                    .map(|i| {
                        let at =
                            distance[i] + ragged * stray.both(self.net.positions[i], self.symmetry);
                        1.0 - smoothstep(within - half, within + half, at)
                    })
                    .collect()
            }
            Extent::Facing { side, from, to } => {
                let direction = match side {
                    Side::Up => Vec3::Y,
                    Side::Down => Vec3::NEG_Y,
                    Side::Front => self.skin.front,
                    Side::Back => -self.skin.front,
                };
                let (from, to) = (from as f32, to as f32);
                let normals = self.net.normals.iter();
                normals
                    .map(|n| smoothstep(from, to, n.dot(direction)))
                    .collect()
            }
        }
    }

    /// Fractal noise; `size` and `rough` as of [`Fractal::new`].
    fn noise(&self, seed: u64, size: f32, rough: f64) -> Fractal {
        Fractal::new(hash64(self.seed ^ hash64(seed)), size, rough)
    }

    /// The pattern at each point, 0..1. `None` if canceled.
    fn pattern(&self, layer: &CoatLayer, cancel: &Cancel) -> Option<Vec<f32>> {
        let edge = layer.edge as f32;
        Some(match &layer.pattern {
            CoatPattern::Plain => vec![1.0; self.net.len()],
            CoatPattern::Turing(turing) => {
                let field = self.turing(turing, layer.seed, cancel)?;
                bordered(&field, turing.cover, 0.0, edge)
            }
            CoatPattern::Rosettes { spots, inside } => {
                let field = self.turing(spots, layer.seed, cancel)?;
                if *inside {
                    bordered(&field, spots.cover, 0.1, edge)
                } else {
                    let field = self.rings(&field, spots, layer.seed, cancel)?;
                    bordered(&field, spots.cover, 0.0, edge)
                }
            }
            CoatPattern::Patches {
                size_mm,
                cover,
                rough,
            } => {
                let size = *size_mm as f32 * self.scale;
                let noise = self.noise(layer.seed ^ 0x7061_7463, 0.7 * size, *rough);
                let points = self.net.positions.iter();
                let field: Vec<f32> = points.map(|&p| noise.both(p, self.symmetry)).collect();
                bordered(&field, Some(*cover), 0.0, edge)
            }
            CoatPattern::Map { picture } => {
                let uvs = self.net.uvs.iter();
                uvs.map(|&uv| picture.at(uv).clamp(0.0, 1.0)).collect()
            }
        })
    }

    fn turing(&self, turing: &Turing, seed: u64, cancel: &Cancel) -> Option<Rc<[f32]>> {
        let from = Turing {
            cover: None,
            ..*turing
        };
        let grown = self.fields.borrow();
        if let Some((.., field)) = grown.iter().find(|(t, s, _)| (*t, *s) == (from, seed)) {
            return Some(Rc::clone(field));
        }
        drop(grown);
        let wanted = Wanted {
            wavelength: turing.wavelength_mm as f32 * self.scale,
            balance: turing.balance as f32,
            order: turing.order as f32,
            across: turing.lay == Lay::Across,
            scale: &[],
            push: &[],
            symmetry: self.symmetry,
            seed: hash64(self.seed ^ seed),
        };
        let field: Rc<[f32]> = self.grow(wanted, turing.fine as f32, cancel)?.into();
        let mut grown = self.fields.borrow_mut();
        grown.push((from, seed, Rc::clone(&field)));
        Some(field)
    }

    /// Grows a pattern on as few points as it needs, and carries it over to all.
    fn grow(&self, wanted: Wanted<'_>, fine: f32, cancel: &Cancel) -> Option<Vec<f32>> {
        let spacing = (wanted.wavelength * fine / POINTS_A_WAVE).max(self.net.spacing);
        let share = (self.net.spacing / spacing).powi(2);
        let count = ((self.net.len() as f32 * share) as usize).max(MIN_POINTS.min(self.net.len()));
        let spacing = self.net.spacing * (self.net.len() as f32 / count as f32).sqrt();
        let coarse = Net::new(self.surface, &self.follicles[..count], spacing);
        // The first points are the same in both nets.
        let push = &wanted.push[..count.min(wanted.push.len())];
        let scale = self.fineness(fine);
        let grown = Wanted {
            wavelength: wanted.wavelength.max(POINTS_A_WAVE * spacing),
            scale: &scale[..count],
            push,
            ..wanted
        };
        let field = turing::grow(&coarse, &grown, cancel)?;
        Some(self.net.lift(&coarse, &field))
    }

    /// The second stage of rosettes: where the first one's spots fade, spots of a shorter wavelength
    /// are pushed on; everywhere else they are kept off (after Liu, Liaw and Maini 2006, "Two-stage Turing
    /// model for generating pigment patterns on the leopard and the jaguar", Physical Review E 74).
    fn rings(&self, field: &[f32], spots: &Turing, seed: u64, cancel: &Cancel) -> Option<Vec<f32>> {
        let level = quantile(field, 0.7);
        let spread = quantile(field, 0.9) - quantile(field, 0.3);
        let ring = |&f: &f32| {
            let off = (f - level) / (0.17 * spread.max(1e-6));
            3.2 * (-off * off).exp() - 2.3
        };
        let push: Vec<f32> = field.iter().map(ring).collect();
        let wanted = Wanted {
            wavelength: (FRAGMENT * spots.wavelength_mm) as f32 * self.scale,
            balance: 0.0,
            order: 0.0,
            across: true,
            scale: &[],
            push: &push,
            symmetry: self.symmetry,
            seed: hash64(self.seed ^ seed ^ 0x7269_6e67),
        };
        self.grow(wanted, spots.fine as f32, cancel)
    }

    /// Factor on wavelengths at each point: `fine` at the ends of the body, 1 away from them.
    fn fineness(&self, fine: f32) -> Vec<f32> {
        let mut scale = vec![1.0f32; self.net.len()];
        if fine >= 1.0 {
            return scale;
        }
        let reach = ENDS_M * self.skin.body.unwrap_or(0.5);
        let ends = [
            Landmark::Nose,
            Landmark::Ears,
            Landmark::Paws,
            Landmark::TailTip,
        ];
        for end in ends {
            for (s, &d) in scale.iter_mut().zip(&*self.distance(end)) {
                let here = fine + (1.0 - fine) * smoothstep(0.2 * reach, 1.3 * reach, d);
                *s = s.min(here);
            }
        }
        // A change of scale within a wavelength would tear the pattern.
        let smooth = Diffusion::new(self.net, 0.0, true);
        let even = vec![1.0; self.net.len()];
        smooth
            .plan(3.0 * self.net.spacing, &even)
            .run(&smooth, &scale)
    }
}

/// A field as shares 0..1 with a border round a level: where a share `cover` of the points is above,
/// else round `level`.
fn bordered(field: &[f32], cover: Option<f64>, level: f32, edge: f32) -> Vec<f32> {
    let level = match cover {
        Some(cover) if cover <= 0.0 => return vec![0.0; field.len()],
        Some(cover) if cover >= 1.0 => return vec![1.0; field.len()],
        Some(cover) => quantile(field, 1.0 - cover as f32),
        None => level,
    };
    let range = quantile(field, 0.95) - quantile(field, 0.05);
    let half = (0.5 * edge * range).max(1e-6);
    field
        .iter()
        .map(|&f| smoothstep(level - half, level + half, f))
        .collect()
}

/// The value below which a share of the values lies.
fn quantile(values: &[f32], share: f32) -> f32 {
    let mut sorted = values.to_vec();
    if sorted.is_empty() {
        return 0.0;
    }
    let at = ((sorted.len() - 1) as f32 * share.clamp(0.0, 1.0)) as usize;
    *sorted.select_nth_unstable_by(at, f32::total_cmp).1
}
