//! Renderings that survive being stopped.

use super::Args;
use super::output::Origin;
use crate::cli::{Console, Failure};
use crate::io::FileError;
use crate::render::{FilmSums, FilmSumsError, Rendering};
use std::io::ErrorKind;
use std::time::{Duration, Instant};

/// Renders to the end, or as far as it goes before something stops it, from the checkpoint on if there is
/// one.
pub(super) fn run(
    args: &Args,
    rendering: &mut Rendering<'_>,
    origin: &Origin,
    console: &Console,
) -> Result<(), Failure> {
    let cancel = console.cancel();
    let Some(path) = &args.checkpoint else {
        rendering.run(None, console, cancel);
        return Ok(());
    };
    let of = origin.text();
    if path.exists() {
        match FilmSums::read(path) {
            Ok(sums) if sums.of() != of => {
                return Err(FilmSumsError::Foreign { what: "the scene" }.into());
            }
            Ok(sums) => {
                rendering.resume(sums)?;
                console.say(format!("going on from {}", path.display()));
            }
            Err(FilmSumsError::Damaged { what, .. }) => {
                console.say(format!(
                    "warning: {} is damaged ({what}) and will be written over",
                    path.display()
                ));
            }
            Err(other) => return Err(other.into()),
        }
    }
    let every = Duration::from_secs_f64(args.checkpoint_every);
    let mut pause = every;
    loop {
        let complete = rendering.run(Some(Instant::now() + pause), console, cancel);
        if complete || cancel.is_cancelled() || late(args, rendering) {
            break;
        }
        let started = Instant::now();
        rendering.sums(&of).write(path)?;
        // Large pictures take long to save: that may cost a twentieth of the time, no more.
        pause = every.max(20 * started.elapsed());
    }
    rendering.sums(&of).write(path)?;
    Ok(())
}

fn late(args: &Args, rendering: &Rendering<'_>) -> bool {
    let spent = rendering.spent();
    args.time.is_some_and(|limit| spent.as_secs_f64() >= limit)
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
