//! Everything that a renderer needs, resolved and immutable. Scene units are millimeters.

mod backdrop;
mod camera;
mod environment;
mod flatten;
mod ground;
mod joints;
mod lamps;
mod outlook;
mod ribbon;
mod strands;
mod surface;
mod tree;

pub use crate::accel::Ray;

use crate::accel::AccelError;
pub use backdrop::Backdrop;
pub use camera::{Camera, View};
pub use environment::{
    Aim, BINS, Environment, EnvironmentError, EnvironmentSample, Spot, Sun,
    load as load_environment,
};
pub use ground::Ground;
pub use lamps::{Emitter, EmitterShape, Lamp, LampChoice, LampSample, LampShape, MOST_LAMPS};
pub use outlook::{Look, Outlook, Sight};
pub use ribbon::Segment;
pub use strands::{Departure, Leaving, StrandHit, Strands};
pub use surface::{Surface, SurfaceHit};
pub use tree::Found;

use crate::blame::Blame;
use crate::bsdf::HairMaterial;
use crate::color::Rgb;
use crate::groom::Groom;
use crate::skin::Skin;
use glam::{Vec3, Vec4Swizzles};
use rayon::prelude::*;

/// Leaves that are looked at together where several threads look at all.
const BATCH: usize = 4096;

/// What a scene is made of.
pub struct SceneParts<'a> {
    /// The fur.
    pub groom: &'a Groom,
    /// Scattering of each hair class of the groom, in its order.
    pub materials: Vec<HairMaterial>,
    /// The skin and its linear diffuse reflectance.
    pub skin: Option<(&'a Skin, Rgb)>,
    /// The light from far away.
    pub environment: Environment,
    /// Lamps beside it, at most [`MOST_LAMPS`].
    pub lamps: &'a [Lamp],
    /// What is behind the subject.
    pub backdrop: Backdrop,
    /// Reflectance of a floor under the subject, 0..1; `None` for no floor.
    pub ground: Option<f32>,
    /// Where to look from.
    pub view: View,
}

/// A scene ready for rendering.
pub struct Scene {
    /// The fur.
    pub strands: Strands,
    /// Scattering of each hair class.
    pub materials: Vec<HairMaterial>,
    /// Names of the hair classes.
    pub classes: Vec<String>,
    /// Names of the zones of the coat.
    pub zones: Vec<String>,
    /// The skin under it.
    pub surface: Option<Surface>,
    /// The floor under it.
    pub ground: Option<Ground>,
    /// The light from far away.
    pub environment: Environment,
    /// What comes of it to places in the fur; `None` where there is nothing to choose.
    pub outlook: Option<Outlook>,
    /// Lamps beside it.
    pub lamps: Vec<Emitter>,
    /// What is behind the subject.
    pub backdrop: Backdrop,
    /// Where to look from.
    pub view: View,
}

/// Something in front of a ray.
#[derive(Clone, Copy, Debug)]
pub enum Hit {
    /// A hair.
    Strand(StrandHit),
    /// The skin.
    Surface(SurfaceHit),
    /// The floor, at this distance.
    Ground(f32),
}

impl Hit {
    /// Along the ray.
    pub fn distance(&self) -> f32 {
        match self {
            Self::Strand(hit) => hit.t,
            Self::Surface(hit) => hit.t,
            Self::Ground(t) => *t,
        }
    }
}

impl Scene {
    /// Sorts everything for tracing.
    pub fn build(parts: SceneParts<'_>) -> Result<Self, SceneError> {
        let needed = parts
            .groom
            .class
            .iter()
            .max()
            .map_or(0, |&c| c as usize + 1);
        if needed > parts.materials.len() {
            return Err(SceneError::Materials {
                needed,
                given: parts.materials.len(),
            });
        }
        let mut strands = Strands::build(parts.groom)?;
        if parts.materials.iter().any(HairMaterial::has_azimuths) {
            strands.carry_sides(parts.groom);
        }
        let surface = match parts.skin {
            Some((skin, color)) => {
                let of = |vertex| parts.groom.skin_color(skin, vertex) * color;
                Some(Surface::build(skin, of)?)
            }
            None => None,
        };
        let mut scene = Self {
            strands,
            materials: parts.materials,
            classes: named(&parts.groom.classes, &parts.groom.class, "class"),
            zones: named(&parts.groom.coats, &parts.groom.coat, "zone"),
            surface,
            ground: None,
            environment: parts.environment,
            outlook: None,
            lamps: Vec::new(),
            backdrop: parts.backdrop,
            view: parts.view,
        };
        let wider = |a: (Vec3, Vec3), b: (Vec3, Vec3)| (a.0.min(b.0), a.1.max(b.1));
        let bounds = |batch| scene.subject(batch).map(|p| (p, p)).reduce(wider);
        let batches = (0..scene.batches()).into_par_iter();
        let Some((lo, hi)) = batches.filter_map(bounds).reduce_with(wider) else {
            return Err(SceneError::Empty);
        };
        let center = 0.5 * (lo + hi);
        let placed = (parts.lamps.iter().enumerate()).map(|(index, lamp)| {
            let emitter = Emitter::new(lamp, center, 0.5 * (hi - lo).length());
            emitter.ok_or(SceneError::Lamp { index })
        });
        scene.lamps = placed.collect::<Result<_, _>>()?;
        if scene.lamps.len() > MOST_LAMPS {
            return Err(SceneError::Lamps {
                count: scene.lamps.len(),
            });
        }
        scene.outlook = Outlook::build(
            &scene.strands,
            scene.surface.as_ref(),
            &scene.environment,
            (lo, hi),
        );
        scene.ground = parts.ground.map(|reflectance| Ground {
            reflectance,
            height: lo.y,
            center,
            reach: 1.5 * (hi - lo).length(),
            open: scene.environment.irradiance_up() / std::f32::consts::PI,
            light: scene.environment.above_horizon(),
        });
        Ok(scene)
    }

    /// The camera for a picture of a given width over height.
    pub fn camera(&self, aspect: f32) -> Camera {
        Camera::framing(self.batches(), |b| self.subject(b), &self.view, aspect)
    }

    /// Mean radiance over all directions, in the middle of the subject.
    pub fn mean_light(&self) -> Rgb {
        let lamps: Rgb = self.lamps.iter().map(Emitter::mean).sum();
        self.environment.mean() + lamps
    }

    /// Radiance of white paint on the floor, at a point of it, if there were no subject.
    pub fn open_floor(&self, ground: &Ground, point: Vec3) -> Rgb {
        let lamps: Rgb = (self.lamps.iter())
            .map(|lamp| lamp.irradiance(point, Vec3::Y))
            .sum();
        ground.open() + lamps / std::f32::consts::PI
    }

    /// The nearest thing in front of a ray.
    pub fn closest(&self, ray: &Ray, leaving: Option<Leaving>) -> Option<Hit> {
        // Strands before the skin: in fur most rays meet one near where they start. At one distance the strand is
        // in front.
        let mut limit = f32::INFINITY;
        let mut found = None;
        let strand = self.strands.nearest(ray, limit, leaving);
        if let Some(found) = &strand {
            limit = found.t;
        }
        let nearer = limit.next_down();
        if let Some(hit) = self.surface.as_ref().and_then(|s| s.closest(ray, nearer)) {
            limit = hit.t;
            found = Some(Hit::Surface(hit));
        }
        if let Some(t) = self.ground.as_ref().and_then(|g| g.hit(ray, limit)) {
            found = Some(Hit::Ground(t));
        }
        found.or_else(|| strand.map(|strand| Hit::Strand(self.strands.describe(&strand, ray))))
    }

    /// Whether anything is in front of a ray nearer than `far`, which is infinite for the environment.
    pub fn occluded(&self, ray: &Ray, far: f32, leaving: Option<Leaving>) -> bool {
        // Strands before the skin: in fur they stop most rays, and near where they start.
        self.ground
            .as_ref()
            .is_some_and(|g| g.hit(ray, far).is_some())
            || self.strands.occluded(ray, far, leaving)
            || self.surface.as_ref().is_some_and(|s| s.occluded(ray, far))
    }

    fn batches(&self) -> usize {
        1 + self.strands.tree().leaves().div_ceil(BATCH)
    }

    /// Points that have to be in the picture: the skin's, then those of some leaves of the tree a batch.
    fn subject(&self, batch: usize) -> impl Iterator<Item = Vec3> {
        let first = batch.saturating_sub(1) * BATCH;
        let tree = self.strands.tree();
        let end = (batch * BATCH).min(tree.leaves());
        let strands = tree.joints(first..end).map(|joint| joint.xyz());
        let skin = self.surface.iter().filter(move |_| batch == 0);
        strands.chain(skin.flat_map(|s| s.corners().iter().flatten().copied()))
    }
}

/// Names of all that strands belong to, and where the groom has none a word and the number.
fn named(names: &[String], used: &[u8], word: &str) -> Vec<String> {
    let count = used.iter().max().map_or(1, |&most| usize::from(most) + 1);
    let mut names = names.to_vec();
    names.extend((names.len()..count).map(|i| format!("{word} {i}")));
    names
}

/// A scene that cannot be traced.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// Neither strands nor skin.
    #[error("the scene is empty: no strand has a length and there is no skin")]
    Empty,
    /// The arrays of a groom do not fit together.
    #[error("the groom's arrays do not fit together: {strands} strands, {points} points")]
    Groom {
        /// Strands by their classes.
        strands: usize,
        /// Control points.
        points: usize,
    },
    /// A control point that cannot be traced.
    #[error(
        "control point {index} of the groom is at {at} m and {width} m wide: not finite or too large"
    )]
    Point {
        /// Index of the point.
        index: usize,
        /// Its position, meters.
        at: Vec3,
        /// Its full width, meters.
        width: f32,
    },
    /// The arrays of a skin do not fit together.
    #[error(
        "the skin's arrays do not fit together: {vertices} vertices, a triangle or normal is off"
    )]
    Skin {
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// Something not finite or more than a kilometer away.
    #[error("geometry at {at} mm is not finite or more than a kilometer away")]
    Coordinates {
        /// Where, millimeters.
        at: Vec3,
    },
    /// Too many triangles in exactly the same place.
    #[error("{count} triangles of the skin fill exactly the same box at {at} mm")]
    Coincident {
        /// How many.
        count: usize,
        /// Where, millimeters.
        at: Vec3,
    },
    /// A lamp that cannot be placed.
    #[error("lamp {} has no size or distance, or the middle of the subject is inside of it", index + 1)]
    Lamp {
        /// Which, from 0.
        index: usize,
    },
    /// Too many lamps.
    #[error("{count} lamps are given, at most {MOST_LAMPS} are possible")]
    Lamps {
        /// How many.
        count: usize,
    },
    /// Hair classes without a material.
    #[error("the groom has {needed} hair classes but only {given} materials are given")]
    Materials {
        /// Classes used.
        needed: usize,
        /// Materials there are.
        given: usize,
    },
}

impl SceneError {
    /// Geometry comes from the user, materials from this program.
    pub fn blame(&self) -> Blame {
        match self {
            Self::Materials { .. } => Blame::Internal,
            _ => Blame::Input,
        }
    }
}

impl From<AccelError> for SceneError {
    fn from(error: AccelError) -> Self {
        match error {
            AccelError::Coordinates { at } => Self::Coordinates { at },
            AccelError::Coincident { count, at } => Self::Coincident { count, at },
        }
    }
}

#[cfg(test)]
mod tests;
