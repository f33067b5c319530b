//! The only creator of output files. A file appears under its name complete, or not at all:
//! sibling temporary, sync, rename. Temporaries of writers that were killed go with the next file
//! that is written beside them. Where the name is a link, what it points to is replaced.

use super::stale;
use crate::blame::Blame;
use std::fs::{File, Metadata, Permissions};
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
    /// As the user gave it.
    path: PathBuf,
    /// Where the file comes to lie.
    target: PathBuf,
    /// Permissions of the file that it takes the place of.
    kept: Option<Permissions>,
    file: BufWriter<NamedTempFile>,
}

impl AtomicFile {
    /// Opens a temporary sibling of `path`, or of what it links to.
    ///
    /// # Errors
    /// Nothing can be written there, or what is there is no regular file: a folder, a device, a pipe.
    pub fn create(path: &Path) -> Result<Self, FileError> {
        let fail = |e| FileError::new("create", path, e);
        let target = behind_links(path).map_err(fail)?;
        let old = std::fs::metadata(&target).ok();
        if let Some(kind) = old.as_ref().map(Metadata::file_type)
            && !kind.is_file()
        {
            let reason = match kind.is_dir() {
                true => io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"),
                false => io::Error::new(io::ErrorKind::InvalidInput, "it is no regular file"),
            };
            return Err(FileError::new("write", path, reason));
        }
        let folder = folder_of(&target);
        if !folder.is_dir() {
            let reason = format!("there is no folder {}", folder.display());
            return Err(fail(io::Error::new(io::ErrorKind::NotFound, reason)));
        }
        stale::sweep(folder);
        let mut builder = tempfile::Builder::new();
        builder.prefix(stale::PREFIX).suffix(stale::SUFFIX);
        #[cfg(unix)]
        builder.permissions(new_file());
        // Without the name of the temporary file, which tells nobody anything.
        let temp = builder.tempfile_in(folder);
        let temp = temp.map_err(|e| fail(io::Error::from(e.kind())))?;
        stale::claim(temp.as_file());
        Ok(Self {
            path: path.to_owned(),
            target,
            kept: old.map(|old| old.permissions()),
            file: BufWriter::with_capacity(1 << 16, temp),
        })
    }

    /// Makes the file appear under its name.
    pub fn commit(self) -> Result<(), FileError> {
        let path = self.path;
        let fail = |e| FileError::new("write", &path, e);
        let temp = self.file.into_inner().map_err(|e| fail(e.into_error()))?;
        if let Some(kept) = self.kept {
            temp.as_file().set_permissions(kept).map_err(fail)?;
        }
        temp.as_file().sync_all().map_err(fail)?;
        temp.persist(&self.target).map_err(|e| fail(e.error))?;
        // The rename itself must survive a power cut; not every system can sync a folder.
        if let Ok(folder) = File::open(folder_of(&self.target)) {
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

/// Where a file of that name would be written to: links are followed, also to what is not there yet.
fn behind_links(path: &Path) -> io::Result<PathBuf> {
    /// As many as Linux follows.
    const MOST: usize = 40;
    let mut target = path.to_owned();
    for _ in 0..MOST {
        match std::fs::read_link(&target) {
            Ok(to) => target = folder_of(&target).join(to),
            Err(_) => return Ok(target),
        }
    }
    Err(io::Error::other("it is a link that leads to itself"))
}

/// Temporary files are private; what becomes an output has the permissions of any new file, less the umask.
#[cfg(unix)]
fn new_file() -> Permissions {
    use std::os::unix::fs::PermissionsExt;
    Permissions::from_mode(0o666)
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

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_stay_as_they_are() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode() & 0o777;
        // As the system makes new files, whatever the umask.
        std::fs::write(at("plain"), b"").unwrap();
        AtomicFile::write_all_to(&at("new"), b"new").unwrap();
        assert_eq!(mode(&at("new")), mode(&at("plain")));
        std::fs::write(at("private"), b"old").unwrap();
        std::fs::set_permissions(at("private"), Permissions::from_mode(0o600)).unwrap();
        symlink("private", at("link")).unwrap();
        AtomicFile::write_all_to(&at("link"), b"new").unwrap();
        assert_eq!(std::fs::read(at("private")).unwrap(), b"new");
        assert_eq!(mode(&at("private")), 0o600);
        assert!(at("link").is_symlink());
        std::fs::create_dir(at("elsewhere")).unwrap();
        symlink("elsewhere/later", at("dangling")).unwrap();
        AtomicFile::write_all_to(&at("dangling"), b"new").unwrap();
        assert_eq!(std::fs::read(at("elsewhere/later")).unwrap(), b"new");
        symlink("round", at("round")).unwrap();
        for (name, reason) in [("round", "leads to itself"), ("device", "no regular file")] {
            if name == "device" {
                symlink("/dev/null", at(name)).unwrap();
            }
            let error = check_writable(&at(name)).unwrap_err();
            assert!(error.to_string().contains(reason), "{error}");
        }
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
