//! Arrays of a crate file.

use super::coding::integers;
use super::scalar::{Scalar, shape};
use super::sized;
use super::values::{ASSET, ITEM, STRING, TOKEN, Values};
use crate::cursor::Cursor;
use crate::usd_file::error::UsdFileError as Error;
use crate::usd_file::text_values::to_f32;
use crate::usd_file::value::Value;

/// Memory of a number of an array, bytes.
const INTEGER: u64 = 8;
const FLOAT: u64 = 4;

/// Shorter arrays are stored plain, whatever their word says.
const LEAST_PACKED: u64 = 16;

impl Values<'_> {
    pub(super) fn array(&mut self, kind: u8, packed: bool, payload: u64) -> Result<Value, Error> {
        let mut cursor = Cursor::new(self.bytes, payload);
        let count = match (payload, self.version) {
            (0, _) => 0,
            (_, [0, 0..=4, _]) => {
                // Number of dimensions, always one.
                cursor.u32()?;
                u64::from(cursor.u32()?)
            }
            (_, [0, 5 | 6, _]) => u64::from(cursor.u32()?),
            _ => cursor.u64()?,
        };
        let packed = packed && count >= LEAST_PACKED;
        if let STRING | TOKEN | ASSET = kind {
            self.spend(count.saturating_mul(ITEM))?;
            let texts: Result<_, Error> =
                (0..count).map(|_| self.text(kind, &mut cursor)).collect();
            return Ok(Value::Texts(texts?));
        }
        let Some((scalar, width)) = shape(kind) else {
            return Ok(Value::Unread);
        };
        match (width, scalar.is_float(), packed) {
            (1, false, false) => {
                self.plain(count, INTEGER, scalar.bytes(), &cursor)?;
                let ints: Result<Vec<i64>, Error> =
                    (0..count).map(|_| Ok(scalar.int(&mut cursor)?)).collect();
                Ok(Value::Ints(ints?.into()))
            }
            (1, false, true) => {
                let mut ints = self.packed(scalar, count, &mut cursor)?;
                if scalar == Scalar::U32 {
                    ints.iter_mut()
                        .for_each(|int| *int = i64::from(*int as u32));
                }
                Ok(Value::Ints(ints.into()))
            }
            (1, true, true) => self.packed_floats(scalar, count, &mut cursor),
            _ => self.floats(scalar, width, count, &mut cursor),
        }
    }

    /// That numbers which stand as they are do, and are not too many.
    ///
    /// * `size`: of a number in memory, bytes. * `bytes`: of one in the file.
    fn plain(
        &mut self,
        count: u64,
        size: u64,
        bytes: u64,
        cursor: &Cursor<'_>,
    ) -> Result<(), Error> {
        self.spend(count.saturating_mul(size))?;
        cursor.clone().take(count.saturating_mul(bytes))?;
        Ok(())
    }

    pub(super) fn floats(
        &mut self,
        scalar: Scalar,
        width: usize,
        count: u64,
        cursor: &mut Cursor<'_>,
    ) -> Result<Value, Error> {
        let count = count.saturating_mul(width as u64);
        self.plain(count, FLOAT, scalar.bytes(), cursor)?;
        let bytes = cursor.take(count * scalar.bytes())?;
        let values = match scalar {
            Scalar::Float => {
                let number = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
                bytes.chunks_exact(4).map(number).collect()
            }
            _ => {
                let mut cursor = Cursor::new(bytes, 0);
                let numbers: Result<Vec<f32>, Error> = (0..count)
                    .map(|_| Ok(to_f32(scalar.read(&mut cursor)?)))
                    .collect();
                numbers?.into()
            }
        };
        Ok(Value::Floats { values, width })
    }

    /// Integers that are packed.
    fn packed(
        &mut self,
        scalar: Scalar,
        count: u64,
        cursor: &mut Cursor<'_>,
    ) -> Result<Vec<i64>, Error> {
        self.spend(count.saturating_mul(INTEGER))?;
        let packed = sized(cursor)?;
        match scalar {
            Scalar::I64 | Scalar::U64 => integers::<8>(packed, count),
            _ => integers::<4>(packed, count),
        }
    }

    /// Floats that are packed as whole numbers, or as places in a table.
    fn packed_floats(
        &mut self,
        scalar: Scalar,
        count: u64,
        cursor: &mut Cursor<'_>,
    ) -> Result<Value, Error> {
        let code = cursor.u8()?;
        let values: Vec<f32> = match code {
            b'i' => {
                let ints = self.packed(Scalar::I32, count, cursor)?;
                ints.into_iter().map(|int| int as f32).collect()
            }
            b't' => {
                let size = u64::from(cursor.u32()?);
                self.plain(size, INTEGER, scalar.bytes(), cursor)?;
                let table: Result<Vec<f64>, Error> =
                    (0..size).map(|_| Ok(scalar.read(cursor)?)).collect();
                let table = table?;
                let places = self.packed(Scalar::U32, count, cursor)?;
                let missing = || cursor.error("a packed number is not in its table");
                let number = |place: i64| {
                    let number = table.get(place as u32 as usize);
                    number.copied().map(to_f32).ok_or_else(missing)
                };
                places.into_iter().map(number).collect::<Result<_, _>>()?
            }
            other => {
                return Err(cursor
                    .error(format!("numbers are packed in an unknown way, {other}"))
                    .into());
            }
        };
        Ok(Value::Floats {
            values: values.into(),
            width: 1,
        })
    }
}
