//! Meshes that are no fiber: what is wrong, in which part, and where.

use glam::DVec3;
use std::fmt;

/// A mesh that cannot be traced. Places are in the units and axes of the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// More triangles than are taken.
    #[error("{file}: {count} triangles, at most {limit} are taken: simplify the mesh")]
    TooMany {
        /// The mesh file.
        file: String,
        /// Triangles in it.
        count: usize,
        /// Most that are taken.
        limit: usize,
    },
    /// Nothing but triangles without area.
    #[error("{file}: {part} has no triangle with an area")]
    Empty {
        /// The mesh file.
        file: String,
        /// What is missing.
        part: &'static str,
    },
    /// The mesh is longer than its period.
    #[error(
        "{file}: the mesh is {length_um:.4} um long, its period only {period_um} um: is unit_um, \
         axis or period_um wrong?"
    )]
    Period {
        /// The mesh file.
        file: String,
        /// Extent along the axis.
        length_um: f64,
        /// The period asked for.
        period_um: f64,
    },
    /// Edges with a face on one side only, other than at matching ends.
    #[error(
        "{file}: the {part} is open along {count} edges, {places}: close the holes{}",
        ends_hint(*at_ends)
    )]
    Open {
        /// The mesh file.
        file: String,
        /// What is open.
        part: &'static str,
        /// How many edges.
        count: usize,
        /// Middles of the first ones.
        places: Places,
        /// Whether all of them are at the two ends.
        at_ends: bool,
    },
    /// Edges of more than two faces that do not bound something by twos.
    #[error(
        "{file}: {count} edges of the {part} belong to three faces or more, {places}: remove inner faces"
    )]
    NonManifold {
        /// The mesh file.
        file: String,
        /// What has them.
        part: &'static str,
        /// How many edges.
        count: usize,
        /// Middles of the first ones.
        places: Places,
    },
    /// A surface with one side, like a Moebius strip.
    #[error("{file}: the {part} has no inside, its surface has one side only, {places}")]
    OneSided {
        /// The mesh file.
        file: String,
        /// What has one side.
        part: &'static str,
        /// Where two sides meet.
        places: Places,
    },
    /// Faces that go through each other.
    #[error(
        "{file}: the {part} goes through the {other} at {count} pairs of faces, {places}: {}",
        if part == other { "unite overlapping solids (boolean union)" } else { "parts must lie inside each other without touching" }
    )]
    Crossing {
        /// The mesh file.
        file: String,
        /// What of the mesh.
        part: &'static str,
        /// What it goes through, itself or another part.
        other: &'static str,
        /// Pairs of faces.
        count: usize,
        /// Where the first ones are.
        places: Places,
    },
    /// More triangles in one place than can be told apart in time.
    #[error("{file}: so many faces lie upon each other that they cannot be checked, {places}")]
    Crowded {
        /// The mesh file.
        file: String,
        /// Where.
        places: Places,
    },
    /// A medulla or void that is not within the cuticle.
    #[error("{file}: the {part} lies outside of the cuticle, {places}")]
    Outside {
        /// The mesh file.
        file: String,
        /// Which part.
        part: &'static str,
        /// A point of it.
        places: Places,
    },
}

fn ends_hint(at_ends: bool) -> &'static str {
    if at_ends {
        "; all of them are at the two ends, whose rims do not match one period_um apart, or say \
         ends = \"capped\" if the ends are closed in the file"
    } else {
        ""
    }
}

/// The first few places of something.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Places {
    /// In units and axes of the file.
    pub points: Vec<DVec3>,
    /// How many there are beyond these.
    pub more: usize,
}

/// Places that a message names.
const NAMED: usize = 3;

impl Places {
    /// Notes a place.
    pub(super) fn add(&mut self, point: impl FnOnce() -> DVec3) {
        if self.points.len() < NAMED {
            self.points.push(point());
        } else {
            self.more += 1;
        }
    }

    /// How many were noted.
    pub(super) fn count(&self) -> usize {
        self.points.len() + self.more
    }
}

impl fmt::Display for Places {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, p) in self.points.iter().enumerate() {
            let word = if i == 0 { "at " } else { ", " };
            write!(f, "{word}({:.5} {:.5} {:.5})", p.x, p.y, p.z)?;
        }
        match self.more {
            0 => Ok(()),
            more => write!(f, " and {more} more"),
        }
    }
}
