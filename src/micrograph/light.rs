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
use crate::sampling::{Rng, Sobol, concentric_disk, hash64};
use glam::DVec3;
use rayon::prelude::*;

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
    /// How much brighter the lamp is than for the empty field, stops, -4 .. 8. `None`: as bright as
    /// the fiber needs to be seen, as one turns it up for dark hair; the field is white then.
    pub lamp_ev: Option<f64>,
}

/// A fiber in Canada balsam under a 20x objective of aperture 0.4, condenser opened as far.
impl Default for Microscope {
    fn default() -> Self {
        Self {
            mount: 1.52,
            objective: 0.4,
            condenser: 0.4,
            focus_um: 0.0,
            lamp_ev: None,
        }
    }
}

/// Brightness of the empty field.
const FIELD: f64 = 0.88;
/// How bright the brightest tenth of the fiber is made. Darker and brown cortex is black on a screen;
/// brighter and its rim is white as the field.
const LEGIBLE: f64 = 0.3;
/// The lamp's range above the empty field. Beyond, only stray light comes through: hair that is air
/// from rim to rim stays dark.
const BRIGHTEST_EV: f64 = 3.0;
/// Light is metered at so many places along and across the fiber, with so many rays each.
const METERED: [usize; 2] = [24, 24];
const METER_RAYS: u32 = 16;
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
        within("the lamp", self.lamp_ev.unwrap_or(0.0), -4.0, 8.0)?;
        within("the focus", self.focus_um, -1000.0, 1000.0)
    }

    /// The microscope with its lamp set for a fiber, in half stops.
    pub(super) fn lit_for(self, subject: &Subject) -> Self {
        let lamp_ev = self.lamp_ev.unwrap_or_else(|| {
            let brightest = meter(&Mounted::new(subject, &self), subject.fiber);
            let wanted = (LEGIBLE / (FIELD * brightest).max(1e-6)).log2();
            (2.0 * wanted.clamp(0.0, BRIGHTEST_EV)).round() / 2.0
        });
        Self {
            lamp_ev: Some(lamp_ev),
            ..self
        }
    }
}

/// A fiber on a slide.
pub(super) struct Mounted {
    microscope: Microscope,
    /// One, or one a channel where materials differ by color.
    fibers: Vec<Fiber>,
    absorption: DVec3,
}

impl Mounted {
    pub(super) fn new(subject: &Subject, microscope: &Microscope) -> Self {
        let fiber = subject.fiber;
        let channels = if fiber.structure().is_colored() { 3 } else { 1 };
        let channel = |c| fiber.clone().in_channel(c).mounted_in(microscope.mount);
        Self {
            microscope: *microscope,
            fibers: (0..channels).map(channel).collect(),
            absorption: DVec3::from_array(absorption_at(subject.class, subject.station)),
        }
    }

    /// Light through a point in focus.
    fn light(&self, focus: DVec3, sample: &mut Sample) -> DVec3 {
        let of = |fiber, sample: &mut Sample| {
            light(fiber, &self.microscope, self.absorption, focus, sample)
        };
        match &self.fibers[..] {
            [red, green, blue] => {
                // The same rays for all colors: they differ by what the materials do.
                let rng = sample.rng.clone();
                let mut channel = |fiber| {
                    sample.rng = rng.clone();
                    of(fiber, sample)
                };
                DVec3::new(channel(red).x, channel(green).y, channel(blue).z)
            }
            fibers => of(&fibers[0], sample),
        }
    }
}

/// Green light in the brightest tenth of the fiber, 1 for the empty field.
fn meter(mounted: &Mounted, fiber: &Fiber) -> f64 {
    let (period, [a, _]) = (fiber.period_um(), fiber.semi_axes_um());
    let [along, across] = METERED;
    let place = |i: usize| {
        // The rim refracts into the mount rather than it absorbs.
        let x = 0.97 * (2.0 * ((i % across) as f64 + 0.5) / across as f64 - 1.0);
        let z = period * ((i / across) as f64 + 0.5) / along as f64;
        (DVec3::new(a * x, 0.0, z), hash64(i as u64))
    };
    let mut metered: Vec<f64> = (0..along * across)
        .into_par_iter()
        .map(|i| {
            let (focus, key) = place(i);
            let points = Sobol::new(key);
            let light = |index| {
                let [p, q, ..] = points.point(index).map(f64::from);
                let mut sample = Sample {
                    x: 0.0,
                    y: 0.0,
                    pair: [p, q],
                    rng: Rng::new(key, u64::from(index)),
                };
                mounted.light(focus, &mut sample).y
            };
            (0..METER_RAYS).map(light).sum::<f64>() / f64::from(METER_RAYS)
        })
        .collect();
    metered.sort_by(f64::total_cmp);
    metered[metered.len() * 9 / 10]
}

pub(super) fn draw(
    subject: &Subject,
    microscope: &Microscope,
    area: (usize, usize),
    raster: &Raster,
) -> Option<Drawn> {
    let um_per_pixel = fit(subject.fiber, area, 0.8, 5.0, None);
    let mounted = Mounted::new(subject, microscope);
    let lamp = FIELD * microscope.lamp_ev.unwrap_or(0.0).exp2();
    let half = 0.5 * area.1 as f64;
    let canvas = raster.draw(area, |sample| {
        // The flat side of the section lies on the slide, the objective is at -y.
        let (x, z) = ((half - sample.y) * um_per_pixel, sample.x * um_per_pixel);
        let focus = DVec3::new(x, -microscope.focus_um, z);
        lamp * mounted.light(focus, sample)
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
