//! The built-in coats, part of the program.

macro_rules! coats {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../../procedural/coats/", $name, ".toml")))),*]
    };
}

/// Name and file text of every built-in coat.
pub const COAT_LIBRARY: [(&str, &str); 9] = coats![
    "tabby",
    "leopard",
    "zebra",
    "badger",
    "fox",
    "cow",
    "countershaded",
    "siamese",
    "tortoiseshell",
];

/// The names of the built-in coats.
pub fn coat_names() -> impl Iterator<Item = &'static str> {
    COAT_LIBRARY.iter().map(|(name, _)| *name)
}
