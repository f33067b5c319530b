//! The library in pictures: for every animal its scales, its medulla, how one hair scatters light and
//! how the fur looks; as a contact sheet or as pages of Markdown.

mod coats;
mod pages;
mod sheet;
mod swatch;

#[cfg(test)]
mod tests;

pub use coats::{COATS, coats_sheet};
pub use pages::{Page, Picture, index, page, pictures_of};
pub use sheet::{ROW_HEIGHTS, Row, picture_size, sheet};

use crate::assembly::{AssemblyError, station_table};
use crate::bake::{Cache, Settings};
use crate::blame::Blame;
use crate::fiber::{Fiber, FiberError};
use crate::groom::GroomError;
use crate::image::Canvas;
use crate::micrograph::{self, Legend, MicrographError, Microscope, Shot, Subject, View};
use crate::progress::{Cancel, Silent};
use crate::render::RenderError;
use crate::scene::SceneError;
use crate::skin::SkinError;
use crate::species::{HairClass, Species, SpeciesError, Station};
use crate::table::{TableError, draw_lobe};

/// A kind of picture of an animal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Scales under the electron microscope.
    Sem,
    /// Transmitted light in a medium of index 1.52.
    Light,
    /// Cross-section.
    Section,
    /// The fiber without its front quarter.
    Cutaway,
    /// Where one hair sends light that comes from 45 degrees toward its tip.
    Lobe,
    /// A piece of fur.
    Swatch,
}

impl Column {
    /// Its heading.
    pub fn title(self) -> &'static str {
        match self {
            Self::Sem => "electron microscope",
            Self::Light => "transmitted light",
            Self::Section => "cross-section",
            Self::Cutaway => "cut away",
            Self::Lobe => "light from 45\u{b0}",
            Self::Swatch => "fur",
        }
    }

    /// As files and options write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sem => "sem",
            Self::Light => "light",
            Self::Section => "section",
            Self::Cutaway => "cutaway",
            Self::Lobe => "lobe",
            Self::Swatch => "swatch",
        }
    }

    /// Width of its pictures over their height.
    pub fn aspect(self) -> f64 {
        match self {
            Self::Sem | Self::Light | Self::Cutaway => 1.6,
            Self::Section | Self::Lobe => 1.0,
            Self::Swatch => 4.0 / 3.0,
        }
    }
}

/// How much work goes into a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quality {
    /// Samples a pixel of micrographs.
    pub micrograph: u32,
    /// Samples a pixel in transmitted light, which is noisier.
    pub light: u32,
    /// Photons of every table, and texels along a face edge of it: four times the photons or half
    /// the edge have the same noise a texel.
    pub photons: u64,
    /// See above; a power of two.
    pub face: usize,
    /// Strands of a swatch.
    pub strands: usize,
    /// Samples a pixel of a swatch.
    pub swatch: u32,
}

impl Quality {
    /// About fifteen seconds an animal on two cores.
    pub const PREVIEW: Self = Self {
        micrograph: 9,
        light: 16,
        photons: 300_000,
        face: 32,
        strands: 10_000,
        swatch: 12,
    };
    /// About two minutes an animal on two cores; the tables are those of `vair render`.
    pub const FULL: Self = Self {
        micrograph: 36,
        light: 192,
        photons: 3_000_000,
        face: 64,
        strands: 60_000,
        swatch: 128,
    };
}

/// A picture that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum GalleryError {
    /// No species.
    #[error(transparent)]
    Species(#[from] SpeciesError),
    /// The fiber cannot be built.
    #[error(transparent)]
    Fiber(#[from] FiberError),
    /// No micrograph.
    #[error(transparent)]
    Micrograph(#[from] MicrographError),
    /// No table.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
    /// No lobe.
    #[error(transparent)]
    Table(#[from] TableError),
    /// No skin.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// No fur.
    #[error(transparent)]
    Groom(#[from] GroomError),
    /// No scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// No rendering.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// Canceled.
    #[error("stopped")]
    Stopped,
}

impl GalleryError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::Species(error) => error.blame(),
            Self::Fiber(error) => error.blame(),
            Self::Micrograph(error) => error.blame(),
            Self::Assembly(error) => error.blame(),
            Self::Table(error) => error.blame(),
            Self::Skin(error) => error.blame(),
            Self::Groom(error) => error.blame(),
            Self::Scene(error) => error.blame(),
            Self::Render(error) => error.blame(),
            Self::Stopped => Blame::Interrupted,
        }
    }
}

/// The station where a hair is thickest, the lowest of equals: farther up the medulla may have ended.
fn widest(class: &HairClass) -> &Station {
    // A validated class has a station.
    class.widest().unwrap_or(&class.stations[0])
}

/// Makes pictures of animals.
pub struct Studio<'a> {
    /// How much work goes into them.
    pub quality: Quality,
    /// Where tables are kept.
    pub cache: Option<&'a Cache>,
    /// Stops the work.
    pub cancel: &'a Cancel,
}

impl Studio<'_> {
    /// One picture: of the widest station of a class of hair, of its scattering or of the fur.
    ///
    /// # Errors
    /// Whatever the parts of the animal do not allow, or canceled.
    pub fn picture(
        &self,
        column: Column,
        species: &Species,
        class: &HairClass,
        size: (usize, usize),
        legend: Legend,
    ) -> Result<Canvas, GalleryError> {
        if self.cancel.is_cancelled() {
            return Err(GalleryError::Stopped);
        }
        let Quality {
            micrograph, light, ..
        } = self.quality;
        let (view, samples) = match column {
            Column::Sem => (View::SEM, micrograph),
            Column::Light => (View::Light(Microscope::default()), light),
            Column::Section => (View::Section, micrograph),
            Column::Cutaway => (View::Cutaway, 2 * micrograph),
            Column::Lobe => return self.lobe(species, class, size),
            Column::Swatch => return swatch::draw(self, species, &swatch::SWATCH, size),
        };
        let station = widest(class);
        let fiber = Fiber::build(&station.structure, 0)?;
        let subject = Subject {
            fiber: &fiber,
            species,
            class,
            station,
        };
        let shot = Shot {
            size,
            samples,
            legend,
        };
        Ok(micrograph::draw(
            view,
            &subject,
            &shot,
            &Silent,
            self.cancel,
        )?)
    }

    fn lobe(
        &self,
        species: &Species,
        class: &HairClass,
        size: (usize, usize),
    ) -> Result<Canvas, GalleryError> {
        let station = widest(class);
        let baked = station_table(
            species,
            class,
            station,
            &self.bake(),
            self.cache,
            &Silent,
            self.cancel,
        )
        .map_err(AssemblyError::from)?;
        if !baked.complete {
            return Err(GalleryError::Stopped);
        }
        let absorption = micrograph::absorption_at(class, station);
        Ok(draw_lobe(&baked.table.dye(absorption)?, 45.0, size)?)
    }

    fn bake(&self) -> Settings {
        Settings {
            photons: self.quality.photons,
            face: self.quality.face,
            ..Settings::cone()
        }
    }
}
