//! The only creator of output files. A file appears under its name complete, or not at all:
//! sibling temporary, sync, rename. Temporaries of writers that were killed go with the next file
//! that is written beside them.

use super::stale;
use crate::blame::Blame;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file operation that failed, with the path and what was being done.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {}: {source}", path.display())]
pub struct FileError {
    /// What was being done: `read`, `create`, `write`.
    pub action: &'static str,
    /// The path as the user gave it.
    pub path: PathBuf,
    /// The operating system's reason.
    pub source: io::Error,
}

impl FileError {
    /// An error of `action` on `path`.
    pub fn new(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self {
            action,
            path: path.to_owned(),
            source,
        }
    }

    /// A missing input is the user's to mend; all else is the surroundings'.
    pub fn blame(&self) -> Blame {
        match (self.action, self.source.kind()) {
            ("read", io::ErrorKind::NotFound | io::ErrorKind::InvalidData) => Blame::Input,
            _ => Blame::Environment,
        }
    }
}

/// A file being written. Dropped without [`AtomicFile::commit`] it leaves nothing behind and the
/// previous file of that name untouched.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    file: BufWriter<NamedTempFile>,
}

impl AtomicFile {
    /// Opens a temporary sibling of `path`.
    pub fn create(path: &Path) -> Result<Self, FileError> {
        if path.is_dir() {
            let reason = io::Error::new(io::ErrorKind::IsADirectory, "it is a folder");
            return Err(FileError::new("write", path, reason));
        }
        stale::sweep(folder_of(path));
        let temp = tempfile::Builder::new()
            .prefix(stale::PREFIX)
            .suffix(stale::SUFFIX)
            .tempfile_in(folder_of(path))
            .map_err(|e| FileError::new("create", path, e))?;
        stale::claim(temp.as_file());
        Ok(Self {
            path: path.to_owned(),
            file: BufWriter::with_capacity(1 << 16, temp),
        })
    }

    /// Makes the file appear under its name.
    pub fn commit(self) -> Result<(), FileError> {
        let path = self.path;
        let fail = |e| FileError::new("write", &path, e);
        let temp = self.file.into_inner().map_err(|e| fail(e.into_error()))?;
        temp.as_file().sync_all().map_err(fail)?;
        set_default_mode(temp.as_file()).map_err(fail)?;
        temp.persist(&path).map_err(|e| fail(e.error))?;
        // The rename itself must survive a power cut; not every system can sync a folder.
        if let Ok(folder) = File::open(folder_of(&path)) {
            let _ = folder.sync_all();
        }
        Ok(())
    }

    /// Writes `bytes` to `path` in one go.
    pub fn write_all_to(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
        let mut file = Self::create(path)?;
        file.write_all(bytes)
            .map_err(|e| FileError::new("write", path, e))?;
        file.commit()
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for AtomicFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Temporary files are private (0600); an output should have the usual permissions.
#[cfg(unix)]
fn set_default_mode(file: &File) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn set_default_mode(_: &File) -> io::Result<()> {
    Ok(())
}

/// Fails now rather than after an hour of work if `path` cannot be written later.
pub fn check_writable(path: &Path) -> Result<(), FileError> {
    AtomicFile::create(path).map(drop)
}

/// Reads a whole file that may be at most `limit` bytes long.
pub fn read_bounded(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let fail = |e| FileError::new("read", path, e);
    let file = File::open(path).map_err(fail)?;
    let mut bytes = Vec::new();
    file.take(limit + 1).read_to_end(&mut bytes).map_err(fail)?;
    if bytes.len() as u64 > limit {
        let reason = format!("it is longer than the limit of {limit} bytes");
        return Err(fail(io::Error::new(io::ErrorKind::InvalidData, reason)));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dropped_leaves_nothing_and_keeps_the_old() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        AtomicFile::write_all_to(&path, b"old").unwrap();
        let mut file = AtomicFile::create(&path).unwrap();
        file.write_all(b"new and longer").unwrap();
        drop(file);
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn refusals_name_the_path_and_the_blame() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("no/such/folder/x.exr");
        let error = check_writable(&missing).unwrap_err();
        assert!(error.to_string().contains("no/such/folder/x.exr"));
        assert_eq!(error.blame(), Blame::Environment);
        assert_eq!(
            check_writable(folder.path()).unwrap_err().blame(),
            Blame::Environment
        );
        assert_eq!(
            read_bounded(&missing, 10).unwrap_err().blame(),
            Blame::Input
        );
        let long = folder.path().join("long");
        AtomicFile::write_all_to(&long, &[0; 11]).unwrap();
        assert_eq!(read_bounded(&long, 10).unwrap_err().blame(), Blame::Input);
    }
}
