//! The froth: spheres of air that do not touch, found through a uniform grid of cells.

use super::packing;
use super::section::{Section, nearest_period};
use glam::{DVec3, IVec3};

/// A spherical void, micrometers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sphere {
    pub(super) center: DVec3,
    pub(super) radius: f64,
}

/// The spheres of one period.
#[derive(Clone, Debug)]
pub(super) struct Froth {
    pub(super) period: f64,
    pub(super) spheres: Vec<Sphere>,
    /// Corner of cell (0, 0, 0) and size of a cell.
    corner: DVec3,
    cell: DVec3,
    count: IVec3,
    /// Where the spheres of a cell begin in `members`.
    first: Vec<u32>,
    members: Vec<u32>,
}

impl Froth {
    /// Sorts packed spheres into cells.
    pub(super) fn new(packed: packing::Packing, section: &Section, ratio: f64) -> Self {
        let packing::Packing { spheres, period } = packed;
        let (rx, ry) = (ratio * section.a, ratio * section.b);
        let mean = spheres.iter().map(|s| s.radius).sum::<f64>() / spheres.len().max(1) as f64;
        // About one sphere a cell: smaller cells cost steps, larger ones tests.
        let size = 2.0 * mean.max(0.25);
        let count = DVec3::new(2.0 * rx, 2.0 * ry, period) / size;
        let count = count.ceil().max(DVec3::ONE).min(DVec3::splat(256.0));
        let mut froth = Self {
            period,
            spheres,
            corner: DVec3::new(-rx, -ry, 0.0),
            cell: DVec3::new(2.0 * rx, 2.0 * ry, period) / count,
            count: count.as_ivec3(),
            first: Vec::new(),
            members: Vec::new(),
        };
        let cells = (froth.count.x * froth.count.y * froth.count.z) as usize;
        let mut lists = vec![Vec::new(); cells];
        for (index, sphere) in froth.spheres.iter().enumerate() {
            let r = DVec3::splat(sphere.radius);
            let lo = froth.cell_of(sphere.center - r);
            let hi = froth.cell_of(sphere.center + r);
            for z in lo.z..=hi.z {
                for y in lo.y.max(0)..=hi.y.min(froth.count.y - 1) {
                    for x in lo.x.max(0)..=hi.x.min(froth.count.x - 1) {
                        let cell = IVec3::new(x, y, z);
                        if froth.touches(sphere, cell) {
                            lists[froth.slot(cell)].push(index as u32);
                        }
                    }
                }
            }
        }
        froth.first.push(0);
        for list in lists {
            froth.members.extend(list);
            froth.first.push(froth.members.len() as u32);
        }
        froth
    }

    fn cell_of(&self, p: DVec3) -> IVec3 {
        ((p - self.corner) / self.cell).floor().as_ivec3()
    }

    fn touches(&self, sphere: &Sphere, cell: IVec3) -> bool {
        let lo = self.corner + cell.as_dvec3() * self.cell;
        let nearest = sphere.center.clamp(lo, lo + self.cell);
        nearest.distance_squared(sphere.center) <= sphere.radius * sphere.radius * (1.0 + 1e-9)
    }

    fn slot(&self, cell: IVec3) -> usize {
        let z = cell.z.rem_euclid(self.count.z);
        ((z * self.count.y + cell.y) * self.count.x + cell.x) as usize
    }

    /// Center of the image of a sphere that is nearest in z.
    pub(super) fn center_near(&self, index: u32, z: f64) -> DVec3 {
        let c = self.spheres[index as usize].center;
        DVec3::new(c.x, c.y, c.z + nearest_period(z - c.z, self.period))
    }

    /// First sphere that the ray enters in `t0..t1`: time and index.
    ///
    /// * `from`: the sphere that the ray starts on, leaving it.
    pub(super) fn enter(
        &self,
        origin: DVec3,
        dir: DVec3,
        t0: f64,
        t1: f64,
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        let start = origin + t0 * dir;
        let inside = self.count - IVec3::ONE;
        let mut cell = self.cell_of(start);
        cell.x = cell.x.clamp(0, inside.x);
        cell.y = cell.y.clamp(0, inside.y);
        let forward = DVec3::select(dir.cmpge(DVec3::ZERO), DVec3::ONE, DVec3::ZERO);
        let step = (2.0 * forward - 1.0).as_ivec3();
        let inverse = 1.0 / dir;
        let delta = (self.cell * inverse).abs();
        let mut next = ((cell.as_dvec3() + forward) * self.cell + self.corner - origin) * inverse;
        // A component of zero never reaches its plane, whatever 0 * inf says.
        for (n, d) in next.as_mut().iter_mut().zip(dir.to_array()) {
            if d == 0.0 {
                *n = f64::INFINITY;
            }
        }
        loop {
            let leave = next.min_element().min(t1);
            let slot = self.slot(cell);
            let z = self.corner.z + (f64::from(cell.z) + 0.5) * self.cell.z;
            let mut best: Option<(f64, u32)> = None;
            for &index in &self.members[self.first[slot] as usize..self.first[slot + 1] as usize] {
                let center = self.center_near(index, z);
                let radius = self.spheres[index as usize].radius;
                let Some(t) = enter_sphere(origin, dir, center, radius) else {
                    continue;
                };
                let on_it = from == Some(index)
                    && (origin - center).length_squared() <= radius * radius * (1.0 + 1e-6);
                if t >= t0 && t < t1 && !on_it && best.is_none_or(|(b, _)| t < b) {
                    best = Some((t, index));
                }
            }
            // A sphere of this cell may be hit beyond it, behind one of a later cell.
            if let Some((t, _)) = best
                && t <= leave
            {
                return best;
            }
            if leave >= t1 {
                return best;
            }
            if next.x <= next.y && next.x <= next.z {
                cell.x += step.x;
                next.x += delta.x;
            } else if next.y <= next.z {
                cell.y += step.y;
                next.y += delta.y;
            } else {
                cell.z += step.z;
                next.z += delta.z;
            }
            if cell.x < 0 || cell.x > inside.x || cell.y < 0 || cell.y > inside.y {
                return None;
            }
        }
    }

    /// Where a ray that starts on or in a sphere leaves it.
    pub(super) fn leave(&self, origin: DVec3, dir: DVec3, index: u32, on_it: bool) -> f64 {
        let to = origin - self.center_near(index, origin.z);
        let b = to.dot(dir);
        if on_it {
            // The root at the start is known; the other is the chord.
            return (-2.0 * b).max(0.0);
        }
        let r = self.spheres[index as usize].radius;
        (-b + (b * b - to.length_squared() + r * r).max(0.0).sqrt()).max(0.0)
    }

    /// The sphere that holds a point.
    pub(super) fn at(&self, p: DVec3) -> Option<u32> {
        let cell = self.cell_of(p);
        let outside = cell.x < 0 || cell.y < 0 || cell.x >= self.count.x || cell.y >= self.count.y;
        if outside {
            return None;
        }
        let slot = self.slot(cell);
        self.members[self.first[slot] as usize..self.first[slot + 1] as usize]
            .iter()
            .copied()
            .find(|&index| {
                let r = self.spheres[index as usize].radius;
                p.distance_squared(self.center_near(index, p.z)) < r * r
            })
    }

    /// Volume of the spheres, cubic micrometers a period.
    pub(super) fn volume(&self) -> f64 {
        packing::volume(&self.spheres)
    }
}

/// Where a ray from outside enters a sphere.
fn enter_sphere(origin: DVec3, dir: DVec3, center: DVec3, radius: f64) -> Option<f64> {
    let to = origin - center;
    let b = to.dot(dir);
    if b >= 0.0 {
        return None;
    }
    // The distance of the center from the ray by its vector keeps the digits that b^2 - c loses.
    let miss = (to - b * dir).length_squared();
    let h = radius * radius - miss;
    (h > 0.0).then(|| -b - h.sqrt())
}
