//! The text form of a layer, `.usda`.

use super::layer::{Attribute, Layer, Prim, Property, VariantSet};
use super::pieces;
use super::spelling::{asset, double, float, list, push, push_tuple, quoted, separated, tuple};
use super::value::{Array, Dictionary, Rows, Value};
use std::fmt::Write as _;
use std::io::{self, Write};

/// Writes a layer as text.
///
/// * `wrote`: hears how many bytes went out; an error of its own stops the writing.
pub(super) fn write(
    layer: &Layer<'_>,
    out: &mut dyn Write,
    wrote: &mut dyn FnMut(u64) -> io::Result<()>,
) -> io::Result<()> {
    let mut text = Text {
        out,
        wrote,
        depth: 0,
    };
    text.out.write_all(b"#usda 1.0\n")?;
    text.layer_metadata(layer)?;
    for prim in &layer.prims {
        text.out.write_all(b"\n")?;
        text.prim(prim)?;
    }
    Ok(())
}

struct Text<'o> {
    out: &'o mut dyn Write,
    wrote: &'o mut dyn FnMut(u64) -> io::Result<()>,
    depth: usize,
}

impl Text<'_> {
    fn line(&mut self, line: &str) -> io::Result<()> {
        self.begin()?;
        writeln!(self.out, "{line}")
    }

    fn begin(&mut self) -> io::Result<()> {
        write!(self.out, "{:1$}", "", 4 * self.depth)
    }

    fn open(&mut self, bracket: &str) -> io::Result<()> {
        self.line(bracket)?;
        self.depth += 1;
        Ok(())
    }

    fn close(&mut self, bracket: &str) -> io::Result<()> {
        self.depth -= 1;
        self.line(bracket)
    }

    fn layer_metadata(&mut self, layer: &Layer<'_>) -> io::Result<()> {
        self.open("(")?;
        self.documentation(&layer.documentation)?;
        self.dictionary("customLayerData", &layer.custom_data)?;
        self.line(&format!("defaultPrim = {}", quoted(&layer.default_prim)))?;
        self.line(&format!(
            "metersPerUnit = {}",
            double(layer.meters_per_unit)
        ))?;
        self.line(&format!("upAxis = {}", quoted(layer.up_axis)))?;
        self.close(")")
    }

    fn documentation(&mut self, text: &str) -> io::Result<()> {
        if text.is_empty() {
            return Ok(());
        }
        self.line(&format!("doc = {}", quoted(text)))
    }

    fn prim(&mut self, prim: &Prim<'_>) -> io::Result<()> {
        let space = if prim.type_name.is_empty() { "" } else { " " };
        self.begin()?;
        write!(
            self.out,
            "{}{space}{} {}",
            prim.specifier.name(),
            prim.type_name,
            quoted(&prim.name)
        )?;
        self.body(prim)
    }

    /// Metadata and content after a prim's or variant's name.
    fn body(&mut self, prim: &Prim<'_>) -> io::Result<()> {
        if has_metadata(prim) {
            self.out.write_all(b" (\n")?;
            self.depth += 1;
            self.prim_metadata(prim)?;
            self.close(")")?;
        } else {
            self.out.write_all(b"\n")?;
        }
        self.open("{")?;
        for property in &prim.properties {
            self.property(property)?;
        }
        for child in &prim.children {
            self.out.write_all(b"\n")?;
            self.prim(child)?;
        }
        for set in &prim.variant_sets {
            self.out.write_all(b"\n")?;
            self.variant_set(set)?;
        }
        self.close("}")
    }

    fn prim_metadata(&mut self, prim: &Prim<'_>) -> io::Result<()> {
        self.documentation(&prim.documentation)?;
        if !prim.kind.is_empty() {
            self.line(&format!("kind = {}", quoted(prim.kind)))?;
        }
        if !prim.api_schemas.is_empty() {
            self.line(&format!("prepend apiSchemas = {}", list(&prim.api_schemas)))?;
        }
        self.dictionary("assetInfo", &prim.asset_info)?;
        self.dictionary("customData", &prim.custom_data)?;
        if let Some(payload) = &prim.payload {
            self.line(&format!("prepend payload = {}", asset(payload)))?;
        }
        if !prim.variant_sets.is_empty() {
            let names: Vec<String> = prim.variant_sets.iter().map(|s| s.name.clone()).collect();
            self.line(&format!("prepend variantSets = {}", list(&names)))?;
        }
        if !prim.selections.is_empty() {
            self.open("variants = {")?;
            for (set, variant) in &prim.selections {
                self.line(&format!("string {set} = {}", quoted(variant)))?;
            }
            self.close("}")?;
        }
        Ok(())
    }

    fn variant_set(&mut self, set: &VariantSet<'_>) -> io::Result<()> {
        self.open(&format!("variantSet {} = {{", quoted(&set.name)))?;
        for variant in &set.variants {
            self.begin()?;
            write!(self.out, "{}", quoted(&variant.name))?;
            self.body(variant)?;
        }
        self.close("}")
    }

    fn dictionary(&mut self, name: &str, dictionary: &Dictionary<'_>) -> io::Result<()> {
        if dictionary.is_empty() {
            return Ok(());
        }
        self.open(&format!("{name} = {{"))?;
        for (key, value) in dictionary {
            if let Value::Dictionary(inner) = value {
                self.dictionary(&format!("dictionary {key}"), inner)?;
                continue;
            }
            self.begin()?;
            write!(self.out, "{} {key} = ", value.type_name())?;
            self.value(value)?;
            self.out.write_all(b"\n")?;
        }
        self.close("}")
    }

    fn property(&mut self, property: &Property<'_>) -> io::Result<()> {
        match property {
            Property::Attribute(attribute) => self.attribute(attribute),
            Property::Relationship { name, target } => {
                self.line(&format!("rel {name} = <{target}>"))
            }
        }
    }

    fn attribute(&mut self, attribute: &Attribute<'_>) -> io::Result<()> {
        let custom = if attribute.custom { "custom " } else { "" };
        let uniform = if attribute.uniform { "uniform " } else { "" };
        let declared = format!(
            "{custom}{uniform}{} {}",
            attribute.type_name, attribute.name
        );
        if attribute.value.is_some() || attribute.connection.is_none() {
            self.begin()?;
            self.out.write_all(declared.as_bytes())?;
            if let Some(value) = &attribute.value {
                self.out.write_all(b" = ")?;
                self.value(value)?;
            }
            if attribute.interpolation.is_empty() {
                self.out.write_all(b"\n")?;
            } else {
                self.out.write_all(b" (\n")?;
                self.depth += 1;
                let interpolation = quoted(attribute.interpolation);
                self.line(&format!("interpolation = {interpolation}"))?;
                self.close(")")?;
            }
        }
        if let Some(source) = &attribute.connection {
            self.line(&format!("{declared}.connect = <{source}>"))?;
        }
        Ok(())
    }

    fn value(&mut self, value: &Value<'_>) -> io::Result<()> {
        let text = match value {
            Value::Array(array) => return self.array(array),
            Value::Bool(value) => u8::from(*value).to_string(),
            Value::Int(value) => value.to_string(),
            Value::Float(value) => float(*value),
            Value::Double(value) => double(*value),
            Value::Vec2(value) => tuple(value),
            Value::Vec3(value) => tuple(value),
            Value::String(text) | Value::Token(text) => quoted(text),
            Value::Asset(path) => asset(path),
            Value::Strings(texts) => list(texts),
            // Dictionaries have a form of their own, see `dictionary`.
            Value::Dictionary(_) => String::new(),
        };
        self.out.write_all(text.as_bytes())
    }

    fn array(&mut self, array: &Array<'_>) -> io::Result<()> {
        let (out, wrote) = (&mut *self.out, &mut *self.wrote);
        out.write_all(b"[")?;
        match array {
            Array::Int(rows) => elements(rows, out, wrote, |v, text| {
                let _ = write!(text, "{v}");
            }),
            Array::Float(rows) => elements(rows, out, wrote, |v, text| push(*v, text)),
            Array::Vec2(rows) => elements(rows, out, wrote, |v, text| push_tuple(v, text)),
            Array::Vec3(rows) => elements(rows, out, wrote, |v, text| push_tuple(v, text)),
        }?;
        self.out.write_all(b"]")
    }
}

fn elements<T: Send>(
    rows: &Rows<'_, T>,
    out: &mut dyn Write,
    wrote: &mut dyn FnMut(u64) -> io::Result<()>,
    push: impl Fn(&T, &mut String) + Sync,
) -> io::Result<()> {
    let encode = |values: &[T], first, bytes: &mut _| separated(values, first, bytes, &push);
    pieces::write(rows, out, encode, wrote)
}

fn has_metadata(prim: &Prim<'_>) -> bool {
    !(prim.documentation.is_empty()
        && prim.kind.is_empty()
        && prim.api_schemas.is_empty()
        && prim.asset_info.is_empty()
        && prim.custom_data.is_empty()
        && prim.payload.is_none()
        && prim.variant_sets.is_empty()
        && prim.selections.is_empty())
}
