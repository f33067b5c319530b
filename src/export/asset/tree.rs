//! The prims of an asset.

use super::color::Coats;
use super::levels::{Level, LevelClass, guides, proxy};
use super::profile::Reader;
use super::provenance::{asset_info, identifier, recipe, user_properties};
use super::{AssetSettings, Parts, material, skin};
use crate::PROGRAM;
use crate::export::usd::{Array, Attribute, Layer, Prim, Rows, Value, VariantSet};
use crate::species::HairClass;
use glam::Vec3;
use std::sync::Arc;

/// A groom as one file.
///
/// * `file`: its name, without a folder.
pub fn layer<'a>(parts: &Parts<'a>, settings: &'a AssetSettings, file: &str) -> Layer<'a> {
    Layer {
        prims: vec![Builder::new(parts, settings).root(file)],
        ..layer_around(parts, settings)
    }
}

/// The file of an asset that is read before its payload: what it is, and how large.
///
/// * `file`: its name, without a folder. * `payload`: that of the payload beside it.
pub fn interface<'a>(
    parts: &Parts<'a>,
    settings: &'a AssetSettings,
    file: &str,
    payload: &str,
) -> Layer<'a> {
    let builder = Builder::new(parts, settings);
    let mut root = builder.bare_root(file);
    root.payload = Some(format!("./{payload}"));
    root.api_schemas.push("GeomModelAPI".to_owned());
    let hints = Array::Vec3(Rows::of(builder.extents_of_all_coats()));
    root.set("float3[]", "extentsHint", hints.into());
    Layer {
        prims: vec![root],
        ..layer_around(parts, settings)
    }
}

/// A layer without prims.
fn layer_around<'a>(parts: &Parts<'_>, settings: &AssetSettings) -> Layer<'a> {
    Layer {
        documentation: format!(
            "Fur of {} ({}), by {PROGRAM}",
            parts.species.name, parts.species.id
        ),
        default_prim: identifier(&parts.species.id),
        meters_per_unit: settings.frame.meters_per_unit(),
        up_axis: settings.frame.up_axis(),
        custom_data: vec![("creator".to_owned(), Value::string(PROGRAM))],
        prims: Vec::new(),
    }
}

/// Makes the prims of an asset.
pub(super) struct Builder<'p, 'a> {
    pub(super) parts: &'p Parts<'a>,
    pub(super) settings: &'a AssetSettings,
    /// Pigment of each class.
    pub(super) coats: Vec<Arc<Coats>>,
    /// What curves are given here.
    pub(super) content: Content,
}

/// What of their strands curves are given in one place; the rest is said in another.
#[derive(Clone, Copy)]
pub(super) struct Content {
    /// Number of points, and what a strand has once.
    pub(super) strands: bool,
    /// Points and widths.
    pub(super) shape: bool,
    /// Color along strands, and materials.
    pub(super) color: bool,
}

/// What a prim of curves is for.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Purpose {
    Render,
    Proxy,
    Guide,
}

impl Purpose {
    /// As USD names it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Render => "render",
            Self::Proxy => "proxy",
            Self::Guide => "guide",
        }
    }
}

impl<'p, 'a> Builder<'p, 'a> {
    fn new(parts: &'p Parts<'a>, settings: &'a AssetSettings) -> Self {
        let content = Content {
            strands: true,
            shape: parts.coats_have_one_shape(),
            color: parts.coats.is_empty(),
        };
        Self::with(parts, settings, content)
    }

    pub(super) fn with(
        parts: &'p Parts<'a>,
        settings: &'a AssetSettings,
        content: Content,
    ) -> Self {
        let coats = |class| Arc::new(Coats::new(parts.species, class, parts.looks.get(class)));
        Self {
            parts,
            settings,
            coats: (0..parts.species.classes.len()).map(coats).collect(),
            content,
        }
    }

    /// The root without what is below it.
    fn bare_root(&self, file: &str) -> Prim<'a> {
        let species = self.parts.species;
        let mut root = Prim::new("Xform", identifier(&species.id));
        root.documentation = species.summary.clone();
        root.kind = "component";
        root.asset_info = asset_info(self.parts, file);
        root.custom_data = recipe(self.parts);
        if self.settings.profile.has(Reader::Unreal) {
            root.api_schemas.push("GroomAPI".to_owned());
            for (name, value) in [("groom_version_major", 1), ("groom_version_minor", 5)] {
                root.add(custom("int", name, Value::Int(value)));
            }
            root.add(custom("string", "groom_tool", Value::string(PROGRAM)));
        }
        let seed = self.parts.seed.to_string();
        user_properties(
            &mut root,
            &[
                ("species", Value::string(&species.name)),
                ("latin", Value::string(&species.latin)),
                ("program", Value::string(PROGRAM)),
                ("seed", Value::string(seed)),
            ],
        );
        root
    }

    fn root(&self, file: &str) -> Prim<'a> {
        let mut root = self.bare_root(file);
        let mut scope = Prim::new("Scope", "mtl");
        scope.children = self.materials();
        if !self.parts.looks.is_empty() {
            scope
                .children
                .push(material::skin(&self.material_scope(), self.skin_color()));
        }
        root.children.push(self.geometry());
        if !scope.children.is_empty() {
            root.children.push(scope);
        }
        if let [_, _, ..] = self.parts.levels {
            root.selections
                .push(("lod".to_owned(), self.parts.levels[0].name.to_owned()));
            root.variant_sets.push(VariantSet {
                name: "lod".to_owned(),
                variants: (0..self.parts.levels.len())
                    .map(|l| self.variant(l))
                    .collect(),
            });
        }
        if let Some(worn) = self.parts.coats.first() {
            root.selections
                .push(("coat".to_owned(), worn.name.to_owned()));
            root.variant_sets.push(self.wardrobe(|coat| coat.always()));
        }
        root
    }

    /// Boxes around all that is shown always, in pictures, in viewports and as guides.
    pub(super) fn extents(&self) -> Vec<[f32; 3]> {
        let full = &self.parts.levels[0];
        let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let around = |level: &Level| {
            let boxes = self.classes(level).into_iter();
            boxes.fold(empty, |(lo, hi), (_, strands)| {
                let [a, b] = self.strands(strands).extent().map(Vec3::from_array);
                (lo.min(a), hi.max(b))
            })
        };
        let mut boxes = vec![
            skin::extent(self.parts.skin, self.settings.frame),
            around(full),
        ];
        if !self.settings.no_proxy {
            boxes.push(around(&proxy(full)));
        }
        boxes
            .iter()
            .flat_map(|(lo, hi)| [lo.to_array(), hi.to_array()])
            .collect()
    }

    /// The color of the skin.
    pub(super) fn skin_color(&self) -> Vec3 {
        Vec3::from_array(self.parts.species.skin_color.map(|c| c as f32))
    }

    /// Path of the scope of the materials.
    fn material_scope(&self) -> String {
        format!("/{}/mtl", identifier(&self.parts.species.id))
    }

    /// Materials of the hair.
    pub(super) fn materials(&self) -> Vec<Prim<'a>> {
        let scope = self.material_scope();
        let mut materials = Vec::new();
        if !self.content.color {
            return materials;
        }
        for (class, look) in self.parts.looks.iter().enumerate() {
            let hair = self.class(class);
            let (names, coats) = (&self.parts.groom.coats, &self.coats[class]);
            materials.extend(material::materials(&scope, hair, names, look, coats));
        }
        materials
    }

    /// Binds a material, if there are any.
    pub(super) fn bind(&self, prim: &mut Prim<'a>, material: &str) {
        if !self.parts.looks.is_empty() {
            prim.api_schemas.push("MaterialBindingAPI".to_owned());
            prim.relate(
                "material:binding",
                format!("{}/{material}", self.material_scope()),
            );
        }
    }

    fn geometry(&self) -> Prim<'a> {
        let mut geometry = Prim::new("Scope", "geo");
        let mut mesh = skin::mesh(
            self.parts.skin,
            self.content.color.then_some(self.parts.groom),
            self.settings.frame,
            self.skin_color(),
        );
        self.bind(&mut mesh, "skin");
        geometry.children.push(mesh);
        for (purpose, classes) in self.shown() {
            let mut scope = Prim::new("Scope", purpose.name());
            scope.set_uniform("token", "purpose", Value::token(purpose.name()));
            for (class, level) in classes {
                let mut curves = self.curves(class);
                if !self.is_of_levels(purpose) {
                    self.fill(&mut curves, class, level, purpose);
                }
                scope.children.push(curves);
            }
            geometry.children.push(scope);
        }
        geometry
    }

    /// What there is for pictures, for viewports and as guides: hair classes and their strands.
    pub(super) fn shown(&self) -> Vec<(Purpose, Vec<(usize, LevelClass)>)> {
        let full = &self.parts.levels[0];
        let mut shown = vec![(Purpose::Render, self.classes(full))];
        if !self.settings.no_proxy {
            shown.push((Purpose::Proxy, self.classes(&proxy(full))));
        }
        let leading = guides(full);
        if !self.settings.no_guides && !leading.strands.is_empty() {
            shown.push((Purpose::Guide, vec![(0, leading)]));
        }
        shown
    }

    /// Whether the levels of detail give curves their strands.
    pub(super) fn is_of_levels(&self, purpose: Purpose) -> bool {
        purpose == Purpose::Render && self.parts.levels.len() > 1
    }

    /// Classes with strands, and those strands.
    pub(super) fn classes(&self, level: &Level) -> Vec<(usize, LevelClass)> {
        let classes = level.classes.iter().cloned().enumerate();
        classes.filter(|(_, c)| !c.strands.is_empty()).collect()
    }

    /// What a level of detail adds to the curves that are there.
    fn variant(&self, index: usize) -> Prim<'a> {
        let level = &self.parts.levels[index];
        let mut variant = self.strands_of(level, level.name);
        if !self.parts.coats.is_empty() {
            let set = self.wardrobe(|coat| coat.strands_of(&coat.parts.levels[index], ""));
            variant.variant_sets.push(set);
        }
        variant
    }

    pub(super) fn class(&self, class: usize) -> &'a HairClass {
        &self.parts.species.classes[class]
    }
}

/// An attribute that no schema knows.
fn custom<'a>(type_name: &'static str, name: &str, value: Value<'a>) -> Attribute<'a> {
    Attribute {
        name: name.to_owned(),
        type_name,
        custom: true,
        value: Some(value),
        ..Attribute::default()
    }
}
