//! Pictures of one fiber as microscopists know them.
//!
//! * [`View::Sem`]: the scales under a scanning electron microscope.
//! * [`View::Light`]: a transmitted-light micrograph in a mounting medium, by tracing photons.
//! * [`View::Section`]: a thin section across the fiber.
//! * [`View::Cutaway`]: a piece of the fiber with its front quarter taken out.
//! * [`View::Plate`]: outside, longitudinal cut and cross-section side by side.
//!
//! The fiber lies along the picture, root left and tip right. A picture is a function of its
//! [`Shot`] and [`Subject`] alone, whatever the number of threads.

mod caption;
mod cutaway;
mod frame;
mod light;
mod pigment;
mod plate;
mod raster;
mod section;
mod sem;
mod specimen;

#[cfg(test)]
mod tests;

pub use caption::{Facts, tilt_deg};
pub(crate) use frame::wrap;
pub use light::Microscope;
pub use pigment::absorption_at;

use crate::blame::Blame;
use crate::fiber::Fiber;
use crate::image::Canvas;
use crate::progress::{Cancel, Progress};
use crate::species::{HairClass, Species, Station};
use raster::Raster;

/// What to look through, and from where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// Scanning electron microscope, the specimen tilted by so many radians so that free edges are
    /// seen, 0..=1.2.
    Sem {
        /// Tilt of the stage.
        tilt: f64,
    },
    /// Transmitted light.
    Light(Microscope),
    /// Thin section across the fiber.
    Section,
    /// A piece without its front quarter.
    Cutaway,
    /// Outside, longitudinal cut and cross-section with labels.
    Plate,
}

impl View {
    /// The electron microscope at its usual tilt: less hides the free edges of the scales, more
    /// shortens them.
    pub const SEM: Self = Self::Sem { tilt: 0.3 };
}

/// A fiber and whose it is.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The fiber, in air.
    pub fiber: &'a Fiber,
    /// The animal.
    pub species: &'a Species,
    /// The class of hair.
    pub class: &'a HairClass,
    /// The place along the hair.
    pub station: &'a Station,
}

/// How a picture is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// Width and height of the whole picture, pixels, from [`Shot::SMALLEST`] to
    /// [`Shot::LARGEST`]; a plate at least [`Shot::SMALLEST_PLATE`].
    pub size: (usize, usize),
    /// Samples a pixel, 1..=65536; more is smoother.
    pub samples: u32,
    /// What is written.
    pub legend: Legend,
}

/// What is written into a picture; a plate always has its labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Legend {
    /// A caption with a scale bar below.
    Caption,
    /// A scale bar in the corner.
    Bar,
    /// Nothing.
    None,
}

impl Shot {
    /// Smallest picture.
    pub const SMALLEST: (usize, usize) = (96, 64);
    /// Smallest plate on which the labels still fit.
    pub const SMALLEST_PLATE: (usize, usize) = (320, 180);
    /// Largest picture.
    pub const LARGEST: (usize, usize) = (8192, 8192);
}

/// A picture that cannot be taken.
#[derive(Debug, thiserror::Error)]
pub enum MicrographError {
    /// A setting is out of range.
    #[error("{name} is {found}, must be {expected}")]
    Setting {
        /// Which setting.
        name: &'static str,
        /// Its value.
        found: String,
        /// The allowed range.
        expected: String,
    },
    /// Canceled.
    #[error("stopped before the picture was complete")]
    Stopped,
}

impl MicrographError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::Setting { .. } => Blame::Input,
            Self::Stopped => Blame::Interrupted,
        }
    }
}

/// Takes a picture.
///
/// # Errors
/// Settings out of range, or stopped.
pub fn draw(
    view: View,
    subject: &Subject,
    shot: &Shot,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Canvas, MicrographError> {
    check(view, shot)?;
    let view = match view {
        View::Light(microscope) => View::Light(microscope.lit_for(subject)),
        view => view,
    };
    let raster = Raster {
        samples: shot.samples,
        progress,
        cancel,
    };
    let picture = match view {
        View::Plate => plate::draw(subject, shot.size, &raster),
        View::Sem { tilt } => frame::draw(subject, shot, view, |area| {
            let um_per_pixel = sem::scale(subject.fiber, area);
            sem::draw(subject.fiber, tilt, um_per_pixel, area, &raster)
        }),
        View::Light(microscope) => frame::draw(subject, shot, view, |area| {
            light::draw(subject, &microscope, area, &raster)
        }),
        View::Section => frame::draw(subject, shot, view, |area| {
            section::draw(subject, area, &raster)
        }),
        View::Cutaway => frame::draw(subject, shot, view, |area| {
            cutaway::draw(subject, area, &raster)
        }),
    };
    picture.ok_or(MicrographError::Stopped)
}

/// Refuses what [`draw`] would refuse, before any work.
///
/// # Errors
/// Settings out of range.
pub fn check(view: View, shot: &Shot) -> Result<(), MicrographError> {
    let refuse = |name, found: String, expected: String| {
        Err(MicrographError::Setting {
            name,
            found,
            expected,
        })
    };
    let ((width, height), (right, bottom)) = (shot.size, Shot::LARGEST);
    let (left, top) = match view {
        View::Plate => Shot::SMALLEST_PLATE,
        _ => Shot::SMALLEST,
    };
    if !(left..=right).contains(&width) || !(top..=bottom).contains(&height) {
        let expected = format!("{left}x{top} to {right}x{bottom} pixels");
        return refuse(
            "the size of the picture",
            format!("{width}x{height}"),
            expected,
        );
    }
    if !(1..=65_536).contains(&shot.samples) {
        return refuse("samples", shot.samples.to_string(), "1 to 65536".to_owned());
    }
    match view {
        View::Sem { tilt } if !(0.0..=1.2).contains(&tilt) => {
            let found = format!("{:.1} degrees", tilt.to_degrees());
            refuse("the tilt of the stage", found, "0 to 68 degrees".to_owned())
        }
        View::Light(microscope) => microscope.check(),
        _ => Ok(()),
    }
}
