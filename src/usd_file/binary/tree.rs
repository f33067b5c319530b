//! Prims and properties out of the specs of a crate file.

use super::values::Values;
use super::{Path, Tables};
use crate::usd_file::DEEPEST;
use crate::usd_file::error::UsdFileError;
use crate::usd_file::layer::{Fields, Layer, Prim, Property, Specifier, VariantSet, field};
use crate::usd_file::value::Value;

/// Kinds of specs, by Pixar's numbers.
const ATTRIBUTE: u32 = 1;
const PRIM: u32 = 6;
const PSEUDO_ROOT: u32 = 7;
const RELATIONSHIP: u32 = 8;
const VARIANT: u32 = 10;
const VARIANT_SET: u32 = 11;

/// Memory of a prim or a property, without what it has, bytes.
const SPEC: u64 = 192;

/// Ends a set of fields.
const END: u32 = u32::MAX;

/// The prims of a file.
pub(super) fn layer(tables: &Tables, values: &mut Values<'_>) -> Result<Layer, UsdFileError> {
    let mut builder = Builder::new(tables)?;
    let root = builder.fields(0, values)?;
    let mut layer = Layer {
        metadata: root,
        prims: Vec::new(),
    };
    for child in builder.below(0) {
        if builder.kind(child) == Some(PRIM) {
            layer.prims.push(builder.prim(child, values)?);
        }
    }
    in_order(&mut layer.prims, &layer.metadata, "primChildren", |p| {
        &p.name
    });
    Ok(layer)
}

struct Builder<'t> {
    tables: &'t Tables,
    /// Spec of each path.
    spec_of: Vec<Option<u32>>,
    /// Paths below each path: `children[starts[p]..starts[p + 1]]`.
    starts: Vec<u32>,
    children: Vec<u32>,
}

impl<'t> Builder<'t> {
    fn new(tables: &'t Tables) -> Result<Self, UsdFileError> {
        let count = tables.paths.len();
        let mut spec_of = vec![None; count];
        for (number, spec) in (0u32..).zip(&tables.specs) {
            let of = spec_of.get_mut(spec.path as usize).ok_or_else(|| {
                UsdFileError::at(format!("spec {number}"), "its path is none of the file's")
            })?;
            *of = Some(number);
        }
        let parents = || tables.paths.iter().map(|path| path.parent as usize);
        let mut starts = vec![0u32; count + 1];
        for parent in parents().filter(|&p| p < count) {
            starts[parent + 1] += 1;
        }
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut children = vec![0; starts[count] as usize];
        for (path, parent) in parents().enumerate().filter(|(_, p)| *p < count) {
            children[next[parent] as usize] = path as u32;
            next[parent] += 1;
        }
        Ok(Self {
            tables,
            spec_of,
            starts,
            children,
        })
    }

    fn below(&self, path: usize) -> Vec<usize> {
        let range = self.starts.get(path).zip(self.starts.get(path + 1));
        let (from, to) = range.map_or((0, 0), |(a, b)| (*a as usize, *b as usize));
        self.children[from..to]
            .iter()
            .map(|&c| c as usize)
            .collect()
    }

    fn path(&self, path: usize) -> &Path {
        &self.tables.paths[path]
    }

    fn kind(&self, path: usize) -> Option<u32> {
        let spec = self.spec_of.get(path).copied().flatten()?;
        Some(self.tables.specs[spec as usize].kind)
    }

    fn element(&self, path: usize) -> Result<&'t str, UsdFileError> {
        let token = self.tables.tokens.get(self.path(path).element as usize);
        let missing = || UsdFileError::at(format!("path {path}"), "its name is no token");
        token.map(String::as_str).ok_or_else(missing)
    }

    fn fields(&self, path: usize, values: &mut Values<'_>) -> Result<Fields, UsdFileError> {
        let mut fields = Fields::new();
        let Some(spec) = self.spec_of.get(path).copied().flatten() else {
            return Ok(fields);
        };
        let start = self.tables.specs[spec as usize].fields as usize;
        let set = self.tables.field_sets.get(start..).unwrap_or_default();
        for &number in set.iter().take_while(|&&field| field != END) {
            let missing = || UsdFileError::at(format!("spec {spec}"), "a field of it is missing");
            let (name, word) = *self
                .tables
                .fields
                .get(number as usize)
                .ok_or_else(missing)?;
            let name = self.tables.tokens.get(name as usize).ok_or_else(missing)?;
            fields.push((values.named(name)?, values.value(word)?));
        }
        Ok(fields)
    }

    /// A prim or a variant, with all below it.
    fn prim(&mut self, path: usize, values: &mut Values<'_>) -> Result<Prim, UsdFileError> {
        if self.path(path).depth as usize > DEEPEST {
            let reason = format!("prims are nested deeper than {DEEPEST} levels");
            return Err(UsdFileError::at(format!("path {path}"), reason));
        }
        values.spend(SPEC)?;
        let mut prim = Prim {
            name: values.named(self.element(path)?)?,
            ..Prim::default()
        };
        let mut fields = self.fields(path, values)?;
        prim.specifier = match field(&fields, "specifier").and_then(Value::number) {
            Some(0.0) => Specifier::Def,
            Some(2.0) => Specifier::Class,
            _ => Specifier::Over,
        };
        if let Some(name) = field(&fields, "typeName").and_then(Value::text) {
            prim.type_name = name.to_owned();
        }
        let mut variants: Vec<(String, Prim)> = Vec::new();
        for child in self.below(path) {
            match self.kind(child) {
                Some(PRIM) => prim.children.push(self.prim(child, values)?),
                Some(kind @ (ATTRIBUTE | RELATIONSHIP)) => {
                    prim.properties.push(self.property(child, kind, values)?);
                }
                Some(VARIANT) => {
                    let element = self.element(child)?;
                    let inner = element.trim_start_matches('{').trim_end_matches('}');
                    let (set, name) = inner.split_once('=').unwrap_or((inner, ""));
                    let mut variant = self.prim(child, values)?;
                    variant.name = name.to_owned();
                    variants.push((set.to_owned(), variant));
                }
                Some(VARIANT_SET | PSEUDO_ROOT) | Some(_) | None => {}
            }
        }
        in_order(&mut prim.properties, &fields, "properties", |p| &p.name);
        in_order(&mut prim.children, &fields, "primChildren", |p| &p.name);
        for (set, variant) in variants {
            match prim.variant_sets.iter_mut().find(|s| s.name == set) {
                Some(known) => known.variants.push(variant),
                None => prim.variant_sets.push(VariantSet {
                    name: set,
                    variants: vec![variant],
                }),
            }
        }
        const STRUCTURE: [&str; 5] = [
            "specifier",
            "typeName",
            "properties",
            "primChildren",
            "variantSetChildren",
        ];
        fields.retain(|(name, _)| !STRUCTURE.contains(&name.as_str()));
        prim.metadata = fields;
        Ok(prim)
    }

    fn property(
        &self,
        path: usize,
        kind: u32,
        values: &mut Values<'_>,
    ) -> Result<Property, UsdFileError> {
        values.spend(SPEC)?;
        let mut property = Property {
            name: values.named(self.element(path)?)?,
            ..Property::default()
        };
        for (name, value) in self.fields(path, values)? {
            match (name.as_str(), value) {
                ("typeName", Value::Text(name)) if kind == ATTRIBUTE => property.type_name = name,
                ("targetPaths" | "connectionPaths", Value::Texts(paths)) => {
                    property.targets = paths;
                }
                ("default", value) => property.value = Some(value),
                ("timeSamples", Value::Dictionary(samples)) => {
                    let time = |text: &str| text.parse().unwrap_or(f64::NAN);
                    let samples = samples.into_iter().map(|(t, value)| (time(&t), value));
                    property.samples = samples.collect();
                }
                ("custom" | "variability", _) => {}
                (_, value) => property.metadata.push((name, value)),
            }
        }
        Ok(property)
    }
}

/// Sorts things into the order that a field names.
fn in_order<T>(things: &mut [T], fields: &Fields, name: &str, of: impl Fn(&T) -> &String) {
    if let Some(Value::Texts(order)) = field(fields, name) {
        let place: std::collections::HashMap<&String, usize> = order
            .iter()
            .enumerate()
            .map(|(i, name)| (name, i))
            .collect();
        things.sort_by_key(|thing| place.get(of(thing)).copied().unwrap_or(usize::MAX));
    }
}
