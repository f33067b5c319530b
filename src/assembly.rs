//! From a species to what a scene needs: the one library module that knows bake and renderer.

mod colors;
mod fitted;
mod looks;

pub use colors::match_colors;
pub use fitted::{Fitted, fitted};
pub use looks::looks;

use crate::bake::{BakeError, Baked, Cache, Settings, find_or_bake};
use crate::blame::Blame;
use crate::bsdf::{CoatPart, HairMaterial, TableSet, Zone};
use crate::groom::GroomError;
use crate::progress::{Cancel, Progress};
use crate::render::RenderError;
use crate::scene::SceneError;
use crate::species::{HairClass, PigmentBand, Section, Species, Station};
use crate::table::{Provenance, ScatterMaps, ScatterTable, TableError, TableFile, Undyed};

/// Materials that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum AssemblyError {
    /// No table.
    #[error(transparent)]
    Bake(#[from] BakeError),
    /// The table cannot be dyed.
    #[error(transparent)]
    Dye(#[from] TableError),
    /// A coat whose color was asked for does not grow.
    #[error("matching colors: {0}")]
    Groom(#[from] GroomError),
    /// It cannot be rendered.
    #[error("matching colors: {0}")]
    Scene(#[from] SceneError),
    /// Its picture cannot be made.
    #[error("matching colors: {0}")]
    Render(#[from] RenderError),
}

impl AssemblyError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::Bake(error) => error.blame(),
            Self::Dye(error) => error.blame(),
            Self::Groom(error) => error.blame(),
            Self::Scene(error) => error.blame(),
            Self::Render(error) => error.blame(),
        }
    }
}

/// What a table of a station says of where it comes from, before it is baked.
pub fn origin(species: &Species, class: &HairClass, station: &Station) -> Provenance {
    Provenance {
        species: species.id.clone(),
        class: class.name.clone(),
        station: station.at,
        species_text: species.text.clone(),
        ..Provenance::default()
    }
}

/// Finds or bakes the table of one station; three of them where its materials differ by color.
pub fn station_table(
    species: &Species,
    class: &HairClass,
    station: &Station,
    settings: &Settings,
    cache: Option<&Cache>,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Baked<Undyed>, BakeError> {
    find_or_bake(
        &station.structure,
        settings,
        origin(species, class, station),
        cache,
        progress,
        cancel,
    )
}

/// The settings for a station: only flat hairs have sides, and only those that are not twisted. The
/// photons are then those of each azimuth.
fn settings_of(station: &Station, settings: &Settings) -> Settings {
    let structure = &station.structure;
    let is_flat = structure.aspect >= LEAST_ASPECT || structure.section != Section::Ellipse;
    if settings.azimuths > 1 && (!is_flat || structure.twist_turns_per_cm != 0.0) {
        return Settings {
            azimuths: 1,
            ..settings.clone()
        };
    }
    Settings {
        photons: settings.photons.saturating_mul(settings.azimuths as u64),
        ..settings.clone()
    }
}

/// Sections less flat than this are taken as round where azimuths are asked for.
const LEAST_ASPECT: f64 = 1.2;

/// The materials of all hair classes: every station baked once, dyed for every pigment zone. Of several
/// azimuths, the photons of the settings are those of each; round and twisted fibers average over them.
/// Dyes are as strong as the species says: see [`match_colors`].
///
/// # Errors
/// A fiber that cannot be built or dyed, or [`BakeError::Stopped`]: a picture needs all its tables.
pub fn materials(
    species: &Species,
    settings: &Settings,
    cache: Option<&Cache>,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Vec<HairMaterial>, AssemblyError> {
    let tables = StationTables::new(species, &[], settings, cache, progress, cancel)?;
    Ok(tables.materials(species)?)
}

/// The table of every station of a species, to be dyed.
pub struct StationTables<'a> {
    /// Of each hair class.
    classes: Vec<Vec<Source<'a>>>,
}

/// Where a table is from.
enum Source<'a> {
    Given(&'a TableFile),
    Baked(Undyed),
}

impl Source<'_> {
    /// Dyed tables keep the pigment that they have.
    fn dye(&self, absorption_per_um: [f64; 3]) -> Result<ScatterMaps, TableError> {
        match self {
            Self::Given(TableFile::Scatter(maps)) => Ok(maps.clone()),
            Self::Given(TableFile::Structure(table)) => table.dye(absorption_per_um),
            Self::Baked(table) => table.dye(absorption_per_um),
        }
    }
}

impl<'a> StationTables<'a> {
    /// Finds or bakes them.
    ///
    /// * `given`: tables that are there already, as far as they reach: a station takes the table of its class
    ///   that was baked nearest to it, and only classes without any are baked.
    ///
    /// # Errors
    /// As for [`materials`], and a table of a class that the species does not have.
    pub fn new(
        species: &Species,
        given: &'a [TableFile],
        settings: &Settings,
        cache: Option<&Cache>,
        progress: &dyn Progress,
        cancel: &Cancel,
    ) -> Result<Self, AssemblyError> {
        for table in given {
            let class = &table.provenance().class;
            if !species.classes.iter().any(|c| c.name == *class) {
                let classes: Vec<&str> = species.classes.iter().map(|c| c.name.as_str()).collect();
                return Err(TableError::Request(format!(
                    "a table of the hair class {class:?} was given; {} has {}",
                    species.id,
                    classes.join(", ")
                ))
                .into());
            }
        }
        let mut classes = Vec::with_capacity(species.classes.len());
        for class in &species.classes {
            let mut sources = Vec::with_capacity(class.stations.len());
            for station in &class.stations {
                if let Some(table) = nearest(given, class, station) {
                    sources.push(Source::Given(table));
                    continue;
                }
                let settings = settings_of(station, settings);
                let baked =
                    baked_source(species, class, station, &settings, cache, progress, cancel)?;
                sources.push(baked);
            }
            classes.push(sources);
        }
        Ok(Self { classes })
    }

    /// That of a station of a class.
    fn at(&self, species: &Species, class: usize, station: &Station) -> Option<&Source<'a>> {
        let stations = &species.classes.get(class)?.stations;
        let index = stations.iter().position(|other| other.at == station.at)?;
        self.classes.get(class)?.get(index)
    }

    /// The materials of all hair classes, dyed for every pigment zone.
    ///
    /// * `species`: the one that the tables are of; its pigment may be another.
    ///
    /// # Errors
    /// Tables that cannot be dyed.
    pub fn materials(&self, species: &Species) -> Result<Vec<HairMaterial>, TableError> {
        let mut materials = Vec::with_capacity(species.classes.len());
        for (index, (class, sources)) in species.classes.iter().zip(&self.classes).enumerate() {
            let (parts, dyes) = coat_parts(&species.pigments(index));
            let mut tables: Vec<ScatterTable> = Vec::with_capacity(dyes.len() * sources.len());
            for band in &dyes {
                for source in sources {
                    tables.push(source.dye(band.absorption_per_um())?.into());
                }
            }
            let stations = class.stations.iter();
            let stations = stations.map(|station| station.at as f32).collect();
            // A validated class has a station and a band, and as many tables as stations times dyes.
            let set = TableSet::with_parts(stations, parts, tables);
            materials.extend(set.map(HairMaterial::Tables));
        }
        Ok(materials)
    }
}

/// [`station_table`] where all of it is needed.
fn baked_source(
    species: &Species,
    class: &HairClass,
    station: &Station,
    settings: &Settings,
    cache: Option<&Cache>,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Source<'static>, AssemblyError> {
    let baked = station_table(species, class, station, settings, cache, progress, cancel)?;
    match baked.complete {
        true => Ok(Source::Baked(baked.table)),
        false => Err(BakeError::Stopped.into()),
    }
}

/// The parts of a coat, and the dyes that they need: pigment that occurs twice is dyed once.
fn coat_parts(pigments: &[&[PigmentBand]]) -> (Vec<CoatPart>, Vec<PigmentBand>) {
    let mut dyes: Vec<PigmentBand> = Vec::new();
    let mut dye_of = |band: &PigmentBand| {
        let same = |d: &PigmentBand| d.absorption_per_um() == band.absorption_per_um();
        dyes.iter().position(same).unwrap_or_else(|| {
            dyes.push(*band);
            dyes.len() - 1
        })
    };
    let parts = (pigments.iter())
        .map(|bands| CoatPart {
            zones: (bands.iter())
                .map(|band| Zone {
                    to_mm: band.to_mm as f32,
                    softness_mm: band.softness_mm as f32,
                })
                .collect(),
            dyes: bands.iter().map(&mut dye_of).collect(),
        })
        .collect();
    (parts, dyes)
}

/// The table of the class that was baked nearest to the station.
fn nearest<'a>(
    given: &'a [TableFile],
    class: &HairClass,
    station: &Station,
) -> Option<&'a TableFile> {
    let off = |table: &TableFile| (table.provenance().station - station.at).abs();
    let of_class = given.iter().filter(|t| t.provenance().class == class.name);
    of_class.min_by(|a, b| off(a).total_cmp(&off(b)))
}
