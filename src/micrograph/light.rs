//! A transmitted-light micrograph: every pixel from rays that the objective gathers, traced back
//! through the fiber into the condenser.
//!
//! Light and importance follow the same paths, so rays start at the objective. All that pass the
//! fiber through the focal plane at one point make one point of the picture; those that come out
//! below within the condenser's cone bring its white light, less what the pigment took, and all
//! others bring none. So air in the medulla is dark: at its walls light is totally reflected out of
//! the cone.

use super::frame::{Drawn, fit};
use super::raster::{Raster, Sample};
use super::{MicrographError, Subject, absorption_at};
use crate::bake::{End, follow};
use crate::fiber::{Fiber, Region};
use crate::sampling::concentric_disk;
use glam::DVec3;

/// A microscope in transmitted light, set up after Koehler.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microscope {
    /// Refractive index of the medium that the fiber is mounted in, 1 (dry) .. 2.
    pub mount: f64,
    /// Numerical aperture of the objective, 0.02 .. 0.95 of the mount's index.
    pub objective: f64,
    /// Numerical aperture of the condenser, the same range.
    pub condenser: f64,
    /// The plane in focus: micrometers above the middle of the fiber.
    pub focus_um: f64,
}

/// A fiber in Canada balsam under a 20x objective of aperture 0.4, condenser opened as far.
impl Default for Microscope {
    fn default() -> Self {
        Self {
            mount: 1.52,
            objective: 0.4,
            condenser: 0.4,
            focus_um: 0.0,
        }
    }
}

/// Brightness of the empty field.
const FIELD: f64 = 0.88;
/// Events after which a photon is given up: what wanders this long in a medulla leaves in no
/// particular direction, and the condenser's cone is a hundredth of all.
const MAX_EVENTS: u32 = 300;
/// Both apertures are the same by default, and a ray that meets nothing must not miss the condenser
/// by a rounding.
const RIM: f64 = 1.0 + 1e-9;

impl Microscope {
    pub(super) fn check(&self) -> Result<(), MicrographError> {
        let within = |name, value: f64, lo: f64, hi: f64| {
            if (lo..=hi).contains(&value) {
                return Ok(());
            }
            Err(MicrographError::Setting {
                name,
                found: value.to_string(),
                expected: format!("{lo} to {hi}"),
            })
        };
        within("the index of the mount", self.mount, 1.0, 2.0)?;
        // Flatter cones never meet the fiber.
        let widest = 0.95 * self.mount;
        within("the objective's aperture", self.objective, 0.02, widest)?;
        within("the condenser's aperture", self.condenser, 0.02, widest)?;
        within("the focus", self.focus_um, -1000.0, 1000.0)
    }
}

pub(super) fn draw(
    subject: &Subject,
    microscope: &Microscope,
    area: (usize, usize),
    raster: &Raster,
) -> Option<Drawn> {
    let um_per_pixel = fit(subject.fiber, area, 0.8, 5.0, None);
    let fiber = subject.fiber.clone().mounted_in(microscope.mount);
    let absorption = DVec3::from_array(absorption_at(subject.class, subject.station));
    let half = 0.5 * area.1 as f64;
    let canvas = raster.draw(area, |sample| {
        // The flat side of the section lies on the slide, the objective is at -y.
        let (x, z) = ((half - sample.y) * um_per_pixel, sample.x * um_per_pixel);
        let focus = DVec3::new(x, -microscope.focus_um, z);
        FIELD * light(&fiber, microscope, absorption, focus, sample)
    })?;
    Some(Drawn {
        canvas,
        um_per_pixel,
    })
}

/// Light of one ray through a point in focus, 1 for the empty field.
pub(super) fn light(
    fiber: &Fiber,
    microscope: &Microscope,
    absorption: DVec3,
    focus: DVec3,
    sample: &mut Sample,
) -> DVec3 {
    // An objective is corrected for sines: its pupil is uniform in them.
    let (u, v) = concentric_disk(sample.pair[0], sample.pair[1]);
    let sine = microscope.objective / microscope.mount;
    let (x, z) = (sine * u, sine * v);
    let dir = DVec3::new(x, (1.0 - x * x - z * z).sqrt(), z);
    let origin = focus - (4.0 * fiber.bounding_radius_um() + microscope.focus_um.abs()) * dir;
    let (leaving, path_um, share) = match fiber.next_hit(origin, dir, Region::Outside, None) {
        None => (dir, 0.0, 1.0),
        Some(hit) => {
            let at = origin + hit.t * dir;
            let flight = follow(fiber, at, dir, hit, &mut sample.rng, MAX_EVENTS);
            match flight.end {
                End::Escaped(leaving) => (leaving, flight.path_um, flight.share),
                _ => return DVec3::ZERO,
            }
        }
    };
    let sine = leaving.x.hypot(leaving.z);
    if leaving.y <= 0.0 || microscope.mount * sine > microscope.condenser * RIM {
        return DVec3::ZERO;
    }
    share * (-path_um * absorption).exp()
}
