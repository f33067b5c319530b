//! The numbers that values of a crate file are made of.

use super::values::{PERMISSION, SPECIFIER, VARIABILITY};
use crate::cursor::{Cursor, Misread};
use half::f16;

/// A number of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scalar {
    U8,
    I32,
    U32,
    I64,
    U64,
    Half,
    Float,
    Double,
}

impl Scalar {
    pub(super) fn bytes(self) -> u64 {
        match self {
            Self::U8 => 1,
            Self::Half => 2,
            Self::I32 | Self::U32 | Self::Float => 4,
            Self::I64 | Self::U64 | Self::Double => 8,
        }
    }

    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::Half | Self::Float | Self::Double)
    }

    pub(super) fn int(self, cursor: &mut Cursor<'_>) -> Result<i64, Misread> {
        Ok(match self {
            Self::U8 => i64::from(cursor.u8()?),
            Self::I32 => i64::from(cursor.u32()? as i32),
            Self::U32 => i64::from(cursor.u32()?),
            _ => cursor.u64()? as i64,
        })
    }

    pub(super) fn read(self, cursor: &mut Cursor<'_>) -> Result<f64, Misread> {
        Ok(match self {
            Self::Half => f64::from(f16::from_bits(cursor.u16()?)),
            Self::Float => f64::from(f32::from_bits(cursor.u32()?)),
            Self::Double => f64::from_bits(cursor.u64()?),
            whole => whole.int(cursor)? as f64,
        })
    }
}

/// Numbers that a type is made of: how many, and of which kind.
pub(super) fn shape(kind: u8) -> Option<(Scalar, usize)> {
    use Scalar::{Double, Float, Half, I32, I64, U8, U32, U64};
    Some(match kind {
        1 | 2 => (U8, 1),
        3 | SPECIFIER | PERMISSION | VARIABILITY => (I32, 1),
        4 => (U32, 1),
        5 => (I64, 1),
        6 => (U64, 1),
        7 => (Half, 1),
        8 => (Float, 1),
        9 | 56 => (Double, 1),
        13 | 16 | 27 => (Double, 4),
        14 => (Double, 9),
        15 => (Double, 16),
        17 | 28 => (Float, 4),
        18 | 29 => (Half, 4),
        19 => (Double, 2),
        20 => (Float, 2),
        21 => (Half, 2),
        22 => (I32, 2),
        23 => (Double, 3),
        24 => (Float, 3),
        25 => (Half, 3),
        26 => (I32, 3),
        30 => (I32, 4),
        _ => return None,
    })
}
