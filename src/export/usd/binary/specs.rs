//! Prims, variants and properties as sets of fields.

use super::values::{Edit, Type, inlined};
use super::{Packer, Paths, Spec};
use crate::export::usd::layer::{Attribute, Layer, Prim, Property, Specifier, VariantSet};
use crate::export::usd::value::{Dictionary, Value};
use std::io;

/// Kinds of specs, by Pixar's numbers.
const ATTRIBUTE: i32 = 1;
const PRIM: i32 = 6;
const PSEUDO_ROOT: i32 = 7;
const RELATIONSHIP: i32 = 8;
const VARIANT: i32 = 10;
const VARIANT_SET: i32 = 11;

/// Variability of what has one value for all times.
const UNIFORM: u32 = 1;

impl Packer<'_> {
    pub(super) fn layer(&mut self, layer: &Layer<'_>) -> io::Result<()> {
        let mut fields = Vec::new();
        self.text_field(&mut fields, "documentation", &layer.documentation)?;
        self.dictionary_field(&mut fields, "customLayerData", &layer.custom_data)?;
        let values = [
            ("defaultPrim", Value::token(&layer.default_prim)),
            ("metersPerUnit", Value::Double(layer.meters_per_unit)),
            ("upAxis", Value::token(layer.up_axis)),
        ];
        for (name, value) in &values {
            self.value_field(&mut fields, name, value)?;
        }
        let names = layer.prims.iter().map(|prim| prim.name.as_str());
        self.names_field(&mut fields, "primChildren", names)?;
        self.spec(Paths::ROOT, PSEUDO_ROOT, fields);
        for prim in &layer.prims {
            let path = self.paths.prim(Paths::ROOT, &prim.name, &mut self.tables);
            self.prim(path, PRIM, prim)?;
        }
        Ok(())
    }

    /// A prim or a variant.
    fn prim(&mut self, path: u32, kind: i32, prim: &Prim<'_>) -> io::Result<()> {
        let mut fields = Vec::new();
        let specifier = if kind == VARIANT {
            Specifier::Over
        } else {
            prim.specifier
        };
        let word = inlined(Type::Specifier, specifier_number(specifier));
        fields.push(self.tables.field("specifier", word));
        if !prim.type_name.is_empty() {
            self.value_field(&mut fields, "typeName", &Value::token(prim.type_name))?;
        }
        if !prim.kind.is_empty() {
            self.value_field(&mut fields, "kind", &Value::token(prim.kind))?;
        }
        self.text_field(&mut fields, "documentation", &prim.documentation)?;
        self.prim_lists(&mut fields, prim)?;
        self.dictionary_field(&mut fields, "assetInfo", &prim.asset_info)?;
        self.dictionary_field(&mut fields, "customData", &prim.custom_data)?;
        let properties = prim.properties.iter().map(Property::name);
        self.names_field(&mut fields, "properties", properties)?;
        let children = prim.children.iter().map(|child| child.name.as_str());
        self.names_field(&mut fields, "primChildren", children)?;
        self.spec(path, kind, fields);
        for property in &prim.properties {
            let path = self.paths.property(path, property.name(), &mut self.tables);
            self.property(path, property)?;
        }
        for child in &prim.children {
            let path = self.paths.prim(path, &child.name, &mut self.tables);
            self.prim(path, PRIM, child)?;
        }
        for set in &prim.variant_sets {
            self.variant_set(path, set)?;
        }
        Ok(())
    }

    fn prim_lists(&mut self, fields: &mut Vec<u32>, prim: &Prim<'_>) -> io::Result<()> {
        if !prim.api_schemas.is_empty() {
            let tokens: Vec<u32> = (prim.api_schemas.iter())
                .map(|t| self.tables.token(t))
                .collect();
            let word = self
                .values
                .list_edit(Type::TokenListOp, Edit::Prepend, &tokens)?;
            fields.push(self.tables.field("apiSchemas", word));
        }
        if let Some(asset) = &prim.payload {
            let word = self.values.payload(asset, &mut self.tables)?;
            fields.push(self.tables.field("payload", word));
        }
        if !prim.selections.is_empty() {
            let word = self.values.selections(&prim.selections, &mut self.tables)?;
            fields.push(self.tables.field("variantSelection", word));
        }
        if !prim.variant_sets.is_empty() {
            let names: Vec<u32> = (prim.variant_sets.iter())
                .map(|set| self.tables.string(&set.name))
                .collect();
            let word = self
                .values
                .list_edit(Type::StringListOp, Edit::Prepend, &names)?;
            fields.push(self.tables.field("variantSetNames", word));
            let names = prim.variant_sets.iter().map(|set| set.name.as_str());
            self.names_field(fields, "variantSetChildren", names)?;
        }
        Ok(())
    }

    fn variant_set(&mut self, prim: u32, set: &VariantSet<'_>) -> io::Result<()> {
        let element = format!("{{{}=}}", set.name);
        let path = self.paths.prim(prim, &element, &mut self.tables);
        let mut fields = Vec::new();
        let names = set.variants.iter().map(|variant| variant.name.as_str());
        self.names_field(&mut fields, "variantChildren", names)?;
        self.spec(path, VARIANT_SET, fields);
        for variant in &set.variants {
            let element = format!("{{{}={}}}", set.name, variant.name);
            let path = self.paths.prim(prim, &element, &mut self.tables);
            self.prim(path, VARIANT, variant)?;
        }
        Ok(())
    }

    fn property(&mut self, path: u32, property: &Property<'_>) -> io::Result<()> {
        match property {
            Property::Attribute(attribute) => self.attribute(path, attribute),
            Property::Relationship { target, .. } => {
                let target = self.paths.absolute(target, &mut self.tables);
                let word = self
                    .values
                    .list_edit(Type::PathListOp, Edit::Explicit, &[target])?;
                let uniform = inlined(Type::Variability, UNIFORM);
                let fields = vec![
                    self.tables.field("variability", uniform),
                    self.tables.field("targetPaths", word),
                ];
                self.spec(path, RELATIONSHIP, fields);
                Ok(())
            }
        }
    }

    fn attribute(&mut self, path: u32, attribute: &Attribute<'_>) -> io::Result<()> {
        let mut fields = Vec::new();
        self.value_field(&mut fields, "typeName", &Value::token(attribute.type_name))?;
        if attribute.custom {
            self.value_field(&mut fields, "custom", &Value::Bool(true))?;
        }
        if attribute.uniform {
            let word = inlined(Type::Variability, UNIFORM);
            fields.push(self.tables.field("variability", word));
        }
        if !attribute.interpolation.is_empty() {
            let value = Value::token(attribute.interpolation);
            self.value_field(&mut fields, "interpolation", &value)?;
        }
        if let Some(value) = &attribute.value {
            self.value_field(&mut fields, "default", value)?;
        }
        if let Some(source) = &attribute.connection {
            let source = self.paths.absolute(source, &mut self.tables);
            let word = self
                .values
                .list_edit(Type::PathListOp, Edit::Explicit, &[source])?;
            fields.push(self.tables.field("connectionPaths", word));
        }
        self.spec(path, ATTRIBUTE, fields);
        Ok(())
    }

    fn spec(&mut self, path: u32, kind: i32, fields: Vec<u32>) {
        let fields = self.tables.field_set(fields);
        self.specs.push(Spec { path, fields, kind });
    }

    fn value_field(
        &mut self,
        fields: &mut Vec<u32>,
        name: &str,
        value: &Value<'_>,
    ) -> io::Result<()> {
        let word = self.values.value(value, &mut self.tables)?;
        fields.push(self.tables.field(name, word));
        Ok(())
    }

    fn text_field(&mut self, fields: &mut Vec<u32>, name: &str, text: &str) -> io::Result<()> {
        if text.is_empty() {
            return Ok(());
        }
        self.value_field(fields, name, &Value::string(text))
    }

    fn dictionary_field(
        &mut self,
        fields: &mut Vec<u32>,
        name: &str,
        dictionary: &Dictionary<'_>,
    ) -> io::Result<()> {
        if dictionary.is_empty() {
            return Ok(());
        }
        let word = self.values.dictionary(dictionary, &mut self.tables)?;
        fields.push(self.tables.field(name, word));
        Ok(())
    }

    fn names_field<'n>(
        &mut self,
        fields: &mut Vec<u32>,
        field: &str,
        names: impl Iterator<Item = &'n str>,
    ) -> io::Result<()> {
        let tokens: Vec<u32> = names.map(|name| self.tables.token(name)).collect();
        if tokens.is_empty() {
            return Ok(());
        }
        let word = self.values.token_vector(&tokens)?;
        fields.push(self.tables.field(field, word));
        Ok(())
    }
}

fn specifier_number(specifier: Specifier) -> u32 {
    match specifier {
        Specifier::Def => 0,
        Specifier::Over => 1,
    }
}
