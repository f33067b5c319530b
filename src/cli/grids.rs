//! Files of grids.

use super::Failure;
use crate::export::vdb::VdbError;
use crate::export::volume::VolumeError;
use crate::io::{AtomicFile, FileError};
use std::path::Path;

/// Writes a file of grids, whole or not at all, and returns what `write` says of it.
///
/// # Errors
/// Those of `write`, with the name of the file where its output failed; the file.
pub(super) fn write_grids<T>(
    path: &Path,
    write: impl FnOnce(AtomicFile) -> Result<(AtomicFile, T), VolumeError>,
) -> Result<T, Failure> {
    let (file, said) = write(AtomicFile::create(path)?).map_err(|error| match error {
        VolumeError::Vdb(VdbError::Io(reason)) => FileError::new("write", path, reason).into(),
        other => Failure::from(other),
    })?;
    file.commit()?;
    Ok(said)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blame::Blame;
    use std::io;

    #[test]
    fn an_output_that_fails_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("coat.vdb");
        let full = |_| -> Result<(AtomicFile, ()), VolumeError> {
            let reason = io::Error::from(io::ErrorKind::StorageFull);
            Err(VdbError::from(reason).into())
        };
        let failure = write_grids(&path, full).unwrap_err();
        assert_eq!(failure.blame, Blame::Environment);
        let said = failure.report.to_string();
        assert!(said.contains("cannot write") && said.contains("coat.vdb"));
        // Other errors have words of their own.
        let empty = |_| -> Result<(AtomicFile, ()), VolumeError> { Err(VolumeError::Empty) };
        let failure = write_grids(&path, empty).unwrap_err();
        assert_eq!(failure.blame, Blame::Input);
        assert!(!path.exists());
    }
}
