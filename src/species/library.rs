//! The built-in species, part of the program.

/// One line a species: its id, which is the name of its file.
macro_rules! library {
    ($($id:literal)*) => {
        &[$(($id, include_str!(concat!("../../procedural/species/", $id, ".toml")))),*]
    };
}

/// Id and file text of every built-in species, family by family.
#[rustfmt::skip]
pub const LIBRARY: &[(&str, &str)] = library![
    // Cats: Felidae
    "cat"
    "lynx"
    "bobcat"

    // Dogs and foxes: Canidae
    "red-fox"
    "arctic-fox"
    "wolf"
    "dog"

    // Raccoons: Procyonidae
    "raccoon"

    // Weasels and otters: Mustelidae
    "mink"
    "river-otter"
    "sea-otter"
    "badger"

    // Bears: Ursidae
    "brown-bear"
    "polar-bear"

    // Seals: Phocidae, Otariidae
    "harbor-seal"
    "fur-seal"

    // Rabbits and hares: Leporidae
    "rabbit"
    "hare"

    // Rodents: Muridae, Sciuridae, Chinchillidae, Castoridae
    "mouse"
    "rat"
    "squirrel"
    "chinchilla"
    "beaver"

    // Deer: Cervidae
    "deer"
    "roe-deer"
    "caribou"
    "moose"

    // Cattle, sheep and goats: Bovidae
    "cow"
    "sheep"
    "cashmere-goat"
    "mohair"

    // Camels: Camelidae
    "alpaca"

    // Horses: Equidae
    "horse"

    // Bats: Vespertilionidae
    "bat"

    // People: Hominidae
    "human"

    // Made-up furs
    "ember-lynx"
    "glass-moth"

    // No animals
    "glass-cylinder"
];

/// The ids of the built-in species.
pub fn ids() -> impl Iterator<Item = &'static str> {
    LIBRARY.iter().map(|(id, _)| *id)
}
