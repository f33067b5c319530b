//! Renderings that survive being stopped.

use super::Args;
use super::live::Live;
use super::output::Origin;
use crate::cli::{Console, Failure};
use crate::io::FileError;
use crate::render::{FilmSums, FilmSumsError, Rendering};
use std::io::ErrorKind;
use std::path::Path;
use std::time::{Duration, Instant};

/// Renders to the end, or as far as it goes before something stops it, from the checkpoint on if there is
/// one; shows it meanwhile where somebody looks. The checkpoint if it has all samples.
pub(super) fn run<'a>(
    args: &'a Args,
    rendering: &mut Rendering<'_>,
    mut live: Option<Live>,
    origin: &Origin,
    console: &Console,
) -> Result<Option<&'a Path>, Failure> {
    let cancel = console.cancel();
    let of = origin.text();
    if let Some(path) = args.checkpoint.as_ref().filter(|path| path.exists()) {
        go_on(rendering, path, &of).map_err(|error| {
            let help = "delete it to begin anew, or give --checkpoint another name";
            Failure::with_help(error.blame(), error, help)
        })?;
        console.say(format!("going on from {}", path.display()));
    }
    let mut saves = args
        .checkpoint
        .as_ref()
        .map(|_| Chore::every(args.checkpoint_every));
    let mut shows = live.as_ref().map(|_| Chore::every(LOOK));
    let mut is_over = false;
    let mut kept = None;
    let mut failing = false;
    while !is_over {
        let due = [&saves, &shows].into_iter().flatten().map(|c| c.due).min();
        let complete = rendering.run(due, console, cancel);
        is_over = complete || cancel.is_cancelled() || rendering.is_late();
        if let (Some(chore), Some(path)) = (&mut saves, &args.checkpoint) {
            let saved = chore.run(is_over, || rendering.sums(&of).write(path));
            kept = matches!(saved, Some(Ok(()))).then_some(path.as_path());
            // A picture is worth more than its checkpoint: it goes on, and tries again when the next is due.
            match saved {
                Some(Err(error)) if !std::mem::replace(&mut failing, true) => {
                    console.say(format!("warning: no checkpoint for now: {error}"));
                }
                Some(Ok(())) => failing = false,
                _ => {}
            }
        }
        if let (Some(chore), Some(live)) = (&mut shows, &mut live) {
            chore.run(is_over, || live.show(&rendering.film(), console));
        }
    }
    Ok(kept)
}

/// Time between two looks at a picture that is being made.
const LOOK: Duration = Duration::from_secs(1);

/// Something to be done now and then beside rendering.
struct Chore {
    every: Duration,
    due: Instant,
}

impl Chore {
    fn every(every: Duration) -> Self {
        let due = Instant::now() + every;
        Self { every, due }
    }

    /// Does it if it is due, or for the last time. What takes long may cost a twentieth of the time, no more.
    fn run<T>(&mut self, is_last: bool, action: impl FnOnce() -> T) -> Option<T> {
        let started = Instant::now();
        (is_last || started >= self.due).then(|| {
            let done = action();
            self.due = Instant::now() + self.every.max(20 * started.elapsed());
            done
        })
    }
}

fn go_on(rendering: &mut Rendering<'_>, path: &Path, of: &str) -> Result<(), FilmSumsError> {
    let sums = FilmSums::read(path)?;
    let same = match sums.of() == of {
        true => rendering.resume(sums),
        false => Err(FilmSumsError::Foreign { what: "the scene" }),
    };
    same.map_err(|source| FilmSumsError::In {
        path: path.to_owned(),
        source: Box::new(source),
    })
}

/// Takes the checkpoint of a finished picture away.
pub(super) fn remove(args: &Args) -> Result<(), FileError> {
    let Some(path) = &args.checkpoint else {
        return Ok(());
    };
    match std::fs::remove_file(path) {
        Err(e) if e.kind() != ErrorKind::NotFound => Err(FileError::new("remove", path, e)),
        _ => Ok(()),
    }
}
