//! The name of a bake: a hash of everything that decides its bits.

use super::Settings;
use crate::hex::hex_digest;
use crate::species::Structure;
use serde_json::Value;

/// Raised whenever geometry, photon walk, tally or filter change what comes out between two versions.
const FORMAT: u32 = 12;

/// Lists longer than this are named by their hash: a mesh has millions of corners.
const LONGEST_LIST: usize = 64;

/// SHA-256, in hexadecimal, of structure, settings, format and program version.
pub fn content_hash(structure: &Structure, settings: &Settings) -> String {
    Recipe::content(&Recipe::new(structure, settings).hash(), settings.photons)
}

/// Everything that decides the bits of a bake but its number of photons. Two bakes with equal
/// recipes fly the same photons, one perhaps more of them.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub(super) struct Recipe(pub(super) Value);

impl Recipe {
    pub(super) fn new(structure: &Structure, settings: &Settings) -> Self {
        let settings = Settings {
            photons: 0,
            ..settings.clone()
        };
        Self(serde_json::json!({
            "format": FORMAT,
            "program": env!("CARGO_PKG_VERSION"),
            "structure": short(plain(structure)),
            "settings": plain(&settings),
        }))
    }

    /// SHA-256 in hexadecimal.
    pub(super) fn hash(&self) -> String {
        hex_digest(self.0.to_string().as_bytes())
    }

    /// The content hash of a table: the hash of its recipe, and how many photons.
    pub(super) fn content(recipe_hash: &str, photons: u64) -> String {
        hex_digest(format!("{recipe_hash} {photons}").as_bytes())
    }
}

fn plain(value: &(impl serde::Serialize + std::fmt::Debug)) -> Value {
    // Plain structs of finite numbers always serialize; the debug form is as unique.
    serde_json::to_value(value).unwrap_or_else(|_| Value::String(format!("{value:?}")))
}

/// Long lists replaced by their hashes.
fn short(value: Value) -> Value {
    match value {
        Value::Array(list) if list.len() > LONGEST_LIST => {
            let text = Value::Array(list).to_string();
            Value::String(format!("sha256 {}", hex_digest(text.as_bytes())))
        }
        Value::Array(list) => Value::Array(list.into_iter().map(short).collect()),
        Value::Object(map) => Value::Object(map.into_iter().map(|(k, v)| (k, short(v))).collect()),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables without azimuths keep their names: what averages is not written down.
    #[test]
    fn azimuths_are_named_where_there_are_several() {
        let name = |azimuths| {
            let settings = Settings {
                azimuths,
                ..Settings::cone()
            };
            Recipe::new(&Structure::default(), &settings).0["settings"].clone()
        };
        assert!(name(1).get("azimuths").is_none());
        assert_eq!(name(8)["azimuths"], 8);
    }
}
