//! Coats to choose from: variants that give the same strands other colors, and other lengths.
//!
//! A choice of coat is said in two places: at the root for what is shown at any level of detail, and
//! within each level for its strands. Both sets of variants have the name `coat`, so that one selection
//! makes both choices.

use super::levels::Level;
use super::look::ClassLook;
use super::provenance::identifier;
use super::tree::{Builder, Content};
use super::{Parts, skin};
use crate::export::usd::{Prim, VariantSet};
use crate::groom::Groom;
use crate::species::Species;

/// A coat to choose.
#[derive(Clone, Copy)]
pub struct Wear<'a> {
    /// Its name among the variants, an identifier.
    pub name: &'a str,
    /// The animal with this coat.
    pub species: &'a Species,
    /// Its fur: of the same follicles for all coats.
    pub groom: &'a Groom,
    /// Its levels of detail, of the same strands for all coats: how much wider they are is each one's own.
    pub levels: &'a [Level],
    /// Materials of the hair classes, in their order; empty for none.
    pub looks: &'a [ClassLook],
}

impl<'a> Parts<'a> {
    /// The same with one of the coats, and no choice.
    fn wearing(&self, coat: &Wear<'a>) -> Self {
        Self {
            groom: coat.groom,
            species: coat.species,
            levels: coat.levels,
            looks: coat.looks,
            coats: &[],
            ..*self
        }
    }

    /// Whether coats are only colors: some make hair shorter, for their pattern to show.
    pub(super) fn coats_have_one_shape(&self) -> bool {
        let same = |coat: &Wear<'_>| {
            coat.groom.points == self.groom.points && coat.groom.widths == self.groom.widths
        };
        self.coats.iter().all(same)
    }
}

impl<'a> Builder<'_, 'a> {
    /// Variants of what `of` makes of each coat.
    pub(super) fn wardrobe(&self, of: impl Fn(&Builder<'_, 'a>) -> Prim<'a>) -> VariantSet<'a> {
        let content = Content {
            strands: false,
            shape: !self.content.shape,
            color: true,
        };
        let variant = |coat: &Wear<'a>| {
            let parts = self.parts.wearing(coat);
            let mut variant = of(&Builder::with(&parts, self.settings, content));
            variant.name = coat.name.to_owned();
            variant
        };
        VariantSet {
            name: "coat".to_owned(),
            variants: self.parts.coats.iter().map(variant).collect(),
        }
    }

    /// What a coat adds that no level of detail has.
    pub(super) fn always(&self) -> Prim<'a> {
        let parts = self.parts;
        let mut mesh = Prim::over("skin");
        skin::paint(&mut mesh, parts.skin, parts.groom, self.skin_color());
        let mut geometry = Prim::over("geo");
        geometry.children.push(mesh);
        for (purpose, classes) in self.shown() {
            if self.is_of_levels(purpose) {
                continue;
            }
            let mut scope = Prim::over(purpose.name());
            for (class, strands) in classes {
                let mut curves = Prim::over(identifier(&self.class(class).name));
                self.fill(&mut curves, class, strands, purpose);
                scope.children.push(curves);
            }
            geometry.children.push(scope);
        }
        let mut variant = Prim::over("");
        variant.children.push(geometry);
        let mut scope = Prim::over("mtl");
        scope.children = self.materials();
        if !scope.children.is_empty() {
            variant.children.push(scope);
        }
        variant
    }

    /// As [`Builder::extents`], around all coats.
    pub(super) fn extents_of_all_coats(&self) -> Vec<[f32; 3]> {
        let mut boxes = self.extents();
        for coat in self.parts.coats {
            let parts = self.parts.wearing(coat);
            let other = Builder::with(&parts, self.settings, self.content).extents();
            // Least and largest corners by turns.
            for (i, (of_all, corner)) in boxes.iter_mut().zip(other).enumerate() {
                let pick = if i % 2 == 0 { f32::min } else { f32::max };
                *of_all = std::array::from_fn(|k| pick(of_all[k], corner[k]));
            }
        }
        boxes
    }
}
