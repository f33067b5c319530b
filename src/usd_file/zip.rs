//! Members of a package (`.usdz`): a zip archive whose members are stored as they are.

use super::error::UsdFileError;
use crate::cursor::Cursor;
use std::ops::Range;

/// A file in a package.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// Its path in the package.
    pub name: String,
    /// Where its bytes stand, as they are stored.
    pub data: Range<usize>,
    /// Whether those are deflated, which packages may not be.
    pub is_packed: bool,
}

/// The members of a package in order, by the heads that stand before each.
///
/// # Errors
/// No zip archive, or a head that is cut off.
pub fn members(bytes: &[u8]) -> Result<Vec<Member>, UsdFileError> {
    if !bytes.starts_with(b"PK") {
        return Err(UsdFileError::NotPackage);
    }
    let mut members = Vec::new();
    let mut cursor = Cursor::new(bytes, 0);
    while bytes[cursor.at() as usize..].starts_with(b"PK\x03\x04") {
        cursor.take(6)?;
        let flags = cursor.u16()?;
        let method = cursor.u16()?;
        cursor.take(8)?;
        let size = cursor.u32()?;
        cursor.u32()?;
        let (name, extra) = (cursor.u16()?, cursor.u16()?);
        let name = String::from_utf8_lossy(cursor.take(u64::from(name))?).into_owned();
        cursor.take(u64::from(extra))?;
        if flags & 8 != 0 {
            return Err(cursor
                .error("a member of the package does not say how long it is")
                .into());
        }
        let start = cursor.at() as usize;
        cursor.take(u64::from(size))?;
        members.push(Member {
            name,
            data: start..start + size as usize,
            is_packed: method != 0,
        });
    }
    Ok(members)
}
