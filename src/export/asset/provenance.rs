//! What a file says of where it comes from.

use super::Parts;
use crate::PROGRAM;
use crate::export::usd::{Attribute, Dictionary, Prim, Value};
use crate::groom::Account;
use crate::hex::hex;
use sha2::{Digest as _, Sha256};

/// Name of a species as an identifier.
pub fn identifier(name: &str) -> String {
    let mut out: String = name
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    if out.is_empty() || out.starts_with(|c: char| c.is_ascii_digit()) {
        out.insert(0, '_');
    }
    out
}

/// First half of the hash of a species file.
fn hash(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    hex(&digest[..8])
}

/// `assetInfo` of the root.
pub(super) fn asset_info<'a>(parts: &Parts<'_>, file: &str) -> Dictionary<'a> {
    vec![
        ("identifier".to_owned(), Value::Asset(format!("./{file}"))),
        ("name".to_owned(), Value::string(&parts.species.id)),
        (
            "version".to_owned(),
            Value::string(hash(&parts.species.text)),
        ),
    ]
}

/// Everything that makes the same groom again.
pub(super) fn recipe<'a>(parts: &Parts<'_>) -> Dictionary<'a> {
    let species = parts.species;
    let accounts = parts.groom.classes.iter().zip(&parts.groom.accounts);
    let accounts = accounts.map(|(class, account)| (identifier(class), told(account)));
    let mut entries = vec![
        ("follicles", sorted(accounts)),
        ("program", Value::string(PROGRAM)),
        ("seed", Value::string(parts.seed.to_string())),
        ("skin", Value::string(&parts.skin.name)),
        ("species", Value::string(&species.id)),
        ("species_sha256_64", Value::string(hash(&species.text))),
        ("species_text", Value::string(&species.text)),
        ("strands", Value::Int(parts.groom.strands() as i32)),
    ];
    if !parts.coats.is_empty() {
        let names: Vec<&str> = parts.coats.iter().map(|coat| coat.name).collect();
        entries.push(("coats", Value::string(names.join(" "))));
    }
    let entries = entries.into_iter().map(|(k, v)| (k.to_owned(), v));
    vec![("vair".to_owned(), sorted(entries))]
}

/// How many hairs of a class were asked for, how many grew, and why others did not or not as asked.
fn told<'a>(account: &Account) -> Value<'a> {
    let counts = [("asked", account.asked), ("grown", account.grown())];
    let counts = counts.into_iter().chain(account.reasons());
    sorted(counts.map(|(name, count)| (name.to_owned(), Value::Int(count as i32))))
}

/// A dictionary in the order in which USD keeps it.
fn sorted<'a>(entries: impl Iterator<Item = (String, Value<'a>)>) -> Value<'a> {
    let mut entries: Dictionary<'_> = entries.collect();
    entries.sort_by(|a, b| a.0.cmp(&b.0));
    Value::Dictionary(entries)
}

/// What Blender shows as custom properties.
pub(super) fn user_properties(prim: &mut Prim<'_>, properties: &[(&str, Value<'static>)]) {
    for (name, value) in properties {
        prim.add(Attribute {
            name: format!("userProperties:vair_{name}"),
            type_name: value.type_name(),
            custom: true,
            value: Some(value.clone()),
            ..Attribute::default()
        });
    }
}
