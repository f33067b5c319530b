//! The path integrator: one sample of one pixel, a pure function of (scene, seed, pixel, index).

use super::draws::{Draws, Purpose};
use super::mattes::Seen;
use super::resample::{Plan, Prospect, Target, resample};
use super::scatter::{Direction, Scatter};
use super::worth::Worth;
use super::{Filter, Sampler};
use crate::color::{Rgb, luminance};
use crate::scene::{Camera, Ground, Hit, LampChoice, Look, Scene};
use glam::{Vec2, Vec3};

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
pub(super) struct Vertex<'a> {
    pub(super) scatter: &'a Scatter<'a>,
    pub(super) draws: &'a Draws,
    /// What light is thought to come here.
    pub(super) prospect: Prospect<'a>,
    /// Scattering events before this one.
    pub(super) depth: u32,
    /// Share of what leaves here that reaches the eye.
    pub(super) throughput: Rgb,
    /// Ways in which the path goes on.
    pub(super) copies: u32,
    /// Luminance at the eye from which on a ray is always sent for it.
    pub(super) enough: f32,
    /// Whether it is the first, on the floor.
    pub(super) on_floor: bool,
}

impl Vertex<'_> {
    /// Candidates for light straight from the environment.
    pub(super) fn plan(&self) -> Plan {
        Plan::direct(self.depth, self.scatter.is_dear_to_draw(), self.copies)
    }
}

/// A scattering point that a path has come to.
struct Arrival<'a> {
    scatter: Scatter<'a>,
    look: Option<Look<'a>>,
    throughput: Rgb,
    copies: u32,
}

/// What all ways of a path have in common.
struct Start<'a> {
    /// The floor if it starts there.
    floor: Option<&'a Ground>,
    worth: Worth,
    enough: f32,
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
    /// Share of all light that comes from the environment.
    pub(super) far_share: f32,
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
                // Times the share of its light that the subject leaves to the floor; of colors that
                // nothing shines in there is nothing to take.
                let open = self.scene.open_floor(ground, scatter.position());
                let light = self.trace(scatter, Some(ground), &draws, &mut out);
                let left = Rgb::select(open.cmpgt(Rgb::ZERO), light / open, Rgb::ONE);
                out.radiance *= Rgb::ONE.lerp(left, share);
            }
            return out;
        }
        out.first = Some(self.describe(&hit, &scatter));
        out.radiance = self.trace(scatter, None, &draws, &mut out);
        out
    }

    /// Radiance that leaves a scattering point toward the viewer.
    ///
    /// * `floor`: the floor if the point is on it.
    fn trace<'s>(
        &'s self,
        first: Scatter<'s>,
        floor: Option<&Ground>,
        draws: &Draws,
        out: &mut Sample,
    ) -> Rgb {
        let look = self.look(first.position(), draws, 0);
        let worth = Worth::new(look.map(|look| self.glow(&look)));
        let start = Start {
            floor,
            enough: self.enough * luminance(first.albedo()),
            worth,
        };
        let first = Arrival {
            scatter: first,
            look,
            throughput: Rgb::ONE,
            copies: 1,
        };
        self.follow(first, 0, &start, draws, out)
    }

    /// Light from a point on that a path has come to, at the eye.
    ///
    /// * `from`: scattering events before.
    fn follow<'s>(
        &'s self,
        mut here: Arrival<'s>,
        from: u32,
        start: &Start<'_>,
        draws: &Draws,
        out: &mut Sample,
    ) -> Rgb {
        let mut sum = Rgb::ZERO;
        for depth in from..FAR_CAP {
            let sight = here.look.map(|look| look.sight);
            let at = Vertex {
                scatter: &here.scatter,
                draws,
                prospect: Prospect::new(&self.scene.environment, sight),
                depth,
                throughput: here.throughput,
                copies: here.copies,
                enough: start.enough,
                on_floor: start.floor.is_some() && depth == 0,
            };
            sum += match start.floor {
                Some(floor) if at.on_floor => self.floor_light(floor, &at, out),
                _ => self.direct(&at, out),
            };
            let lamps = self.lamps_from(&here.scatter);
            if let Some(lamps) = &lamps {
                sum += self.lamp_light(lamps, &at, out);
            }
            for copy in 1..at.copies {
                let draws = draws.copy(depth, copy);
                let (light, next) = self.go_on(&at, start, lamps.as_ref(), &draws, out);
                sum += light;
                if let Some(next) = next {
                    sum += self.follow(next, depth + 1, start, &draws, out);
                }
            }
            let (light, next) = self.go_on(&at, start, lamps.as_ref(), draws, out);
            sum += light;
            let Some(next) = next else {
                return sum;
            };
            here = next;
        }
        out.capped = true;
        sum
    }

    /// One of the ways in which a path goes on from a point: light that is met, at the eye, and where it comes to.
    fn go_on(
        &self,
        at: &Vertex<'_>,
        start: &Start<'_>,
        lamps: Option<&LampChoice<'_>>,
        draws: &Draws,
        out: &mut Sample,
    ) -> (Rgb, Option<Arrival<'_>>) {
        let (depth, mut light) = (at.depth, Rgb::ZERO);
        let Some(direction) = self.continue_from(at.scatter, draws, depth) else {
            return (light, None);
        };
        let mut throughput = at.throughput * direction.weight / at.copies as f32;
        let [_, chance, blend, _] = draws.point(depth, Purpose::Choice);
        let survival = start.worth.before_ray(throughput, depth);
        if chance >= survival {
            return (light, None);
        }
        throughput /= survival;
        let (ray, leaving) = at.scatter.leave(direction.dir);
        out.rays += 1;
        let hit = self.scene.closest(&ray, leaving);
        if let Some(lamps) = lamps {
            let far = hit.as_ref().map_or(f32::INFINITY, Hit::distance);
            let share = |pdf| self.lamp_shares(at.on_floor, pdf, direction.pdf)[1];
            light += throughput * lamps.met(&ray, far, share);
        }
        let Some(hit) = hit else {
            if !at.on_floor {
                let spot = self.scene.environment.spot(direction.dir);
                let (radiance, light_pdf, _) = at.prospect.eval(spot);
                let share = self.escape_weight(at, direction.pdf, light_pdf);
                light += throughput * radiance * share;
            }
            return (light, None);
        };
        let depth = depth + 1;
        let look = self.look(ray.origin + hit.distance() * ray.dir, draws, depth);
        let glow = look.map(|look| self.glow(&look));
        let fate = start.worth.on_arrival(throughput, glow, depth);
        if draws.point(depth, Purpose::Choice)[3] >= fate.survival {
            return (light, None);
        }
        let arrival = Arrival {
            scatter: Scatter::new(self.scene, &ray, &hit, false, blend),
            look,
            throughput: throughput / fate.survival,
            copies: fate.copies,
        };
        (light, Some(arrival))
    }

    /// What is known of the light at a place that a path comes to.
    fn look(&self, place: Vec3, draws: &Draws, depth: u32) -> Option<Look<'_>> {
        let outlook = (self.scene.outlook.as_ref()).filter(|_| self.sampler == Sampler::Qsir)?;
        let [x, y, z, _] = draws.point(depth, Purpose::Outlook);
        outlook.look(place, [x, y, z])
    }

    /// Mean radiance at a place over that where nothing is in the way: lamps are thought to light all places alike.
    fn glow(&self, look: &Look<'_>) -> f32 {
        1.0 + self.far_share * (look.glow - 1.0)
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
