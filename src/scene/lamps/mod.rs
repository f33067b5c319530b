//! Lamps beside the environment: they give light, throw no shadow of their own, and the camera does not see
//! them.

mod cone;
mod rect;

use crate::accel::Ray;
use crate::color::{Rgb, luminance};
use cone::Cone;
use glam::{DVec3, Vec3};
use rect::{Rect, SphericalRect};
use std::f32::consts::PI;

/// Most lamps of a scene: all are weighed at every scattering.
pub const MOST_LAMPS: usize = 16;

/// A lamp as it is asked for, relative to the subject, at whose middle it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// What it is.
    pub shape: LampShape,
    /// Where it stands around the subject, degrees: 0 is +Z, 90 +X.
    pub yaw_deg: f32,
    /// How high it stands, as an angle above the level of the subject's middle, degrees, -90..90.
    pub pitch_deg: f32,
    /// Radiance that white paint has in the middle of the subject if it faces the lamp and sees nothing else,
    /// >= 0. Moving or resizing a lamp changes its shadows, not how bright it is there.
    pub strength: Rgb,
}

/// Shapes of lamps. Lengths in radii of the subject, which are half the diagonal of its bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LampShape {
    /// A rectangle that shines to the side where the subject is.
    Rect {
        /// From the middle of the subject to that of the lamp, > 0.
        distance: f32,
        /// Width and height, > 0.
        size: [f32; 2],
    },
    /// A ball.
    Sphere {
        /// From the middle of the subject to that of the lamp, more than the radius of the ball.
        distance: f32,
        /// Of the ball, > 0.
        radius: f32,
    },
    /// A disk at infinite distance.
    Sun {
        /// Degrees across, > 0 and below 180.
        diameter_deg: f32,
    },
}

/// A lamp at its place, scene units.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    place: Place,
    /// Radiance of its surface.
    radiance: Rgb,
    /// Mean radiance over all directions, in the middle of the subject.
    mean: Rgb,
}

/// What shines at its place, scene units.
#[derive(Clone, Copy, Debug)]
pub enum EmitterShape {
    /// A rectangle.
    Rect {
        /// Its middle.
        center: Vec3,
        /// Half its width and half its height, as vectors.
        half: [Vec3; 2],
        /// Unit, to the side that shines: the cross product of the halves has this direction.
        facing: Vec3,
    },
    /// A ball.
    Sphere {
        /// Its middle.
        center: Vec3,
        /// Its radius.
        radius: f32,
    },
    /// A disk at infinite distance.
    Sun {
        /// Unit, to its middle.
        toward: Vec3,
        /// Sine of half the angle that it fills.
        sin: f32,
    },
}

/// Where light comes from. Double precision: lamps may be small and far away.
#[derive(Clone, Copy, Debug)]
enum Place {
    Rect(Rect),
    Sphere { center: DVec3, radius: f64 },
    Sun(Cone),
}

/// A place as it looks from a point.
#[derive(Clone, Copy)]
enum Look {
    Rect(SphericalRect),
    Cone(Cone),
}

/// A direction to a lamp.
#[derive(Clone, Copy, Debug)]
pub struct LampSample {
    /// Unit.
    pub dir: Vec3,
    /// Distance to the lamp; infinite for the sun.
    pub distance: f32,
    /// Radiance from there, of this lamp alone.
    pub radiance: Rgb,
    /// Density per steradian with which this lamp and direction are drawn, > 0.
    pub pdf: f32,
}

/// The lamps as they look from one point: how likely each is to be drawn there.
#[derive(Clone, Copy)]
pub struct LampChoice<'a> {
    lamps: &'a [Emitter],
    from: Vec3,
    /// Chances; they sum to 1.
    chance: [f32; MOST_LAMPS],
    /// Density per steradian of each, chance included; 0 for lamps that are not seen.
    pdf: [f32; MOST_LAMPS],
}

impl Emitter {
    /// Puts a lamp where it belongs; `None` if it has no size, no distance, or holds the subject's middle.
    ///
    /// * `center`, `radius`: of the subject, scene units.
    pub fn new(lamp: &Lamp, center: Vec3, radius: f32) -> Option<Self> {
        let (yaw, pitch) = (
            f64::from(lamp.yaw_deg).to_radians(),
            f64::from(lamp.pitch_deg).to_radians(),
        );
        let toward = DVec3::new(
            yaw.sin() * pitch.cos(),
            pitch.sin(),
            yaw.cos() * pitch.cos(),
        );
        let (center, unit) = (center.as_dvec3(), f64::from(radius));
        let length = |x: f32| {
            let length = unit * f64::from(x);
            (length > 0.0 && length.is_finite()).then_some(length)
        };
        let place = match lamp.shape {
            LampShape::Rect { distance, size } => {
                let across = DVec3::new(yaw.cos(), 0.0, -yaw.sin());
                // Looking back at the subject its front is -toward, and across is to the left.
                Place::Rect(Rect {
                    center: center + toward * length(distance)?,
                    axes: [-across, toward.cross(across), -toward],
                    half: [0.5 * length(size[0])?, 0.5 * length(size[1])?],
                })
            }
            LampShape::Sphere { distance, radius } => Place::Sphere {
                center: center + toward * length(distance)?,
                radius: length(radius)?,
            },
            LampShape::Sun { diameter_deg } => {
                let half = (0.5 * f64::from(diameter_deg)).to_radians();
                (diameter_deg > 0.0 && diameter_deg < 180.0)
                    .then(|| Place::Sun(Cone::new(toward, half.sin() * half.sin())))?
            }
        };
        let facing = place.irradiance(center, toward);
        (facing > 0.0).then(|| Self {
            place,
            radiance: lamp.strength * (f64::from(PI) / facing) as f32,
            // All of it as if from one direction.
            mean: 0.25 * lamp.strength,
        })
    }

    /// Radiance of its surface.
    pub fn radiance(&self) -> Rgb {
        self.radiance
    }

    /// What shines.
    pub fn shape(&self) -> EmitterShape {
        match self.place {
            Place::Rect(rect) => EmitterShape::Rect {
                center: rect.center.as_vec3(),
                half: [0, 1].map(|i| (rect.axes[i] * rect.half[i]).as_vec3()),
                facing: rect.axes[2].as_vec3(),
            },
            Place::Sphere { center, radius } => EmitterShape::Sphere {
                center: center.as_vec3(),
                radius: radius as f32,
            },
            Place::Sun(cone) => EmitterShape::Sun {
                toward: cone.axis().as_vec3(),
                sin: cone.sin() as f32,
            },
        }
    }

    /// Mean radiance over all directions, in the middle of the subject, roughly.
    pub fn mean(&self) -> Rgb {
        self.mean
    }

    /// Irradiance of this lamp alone on a plane through a point.
    ///
    /// * `normal`: unit, of the plane.
    pub fn irradiance(&self, point: Vec3, normal: Vec3) -> Rgb {
        let of_one = (self.place).irradiance(point.as_dvec3(), normal.as_dvec3());
        self.radiance * of_one as f32
    }
}

impl Place {
    /// How it looks from a point; `None` from where it cannot be seen.
    fn seen_from(&self, point: DVec3) -> Option<Look> {
        match self {
            Self::Rect(rect) => rect.seen_from(point).map(Look::Rect),
            Self::Sphere { center, radius } => {
                let d = *center - point;
                let sin2 = radius * radius / d.length_squared();
                (sin2 < 1.0).then(|| Look::Cone(Cone::new(d.normalize(), sin2)))
            }
            Self::Sun(cone) => Some(Look::Cone(*cone)),
        }
    }

    /// Distance along a ray to where it shines toward the ray's start.
    fn hit(&self, origin: DVec3, dir: DVec3) -> Option<f64> {
        match self {
            Self::Rect(rect) => rect.hit(origin, dir),
            Self::Sphere { center, radius } => {
                let d = *center - origin;
                let along = d.dot(dir);
                let inside = radius * radius - (d - along * dir).length_squared();
                let t = along - inside.max(0.0).sqrt();
                (inside >= 0.0 && t > 0.0).then_some(t)
            }
            Self::Sun(cone) => cone.holds(dir).then_some(f64::INFINITY),
        }
    }

    /// Irradiance of radiance 1.
    fn irradiance(&self, point: DVec3, normal: DVec3) -> f64 {
        match (self, self.seen_from(point)) {
            (Self::Rect(rect), _) => rect.irradiance(point, normal),
            (_, Some(Look::Cone(cone))) => cone.irradiance(normal),
            _ => 0.0,
        }
    }
}

impl Look {
    fn solid_angle(&self) -> f64 {
        match self {
            Self::Rect(rect) => rect.solid_angle(),
            Self::Cone(cone) => cone.solid_angle(),
        }
    }
}

impl<'a> LampChoice<'a> {
    /// Weighs lamps by the light that they would give to a point with nothing between.
    ///
    /// * `lamps`: at most [`MOST_LAMPS`].
    pub fn new(lamps: &'a [Emitter], from: Vec3) -> Self {
        let point = from.as_dvec3();
        let (mut chance, mut pdf) = ([0.0; MOST_LAMPS], [0.0; MOST_LAMPS]);
        let mut sum = 0.0;
        for (i, lamp) in lamps.iter().enumerate() {
            let look = lamp.place.seen_from(point);
            let solid_angle = look.map_or(0.0, |look| look.solid_angle() as f32);
            let brightness = luminance(lamp.radiance);
            chance[i] = solid_angle * brightness;
            pdf[i] = if solid_angle > 0.0 { brightness } else { 0.0 };
            sum += chance[i];
        }
        let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        Self {
            lamps,
            from,
            chance: chance.map(|c| c * scale),
            pdf: pdf.map(|p| p * scale),
        }
    }

    /// Draws a lamp and a direction to it from three numbers in `[0, 1)`; `None` where no lamp is seen.
    pub fn sample(&self, u: [f32; 3]) -> Option<LampSample> {
        let mut left = u[2];
        let seen = |i: &usize| self.pdf[*i] > 0.0;
        // Rounding may leave something after the last.
        let last = (0..self.lamps.len()).rfind(seen)?;
        let mut chosen = last;
        for i in (0..last).filter(seen) {
            if left < self.chance[i] {
                chosen = i;
                break;
            }
            left -= self.chance[i];
        }
        let lamp = &self.lamps[chosen];
        let point = self.from.as_dvec3();
        let u = [f64::from(u[0]), f64::from(u[1])];
        let (dir, distance) = match (lamp.place.seen_from(point)?, lamp.place) {
            (Look::Rect(rect), _) => {
                let to = rect.sample(u);
                (to.normalize(), to.length())
            }
            (Look::Cone(cone), place) => {
                let dir = cone.sample(u);
                // At the very rim rounding may miss the ball.
                let rim = |center: DVec3| (center - point).length();
                let distance = place.hit(point, dir).unwrap_or(match place {
                    Place::Sphere { center, .. } => rim(center),
                    _ => f64::INFINITY,
                });
                (dir, distance)
            }
        };
        Some(LampSample {
            dir: dir.as_vec3(),
            distance: distance as f32,
            radiance: lamp.radiance,
            pdf: self.pdf[chosen],
        })
    }

    /// Light of the lamps that a ray meets in front of `limit`, each weighted by a function of its density of
    /// [`LampChoice::sample`].
    pub fn met(&self, ray: &Ray, limit: f32, weight: impl Fn(f32) -> f32) -> Rgb {
        let (origin, dir) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
        let mut sum = Rgb::ZERO;
        for (lamp, pdf) in self.lamps.iter().zip(self.pdf) {
            let hit = lamp.place.hit(origin, dir);
            if hit.is_some_and(|t| t as f32 <= limit) {
                sum += lamp.radiance * weight(pdf);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests;
