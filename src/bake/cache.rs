//! Baked tables by content: a bake with the same structure and settings is never done twice.

use crate::io::{FileError, check_writable};
use crate::table::{StructureTable, TableError};
use std::path::{Path, PathBuf};

/// Extension of files of sums.
pub(super) const SUMS: &str = "safetensors";

/// A folder of tables named by their content hash, and of sums that more photons can be added to.
#[derive(Clone, Debug)]
pub struct Cache {
    folder: PathBuf,
}

/// What is in a cache.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CacheSize {
    /// Number of tables.
    pub tables: u64,
    /// Number of files of sums: bakes that can go on.
    pub sums: u64,
    /// The size of all on disk.
    pub bytes: u64,
}

impl CacheSize {
    fn count(&mut self, path: &Path, bytes: u64) {
        match path.extension().is_some_and(|e| e == SUMS) {
            true => self.sums += 1,
            false => self.tables += 1,
        }
        self.bytes += bytes;
    }
}

impl Cache {
    /// The user's cache: `VAIR_CACHE` if set, else `vair` in the system's cache folder. `None` where
    /// the system has none.
    pub fn of_user() -> Option<Self> {
        let folder = match std::env::var_os("VAIR_CACHE") {
            Some(folder) if !folder.is_empty() => PathBuf::from(folder),
            _ => dirs::cache_dir()?.join("vair"),
        };
        Some(Self { folder })
    }

    /// A cache in a given folder, made when first written to.
    pub fn at(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
        }
    }

    /// Where the tables are.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The table of a content hash, if there is a whole one that says it is that.
    pub fn get(&self, content: &str) -> Option<StructureTable> {
        let table = StructureTable::read(&self.path(content)).ok()?;
        (table.provenance.content == content).then_some(table)
    }

    /// Whether something can be stored.
    ///
    /// # Errors
    /// A folder that cannot be made or written to.
    pub fn check(&self) -> Result<(), FileError> {
        std::fs::create_dir_all(&self.folder)
            .map_err(|e| FileError::new("create", &self.folder, e))?;
        check_writable(&self.path("any"))
    }

    /// Stores a finished table.
    pub fn put(&self, table: &StructureTable) -> Result<(), TableError> {
        // If the folder cannot be made, writing into it fails with the path and the reason.
        let _ = std::fs::create_dir_all(&self.folder);
        table.write(&self.path(&table.provenance.content))
    }

    /// Where the sums of a bake are kept: see [`super::Bake::name`].
    pub fn sums_path(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}.{SUMS}"))
    }

    /// Counts what is there.
    pub fn size(&self) -> CacheSize {
        let mut size = CacheSize::default();
        for (path, bytes) in self.entries() {
            size.count(&path, bytes);
        }
        size
    }

    /// Removes all tables and sums and says what was removed.
    pub fn clear(&self) -> CacheSize {
        let mut removed = CacheSize::default();
        for (path, bytes) in self.entries() {
            if std::fs::remove_file(&path).is_ok() {
                removed.count(&path, bytes);
            }
        }
        removed
    }

    fn path(&self, content: &str) -> PathBuf {
        self.folder.join(format!("{content}.exr"))
    }

    /// Paths and sizes of tables and sums; nothing else in the folder is looked at.
    fn entries(&self) -> Vec<(PathBuf, u64)> {
        let Ok(entries) = std::fs::read_dir(&self.folder) else {
            return Vec::new();
        };
        let is_ours = |path: &Path| {
            let stem = path.file_stem().and_then(|s| s.to_str()).unwrap_or("");
            path.extension().is_some_and(|e| e == "exr" || e == SUMS)
                && stem.len() == 64
                && stem.bytes().all(|b| b.is_ascii_hexdigit())
        };
        entries
            .filter_map(Result::ok)
            .filter(|entry| is_ours(&entry.path()))
            .map(|entry| (entry.path(), entry.metadata().map_or(0, |m| m.len())))
            .collect()
    }
}
