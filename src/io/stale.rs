//! What writers that were killed have left behind.
//!
//! A process that dies by `kill -9` or with the machine cannot remove the temporary file it was
//! writing. Every writer holds a lock on its own; whoever next writes to the same folder removes those
//! that nobody holds.

use std::fs::{File, OpenOptions};
use std::path::Path;
use std::time::Duration;

/// Names of temporary files begin and end so.
pub(super) const PREFIX: &str = ".vair-";
pub(super) const SUFFIX: &str = ".part";

/// Younger files are left alone: their writer may not have come to lock them.
const LEAST_AGE: Duration = Duration::from_secs(60);

/// Claims a temporary file for this process for as long as it is open. Where a file system knows no
/// locks nothing is lost but the cleaning.
pub(super) fn claim(file: &File) {
    let _ = file.try_lock();
}

/// Removes temporary files of writers that are gone. What cannot be looked at or removed stays.
pub(super) fn sweep(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let named = name
            .to_str()
            .is_some_and(|n| n.starts_with(PREFIX) && n.ends_with(SUFFIX));
        let plain = entry.file_type().is_ok_and(|kind| kind.is_file());
        if named && plain && is_abandoned(&entry.path()) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

fn is_abandoned(path: &Path) -> bool {
    // A lock may need a file that could be written to.
    let Ok(file) = OpenOptions::new().read(true).write(true).open(path) else {
        return false;
    };
    let age = file.metadata().and_then(|data| data.modified());
    let old = age.is_ok_and(|time| time.elapsed().is_ok_and(|age| age >= LEAST_AGE));
    old && file.try_lock().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::AtomicFile;
    use std::io::Write;
    use std::time::SystemTime;

    /// A file that looks as if it had been written to last an hour ago.
    fn old(folder: &Path, name: &str) -> File {
        let mut file = File::create(folder.join(name)).unwrap();
        file.write_all(b"half").unwrap();
        let then = SystemTime::now() - Duration::from_secs(3600);
        file.set_modified(then).unwrap();
        file
    }

    #[test]
    fn only_what_nobody_holds_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        drop(old(at, ".vair-dead.part"));
        drop(old(at, ".vair-note.txt"));
        drop(old(at, "vair-x.part"));
        let held = old(at, ".vair-alive.part");
        claim(&held);
        std::fs::write(at.join(".vair-young.part"), b"half").unwrap();
        AtomicFile::write_all_to(&at.join("out"), b"whole").unwrap();
        let there = |name: &str| at.join(name).exists();
        assert!(!there(".vair-dead.part"));
        for name in [
            ".vair-note.txt",
            "vair-x.part",
            ".vair-alive.part",
            ".vair-young.part",
            "out",
        ] {
            assert!(there(name), "{name}");
        }
        // Its writer goes, and with it the lock.
        drop(held);
        AtomicFile::write_all_to(&at.join("out"), b"whole").unwrap();
        assert!(!there(".vair-alive.part"));
    }
}
