//! Bakes that survive being stopped, by a signal, a power cut or `kill -9`.

use super::{Bake, Cache, Ended, Goal, SumsError};
use crate::io::FileError;
use crate::progress::{Cancel, Progress};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A file that a running bake saves its sums to, and how often.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    path: PathBuf,
    every: Duration,
    last: Instant,
    in_cache: bool,
    /// Whether the sums stay when the bake is done: then more photons continue from there.
    keep: bool,
}

/// What a checkpoint held when the bake began.
#[derive(Debug)]
pub enum Found {
    /// Nothing.
    None,
    /// So many photons of this bake; it goes on from there.
    Photons(u64),
    /// More photons of this bake than it wants. They are left alone: the checkpoint will not be
    /// written to.
    Beyond,
    /// Something damaged, which will be written over.
    Damaged(SumsError),
}

impl Checkpoint {
    /// Seconds between two saves if nothing else is asked for: a save of the default sizes writes
    /// 41 MB, a few tenths of a second.
    pub const EVERY: Duration = Duration::from_secs(30);

    /// A checkpoint in the cache, under the bake's name.
    ///
    /// * `keep`: leave the sums there when the bake is done.
    pub fn in_cache(cache: &Cache, bake: &Bake<'_>, every: Duration, keep: bool) -> Self {
        Self {
            path: cache.sums_path(&bake.name()),
            every,
            last: Instant::now(),
            in_cache: true,
            keep,
        }
    }

    /// A checkpoint beside an output, under its name and `.checkpoint`. It goes when the bake is
    /// done.
    pub fn beside(output: &Path, every: Duration) -> Self {
        let mut path = output.as_os_str().to_owned();
        path.push(".checkpoint");
        Self {
            path: path.into(),
            every,
            last: Instant::now(),
            in_cache: false,
            keep: false,
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Lets a bake go on from what is there.
    ///
    /// # Errors
    /// Sums of another bake, which are not to be written over; a file that cannot be read.
    pub fn resume(&mut self, bake: &Bake<'_>) -> Result<Found, SumsError> {
        match bake.resume(&self.path) {
            Ok(()) => {
                // Someone may have meant to keep them.
                self.keep |= self.in_cache;
                Ok(Found::Photons(bake.photons()))
            }
            Err(SumsError::File(FileError { source, .. }))
                if source.kind() == ErrorKind::NotFound =>
            {
                Ok(Found::None)
            }
            Err(error @ SumsError::Damaged { .. }) => Ok(Found::Damaged(error)),
            Err(SumsError::Foreign { .. }) if self.in_cache => Ok(Found::Beyond),
            Err(error) => Err(error),
        }
    }

    fn save(&mut self, bake: &Bake<'_>) -> Result<(), SumsError> {
        self.last = Instant::now();
        if let Some(folder) = self.path.parent() {
            // If it cannot be made, writing into it fails with the path and the reason.
            let _ = std::fs::create_dir_all(folder);
        }
        bake.save(&self.path)
    }

    fn is_due(&self) -> bool {
        self.last.elapsed() >= self.every
    }

    /// The bake is done and its result is in a safe place.
    pub fn finish(&mut self, bake: &Bake<'_>) -> Result<(), SumsError> {
        if self.keep {
            return self.save(bake);
        }
        match std::fs::remove_file(&self.path) {
            Err(e) if e.kind() != ErrorKind::NotFound => {
                Err(FileError::new("remove", &self.path, e).into())
            }
            _ => Ok(()),
        }
    }
}

/// [`Bake::run`] with checkpoints, one of them when it is cancelled.
///
/// * `between`: called after every pass. The first checkpoint that cannot be written is reported to
///   it; the bake goes on without more of them.
pub fn drive(
    bake: &Bake<'_>,
    goal: &Goal,
    mut checkpoint: Option<&mut Checkpoint>,
    progress: &dyn Progress,
    cancel: &Cancel,
    between: &mut dyn FnMut(&Bake<'_>, Option<SumsError>),
) -> Ended {
    bake.begin(progress);
    let ended = loop {
        let ended = bake.refine(goal, progress, cancel);
        let due = |c: &Checkpoint| match ended {
            None => c.is_due(),
            // Saved sums that nothing has been added to need no saving.
            Some(ended) => ended == Ended::Cancelled && bake.photons() > 0,
        };
        let saved = checkpoint.as_mut().filter(|c| due(c)).map(|c| c.save(bake));
        let failed = saved.and_then(Result::err);
        if failed.is_some() {
            checkpoint = None;
        }
        between(bake, failed);
        if let Some(ended) = ended {
            break ended;
        }
    };
    progress.finish();
    ended
}
