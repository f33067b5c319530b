//! The grids that strands are made into.

use super::moments::Moments;
use crate::export::vdb::{Class, Leaf, Meta, VectorKind};
use glam::{IVec3, Vec3};

/// A grid of a coat.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Field {
    /// Diameter times length of the strands in a voxel over its volume, one over a unit of length: the
    /// extinction coefficient for light across the strands. Thinning a groom leaves it as it is as far as
    /// the strands are widened to cover as much.
    Density,
    /// Mean scattering albedo of the strands, linear Rec.709, weighted by area: what a volume shader needs
    /// as its color to look like fur of the strands' color (see [`super::scattering_albedo`]). It reaches a
    /// voxel farther than they do, so that interpolation at the edge of the coat does not mix in black.
    Color,
    /// The same under the name that Houdini and RenderMan look for, `Cd`.
    Cd,
    /// Mean of the unit tangents, root to tip, weighted by area: its length is 1 where all are parallel.
    Tangent,
    /// Mean diameter by length: density over width is the length of strands per volume.
    Width,
    /// Share of a straight line's chance to meet a strand on its way across the voxel, across the
    /// strands: 1 - exp(-density x voxel).
    Coverage,
    /// Share of the volume that strands fill. Of a thinned groom it is that of the widened strands.
    Fraction,
    /// Signed distance from the skin, negative inside.
    Surface,
}

impl Field {
    /// All, in the order in which files have them.
    pub const ALL: [Self; 8] = [
        Self::Density,
        Self::Color,
        Self::Cd,
        Self::Tangent,
        Self::Width,
        Self::Coverage,
        Self::Fraction,
        Self::Surface,
    ];

    /// Name of the grid.
    pub fn name(self) -> &'static str {
        match self {
            Self::Density => "density",
            Self::Color => "color",
            Self::Cd => "Cd",
            Self::Tangent => "tangent",
            Self::Width => "width",
            Self::Coverage => "coverage",
            Self::Fraction => "fraction",
            Self::Surface => "surface",
        }
    }

    /// The field of that name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|field| field.name() == name)
    }

    /// What readers take it for.
    pub fn class(self) -> Class {
        match self {
            Self::Density | Self::Fraction => Class::FogVolume,
            Self::Surface => Class::LevelSet,
            _ => Class::Unknown,
        }
    }

    /// Whether its values are vectors.
    pub fn is_vector(self) -> bool {
        matches!(self, Self::Color | Self::Cd | Self::Tangent)
    }

    /// Unit of its values where that of length is so many meters.
    pub fn unit(self, meters: f64) -> String {
        let length = match meters {
            1.0 => "m".to_owned(),
            0.01 => "cm".to_owned(),
            other => format!("({other} m)"),
        };
        match self {
            Self::Density => format!("1/{length}"),
            Self::Color | Self::Cd => "linear Rec.709".to_owned(),
            Self::Width | Self::Surface => length,
            Self::Tangent | Self::Coverage | Self::Fraction => "1".to_owned(),
        }
    }

    /// Metadata beyond what the format asks for.
    pub(super) fn metadata(self, meters: f64) -> Vec<(String, Meta)> {
        let mut all = vec![("unit".to_owned(), Meta::Text(self.unit(meters)))];
        match self {
            Self::Color | Self::Cd => all.push(VectorKind::Invariant.meta()),
            Self::Tangent => all.push(VectorKind::ContravariantRelative.meta()),
            _ => {}
        }
        all
    }

    /// Bytes of one leaf in memory; colors also reach into leaves around.
    pub(super) fn leaf_bytes(self) -> u64 {
        match self {
            Self::Color | Self::Cd => 2 * 512 * 12,
            Self::Tangent => 512 * 12,
            _ => 512 * 4,
        }
    }
}

/// A leaf of numbers from what strands left in its voxels.
pub(super) fn scalar_leaf(
    field: Field,
    origin: IVec3,
    moments: &[Moments],
    voxel: f64,
) -> Leaf<f32> {
    let volume = voxel.powi(3);
    leaf(origin, moments, |m| match field {
        Field::Width => (m.area / m.length) as f32,
        Field::Coverage => -(-m.area / volume * voxel).exp_m1() as f32,
        Field::Fraction => (m.volume / volume) as f32,
        _ => (m.area / volume) as f32,
    })
}

/// A leaf of vectors.
pub(super) fn vector_leaf(field: Field, origin: IVec3, moments: &[Moments]) -> Leaf<Vec3> {
    leaf(origin, moments, |m| {
        let sum = if field == Field::Tangent {
            m.tangent
        } else {
            m.color
        };
        (sum / m.area).as_vec3()
    })
}

fn leaf<T: crate::export::vdb::Value>(
    origin: IVec3,
    moments: &[Moments],
    value: impl Fn(&Moments) -> T,
) -> Leaf<T> {
    let mut leaf = Leaf::new(origin, T::ZERO);
    for (offset, m) in moments.iter().enumerate() {
        // Without an area there is nothing to see, and nothing to divide by.
        if m.area > 0.0 {
            leaf.set(leaf.voxel(offset), value(m));
        }
    }
    leaf
}
