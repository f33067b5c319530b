//! The way of a ray from tile to tile.

use super::shear::Shear;
use super::twist::Screw;
use super::{MOST_TILES, OVERLAP};
use glam::{DVec2, DVec3};

/// Square of the radius of a cylinder a little wider than the mesh.
const CYLINDER: f64 = 1.0 + 1e-5;

/// A ray that goes from tile to tile until it has left the cylinder about the mesh.
#[derive(Clone, Debug)]
pub(super) struct Way {
    screw: Screw,
    origin: DVec3,
    dir: DVec3,
    /// Way before the next tile, in radii.
    before: f64,
    /// Way to where it leaves the cylinder, once that was asked for.
    end: Option<f64>,
    /// Periods between the next tile and the mesh.
    image: f64,
    /// Way along the axis from the last tile's begin to its end, in radii.
    rest: f64,
    tiles: usize,
}

/// The part of a ray in one tile.
#[derive(Clone, Debug)]
pub(super) struct Stretch {
    /// In the place of the mesh.
    pub(super) ray: Shear,
    /// Way of the ray before it, and to a little beyond the end of the tile, in radii.
    pub(super) before: f64,
    pub(super) beyond: f64,
    /// Way along the axis to the end of the tile, and all that there is of the ray.
    rest: f64,
    most: f64,
    /// Periods between its tile and the mesh.
    pub(super) image: f64,
    /// Whether it is so near the ray's start that what that lies on might be met again.
    pub(super) is_first: bool,
}

impl Stretch {
    /// Way of the ray to the end of the tile, in radii.
    pub(super) fn length(&self) -> f64 {
        along(self.rest, self.ray.dir).max(0.0).min(self.most)
    }
}

/// Way of a ray that comes along the axis by so much.
#[inline(always)]
fn along(rest: f64, dir: DVec3) -> f64 {
    let way = rest / dir.z;
    if dir.z == 0.0 { f64::INFINITY } else { way }
}

impl Way {
    /// `None` for a ray that does not meet the cylinder.
    ///
    /// * `origin`: in radii.
    #[inline(always)]
    pub(super) fn new(screw: Screw, origin: DVec3, dir: DVec3) -> Option<Self> {
        // A ray that starts within the cylinder about the mesh meets nothing behind that: where it leaves it, is asked
        // for when the first tile has nothing.
        let (before, end) = match is_within_cylinder(origin) {
            true => (0.0, None),
            false => {
                let (begin, end) = within_cylinder(origin, dir)?;
                (begin.max(0.0), Some(end))
            }
        };
        if end.is_some_and(|end| before >= end) {
            return None;
        }
        // Where it starts decides the tile; beyond that only the direction does.
        let start = origin + before * dir;
        Some(Self {
            screw,
            origin,
            dir,
            before,
            end,
            image: (start.z / screw.period).floor(),
            rest: 0.0,
            tiles: 0,
        })
    }
}

impl Iterator for Way {
    type Item = Stretch;

    #[inline(always)]
    fn next(&mut self) -> Option<Stretch> {
        let Self {
            screw, origin, dir, ..
        } = *self;
        if self.tiles > 0 {
            self.before += along(self.rest, dir).max(0.0);
            self.image += dir.z.signum();
            let leaves = || within_cylinder(origin, dir).map_or(0.0, |(_, end)| end);
            if self.tiles == MOST_TILES || self.before >= *self.end.get_or_insert_with(leaves) {
                return None;
            }
        }
        self.tiles += 1;
        let (before, image, period) = (self.before, self.image, screw.period);
        let mut local = origin + before * dir;
        local.z -= image * period;
        // Up or down is chance, and no branch would be guessed.
        let rest = |to: f64| (if dir.z > 0.0 { period + to } else { -to }) - local.z;
        let most = self.end.map_or(f64::INFINITY, |end| end - before);
        self.rest = rest(0.0);
        Some(Stretch {
            ray: Shear::new(screw.turn(local, -image), screw.turn(dir, -image)),
            before,
            beyond: along(rest(OVERLAP), dir).min(most),
            rest: self.rest,
            most,
            image,
            is_first: before <= 0.5 * period,
        })
    }
}

#[inline(always)]
fn is_within_cylinder(point: DVec3) -> bool {
    point.truncate().length_squared() - CYLINDER < 0.0
}

/// Where a ray is within the cylinder about the mesh.
#[inline(always)]
fn within_cylinder(origin: DVec3, dir: DVec3) -> Option<(f64, f64)> {
    let (o, d): (DVec2, DVec2) = (origin.truncate(), dir.truncate());
    let (a, b, c) = (d.length_squared(), o.dot(d), o.length_squared() - CYLINDER);
    if a < 1e-30 {
        return (c < 0.0).then_some((0.0, f64::INFINITY));
    }
    let discriminant = b * b - a * c;
    if discriminant <= 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    Some(((-b - root) / a, (-b + root) / a))
}
