//! Light straight from the environment and from lamps, by rays that ask whether anything is in the way.

use super::Sampler;
use super::draws::Purpose;
use super::path::{Integrator, Sample, Vertex};
use super::resample::{TYPICAL_OPEN, candidates, chance_of_asking};
use super::scatter::Scatter;
use crate::color::Rgb;
use crate::scene::{Ground, LampChoice};
use glam::Vec3;

impl Integrator<'_> {
    /// Light straight from the environment, at the eye.
    pub(super) fn direct(&self, at: &Vertex<'_>, out: &mut Sample) -> Rgb {
        let Vertex {
            scatter,
            draws,
            depth,
            ..
        } = *at;
        let environment = &self.scene.environment;
        match self.sampler {
            Sampler::Bsdf | Sampler::QsirOneRay => Rgb::ZERO,
            Sampler::Qsir => {
                let mut sum = Rgb::ZERO;
                candidates(scatter, at.prospect, at.plan(), draws, depth, |c| {
                    let light = at.throughput * c.density * c.light * c.weight;
                    let sent = chance_of_asking(light, c.open, at.enough);
                    sum +=
                        self.ask_by_chance(at, c.dir, f32::INFINITY, light, [c.chance, sent], out);
                });
                sum
            }
            Sampler::Env | Sampler::Mis => {
                let u = draws.point(depth, Purpose::Light);
                let Some(light) = environment.sample([u[0], u[1]]) else {
                    return Rgb::ZERO;
                };
                let (density, scatter_pdf) = scatter.eval(light.dir);
                let share = match self.sampler {
                    Sampler::Mis => power(light.pdf, scatter_pdf),
                    _ => 1.0,
                };
                let weight = at.throughput * density * light.radiance * (share / light.pdf);
                self.unless_occluded(scatter, light.dir, f32::INFINITY, weight, out)
            }
        }
    }

    /// The lamps from a scattering point; `None` if there are none.
    pub(super) fn lamps_from(&self, scatter: &Scatter<'_>) -> Option<LampChoice<'_>> {
        let lamps = &self.scene.lamps;
        (!lamps.is_empty()).then(|| LampChoice::new(lamps, scatter.position()))
    }

    /// Light straight from a lamp, at the eye.
    pub(super) fn lamp_light(
        &self,
        lamps: &LampChoice<'_>,
        at: &Vertex<'_>,
        out: &mut Sample,
    ) -> Rgb {
        let u = at.draws.point(at.depth, Purpose::Lamp);
        let Some(lamp) = lamps.sample([u[0], u[1], u[2]]) else {
            return Rgb::ZERO;
        };
        let (density, scatter_pdf) = at.scatter.eval(lamp.dir);
        let [share, _] = self.lamp_shares(at.on_floor, lamp.pdf, scatter_pdf);
        let light = at.throughput * density * lamp.radiance * (share / lamp.pdf);
        match self.sampler {
            Sampler::Qsir => {
                let sent = chance_of_asking(light, TYPICAL_OPEN, at.enough);
                self.ask_by_chance(at, lamp.dir, lamp.distance, light, [u[3], sent], out)
            }
            _ => self.unless_occluded(at.scatter, lamp.dir, lamp.distance, light, out),
        }
    }

    /// How much of the light of lamps the rays that are sent to them bring, and how much of it the continuing
    /// rays that meet them. Where continuing rays are resampled their density is not known.
    pub(super) fn lamp_shares(&self, on_floor: bool, lamp_pdf: f32, scatter_pdf: f32) -> [f32; 2] {
        match self.sampler {
            _ if on_floor => [1.0, 0.0],
            Sampler::Bsdf => [0.0, 1.0],
            Sampler::Env | Sampler::QsirOneRay => [1.0, 0.0],
            Sampler::Qsir | Sampler::Mis => {
                [power(lamp_pdf, scatter_pdf), power(scatter_pdf, lamp_pdf)]
            }
        }
    }

    /// Light straight from the environment to white paint on the floor, which has no other noise
    /// than that of visibility.
    pub(super) fn floor_light(&self, floor: &Ground, at: &Vertex<'_>, out: &mut Sample) -> Rgb {
        let u = at.draws.point(0, Purpose::Light);
        match floor.sample(&self.scene.environment, [u[0], u[1]]) {
            Some((dir, light)) => self.unless_occluded(at.scatter, dir, f32::INFINITY, light, out),
            None => Rgb::ZERO,
        }
    }

    /// As [`Self::unless_occluded`] on the average, but most rays that would bring little are not sent.
    ///
    /// * `chance`: a number in `[0, 1)`. * `sent`: the probability with which it is sent.
    fn ask_by_chance(
        &self,
        at: &Vertex<'_>,
        dir: Vec3,
        far: f32,
        light: Rgb,
        [chance, sent]: [f32; 2],
        out: &mut Sample,
    ) -> Rgb {
        // Also drops NaN.
        if chance < sent {
            self.unless_occluded(at.scatter, dir, far, light / sent, out)
        } else {
            Rgb::ZERO
        }
    }

    fn unless_occluded(
        &self,
        scatter: &Scatter<'_>,
        dir: Vec3,
        far: f32,
        light: Rgb,
        out: &mut Sample,
    ) -> Rgb {
        if light.max_element() <= 0.0 {
            return Rgb::ZERO;
        }
        let (ray, leaving) = scatter.leave(dir);
        out.rays += 1;
        if self.scene.occluded(&ray, far, leaving) {
            Rgb::ZERO
        } else {
            light
        }
    }

    /// How much of the environment's light an escaping path may bring that was not gathered before.
    pub(super) fn escape_weight(&self, at: &Vertex<'_>, scatter_pdf: f32, light_pdf: f32) -> f32 {
        match self.sampler {
            Sampler::Bsdf | Sampler::QsirOneRay => 1.0,
            Sampler::Qsir => at.plan().escape_weight(scatter_pdf, light_pdf),
            Sampler::Env => 0.0,
            Sampler::Mis => power(scatter_pdf, light_pdf),
        }
    }
}

/// The power heuristic with exponent 2 (Veach 1997).
fn power(own: f32, other: f32) -> f32 {
    let (a, b) = (own * own, other * other);
    if a > 0.0 { a / (a + b) } else { 0.0 }
}
