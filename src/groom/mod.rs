//! Strands of fur on a skin, in flat arrays.

mod account;
mod barrier;
mod clump;
mod coat;
mod collide;
#[cfg(test)]
mod collide_tests;
mod comb;
#[cfg(test)]
mod comb_tests;
mod cover;
mod error;
mod field;
mod follicle;
mod here;
mod near;
mod noise;
mod plan;
mod pores;
#[cfg(test)]
mod pores_tests;
mod scatter;
#[cfg(test)]
mod scatter_tests;
#[cfg(test)]
mod shape_tests;
mod strand;
mod strands;
#[cfg(test)]
mod tests;
mod vary;
#[cfg(test)]
mod vary_tests;
mod walk;
mod waves;

pub use account::Account;
pub(crate) use cover::widenings;
pub use error::GroomError;
pub use plan::{DEFAULT_STRANDS, MAX_CLASSES, MAX_STRANDS};
pub use strands::Groom;

use crate::progress::{Cancel, Progress};
use crate::skin::Skin;
use crate::species::{Collision, Species, VaryWhat};
use coat::Coat;
use collide::{Collider, Contact};
use comb::Comb;
use field::Field;
use follicle::{Follicle, Surface};
use glam::Vec3;
use noise::Symmetry;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use strand::{CLASS_SHIFT, Grower};
use vary::Variation;

/// What the caller of [`grow`] chooses.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroomSettings {
    /// Strands in all; `None` for the natural number, at most [`DEFAULT_STRANDS`].
    pub strands: Option<usize>,
    /// Seed of everything random. The same seed and skin give nested grooms for any `strands`.
    pub seed: u64,
}

/// Size of a groom that has not been grown yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Forecast {
    /// Strands of all classes.
    pub strands: usize,
    /// Control points of all strands.
    pub points: usize,
    /// Each class of the species.
    pub classes: Vec<ClassForecast>,
}

/// Size of a class of a groom that has not been grown yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClassForecast {
    /// Strands.
    pub strands: usize,
    /// As [`Groom::width_scale`].
    pub width_scale: f32,
}

/// How large the groom will be that [`grow`] makes of the same arguments. The strands of a class that a
/// smaller groom has are those of lowest rank of a larger one.
///
/// # Errors
/// As [`grow`], before it begins.
pub fn forecast(
    skin: &Skin,
    species: &Species,
    strands: Option<usize>,
) -> Result<Forecast, GroomError> {
    let area = Surface::new(skin)?.weighted_area();
    let plan = plan::plan(skin, area, species, strands)?;
    let points = plan.iter().zip(&species.classes);
    let points = points
        .map(|(plan, class)| plan.strands * strand::points_of(&class.groom))
        .sum();
    let classes: Vec<ClassForecast> = (plan.iter())
        .map(|class| ClassForecast {
            strands: class.strands,
            width_scale: class.width_scale as f32,
        })
        .collect();
    Ok(Forecast {
        strands: classes.iter().map(|c| c.strands).sum(),
        points,
        classes,
    })
}

/// Grows the fur of `species` on `skin`: strands sorted by class, then by rank.
///
/// The result is a function of the arguments alone, not of the number of threads. A groom of fewer
/// strands is a subset of one with more: same ids, same curves; only widths differ, to cover as
/// much. Follicles that have no hair or no room are counted in its warnings.
///
/// # Errors
/// [`GroomError`]: nothing to grow or nowhere to grow it, or `cancel` was set.
pub fn grow(
    skin: &Skin,
    species: &Species,
    settings: &GroomSettings,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Groom, GroomError> {
    let surface = Surface::new(skin)?;
    let plan = plan::plan(skin, surface.weighted_area(), species, settings.strands)?;
    let total: usize = plan.iter().map(|c| c.strands).sum();
    progress.begin("placing roots", total as u64, "roots");
    let comb = Comb::new(&species.groom.comb, skin);
    let symmetry = Symmetry {
        mirror: skin.mirror.as_ref(),
        amount: species.groom.symmetry as f32,
    };
    let scatter = || -> Result<Vec<_>, GroomError> {
        if let Some(recipe) = &species.groom.pores {
            let dealt = pores::Dealt {
                recipe,
                species,
                plan: &plan,
                comb: comb.as_ref(),
                seed: settings.seed,
            };
            return dealt.scatter(&surface, skin, progress, cancel);
        }
        (plan.par_iter().enumerate())
            .map(|(class, plan)| {
                let seed = follicle::class_seed(settings.seed, class);
                surface.scatter(seed, plan.strands, progress, cancel)
            })
            .collect()
    };
    let paint = || -> Result<Option<Coat>, GroomError> {
        let recipe = species.coat.as_ref();
        let coat = recipe.map(|recipe| Coat::paint(skin, recipe, symmetry, settings.seed, cancel));
        coat.transpose()
    };
    let field = || (skin.gravity == 0.0).then(|| Field::new(skin));
    let collider = || match species.groom.collision {
        Collision::Near => Ok(None),
        Collision::Exact => Collider::new(skin).map(Some),
    };
    let (scattered, (coat, field, collider)) =
        rayon::join(scatter, || (paint(), field(), collider()));
    let (scattered, coat, collider) = (scattered?, coat?, collider?);
    progress.finish();
    progress.begin("growing fur", total as u64, "strands");
    let mut groom = Groom {
        classes: species.classes.iter().map(|c| c.name.clone()).collect(),
        coats: match &species.coat {
            Some(recipe) => recipe.parts(),
            None => vec!["own".to_owned()],
        },
        skin_tint: (coat.iter())
            .flat_map(|coat| coat.skin_tint(skin, species))
            .collect(),
        warnings: (coat.iter().flat_map(|c| c.warnings.clone()))
            .chain(comb.iter().flat_map(|c| c.warnings.clone()))
            .chain(symmetry.idle(skin))
            .collect(),
        width_scale: plan.iter().map(|c| c.width_scale as f32).collect(),
        natural: plan.iter().map(|c| c.natural).collect(),
        offsets: vec![0],
        ..Groom::default()
    };
    for (class, scattered) in scattered.iter().enumerate() {
        let follicles = &scattered.follicles;
        let class_groom = &species.classes[class].groom;
        let variation = Variation::new(&class_groom.vary, symmetry, settings.seed);
        let vary_of = |follicle: &Follicle| variation.at(follicle.position, surface.uv(follicle));
        let thick = (class_groom.diameter_um * 1e-6) as f32;
        let shortest = (class_groom.diameter_um * 1e-3 / class_groom.length_mm) as f32;
        let fates: Vec<Fate> = (follicles.par_iter().enumerate())
            .with_min_len(1024)
            .map(|(rank, follicle)| {
                let vary = vary_of(follicle);
                let cut = here::trim(class_groom, &vary) <= thick;
                let length = surface.length(follicle) * vary[VaryWhat::Length];
                // Most coats shorten hair nowhere by so much that it matters.
                let is_short = length <= shortest
                    || coat.as_ref().is_some_and(|coat| {
                        length * coat.least_hair() <= shortest && {
                            let root = surface.root(follicle);
                            let id = id_of(class, rank);
                            let near = &mut Vec::new();
                            let (_, hair) = coat.choose(id, root.position, root.normal, near);
                            length * hair <= shortest
                        }
                    });
                if cut || is_short {
                    Fate::Short
                } else if vary[VaryWhat::Width] <= 0.0 {
                    Fate::Thin
                } else if !variation.grows(id_of(class, rank), vary[VaryWhat::Density]) {
                    Fate::Sparse
                } else {
                    Fate::Grown
                }
            })
            .collect();
        let grown = fates.iter().enumerate().filter(|(_, f)| **f == Fate::Grown);
        let mut ranks: Vec<u32> = grown.map(|(rank, _)| rank as u32).collect();
        let count = |fate| fates.iter().filter(|f| **f == fate).count();
        let mut account = Account {
            asked: fates.len(),
            short: count(Fate::Short),
            thin: count(Fate::Thin),
            sparse: count(Fate::Sparse),
            crowded: scattered.crowded,
            ..Account::default()
        };
        groom
            .warnings
            .extend(variation.idle(&groom.classes[class], class_groom, comb.is_some()));
        let width_scale = plan[class].width_scale;
        let grower = Grower::new(
            class_groom,
            &variation,
            skin,
            field.as_ref(),
            comb.as_ref(),
            settings.seed,
            width_scale,
        );
        let per_strand = grower.points();
        let (bent, cut) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let start = groom.points.len();
        groom
            .points
            .resize(start + per_strand * ranks.len(), Vec3::ZERO);
        groom.widths.resize(groom.points.len(), 0.0);
        let first = groom.normal.len();
        groom.normal.resize(first + ranks.len(), Vec3::ZERO);
        groom.length.resize(first + ranks.len(), 0.0);
        groom.coat.resize(first + ranks.len(), 0);
        groom.points[start..]
            .par_chunks_mut(per_strand * CHUNK)
            .zip(groom.widths[start..].par_chunks_mut(per_strand * CHUNK))
            .zip(groom.normal[first..].par_chunks_mut(CHUNK))
            .zip(groom.length[first..].par_chunks_mut(CHUNK))
            .zip(groom.coat[first..].par_chunks_mut(CHUNK))
            .zip(ranks.par_chunks(CHUNK))
            .for_each(|(((((points, widths), normals), lengths), parts), ranks)| {
                if cancel.is_cancelled() {
                    return;
                }
                // Neighbors one after another: they need the same parts of skin and field.
                let place = |i: &u32| follicles[ranks[*i as usize] as usize];
                let mut near = Vec::new();
                let mut order: Vec<u32> = (0..ranks.len() as u32).collect();
                order.sort_unstable_by_key(|i| (surface.place(&place(i)).0, *i));
                for i in order.into_iter().map(|i| i as usize) {
                    let follicle = &follicles[ranks[i] as usize];
                    let id = id_of(class, ranks[i] as usize);
                    let mut root = surface.root(follicle);
                    root.vary = vary_of(follicle);
                    if let Some(comb) = &comb {
                        root.combing = comb.lay(
                            root.position,
                            root.normal,
                            root.lay,
                            root.vary[VaryWhat::Comb],
                        );
                    }
                    if let Some(coat) = &coat {
                        let (zone, hair) = coat.choose(id, root.position, root.normal, &mut near);
                        parts[i] = zone;
                        root.length *= hair;
                    }
                    let strand = i * per_strand..(i + 1) * per_strand;
                    let points = &mut points[strand.clone()];
                    normals[i] = grower.grow(id, &root, points, &mut widths[strand]);
                    let contact = collider.as_ref().map_or(Contact::Free, |collider| {
                        let triangle = surface.place(follicle).0;
                        collider.settle(triangle, points, 1e-6 * class_groom.diameter_um as f32)
                    });
                    if contact != Contact::Free {
                        let along = points[1] - points[0];
                        let across = normals[i].reject_from(along);
                        let any = along.normalize_or(Vec3::Y).any_orthonormal_vector();
                        normals[i] = across.normalize_or(any);
                    }
                    match contact {
                        Contact::Free => {}
                        Contact::Bent => _ = bent.fetch_add(1, Ordering::Relaxed),
                        Contact::Cut => _ = cut.fetch_add(1, Ordering::Relaxed),
                        // Taken out below.
                        Contact::Buried => continue,
                    }
                    lengths[i] = arc_length(points);
                }
                progress.advance(ranks.len() as u64);
            });
        if cancel.is_cancelled() {
            return Err(GroomError::Cancelled);
        }
        account.bent = bent.into_inner();
        account.cut = cut.into_inner();
        account.buried = groom.remove_buried(first, start, per_strand, &mut ranks);
        let name = &groom.classes[class];
        let stretched = strand::stretched(&species.classes[class].groom, name);
        let said = [account.missing(name), account.collided(name), stretched];
        groom.warnings.extend(said.into_iter().flatten());
        groom
            .warnings
            .extend(scattered.crowding(&groom.classes[class], skin));
        groom.accounts.push(account);
        let ends = (1..=ranks.len()).map(|i| (start + i * per_strand) as u32);
        groom.offsets.extend(ends);
        groom.class.resize(first + ranks.len(), class as u8);
        let ids = ranks.iter().map(|&rank| id_of(class, rank as usize));
        groom.id.extend(ids);
        let grown = ranks.par_iter().map(|&rank| &follicles[rank as usize]);
        (groom.root_uv).par_extend(grown.clone().map(|follicle| surface.uv(follicle)));
        (groom.root_triangle).par_extend(grown.clone().map(|f| surface.place(f).0));
        (groom.root_barycentric).par_extend(grown.map(|f| surface.place(f).1));
    }
    progress.finish();
    Ok(groom)
}

/// Strands of neighboring ranks that a thread grows.
const CHUNK: usize = 1 << 14;

/// The id of a strand.
fn id_of(class: usize, rank: usize) -> u32 {
    (class as u32) << CLASS_SHIFT | rank as u32
}

/// What becomes of a follicle.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fate {
    /// A hair.
    Grown,
    /// None: it would be shorter than it is thick.
    Short,
    /// None: it would have no width.
    Thin,
    /// None: fewer hairs grow here.
    Sparse,
}

fn arc_length(points: &[Vec3]) -> f32 {
    points.windows(2).map(|p| p[0].distance(p[1])).sum()
}
