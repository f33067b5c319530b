//! A file whose beginning stays in memory until its end is written.

use crate::io::{AtomicFile, sort_exr_attributes};
use std::io::{Result, Seek, SeekFrom, Write};

/// An EXR file under way. Its headers are put in order when all else is on its way to the disk.
pub(super) struct Headed {
    head: Vec<u8>,
    kept: usize,
    file: AtomicFile,
    /// Where the next byte goes, and where the file is.
    at: usize,
    file_at: usize,
}

impl Headed {
    /// * `kept`: bytes that the headers take at most.
    pub(super) fn new(file: AtomicFile, kept: usize) -> Self {
        Self {
            head: Vec::new(),
            kept,
            file,
            at: 0,
            file_at: 0,
        }
    }

    /// The whole file, its attributes sorted.
    pub(super) fn finish(mut self) -> Result<AtomicFile> {
        sort_exr_attributes(&mut self.head);
        self.file.seek(SeekFrom::Start(0))?;
        self.file.write_all(&self.head)?;
        Ok(self.file)
    }
}

impl Write for Headed {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        let count = if self.at < self.kept {
            let count = bytes.len().min(self.kept - self.at);
            let end = self.at + count;
            if self.head.len() < end {
                self.head.resize(end, 0);
            }
            self.head[self.at..end].copy_from_slice(&bytes[..count]);
            count
        } else {
            if self.file_at != self.at {
                self.file.seek(SeekFrom::Start(self.at as u64))?;
            }
            let count = self.file.write(bytes)?;
            self.file_at = self.at + count;
            count
        };
        self.at += count;
        Ok(count)
    }

    fn flush(&mut self) -> Result<()> {
        self.file.flush()
    }
}

impl Seek for Headed {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        let at = match to {
            SeekFrom::Start(at) => at,
            SeekFrom::Current(by) => (self.at as u64).saturating_add_signed(by),
            SeekFrom::End(_) => return Err(std::io::ErrorKind::Unsupported.into()),
        };
        self.at = at as usize;
        Ok(at)
    }
}
