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
    /// Photons whose sums the file has, as far as is known.
    holds: Option<u64>,
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
            holds: None,
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
            holds: None,
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
                self.holds = Some(bake.photons());
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

    /// Whether the file has the sums of all that is done so far.
    pub fn holds(&self, bake: &Bake<'_>) -> bool {
        self.holds == Some(bake.photons())
    }

    /// Writes the sums of what is done so far, if the file does not have them.
    ///
    /// # Errors
    /// A file that cannot be written. It then is as it was.
    pub fn save(&mut self, bake: &Bake<'_>) -> Result<(), SumsError> {
        self.last = Instant::now();
        if self.holds(bake) {
            return Ok(());
        }
        if let Some(folder) = self.path.parent() {
            // If it cannot be made, writing into it fails with the path and the reason.
            let _ = std::fs::create_dir_all(folder);
        }
        let photons = bake.photons();
        bake.save(&self.path)?;
        self.holds = Some(photons);
        Ok(())
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
/// * `between`: called after every pass. A checkpoint that cannot be written is reported to it, but not
///   again until one was; the bake goes on and tries again when the next is due.
pub fn drive(
    bake: &Bake<'_>,
    goal: &Goal,
    mut checkpoint: Option<&mut Checkpoint>,
    progress: &dyn Progress,
    cancel: &Cancel,
    between: &mut dyn FnMut(&Bake<'_>, Option<SumsError>),
) -> Ended {
    let mut failing = false;
    bake.begin(progress);
    let ended = loop {
        let ended = bake.refine(goal, progress, cancel);
        let due = |c: &Checkpoint| match ended {
            None => c.is_due(),
            Some(ended) => ended == Ended::Cancelled && bake.photons() > 0,
        };
        let saved = checkpoint.as_mut().filter(|c| due(c)).map(|c| c.save(bake));
        let failed = saved.and_then(|saved| {
            let again = std::mem::replace(&mut failing, saved.is_err());
            saved.err().filter(|_| !again)
        });
        between(bake, failed);
        if let Some(ended) = ended {
            break ended;
        }
    };
    progress.finish();
    ended
}
