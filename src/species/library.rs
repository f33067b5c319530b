//! The built-in species, part of the program.

/// Id and file text of every built-in species, in the order of the library.
pub const LIBRARY: [(&str, &str); 5] = [
    (
        "red-fox",
        include_str!("../../procedural/species/red-fox.toml"),
    ),
    (
        "polar-bear",
        include_str!("../../procedural/species/polar-bear.toml"),
    ),
    ("mink", include_str!("../../procedural/species/mink.toml")),
    ("human", include_str!("../../procedural/species/human.toml")),
    (
        "glass-cylinder",
        include_str!("../../procedural/species/glass-cylinder.toml"),
    ),
];

/// The ids of the built-in species.
pub fn ids() -> impl Iterator<Item = &'static str> {
    LIBRARY.iter().map(|(id, _)| *id)
}

/// The file text of a built-in species.
pub(super) fn text_of(id: &str) -> Option<&'static str> {
    LIBRARY
        .iter()
        .find(|(known, _)| *known == id)
        .map(|(_, text)| *text)
}
