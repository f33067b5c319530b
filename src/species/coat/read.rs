//! Reading a coat recipe: the same two passes as for species files.

use super::fields::COAT;
use super::{
    CoatLayer, CoatLimit, CoatPattern, CoatRecipe, CoatZone, Extent, Join, Lay, Side, Turing,
    library,
};
use crate::skin::Landmark;
use crate::species::build::{Reader, number, tables};
use crate::species::check::{Checked, Value};
use crate::species::error::{Problems, SpeciesError, SpeciesErrors, closest, suggestion};
use crate::species::model::PigmentBand;
use crate::species::recipe::{self, need, picture, text, word};
use std::path::Path;

/// The coat of that name, or in the file at that path if it ends in `.toml`; and the text of it.
///
/// # Errors
/// An unknown name, an unreadable file, or everything that is wrong with it.
pub(crate) fn coat_of(name: &str, folder: &Path) -> Result<(CoatRecipe, String), SpeciesError> {
    if !name.ends_with(".toml") {
        let known = library::COAT_LIBRARY.iter().find(|(id, _)| *id == name);
        let Some((id, text)) = known else {
            let names: Vec<&str> = library::coat_names().collect();
            let best = closest(name, names.iter().copied());
            return Err(SpeciesError::UnknownCoat {
                name: name.to_owned(),
                hint: suggestion(best, &names) + ", or the path of a .toml file",
            });
        };
        let recipe = parse(text, id, &format!("{id}.toml"))?;
        return Ok((recipe, (*text).to_owned()));
    }
    let path = folder.join(name);
    let text = recipe::read(&path)?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let recipe = parse(&text, &stem, &path.display().to_string())?;
    Ok((recipe, text))
}

/// Reads the text of a recipe.
///
/// * `file`: for messages; its folder is where maps are looked for.
fn parse(text: &str, name: &str, file: &str) -> Result<CoatRecipe, SpeciesErrors> {
    let folder = Path::new(file).parent().unwrap_or(Path::new(""));
    recipe::parse(text, file, &COAT, |root, problems| {
        build(root, name, folder, problems)
    })
}

/// Builds a checked recipe; `None` only if a problem was reported.
fn build(root: &Checked, name: &str, folder: &Path, problems: &mut Problems) -> Option<CoatRecipe> {
    let mut zones: Vec<CoatZone> = Vec::new();
    for table in tables(root, "zones").unwrap_or_default() {
        let mut bands = |key: &str| -> Option<Vec<PigmentBand>> {
            match table.get(key) {
                Some(_) => Reader::new(problems, folder).bands(table, key),
                None => Some(Vec::new()),
            }
        };
        let (guard, under) = (bands("guard"), bands("under"));
        let zone_name = text(table, "name")?;
        if zone_name == "own" || zones.iter().any(|z| z.name == zone_name) {
            let message = format!("`{}` is \"{zone_name}\"", table.path_of("name"));
            let hint = "every zone has a name of its own, and \"own\" is the species' pigment";
            problems.push(&table.place, message, Some(hint.to_owned()));
        }
        zones.push(CoatZone {
            name: zone_name,
            // What was refused is a problem already: go on, to find all of them.
            guard: guard.unwrap_or_default(),
            under: under.unwrap_or_default(),
            hair: number(table, "hair").unwrap_or(1.0),
        });
    }
    let mut layers = Vec::new();
    for table in tables(root, "layers").unwrap_or_default() {
        layers.extend(layer(table, &zones, folder, problems));
    }
    Some(CoatRecipe {
        name: name.to_owned(),
        summary: text(root, "summary")?,
        body_mm: number(root, "body_mm").unwrap_or(0.0),
        hair: number(root, "hair").unwrap_or(1.0),
        zones,
        layers,
    })
}

fn layer(
    table: &Checked,
    zones: &[CoatZone],
    folder: &Path,
    problems: &mut Problems,
) -> Option<CoatLayer> {
    let pattern = pattern(table, folder, problems);
    let wanted = text(table, "zone")?;
    let zone = match zones.iter().position(|z| z.name == wanted) {
        _ if wanted == "own" => 0,
        Some(index) => index + 1,
        None => {
            let names = zones.iter().map(|z| z.name.as_str()).chain(["own"]);
            let names: Vec<&str> = names.collect();
            let hint = suggestion(closest(&wanted, names.iter().copied()), &names);
            let message = format!("`{}` is \"{wanted}\", no zone", table.path_of("zone"));
            let place = table.get("zone").map_or(&table.place, |i| &i.place);
            problems.push(place, message, Some(hint));
            0
        }
    };
    let mut limits = Vec::new();
    for limit in tables(table, "where").unwrap_or_default() {
        limits.push(CoatLimit {
            extent: match extent(limit, problems) {
                Some(extent) => extent,
                None => continue,
            },
            join: match word(limit, "join") {
                Some("or") => Join::Or,
                Some("not") => Join::Not,
                _ => Join::And,
            },
        });
    }
    Some(CoatLayer {
        zone,
        pattern: pattern?,
        strength: number(table, "strength").unwrap_or(1.0),
        edge: number(table, "edge").unwrap_or(0.25),
        seed: number(table, "seed").unwrap_or(0.0) as u64,
        limits,
    })
}

fn pattern(table: &Checked, folder: &Path, problems: &mut Problems) -> Option<CoatPattern> {
    let fine = number(table, "fine").unwrap_or(1.0);
    let spots = |wavelength_mm: f64| Turing {
        wavelength_mm,
        balance: -0.75,
        order: 0.0,
        lay: Lay::Across,
        cover: number(table, "cover"),
        fine,
    };
    Some(match word(table, "pattern")? {
        "turing" => CoatPattern::Turing(Turing {
            balance: number(table, "balance").unwrap_or(0.0),
            order: number(table, "order").unwrap_or(0.0),
            lay: match word(table, "lay") {
                Some("along") => Lay::Along,
                _ => Lay::Across,
            },
            ..spots(need(table, "wavelength_mm", problems)?)
        }),
        kind @ ("rosettes" | "rosette-centers") => CoatPattern::Rosettes {
            spots: spots(need(table, "wavelength_mm", problems)?),
            inside: kind == "rosette-centers",
        },
        "patches" => CoatPattern::Patches {
            size_mm: need(table, "size_mm", problems)?,
            cover: number(table, "cover").unwrap_or(0.5),
            rough: number(table, "rough").unwrap_or(0.4),
        },
        "map" => CoatPattern::Map {
            picture: picture(table, "srgb", folder, problems)?,
        },
        _ => CoatPattern::Plain,
    })
}

fn extent(table: &Checked, problems: &mut Problems) -> Option<Extent> {
    match (word(table, "near"), word(table, "facing")) {
        (Some(near), None) => Some(Extent::Near {
            landmark: Landmark::ALL.into_iter().find(|l| l.name() == near)?,
            within_mm: need(table, "within_mm", problems)?,
            soft_mm: number(table, "soft_mm").unwrap_or(10.0),
            ragged_mm: number(table, "ragged_mm").unwrap_or(0.0),
        }),
        (None, Some(facing)) => Some(Extent::Facing {
            side: match facing {
                "up" => Side::Up,
                "down" => Side::Down,
                "front" => Side::Front,
                _ => Side::Back,
            },
            from: number(table, "from").unwrap_or(0.0),
            to: number(table, "to").unwrap_or(0.6),
        }),
        _ => {
            let refused = |key| {
                table
                    .get(key)
                    .is_some_and(|i| matches!(i.value, Value::Refused))
            };
            if !refused("near") && !refused("facing") {
                let message = format!("`{}` says neither or both of two things", table.path);
                let hint = "a limit is either `near` a landmark or `facing` a direction";
                problems.push(&table.place, message, Some(hint.to_owned()));
            }
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fields::{COATS, LANDMARKS};
    use super::*;

    #[test]
    fn built_in_coats_are_whole_and_listed() {
        let listed: Vec<&str> = COATS.iter().map(|c| c.name).collect();
        assert_eq!(listed, library::coat_names().collect::<Vec<_>>());
        for name in listed {
            let (recipe, _) = coat_of(name, Path::new("")).unwrap();
            // Every zone is painted somewhere.
            for zone in 1..=recipe.zones.len() {
                assert!(recipe.layers.iter().any(|l| l.zone == zone), "{name}");
            }
        }
        let landmarks: Vec<&str> = LANDMARKS.iter().map(|c| c.name).collect();
        assert_eq!(landmarks, Landmark::ALL.map(Landmark::name));
    }

    #[test]
    fn everything_wrong_is_said_at_its_place() {
        let text = r#"
summary = "wrong"
[[zones]]
name = "own"
[[zones]]
name = "dark"
[[zones.guard]]
eumelanin = 600
pheomelanin = 0
estimate = "too much"
[[layers]]
zone = "drak"
pattern = "turing"
[[layers]]
zone = "dark"
pattern = "map"
file = "missing.png"
[[layers]]
zone = "dark"
pattern = "plain"
seed = 2.5
size_mm = 3
[[layers.where]]
near = "nose"
facing = "up"
within_mm = 3
"#;
        let said = parse(text, "wrong", "wrong.toml").unwrap_err().to_string();
        for part in [
            "`zones.0.name` is \"own\"",
            "`zones.1.guard.0.eumelanin` is 600",
            "`layers.0.zone` is \"drak\", no zone (did you mean `dark`?)",
            "`layers.0.wavelength_mm` is missing",
            "missing.png",
            "`layers.2.size_mm` has no meaning with pattern \"plain\"",
            "`layers.2.seed` is 2.5, expected a whole number from 0 to",
            "`layers.2.where.0` says",
        ] {
            assert!(said.contains(part), "{part} in\n{said}");
        }
        let unknown = coat_of("tabbi", Path::new("")).unwrap_err().to_string();
        assert!(unknown.contains("did you mean `tabby`"), "{unknown}");
    }
}
