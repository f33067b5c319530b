//! `--set key.path=value`: changes a document before it is checked, so that an override meets the
//! same rules as the file.

use super::check::{class_names, join};
use super::error::{Place, Problems, closest, printable, suggestion};
use super::fields;
use super::shape::{CITATION, Kind, Shape};
use super::tree::{Data, Node, Table, parse_override};

/// Applies overrides in order; what cannot be applied is reported.
pub(crate) fn apply(root: &mut Table, overrides: &[String], problems: &mut Problems) {
    for (index, text) in overrides.iter().enumerate() {
        if let Err(refusal) = apply_one(root, text, index) {
            problems.push(&Place::Set(index), refusal.message, refusal.hint);
        }
    }
}

/// The overrides as comments, to stand at the end of the file's text.
pub(crate) fn as_comments(overrides: &[String]) -> String {
    let line = |text: &String| format!("# --set {}\n", printable(text));
    if overrides.is_empty() {
        String::new()
    } else {
        format!(
            "\n# Overrides:\n{}",
            overrides.iter().map(line).collect::<String>()
        )
    }
}

struct Refusal {
    message: String,
    hint: Option<String>,
}

fn refuse<T>(message: String, hint: impl Into<Option<String>>) -> Result<T, Refusal> {
    Err(Refusal {
        message,
        hint: hint.into(),
    })
}

fn apply_one(root: &mut Table, text: &str, index: usize) -> Result<(), Refusal> {
    let Some((path, value)) = text.split_once('=') else {
        let hint = "for example --set structure.ior=1.55".to_owned();
        return refuse("no `=`: expected key.path=value".to_owned(), hint);
    };
    let keys: Vec<&str> = path.split('.').map(str::trim).collect();
    let classes = class_names(root);
    let target = Target {
        shape: &fields::SPECIES,
        classes: &classes,
        path: "",
    };
    target.set(root, &keys, &parse_override(value.trim(), index))
}

/// The table that an override has reached.
struct Target<'a> {
    shape: &'static Shape,
    classes: &'a [String],
    path: &'a str,
}

impl Target<'_> {
    /// Sets the value at `keys`, seen from here; never empty.
    fn set(&self, table: &mut Table, keys: &[&str], value: &Node) -> Result<(), Refusal> {
        let Some((key, rest)) = keys.split_first() else {
            return Ok(());
        };
        let path = &join(self.path, key);
        if let Some(field) = self.shape.field(key) {
            return match &field.kind {
                Kind::Table(shape) => set_table(table, key, shape, path, rest, value),
                Kind::Tables(shape, _) => set_item(table, key, shape, path, rest, value),
                Kind::Numbers(..) | Kind::Color(_) => set_number(table, key, path, rest, value),
                Kind::Sources | Kind::Words(_) if rest.len() == 1 => {
                    let mut inner = value.clone();
                    if let Some(Data::Table(old)) = table.get(key).map(|n| &n.data) {
                        let mut old = old.clone();
                        old.put(rest[0], value.clone());
                        inner.data = Data::Table(old);
                    }
                    table.put(key, inner);
                    Ok(())
                }
                _ => set_leaf(table, key, path, rest, value),
            };
        }
        if self.classes.iter().any(|c| c == key) {
            return set_table(table, key, &fields::CLASS, path, rest, value);
        }
        if self.shape.cited && CITATION.contains(key) {
            return set_leaf(table, key, path, rest, value);
        }
        let mut known: Vec<&str> = self.shape.keys().collect();
        known.extend(self.classes.iter().map(String::as_str));
        let hint = suggestion(closest(key, known.iter().copied()), &known);
        refuse(format!("unknown key `{path}`"), hint)
    }
}

fn set_table(
    table: &mut Table,
    key: &str,
    shape: &'static Shape,
    path: &str,
    rest: &[&str],
    value: &Node,
) -> Result<(), Refusal> {
    if rest.is_empty() {
        table.put(key, value.clone());
        return Ok(());
    }
    if table.get(key).is_none() {
        let empty = Data::Table(Table::default());
        table.put(
            key,
            Node {
                place: value.place.clone(),
                data: empty,
            },
        );
    }
    match table.get_mut(key).map(|n| &mut n.data) {
        Some(Data::Table(inner)) => inside(inner, shape, path, rest, value),
        // The file is wrong here and the check says so.
        _ => Ok(()),
    }
}

fn set_item(
    table: &mut Table,
    key: &str,
    shape: &'static Shape,
    path: &str,
    rest: &[&str],
    value: &Node,
) -> Result<(), Refusal> {
    let Some((index, rest)) = rest.split_first() else {
        table.put(key, value.clone());
        return Ok(());
    };
    let Some(Data::Array(items)) = table.get_mut(key).map(|n| &mut n.data) else {
        return refuse(format!("there is no list `{path}` in the file"), None);
    };
    let item = item_at(items, index, path)?;
    if rest.is_empty() {
        *item = value.clone();
        return Ok(());
    }
    match &mut item.data {
        Data::Table(inner) => inside(inner, shape, &format!("{path}.{index}"), rest, value),
        _ => Ok(()),
    }
}

fn set_number(
    table: &mut Table,
    key: &str,
    path: &str,
    rest: &[&str],
    value: &Node,
) -> Result<(), Refusal> {
    let [index] = rest else {
        return set_leaf(table, key, path, rest, value);
    };
    let list = match table.get_mut(key).map(|n| &mut n.data) {
        Some(Data::Table(inner)) => inner.get_mut("value").map(|n| &mut n.data),
        other => other,
    };
    let Some(Data::Array(items)) = list else {
        return refuse(format!("there is no list `{path}` in the file"), None);
    };
    *item_at(items, index, path)? = value.clone();
    Ok(())
}

/// Replaces a number, word or text, with its source: the new one does not come from there.
fn set_leaf(
    table: &mut Table,
    key: &str,
    path: &str,
    rest: &[&str],
    value: &Node,
) -> Result<(), Refusal> {
    if !matches!(rest, [] | ["value"]) {
        let hint = format!("write {path}=...");
        return refuse(
            format!("`{path}` is a single value, there is nothing below it"),
            hint,
        );
    }
    table.put(key, value.clone());
    Ok(())
}

fn inside(
    table: &mut Table,
    shape: &'static Shape,
    path: &str,
    rest: &[&str],
    value: &Node,
) -> Result<(), Refusal> {
    let target = Target {
        shape,
        classes: &[],
        path,
    };
    target.set(table, rest, value)
}

fn item_at<'a>(items: &'a mut [Node], index: &str, path: &str) -> Result<&'a mut Node, Refusal> {
    let last = items.len().saturating_sub(1);
    let place = index.parse::<usize>().ok().filter(|i| *i <= last);
    match place.and_then(|i| items.get_mut(i)) {
        Some(item) => Ok(item),
        None => refuse(
            format!("`{path}` has no item `{index}`"),
            format!("its items are counted from 0 to {last}: {path}.0"),
        ),
    }
}
