//! The built-in recipes, part of the program.

macro_rules! recipes {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../../procedural/patterns/", $name, ".toml")))),*]
    };
}

/// Name and file text of every built-in recipe, in the order of the field guides: one scale round,
/// petals, tiles, waves, chevrons, ragged margins.
pub const PATTERN_LIBRARY: [(&str, &str); 17] = recipes![
    "coronal",
    "coronal-dentate",
    "broad-petal",
    "diamond-petal",
    "lanceolate-petal",
    "otter-fin",
    "pectinate",
    "mosaic",
    "mosaic-rippled",
    "regular-wave",
    "irregular-wave",
    "close-wave",
    "single-chevron",
    "double-chevron",
    "human-imbricate",
    "torn-paper",
    "squat-polygon",
];

/// The names of the built-in recipes.
pub fn pattern_names() -> impl Iterator<Item = &'static str> {
    PATTERN_LIBRARY.iter().map(|(name, _)| *name)
}
