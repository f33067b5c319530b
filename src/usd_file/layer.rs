//! What stands in one file.

use super::value::Value;

/// Names and values of metadata.
pub type Fields = Vec<(String, Value)>;

/// One file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer {
    /// `defaultPrim`, `metersPerUnit`, `upAxis` and the like.
    pub metadata: Fields,
    /// Root prims.
    pub prims: Vec<Prim>,
}

/// What a prim's opinion does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Specifier {
    /// Makes the prim.
    Def,
    /// Adds to one that is made elsewhere.
    #[default]
    Over,
    /// A prim to inherit from; not shown.
    Class,
}

/// A prim, or what one variant says of its prim.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Prim {
    /// Its name among its siblings.
    pub name: String,
    /// What the opinion does.
    pub specifier: Specifier,
    /// Schema; empty for none.
    pub type_name: String,
    /// `kind`, `apiSchemas`, `payload` and the like.
    pub metadata: Fields,
    /// Attributes and relationships.
    pub properties: Vec<Property>,
    /// Prims below.
    pub children: Vec<Prim>,
    /// Sets of variants.
    pub variant_sets: Vec<VariantSet>,
}

/// Alternatives of a prim.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VariantSet {
    /// Its name.
    pub name: String,
    /// Name and content of each.
    pub variants: Vec<Prim>,
}

/// An attribute or a relationship.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Property {
    /// With its namespaces.
    pub name: String,
    /// `texCoord2f[]`; empty for a relationship.
    pub type_name: String,
    /// The value for all times.
    pub value: Option<Value>,
    /// Values by time.
    pub samples: Vec<(f64, Value)>,
    /// Prims that a relationship names, or the attributes that give this one its value.
    pub targets: Vec<String>,
    /// `interpolation` and the like.
    pub metadata: Fields,
}

/// The value of a field.
pub(super) fn field<'f>(fields: &'f Fields, name: &str) -> Option<&'f Value> {
    fields.iter().find(|(key, _)| key == name).map(|(_, v)| v)
}

/// Memory of names and values, bytes.
pub(super) fn memory(fields: &Fields) -> usize {
    let each = fields
        .iter()
        .map(|(name, value)| texts([name]) + value.memory());
    each.sum()
}

/// Memory of texts with their heads, bytes.
pub(super) fn texts<'t>(all: impl IntoIterator<Item = &'t String>) -> usize {
    all.into_iter()
        .map(|text| size_of::<String>() + text.len())
        .sum()
}

impl Layer {
    /// A value of the layer's metadata.
    pub fn field(&self, name: &str) -> Option<&Value> {
        field(&self.metadata, name)
    }
}

impl Prim {
    /// A value of the prim's metadata.
    pub fn field(&self, name: &str) -> Option<&Value> {
        field(&self.metadata, name)
    }

    /// The property of a name.
    pub fn property(&self, name: &str) -> Option<&Property> {
        self.properties.iter().find(|p| p.name == name)
    }

    /// The value of an attribute: for all times, else the earliest.
    pub fn value(&self, name: &str) -> Option<&Value> {
        self.property(name)?.any_value()
    }

    /// The word or text that is the value of an attribute.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.value(name).and_then(Value::text)
    }

    /// Whether an applied schema is among those of the prim.
    pub fn has_api(&self, name: &str) -> bool {
        matches!(self.field("apiSchemas"), Some(Value::Texts(all)) if all.iter().any(|a| a == name))
    }

    /// Memory that a copy takes, without children and variants, bytes; about.
    pub(super) fn memory(&self) -> usize {
        let properties = self.properties.iter().map(|property| {
            let samples = property.samples.iter().map(|(_, value)| value);
            let values = property.value.iter().chain(samples);
            let names = [&property.name, &property.type_name];
            size_of_val(property)
                + texts(names.into_iter().chain(&property.targets))
                + values.map(Value::memory).sum::<usize>()
                + memory(&property.metadata)
        });
        size_of_val(self)
            + texts([&self.name, &self.type_name])
            + memory(&self.metadata)
            + properties.sum::<usize>()
    }

    /// The child of a name.
    pub fn child(&self, name: &str) -> Option<&Prim> {
        self.children.iter().find(|c| c.name == name)
    }
}

impl Property {
    /// The value for all times, else the earliest.
    pub fn any_value(&self) -> Option<&Value> {
        let first = || self.samples.first().map(|(_, value)| value);
        let value = self.value.as_ref().or_else(first)?;
        (*value != Value::Block).then_some(value)
    }

    /// A value of the metadata.
    pub fn field(&self, name: &str) -> Option<&Value> {
        field(&self.metadata, name)
    }

    /// A word of the metadata; empty if there is none.
    pub fn word(&self, name: &str) -> &str {
        self.field(name).and_then(Value::text).unwrap_or_default()
    }
}
