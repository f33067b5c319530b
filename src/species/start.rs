//! A new species file from a file that is there.

use super::error::Place;
use super::tree::{self, Data};
use std::ops::Range;

/// Longest id of a species.
const LONGEST_ID: usize = 60;

/// Whether a species may be called so: lower-case letters and digits in words parted by hyphens.
pub fn is_id(name: &str) -> bool {
    let word = |w: &str| {
        !w.is_empty()
            && w.chars()
                .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
    };
    name.len() <= LONGEST_ID && name.split('-').all(word)
}

/// The text of a species file `id` that says the same as `text`, a valid file, which is the species
/// `from`: under a name of its own, without the synonyms, with the next steps at its head.
pub fn start_from(text: &str, from: &str, id: &str) -> String {
    let name = common_name(id);
    let mut cuts: Vec<(Range<usize>, String)> = Vec::new();
    for entry in &tree::parse(text).unwrap_or_default().entries {
        let (Place::File(key), Place::File(value)) = (&entry.key_place, &entry.node.place) else {
            continue;
        };
        match (entry.key.as_str(), &entry.node.data) {
            ("name", Data::Text(_)) => cuts.push((value.clone(), format!("\"{name}\""))),
            ("synonyms", Data::Array(_)) => cuts.push((key.start..value.end, String::new())),
            _ => {}
        }
    }
    cuts.sort_by_key(|(range, _)| std::cmp::Reverse(range.start));
    let mut body = text.to_owned();
    for (range, put) in cuts {
        // A key that goes takes its line with it.
        let end = match put.is_empty() && body[range.end..].starts_with('\n') {
            true => range.end + 1,
            false => range.end,
        };
        body.replace_range(range.start..end, &put);
    }
    // The comment at the head is that of the other animal.
    let head = |line: &&str| line.is_empty() || line.starts_with('#');
    let body: Vec<&str> = body.lines().skip_while(head).collect();
    format!(
        "#:schema species.schema.json\n\
         # {name}, started from {from}.\n\
         #\n\
         #   vair schema species > species.schema.json   editors complete and check this file\n\
         #   vair species check {id}.toml   everything that is wrong with it, at once\n\
         #   vair render {id}.toml -o {id}.png   a still of it\n\
         #\n\
         # A number that you change is no longer that of its source: say where yours comes from.\n\
         \n{}\n",
        body.join("\n")
    )
}

/// `my-cat` as `My cat`.
fn common_name(id: &str) -> String {
    let spaced = id.replace('-', " ");
    let mut letters = spaced.chars();
    match letters.next() {
        Some(first) => first.to_uppercase().chain(letters).collect(),
        None => spaced,
    }
}
