//! A layer in memory: prims with metadata, attributes, relationships, variants. Only what the files of
//! this program need of Pixar's scene description.

use super::value::{Dictionary, Value};

/// One file.
#[derive(Default)]
pub struct Layer<'a> {
    /// What the file is, for people.
    pub documentation: String,
    /// Name of the prim that a reference to the file means: one of `prims`.
    pub default_prim: String,
    /// Length of a unit, meters.
    pub meters_per_unit: f64,
    /// `Y` or `Z`.
    pub up_axis: &'static str,
    /// Where the file comes from.
    pub custom_data: Dictionary<'a>,
    /// Root prims.
    pub prims: Vec<Prim<'a>>,
}

/// What a prim's text does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Specifier {
    /// Makes the prim.
    #[default]
    Def,
    /// Adds to one that is made elsewhere.
    Over,
}

impl Specifier {
    /// As in the text form.
    pub fn name(self) -> &'static str {
        match self {
            Self::Def => "def",
            Self::Over => "over",
        }
    }
}

/// A prim, or what one variant says of its prim.
#[derive(Default)]
pub struct Prim<'a> {
    /// What the prim's text does; of no meaning for a variant.
    pub specifier: Specifier,
    /// Schema, `Mesh`; empty for none.
    pub type_name: &'static str,
    /// An identifier; any name for a variant.
    pub name: String,
    /// For people.
    pub documentation: String,
    /// `component`; empty for none.
    pub kind: &'static str,
    /// Applied schemas that are put before others.
    pub api_schemas: Vec<String>,
    /// Identifier, name, version.
    pub asset_info: Dictionary<'a>,
    /// Anything.
    pub custom_data: Dictionary<'a>,
    /// Chosen variant of each set.
    pub selections: Vec<(String, String)>,
    /// A file whose default prim is loaded on demand.
    pub payload: Option<String>,
    /// Attributes and relationships.
    pub properties: Vec<Property<'a>>,
    /// Prims below.
    pub children: Vec<Prim<'a>>,
    /// Sets of variants.
    pub variant_sets: Vec<VariantSet<'a>>,
}

/// Alternatives of a prim.
pub struct VariantSet<'a> {
    /// An identifier.
    pub name: String,
    /// Name and content of each.
    pub variants: Vec<Prim<'a>>,
}

/// A property of a prim.
pub enum Property<'a> {
    /// A value.
    Attribute(Attribute<'a>),
    /// The name of another prim.
    Relationship {
        /// `material:binding`.
        name: String,
        /// Absolute path.
        target: String,
    },
}

/// A typed value of a prim.
#[derive(Default)]
pub struct Attribute<'a> {
    /// With its namespaces, `primvars:st`.
    pub name: String,
    /// `texCoord2f[]`.
    pub type_name: &'static str,
    /// Whether it has one value for all times.
    pub uniform: bool,
    /// Whether no schema knows it.
    pub custom: bool,
    /// `vertex`, `uniform`, `constant`; empty for none.
    pub interpolation: &'static str,
    /// The value, if it is not only connected or declared.
    pub value: Option<Value<'a>>,
    /// Absolute path of an attribute that gives the value instead.
    pub connection: Option<String>,
}

impl<'a> Prim<'a> {
    /// Makes a prim of a schema.
    pub fn new(type_name: &'static str, name: impl Into<String>) -> Self {
        Self {
            type_name,
            name: name.into(),
            ..Self::default()
        }
    }

    /// Adds to a prim that is made elsewhere.
    pub fn over(name: impl Into<String>) -> Self {
        Self {
            specifier: Specifier::Over,
            ..Self::new("", name)
        }
    }

    /// Adds an attribute that may change over time.
    pub fn set(&mut self, type_name: &'static str, name: impl Into<String>, value: Value<'a>) {
        self.add(Attribute {
            name: name.into(),
            type_name,
            value: Some(value),
            ..Attribute::default()
        });
    }

    /// Adds an attribute with one value for all times.
    pub fn set_uniform(
        &mut self,
        type_name: &'static str,
        name: impl Into<String>,
        value: Value<'a>,
    ) {
        self.add(Attribute {
            name: name.into(),
            type_name,
            uniform: true,
            value: Some(value),
            ..Attribute::default()
        });
    }

    /// Adds a primvar; `name` is without its namespace.
    pub fn primvar(
        &mut self,
        type_name: &'static str,
        name: &str,
        interpolation: &'static str,
        value: Value<'a>,
    ) {
        self.add(Attribute {
            name: format!("primvars:{name}"),
            type_name,
            interpolation,
            value: Some(value),
            ..Attribute::default()
        });
    }

    /// Adds an attribute.
    pub fn add(&mut self, attribute: Attribute<'a>) {
        self.properties.push(Property::Attribute(attribute));
    }

    /// Adds a relationship.
    pub fn relate(&mut self, name: impl Into<String>, target: impl Into<String>) {
        self.properties.push(Property::Relationship {
            name: name.into(),
            target: target.into(),
        });
    }
}

impl Property<'_> {
    /// With its namespaces.
    pub fn name(&self) -> &str {
        match self {
            Self::Attribute(attribute) => &attribute.name,
            Self::Relationship { name, .. } => name,
        }
    }
}
