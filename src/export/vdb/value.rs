//! The two types of values that grids hold.

use glam::Vec3;
use half::f16;

/// A value of a voxel: `f32` or [`Vec3`].
pub trait Value: Copy + PartialEq + Send + Sync + Sealed {
    /// Name of the type in the file.
    const TYPE: &'static str;
    /// Bytes in memory.
    const SIZE: usize;
    /// Zero.
    const ZERO: Self;
    /// `-self`.
    fn negated(self) -> Self;
    /// The components; one for scalars.
    fn components(&self) -> &[f32];
    /// The nearest value whose components are halves.
    fn to_half(self) -> Self;
}

/// Keeps [`Value`] to the types that the format's names stand for.
pub trait Sealed {}
impl Sealed for f32 {}
impl Sealed for Vec3 {}

impl Value for f32 {
    const TYPE: &'static str = "float";
    const SIZE: usize = 4;
    const ZERO: Self = 0.0;

    fn negated(self) -> Self {
        -self
    }

    fn components(&self) -> &[f32] {
        std::slice::from_ref(self)
    }

    fn to_half(self) -> Self {
        f16::from_f32(self).to_f32()
    }
}

impl Value for Vec3 {
    const TYPE: &'static str = "vec3s";
    const SIZE: usize = 12;
    const ZERO: Self = Self::ZERO;

    fn negated(self) -> Self {
        -self
    }

    fn components(&self) -> &[f32] {
        self.as_ref()
    }

    fn to_half(self) -> Self {
        Self::from_array(self.to_array().map(f32::to_half))
    }
}

/// Appends the value as the file has it.
pub(super) fn put<T: Value>(value: T, half: bool, out: &mut Vec<u8>) {
    for &c in value.components() {
        if half {
            out.extend(f16::from_f32(c).to_le_bytes());
        } else {
            out.extend(c.to_le_bytes());
        }
    }
}
