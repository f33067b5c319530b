//! The name of a bake: a hash of everything that decides its bits.

use super::Settings;
use crate::species::Structure;
use sha2::{Digest, Sha256};

/// Raised whenever geometry, photon walk or tally change what comes out between two versions.
const FORMAT: u32 = 4;

/// SHA-256, in hexadecimal, of structure, settings, format and program version.
pub fn content_hash(structure: &Structure, settings: &Settings) -> String {
    // Plain structs of finite numbers always serialize; the debug form is as unique.
    let text = serde_json::to_string(&(FORMAT, env!("CARGO_PKG_VERSION"), structure, settings))
        .unwrap_or_else(|_| format!("{FORMAT} {structure:?} {settings:?}"));
    Sha256::digest(text.as_bytes())
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}
