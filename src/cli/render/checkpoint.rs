//! Renderings that survive being stopped.

use super::Args;
use super::output::Origin;
use crate::cli::{Console, Failure};
use crate::io::FileError;
use crate::render::{FilmSums, FilmSumsError, Rendering};
use std::io::ErrorKind;
use std::path::Path;
use std::time::Instant;

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
        go_on(rendering, path, &of).map_err(|error| {
            let help = "delete it to begin anew, or give --checkpoint another name";
            Failure::with_help(error.blame(), error, help)
        })?;
        console.say(format!("going on from {}", path.display()));
    }
    // A picture is worth more than its checkpoint: it goes on without.
    let save = |rendering: &Rendering<'_>| {
        let saved = rendering.sums(&of).write(path);
        if let Err(error) = &saved {
            console.say(format!("warning: no more checkpoints: {error}"));
        }
        saved.is_ok()
    };
    let mut pause = args.checkpoint_every;
    loop {
        let complete = rendering.run(Some(Instant::now() + pause), console, cancel);
        if complete || cancel.is_cancelled() || rendering.is_late() {
            break;
        }
        let started = Instant::now();
        if !save(rendering) {
            rendering.run(None, console, cancel);
            return Ok(());
        }
        // Large pictures take long to save: that may cost a twentieth of the time, no more.
        pause = args.checkpoint_every.max(20 * started.elapsed());
    }
    save(rendering);
    Ok(())
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
