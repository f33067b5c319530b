//! The path integrator: one sample of one pixel, a pure function of (scene, seed, pixel, index).

use super::draws::{Draws, Purpose};
use super::mattes::Seen;
use super::resample::{
    Plan, Prospect, TYPICAL_OPEN, Target, candidates, chance_of_asking, resample,
};
use super::scatter::{Direction, Scatter};
use super::{Filter, Sampler};
use crate::color::{Rgb, luminance};
use crate::scene::{Camera, Ground, Hit, LampChoice, Scene};
use glam::{Vec2, Vec3};

/// Scattering events before roulette may end a path. At 1 dark fur pays more in noise than it saves,
/// at 8 pale fur takes 1.6 times the time for the same noise.
const ROULETTE_FROM: u32 = 2;

/// Share of the light at a scattering point that reaches the eye, below which paths may end there. At 1 pale fur has a sixth more
/// error for an eighth less time, at 0.5 a tenth less for an eighth more.
const WORTH_FOLLOWING: f32 = 0.7;

/// Scattering events after which a path is cut whatever it carries. Lossless fur escapes long
/// before: cut paths are counted and reported.
const FAR_CAP: u32 = 1000;

/// Light, as a share of what the place that the camera sees would send in even light, from which on a ray is
/// always sent for it. At a quarter more fur takes 3 to 6 % fewer rays and has 2 to 11 % more error.
pub(super) const ENOUGH: f32 = 0.4;

/// What the camera saw first.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FirstHit {
    /// Distance from the camera, millimeters.
    pub(super) depth: f32,
    pub(super) albedo: Rgb,
    pub(super) normal: Vec3,
    /// Root to tip; zero on surfaces.
    pub(super) tangent: Vec3,
    /// Stable id of the strand; `None` on surfaces.
    pub(super) strand: Option<u32>,
    pub(super) root_uv: Vec2,
}

/// One sample of a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sample {
    /// Radiance, backdrop included.
    pub(super) radiance: Rgb,
    /// Where the subject was met.
    pub(super) first: Option<FirstHit>,
    /// What was met.
    pub(super) seen: Option<Seen>,
    /// Closest-hit and occlusion queries made.
    pub(super) rays: u32,
    /// Whether the far cap cut the path.
    pub(super) capped: bool,
}

/// A scattering point of a path.
struct Vertex<'a> {
    scatter: &'a Scatter<'a>,
    draws: &'a Draws,
    /// What light is thought to come here.
    prospect: Prospect<'a>,
    /// Scattering events before this one.
    depth: u32,
    /// Share of what leaves here that reaches the eye.
    throughput: Rgb,
    /// Luminance at the eye from which on a ray is always sent for it.
    enough: f32,
    /// Whether it is the first, on the floor.
    on_floor: bool,
}

impl Vertex<'_> {
    /// Candidates for light straight from the environment.
    fn plan(&self) -> Plan {
        Plan::direct(self.depth, self.scatter.is_dear_to_draw())
    }
}

/// Traces paths of one picture.
pub(super) struct Integrator<'a> {
    pub(super) scene: &'a Scene,
    pub(super) camera: Camera,
    pub(super) resolution: [u32; 2],
    pub(super) seed: u64,
    pub(super) sampler: Sampler,
    pub(super) filter: Filter,
    /// [`ENOUGH`] times the luminance of even light.
    pub(super) enough: f32,
    /// Replaces the target of resampling, for the test of its bias.
    #[cfg(test)]
    pub(super) bare_target: bool,
}

impl Integrator<'_> {
    /// Sample `index` of the pixel at `(x, y)` of the full frame.
    pub(super) fn sample(&self, x: u32, y: u32, index: u32) -> Sample {
        let [width, height] = self.resolution;
        let draws = Draws::new(
            self.seed,
            u64::from(y) * u64::from(width) + u64::from(x),
            index,
        );
        let u = draws.point(0, Purpose::Filter);
        let offset = self.filter.offset([u[0], u[1]]);
        let at = [
            (x as f32 + 0.5 + offset[0]) / width as f32,
            (y as f32 + 0.5 + offset[1]) / height as f32,
        ];
        let ray = if self.camera.has_lens() {
            let lens = draws.point(0, Purpose::Lens);
            self.camera.ray_through(at[0], at[1], [lens[0], lens[1]])
        } else {
            self.camera.ray(at[0], at[1])
        };
        let mut out = Sample {
            rays: 1,
            ..Sample::default()
        };
        let backdrop = || {
            self.scene
                .backdrop
                .radiance(&self.scene.environment, ray.dir, at)
        };
        let Some(hit) = self.scene.closest(&ray, None) else {
            out.radiance = backdrop();
            return out;
        };
        out.seen = Some(match &hit {
            Hit::Strand(hit) => Seen::Strand {
                class: hit.class,
                zone: hit.coat,
            },
            Hit::Surface(_) => Seen::Skin,
            Hit::Ground(_) => Seen::Ground,
        });
        let scatter = Scatter::new(self.scene, &ray, &hit, true, u[2]);
        if let (Hit::Ground(t), Some(ground)) = (&hit, &self.scene.ground) {
            let share = ground.shadow_share(ray.origin + *t * ray.dir);
            out.radiance = backdrop();
            if share > 0.0 {
                // Times the share of its light that the subject leaves to the floor.
                let light = self.trace(&scatter, Some(ground), &draws, &mut out);
                let open = self.scene.open_floor(ground, scatter.position());
                let left = light / open.max(Rgb::splat(f32::MIN_POSITIVE));
                out.radiance *= Rgb::ONE.lerp(left, share);
            }
            return out;
        }
        let light = self.trace(&scatter, None, &draws, &mut out);
        out.radiance = light;
        out.first = Some(self.describe(&hit, &scatter));
        out
    }

    /// Radiance that leaves a scattering point toward the viewer.
    ///
    /// * `floor`: the floor if the point is on it.
    fn trace(
        &self,
        first: &Scatter<'_>,
        floor: Option<&Ground>,
        draws: &Draws,
        out: &mut Sample,
    ) -> Rgb {
        let environment = &self.scene.environment;
        let mut sum = Rgb::ZERO;
        let mut throughput = Rgb::ONE;
        let enough = self.enough * luminance(first.albedo());
        let mut next;
        let mut scatter = first;
        for depth in 0..FAR_CAP {
            let on_floor = floor.is_some() && depth == 0;
            let at = Vertex {
                scatter,
                draws,
                prospect: self.prospect(scatter, draws, depth),
                depth,
                throughput,
                enough,
                on_floor,
            };
            sum += match floor {
                Some(floor) if on_floor => self.floor_light(floor, &at, out),
                _ => self.direct(&at, out),
            };
            let lamps = self.lamps_from(scatter);
            if let Some(lamps) = &lamps {
                sum += self.lamp_light(lamps, &at, out);
            }
            let Some(direction) = self.continue_from(scatter, draws, depth) else {
                return sum;
            };
            throughput *= direction.weight;
            if depth >= ROULETTE_FROM {
                let survival = (throughput.max_element() / WORTH_FOLLOWING).min(1.0);
                if draws.point(depth, Purpose::Choice)[1] >= survival {
                    return sum;
                }
                throughput /= survival;
            }
            // Asked for before it is known whether the ray escapes: many do.
            let spot = environment.spot(direction.dir);
            let (ray, leaving) = scatter.leave(direction.dir);
            out.rays += 1;
            let hit = self.scene.closest(&ray, leaving);
            if let Some(lamps) = &lamps {
                let far = hit.as_ref().map_or(f32::INFINITY, Hit::distance);
                let share = |pdf| self.lamp_shares(on_floor, pdf, direction.pdf)[1];
                sum += throughput * lamps.met(&ray, far, share);
            }
            let Some(hit) = hit else {
                if on_floor {
                    return sum;
                }
                let (light, light_pdf, _) = at.prospect.eval(spot);
                let share = self.escape_weight(&at, direction.pdf, light_pdf);
                return sum + throughput * light * share;
            };
            let blend = draws.point(depth, Purpose::Choice)[2];
            next = Scatter::new(self.scene, &ray, &hit, false, blend);
            scatter = &next;
        }
        out.capped = true;
        sum
    }

    /// What light is thought to come to a scattering point.
    fn prospect(&self, scatter: &Scatter<'_>, draws: &Draws, depth: u32) -> Prospect<'_> {
        let sight = (self.scene.outlook.as_ref())
            .filter(|_| self.sampler == Sampler::Qsir)
            .and_then(|outlook| {
                let [x, y, z, _] = draws.point(depth, Purpose::Outlook);
                outlook.sight(scatter.position(), [x, y, z])
            });
        Prospect::new(&self.scene.environment, sight)
    }

    /// The direction in which the path goes on.
    fn continue_from(&self, scatter: &Scatter<'_>, draws: &Draws, depth: u32) -> Option<Direction> {
        if self.sampler == Sampler::QsirOneRay
            && let Some(plan) = Plan::one_ray(depth)
        {
            let prospect = Prospect::new(&self.scene.environment, None);
            let target = self.target(depth);
            return resample(scatter, prospect, plan, &target, draws, depth);
        }
        let u = draws.point(depth, Purpose::Continue);
        scatter.sample([u[0], u[1], u[2]])
    }

    fn target(&self, depth: u32) -> Target {
        #[cfg(test)]
        if self.bare_target {
            return Target::DIRECT;
        }
        Target::all(self.scene.mean_light(), depth)
    }

    /// Light straight from the environment, at the eye.
    fn direct(&self, at: &Vertex<'_>, out: &mut Sample) -> Rgb {
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
                for c in candidates(scatter, at.prospect, at.plan(), draws, depth) {
                    let light = at.throughput * c.density * c.light * c.weight;
                    let sent = chance_of_asking(light, c.open, at.enough);
                    sum +=
                        self.ask_by_chance(at, c.dir, f32::INFINITY, light, [c.chance, sent], out);
                }
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
    fn lamps_from(&self, scatter: &Scatter<'_>) -> Option<LampChoice<'_>> {
        let lamps = &self.scene.lamps;
        (!lamps.is_empty()).then(|| LampChoice::new(lamps, scatter.position()))
    }

    /// Light straight from a lamp, at the eye.
    fn lamp_light(&self, lamps: &LampChoice<'_>, at: &Vertex<'_>, out: &mut Sample) -> Rgb {
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
    fn lamp_shares(&self, on_floor: bool, lamp_pdf: f32, scatter_pdf: f32) -> [f32; 2] {
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
    fn floor_light(&self, floor: &Ground, at: &Vertex<'_>, out: &mut Sample) -> Rgb {
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
    fn escape_weight(&self, at: &Vertex<'_>, scatter_pdf: f32, light_pdf: f32) -> f32 {
        match self.sampler {
            Sampler::Bsdf | Sampler::QsirOneRay => 1.0,
            Sampler::Qsir => at.plan().escape_weight(scatter_pdf, light_pdf),
            Sampler::Env => 0.0,
            Sampler::Mis => power(scatter_pdf, light_pdf),
        }
    }

    fn describe(&self, hit: &Hit, scatter: &Scatter<'_>) -> FirstHit {
        let strands = &self.scene.strands;
        let (depth, strand) = match hit {
            Hit::Strand(hit) => (hit.t, Some(hit)),
            Hit::Surface(hit) => (hit.t, None),
            Hit::Ground(t) => (*t, None),
        };
        FirstHit {
            depth,
            albedo: scatter.albedo(),
            normal: scatter.normal(),
            tangent: strand.map_or(Vec3::ZERO, |s| s.tangent),
            strand: strand.map(|s| strands.id(s.strand)),
            root_uv: strand.map_or(Vec2::ZERO, |s| strands.root_uv(s.strand)),
        }
    }
}

/// The power heuristic with exponent 2 (Veach 1997).
fn power(own: f32, other: f32) -> f32 {
    let (a, b) = (own * own, other * other);
    if a > 0.0 { a / (a + b) } else { 0.0 }
}
