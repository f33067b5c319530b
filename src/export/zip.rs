//! Archives of files as they are, without compression: of arrays for numpy, of packages whose members readers
//! map into memory.
//!
//! PKWARE, "APPNOTE.TXT" 6.3, without compression, encryption and the 64-bit fields; Pixar, "USDZ File Format
//! Specification" 1.3, for what fills up to the alignment.

use std::io::{self, Write};

/// Bytes of a member's header besides its name and what follows.
const HEADER: usize = 30;
/// Marks the bytes that fill up to the alignment, as Pixar's own writer does.
const FILLER: u16 = 0x1986;
/// Version 2.0, no flags, stored, midnight, the first of January 1980: dates would make other bytes of the
/// same files.
const FIRST_WORDS: [u16; 5] = [20, 0, 0, 0, 0x0021];

/// An archive that is being written.
pub(super) struct Archive<W> {
    out: W,
    alignment: usize,
    at: usize,
    directory: Vec<u8>,
    files: u16,
}

impl<W: Write> Archive<W> {
    /// * `alignment`: members begin at multiples of so many bytes, 1 or at least 8.
    pub(super) fn new(out: W, alignment: usize) -> Self {
        Self {
            out,
            alignment,
            at: 0,
            directory: Vec::new(),
            files: 0,
        }
    }

    /// Adds a file.
    ///
    /// # Errors
    /// More than 4 GB in all, the output.
    pub(super) fn add(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let begin = self.at + HEADER + name.len();
        let mut filler = begin.next_multiple_of(self.alignment) - begin;
        // A filler has a head of four bytes.
        if (1..4).contains(&filler) {
            filler += self.alignment;
        }
        let common = common(name, bytes)?;
        self.out.write_all(b"PK\x03\x04")?;
        self.out.write_all(&common)?;
        self.out.write_all(&(filler as u16).to_le_bytes())?;
        self.out.write_all(name.as_bytes())?;
        if filler > 0 {
            self.out.write_all(&FILLER.to_le_bytes())?;
            self.out.write_all(&(filler as u16 - 4).to_le_bytes())?;
            self.out.write_all(&vec![0; filler - 4])?;
        }
        self.out.write_all(bytes)?;
        self.directory.extend(b"PK\x01\x02");
        self.directory.extend(FIRST_WORDS[0].to_le_bytes());
        self.directory.extend(common);
        // No extra field, no comment, first disk, no attributes.
        self.directory.extend([0; 12]);
        self.directory.extend(size(self.at)?.to_le_bytes());
        self.directory.extend(name.as_bytes());
        self.files += 1;
        self.at = begin + filler + bytes.len();
        Ok(())
    }

    /// Writes the directory, which ends an archive.
    ///
    /// # Errors
    /// As [`Archive::add`].
    pub(super) fn finish(mut self) -> io::Result<()> {
        let count = self.files.to_le_bytes();
        self.out.write_all(&self.directory)?;
        self.out.write_all(b"PK\x05\x06\0\0\0\0")?;
        self.out.write_all(&count)?;
        self.out.write_all(&count)?;
        self.out
            .write_all(&size(self.directory.len())?.to_le_bytes())?;
        self.out.write_all(&size(self.at)?.to_le_bytes())?;
        self.out.write_all(&[0; 2])
    }
}

/// What a member's header and its entry in the directory have in common, from the version needed to the
/// length of the name.
fn common(name: &str, bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut crc = flate2::Crc::new();
    crc.update(bytes);
    let size = size(bytes.len())?.to_le_bytes();
    let mut out = Vec::new();
    for word in FIRST_WORDS {
        out.extend(word.to_le_bytes());
    }
    out.extend(crc.sum().to_le_bytes());
    out.extend(size);
    out.extend(size);
    out.extend((name.len() as u16).to_le_bytes());
    Ok(out)
}

fn size(bytes: usize) -> io::Result<u32> {
    u32::try_from(bytes).map_err(|_| io::Error::other("an archive holds at most 4 GB"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_begin_at_multiples_of_64() {
        // Names of all lengths, so that fillers of all lengths are needed.
        for length in 1..130 {
            let name = "n".repeat(length);
            let mut bytes = Vec::new();
            let mut archive = Archive::new(&mut bytes, 64);
            archive.add(&name, &vec![7; length]).unwrap();
            archive.add("last", b"bytes to find").unwrap();
            archive.finish().unwrap();
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
