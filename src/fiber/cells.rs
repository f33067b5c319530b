//! Convex cells that fill an elliptic cylinder, each air or keratin or air in a wall of keratin:
//! whatever leaves one through a face is in the neighbor, so that nothing has to be searched.
//!
//! Faces are tested four at a time in single precision, relative to the cell's center; the one that
//! comes first is then met in double precision. Where two faces are nearer to each other than a few
//! millionths of a micrometer the wrong one may be taken: that moves a hit by as much, and loses none,
//! because where a ray is follows from the cells it crosses, never from a sign of a distance.

mod faces;
mod near;
#[cfg(target_arch = "x86_64")]
mod sixteen;
#[cfg(test)]
mod tests;
mod walk;

use super::section::nearest_image;
use faces::{Block, Fours, Tester};
use glam::{DVec2, DVec3, IVec3};
use near::Near;
#[cfg(target_arch = "x86_64")]
pub(super) use sixteen::Sixteens;

/// A cell to be put into the store.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    pub(super) center: DVec3,
    pub(super) faces: Vec<Face>,
    /// Whether there is a void in it.
    pub(super) air: bool,
    /// Whether it reaches over the outline.
    pub(super) rim: bool,
}

/// The half-spaces `normal . p <= cell`, which is the cell, and `normal . p <= void`, which is the void
/// in it, both seen from the center. Infinite where a face bounds only one of them.
#[derive(Clone, Debug)]
pub(super) struct Face {
    pub(super) normal: DVec3,
    pub(super) cell: f64,
    pub(super) void: f64,
    /// What is behind: nothing, a cell, or one of up to three.
    pub(super) next: Vec<Neighbor>,
}

/// A cell and the number of periods that its image is further up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbor {
    pub(super) cell: usize,
    pub(super) up: i8,
}

impl Face {
    /// In single precision, as the store has it, so that the shapes that others keep are the same.
    pub(super) fn new(normal: DVec3, cell: f64, void: f64, next: Vec<Neighbor>) -> Self {
        Self {
            normal: normal.as_vec3().as_dvec3(),
            cell: f64::from(cell as f32),
            void: f64::from(void as f32),
            next,
        }
    }
}

impl Neighbor {
    pub(super) fn new(cell: usize, up: i8) -> Self {
        Self { cell, up }
    }
}

/// The cells of one period.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    period: f64,
    /// Inverse semi-axes of the outline, which ends all voids.
    inverse: DVec2,
    rooms: Vec<Room>,
    blocks: Vec<Block>,
    /// The same for sixteen faces at a time.
    #[cfg(target_arch = "x86_64")]
    sixteens: Vec<sixteen::Faces>,
    /// By slot: four a block.
    links: Vec<Link>,
    forks: Vec<Vec<Link>>,
    /// The cell of each block.
    owners: Vec<u32>,
    near: Near,
}

/// A cell in the store.
#[derive(Clone, Copy, Debug)]
pub(in crate::fiber) struct Room {
    center: DVec3,
    first: u32,
    end: u32,
    /// Of its faces by sixteens.
    #[cfg(target_arch = "x86_64")]
    first_sixteen: u32,
    air: bool,
    rim: bool,
}

/// What is behind a face.
#[derive(Clone, Copy, Debug)]
struct Link {
    /// From the center to the neighbor's.
    step: DVec3,
    next: u32,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// The same matter goes on.
    Open,
    /// One of several, at `next` among the forks; where the ray is says which.
    Fork,
    /// Air on one side, keratin on the other.
    Bare,
    /// The void ends before the face, in a wall of keratin.
    Walled,
}

/// Where something is: a cell, and the place seen from its center.
#[derive(Clone, Copy, Debug)]
struct Place {
    cell: u32,
    at: DVec3,
}

/// Mark of the outline in the number of a face; the rest is then the number of the cell.
const OUTLINE: u32 = 1 << 31;
/// No neighbor.
const NOTHING: u32 = u32::MAX;
/// Cells that a ray crosses at most.
const MOST_CELLS: u32 = 10_000;

impl Cells {
    /// * `semi`: semi-axes of the outline.
    /// * `size`: about the distance of cells.
    pub(super) fn new(cells: &[Cell], semi: DVec2, period: f64, size: f64) -> Self {
        let mut store = Self {
            period,
            inverse: 1.0 / semi,
            rooms: Vec::with_capacity(cells.len()),
            blocks: Vec::new(),
            #[cfg(target_arch = "x86_64")]
            sixteens: Vec::new(),
            links: Vec::new(),
            forks: Vec::new(),
            owners: Vec::new(),
            near: Near::new(semi, period, size),
        };
        for (index, cell) in cells.iter().enumerate() {
            let first = store.blocks.len() as u32;
            for faces in cell.faces.chunks(4) {
                store.owners.push(index as u32);
                store.blocks.push(Block::new(faces));
                for lane in 0..4 {
                    let link = faces
                        .get(lane)
                        .map_or(Link::NOTHING, |face| store.link(cells, index, face));
                    store.links.push(link);
                }
            }
            #[cfg(target_arch = "x86_64")]
            let first_sixteen = store.sixteens.len() as u32;
            #[cfg(target_arch = "x86_64")]
            {
                let blocks = store.blocks[first as usize..].chunks(4);
                store.sixteens.extend(blocks.map(sixteen::Faces::new));
            }
            store.rooms.push(Room {
                center: cell.center,
                first,
                end: store.blocks.len() as u32,
                #[cfg(target_arch = "x86_64")]
                first_sixteen,
                air: cell.air,
                rim: cell.rim,
            });
        }
        store.look_round(semi);
        store
    }

    fn link(&mut self, cells: &[Cell], index: usize, face: &Face) -> Link {
        let from = &cells[index];
        let to = |n: &Neighbor| Link {
            step: cells[n.cell].center + DVec3::Z * (f64::from(n.up) * self.period) - from.center,
            next: n.cell as u32,
            kind: if from.air && face.void < face.cell {
                Kind::Walled
            } else if from.air == cells[n.cell].air {
                Kind::Open
            } else {
                Kind::Bare
            },
        };
        match face.next.as_slice() {
            [] => Link::NOTHING,
            [one] => to(one),
            several => {
                self.forks.push(several.iter().map(to).collect());
                Link {
                    next: self.forks.len() as u32 - 1,
                    kind: Kind::Fork,
                    ..Link::NOTHING
                }
            }
        }
    }

    /// Fills the coarse grid, each box from the one before.
    fn look_round(&mut self, semi: DVec2) {
        let count = self.near.count;
        let mut cell = 0;
        for z in 0..count.z {
            for y in 0..count.y {
                for x in 0..count.x {
                    let middle = (IVec3::new(x, y, z).as_dvec3() + 0.5) / self.near.inverse;
                    let p = middle - semi.extend(0.0);
                    cell = self.seek(Fours, self.place(cell, p)).cell;
                    self.near.cells.push(cell);
                }
            }
        }
    }

    #[inline]
    fn place(&self, cell: u32, p: DVec3) -> Place {
        let center = self.rooms[cell as usize].center;
        let at = p - nearest_image(center, p.z, self.period);
        Place { cell, at }
    }

    #[inline]
    fn blocks_of(&self, room: &Room) -> &[Block] {
        &self.blocks[room.first as usize..room.end as usize]
    }

    /// What is behind a face at a place on it, of any matter or only of one.
    #[inline(always)]
    fn behind<'a>(
        &'a self,
        faces: impl Tester,
        place: Place,
        link: &'a Link,
        air: Option<bool>,
    ) -> &'a Link {
        if link.kind != Kind::Fork {
            return link;
        }
        let (mut best, mut most) = (link, f32::NEG_INFINITY);
        for way in &self.forks[link.next as usize] {
            let room = self.room_left(faces, place.through(way)).0;
            if room > most && air.is_none_or(|air| self.rooms[way.next as usize].air == air) {
                (best, most) = (way, room);
            }
        }
        best
    }

    /// The place of a point on a face, on the side of air or of keratin.
    #[inline(always)]
    fn beside(&self, faces: impl Tester, face: u32, p: DVec3, air: bool) -> Place {
        let place = self.place(self.owners[face as usize / 4], p);
        let link = &self.links[face as usize];
        if link.kind == Kind::Walled || self.rooms[place.cell as usize].air == air {
            return place;
        }
        place.through(self.behind(faces, place, link, Some(air)))
    }

    /// Distance from the nearest face of the cell, negative outside, and the slot of that face.
    #[inline(always)]
    fn room_left(&self, faces: impl Tester, place: Place) -> (f32, usize) {
        faces.room_left(self, &self.rooms[place.cell as usize], place.at.as_vec3())
    }

    /// The cell of a place, going from cell to cell through the face that it is farthest behind.
    #[inline(always)]
    fn seek(&self, faces: impl Tester, mut place: Place) -> Place {
        for _ in 0..MOST_CELLS {
            let (room, slot) = self.room_left(faces, place);
            let link = self.behind(faces, place, &self.links[slot], None);
            if room >= 0.0 || link.next == NOTHING {
                break;
            }
            place = place.through(link);
        }
        place
    }

    #[inline(always)]
    fn find_by(&self, faces: impl Tester, p: DVec3) -> Place {
        self.seek(
            faces,
            self.place(self.near.cell(p, 1.0 / self.inverse, self.period), p),
        )
    }

    /// Where a ray is within the outline.
    #[inline]
    fn outline(&self, origin: DVec3, dir: DVec3) -> Option<(f64, f64)> {
        let (o, d) = (
            origin.truncate() * self.inverse,
            dir.truncate() * self.inverse,
        );
        let (a, b, c) = (d.length_squared(), o.dot(d), o.length_squared() - 1.0);
        if a < 1e-30 {
            return (c < 0.0).then_some((f64::NEG_INFINITY, f64::INFINITY));
        }
        let root = b * b - a * c;
        if root <= 0.0 {
            return None;
        }
        // The sum of equal signs loses no digits; the other root follows from their product.
        Some(if b >= 0.0 {
            let q = -b - root.sqrt();
            (q / a, c / q)
        } else {
            let q = root.sqrt() - b;
            (c / q, q / a)
        })
    }

    /// Outward normal of a face at a point, of any length.
    pub(super) fn gradient(&self, face: u32, p: DVec3) -> DVec3 {
        if face & OUTLINE != 0 {
            return (p.truncate() * self.inverse * self.inverse).extend(0.0);
        }
        self.blocks[face as usize / 4].normal(face as usize % 4)
    }
}

impl Place {
    /// The same place seen from a neighbor.
    #[inline]
    fn through(self, link: &Link) -> Self {
        Self {
            cell: link.next,
            at: self.at - link.step,
        }
    }
}

impl Link {
    const NOTHING: Self = Self {
        step: DVec3::ZERO,
        next: NOTHING,
        kind: Kind::Walled,
    };
}
