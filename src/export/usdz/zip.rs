//! The archive of a .usdz: members as they are, each at a multiple of 64 bytes, so that readers can map
//! them into memory.
//!
//! Pixar, "USDZ File Format Specification" 1.3; PKWARE, "APPNOTE.TXT" 6.3, without compression,
//! encryption and the 64-bit fields.

use std::io::{self, Write};

/// Members begin at multiples of this.
const ALIGNMENT: usize = 64;
/// Bytes of a member's header besides its name and what follows.
const HEADER: usize = 30;
/// Marks the bytes that fill up to the alignment, as Pixar's own writer does.
const FILLER: u16 = 0x1986;
/// The first of January 1980: dates would make other bytes of the same files.
const DATE: u16 = 0x0021;

/// Writes an archive of files, in this order: names and contents.
///
/// # Errors
/// More than 4 GB, the output.
pub(super) fn write(out: &mut impl Write, files: &[(&str, Vec<u8>)]) -> io::Result<()> {
    let mut at = 0usize;
    let mut directory: Vec<u8> = Vec::new();
    for (name, bytes) in files {
        let mut filler =
            (at + HEADER + name.len()).next_multiple_of(ALIGNMENT) - at - HEADER - name.len();
        // A filler has a head of four bytes.
        if (1..4).contains(&filler) {
            filler += ALIGNMENT;
        }
        let common = common(name, bytes)?;
        let start = at;
        out.write_all(b"PK\x03\x04")?;
        out.write_all(&common)?;
        out.write_all(&(filler as u16).to_le_bytes())?;
        out.write_all(name.as_bytes())?;
        if filler > 0 {
            out.write_all(&FILLER.to_le_bytes())?;
            out.write_all(&(filler as u16 - 4).to_le_bytes())?;
            out.write_all(&vec![0; filler - 4])?;
        }
        out.write_all(bytes)?;
        at += HEADER + name.len() + filler + bytes.len();
        directory.extend(b"PK\x01\x02");
        directory.extend(10u16.to_le_bytes());
        directory.extend(common);
        // No extra field, no comment, first disk, no attributes.
        directory.extend([0; 12]);
        directory.extend(size(start)?.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let count = (files.len() as u16).to_le_bytes();
    out.write_all(&directory)?;
    out.write_all(b"PK\x05\x06\0\0\0\0")?;
    out.write_all(&count)?;
    out.write_all(&count)?;
    out.write_all(&size(directory.len())?.to_le_bytes())?;
    out.write_all(&size(at)?.to_le_bytes())?;
    out.write_all(&[0; 2])
}

/// What a member's header and its entry in the directory have in common, from the version needed to the
/// length of the name.
fn common(name: &str, bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut crc = flate2::Crc::new();
    crc.update(bytes);
    let size = size(bytes.len())?.to_le_bytes();
    let mut out = Vec::new();
    // Version 1.0, no flags, stored.
    for word in [10u16, 0, 0, 0, DATE] {
        out.extend(word.to_le_bytes());
    }
    out.extend(crc.sum().to_le_bytes());
    out.extend(size);
    out.extend(size);
    out.extend((name.len() as u16).to_le_bytes());
    Ok(out)
}

fn size(bytes: usize) -> io::Result<u32> {
    u32::try_from(bytes).map_err(|_| io::Error::other("a .usdz holds at most 4 GB"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_begin_at_multiples_of_64() {
        // Names of all lengths, so that fillers of all lengths are needed.
        for length in 1..130 {
            let name = "n".repeat(length);
            let files = [
                (name.as_str(), vec![7u8; length]),
                ("last", b"bytes to find".to_vec()),
            ];
            let mut bytes = Vec::new();
            write(&mut bytes, &files).unwrap();
            let of = |wanted: &[u8]| {
                bytes
                    .windows(wanted.len())
                    .position(|w| w == wanted)
                    .unwrap()
            };
            assert_eq!(of(&vec![7u8; length]) % 64, 0, "{length}");
            assert_eq!(of(b"bytes to find") % 64, 0, "{length}");
        }
    }
}
