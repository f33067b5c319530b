//! Levels of detail: each is a part of the one before.

use crate::groom::{self, Groom, GroomError, forecast};
use crate::skin::Skin;
use crate::species::Species;
use std::sync::Arc;

/// Names of the levels, the finest first.
const NAMES: [&str; 4] = ["full", "medium", "low", "far"];

/// A level has this share of the strands of the one before.
const SHARE: usize = 4;

/// Strands that are shown for the whole coat where speed matters most.
const PROXY: usize = 2_000;

/// Guides at most.
const GUIDES: usize = 500;

/// Strands of every class that are shown at some distance.
#[derive(Clone, Debug)]
pub struct Level {
    /// Its name among the variants.
    pub name: &'static str,
    /// Each hair class.
    pub classes: Vec<LevelClass>,
}

/// Strands of one hair class that are shown at some distance.
#[derive(Clone, Debug)]
pub struct LevelClass {
    /// Which of the groom's strands, in order.
    pub strands: Arc<[u32]>,
    /// Factor on their widths by which the coat stays opaque.
    pub widening: f32,
}

/// So many levels of a groom, the finest first; fewer if there are too few strands for them. All cover as
/// much as the first.
///
/// # Errors
/// Those of [`forecast`]: the groom is not of this skin and species.
pub fn levels(
    groom: &Groom,
    skin: &Skin,
    species: &Species,
    count: usize,
) -> Result<Vec<Level>, GroomError> {
    let mut all = vec![0; groom.classes.len()];
    for &class in &groom.class {
        all[usize::from(class)] += 1;
    }
    // Coarser levels share strands among classes as so small a groom would, as far as each has grown.
    let shares = |strands| -> Result<Vec<usize>, GroomError> {
        let plan = forecast(skin, species, Some(strands))?;
        Ok(plan.classes.iter().map(|c| c.strands).collect())
    };
    let mut parts = vec![all.clone()];
    let planned = shares(groom.strands().max(1))?;
    let mut strands = groom.strands() / SHARE;
    while parts.len() < count.min(NAMES.len()) && strands >= groom.classes.len().max(1) {
        let plan = shares(strands)?;
        let kept = |i: usize| (all[i] * plan[i] / planned[i].max(1)).min(all[i]);
        parts.push((0..all.len()).map(kept).collect());
        strands /= SHARE;
    }
    let thinner = parts.get(1..).unwrap_or_default();
    let mut widenings = vec![vec![1.0; groom.classes.len()]];
    if !thinner.is_empty() {
        widenings.extend(groom::widenings(groom, skin, thinner));
    }
    let levels = NAMES.into_iter().zip(parts.iter().zip(widenings));
    Ok(levels
        .map(|(name, (kept, widenings))| level(groom, name, kept, &widenings))
        .collect())
}

/// The strands that stand for the coat in viewports.
pub(super) fn proxy(full: &Level) -> Level {
    let all: usize = full.classes.iter().map(|c| c.strands.len()).sum();
    let share = (PROXY as f64 / all.max(1) as f64).min(1.0);
    Level {
        name: "proxy",
        classes: (full.classes.iter())
            .map(|LevelClass { strands, widening }| {
                let count = ((strands.len() as f64 * share).ceil() as usize).min(strands.len());
                // Wide enough to hide the skin, without becoming sticks.
                let wider = (1.0 / share).sqrt().min(8.0) as f32;
                LevelClass {
                    strands: Arc::from(&strands[..count]),
                    widening: widening * wider,
                }
            })
            .collect(),
    }
}

/// Guides: the most evenly spread strands of the first class.
pub(super) fn guides(full: &Level) -> LevelClass {
    let strands: &[u32] = full.classes.first().map_or(&[], |class| &class.strands);
    LevelClass {
        strands: Arc::from(&strands[..strands.len().min(GUIDES)]),
        widening: 1.0,
    }
}

/// * `kept`: strands of each class; `widenings`: factors on their widths.
fn level(groom: &Groom, name: &'static str, kept: &[usize], widenings: &[f32]) -> Level {
    // Strands are sorted by class, then by rank: those of lowest rank are an even part of the coat.
    let mut ranks = vec![Vec::new(); groom.classes.len()];
    for (index, &class) in groom.class.iter().enumerate() {
        let ranks = &mut ranks[usize::from(class)];
        if ranks.len() < kept[usize::from(class)] {
            ranks.push(index as u32);
        }
    }
    Level {
        name,
        classes: (ranks.into_iter().zip(widenings))
            .map(|(ranks, &widening)| LevelClass {
                strands: ranks.into(),
                widening,
            })
            .collect(),
    }
}
