//! The course of `vair bake`: look into the cache, go on or begin, fly, write.

use super::report::report;
use super::{Args, find_class, find_station, settings, write_table};
use crate::assembly::origin;
use crate::bake::{Bake, Cache, Checkpoint, Ended, Found, Goal, Settings, SumsError, drive, find};
use crate::blame::Blame;
use crate::cli::{self, Console, Failure, cache};
use crate::fiber::Fiber;
use crate::io::check_writable;
use crate::species::{self, Structure};
use crate::table::{Provenance, Undyed};
use std::time::{Duration, Instant};

pub(super) fn run(args: &Args, start: Instant, console: &Console) -> Result<(), Failure> {
    let species = species::load(&args.name, &args.set)?;
    let class = find_class(&species, args.class.as_deref())?;
    let station = find_station(class, args.station)?;
    let settings = settings(args);
    check_output(args)?;
    if station.structure.mesh.is_some() {
        // Said of tables from the cache as well: they were baked of the same mesh.
        for warning in Fiber::build(&station.structure, args.seed)?.warnings() {
            console.say(format!("warning: {warning}"));
        }
    }
    let band = class.band_at(station.at);
    let mut job = Job {
        args,
        start,
        console,
        structure: &station.structure,
        settings,
        origin: origin(&species, class, station),
        dye: station
            .structure
            .is_colored()
            .then(|| band.absorption_per_um()),
        goal: Goal {
            error: args.target_error,
            until: None,
        },
        cache: cache::of_user(args.no_cache, console),
    };
    if job.dye.is_some() && args.shard.is_none() {
        let pigment = match &band.dye {
            Some(dye) => format!("the dye of {:?}", dye.color),
            None => format!(
                "eumelanin {} and pheomelanin {}",
                band.eumelanin, band.pheomelanin
            ),
        };
        console.say(format!(
            "materials differ by color: a table of R G B, with {pigment}"
        ));
    }
    job.run()
}

/// About how long it takes until a table is written, safe on a disk, and its error known, which is estimated meanwhile.
fn after(bake: &Bake<'_>, settings: &Settings) -> Duration {
    const SECONDS_A_BYTE: f64 = 2e-9;
    let samples =
        settings.nodes() * 6 * settings.face * settings.face * (settings.levels.len() + 1);
    let writing = Duration::from_secs_f64(4.0 * samples as f64 * SECONDS_A_BYTE);
    let estimating = bake.estimating();
    // Writing takes one thread away from the others.
    let threads = u32::try_from(rayon::current_num_threads()).unwrap_or(u32::MAX);
    writing.max(estimating + writing / threads)
}

/// Shards are sums, whole bakes are tables: a name that says otherwise is a mistake.
fn check_output(args: &Args) -> Result<(), Failure> {
    let is_sums = args.output.extension().is_some_and(|e| e == "safetensors");
    if is_sums == args.shard.is_some() {
        return match is_sums {
            true => Ok(check_writable(&args.output)?),
            false => cli::check_output(&args.output, "a table", "exr"),
        };
    }
    let (message, help) = match args.shard {
        Some(_) => (
            "a shard is a file of sums, not a table",
            "end the name in .safetensors",
        ),
        None => (
            "a whole bake is a table, not a file of sums",
            "end the name in .exr",
        ),
    };
    let message = format!("{}: {message}", args.output.display());
    Err(Failure::with_help(Blame::Input, message, help))
}

struct Job<'a> {
    args: &'a Args,
    /// When the command began.
    start: Instant,
    console: &'a Console,
    structure: &'a Structure,
    settings: Settings,
    origin: Provenance,
    dye: Option<[f64; 3]>,
    goal: Goal,
    cache: Option<Cache>,
}

impl Job<'_> {
    fn run(&mut self) -> Result<(), Failure> {
        let (args, console) = (self.args, self.console);
        if args.shard.is_none()
            && !args.restart
            && let Some(cache) = &self.cache
            && let Some(table) = find(self.structure, &self.settings, &self.origin, cache)
        {
            console.say("the cache holds this table");
            write_table(&table, self.dye, &args.output)?;
            report(table.tables(), console);
            return Ok(());
        }
        let bake = self.bake()?;
        self.goal.until = args.time.map(|time| {
            // Everything is to be said by then.
            let after = after(&bake, &self.settings);
            self.start + time - after.min(time / 2)
        });
        if self.is_done_shard(&bake) {
            console.say(format!("{} holds this shard", args.output.display()));
            return Ok(());
        }
        let mut checkpoint = self.checkpoint(&bake)?;
        let ended = self.fly(&bake, &mut checkpoint);
        self.keep(&bake, &mut checkpoint, ended)
    }

    fn bake(&self) -> Result<Bake<'static>, Failure> {
        let mut bake =
            Bake::new(self.structure, &self.settings)?.with_origin(self.origin.clone(), self.dye);
        if let Some(shard) = self.args.shard {
            bake = bake.with_shard(shard);
        }
        Ok(match self.args.memory {
            Some(limit) => bake.with_memory(limit).map_err(|error| {
                let help = "smaller --face or --bins need less";
                Failure::with_help(error.blame(), error, help)
            })?,
            None => bake,
        })
    }

    fn is_done_shard(&self, bake: &Bake<'_>) -> bool {
        let args = self.args;
        args.shard.is_some() && !args.restart && bake.holds_all(&args.output)
    }

    /// The checkpoint of this bake; what it holds is taken over.
    fn checkpoint(&self, bake: &Bake<'_>) -> Result<Checkpoint, Failure> {
        let (args, every) = (self.args, self.args.checkpoint_every);
        let beside = || Checkpoint::beside(&args.output, every);
        let mut checkpoint = match &self.cache {
            Some(cache) if args.shard.is_none() => Checkpoint::in_cache(cache, bake, every, true),
            _ => beside(),
        };
        if args.restart {
            return Ok(checkpoint);
        }
        let mut found = self.resume(&mut checkpoint, bake)?;
        if let Found::Beyond = found {
            // The cache has more photons than are wanted here, and they are worth keeping.
            checkpoint = beside();
            found = self.resume(&mut checkpoint, bake)?;
        }
        let path = checkpoint.path().display();
        match found {
            Found::None | Found::Beyond => {}
            Found::Photons(photons) => self.console.say(format!(
                "going on from {photons} photons in {path} (--restart starts anew)"
            )),
            Found::Damaged(error) => {
                self.console.say(format!("warning: {error}; starting anew"));
            }
        }
        Ok(checkpoint)
    }

    fn resume(&self, checkpoint: &mut Checkpoint, bake: &Bake<'_>) -> Result<Found, Failure> {
        checkpoint.resume(bake).map_err(|error| {
            let help = "--restart writes over it; another name for the output leaves it alone";
            match error {
                SumsError::Foreign { .. } => Failure::with_help(error.blame(), error, help),
                other => other.into(),
            }
        })
    }

    fn fly(&self, bake: &Bake<'_>, checkpoint: &mut Checkpoint) -> Ended {
        let console = self.console;
        let mut last_preview = None::<Instant>;
        let mut between = |bake: &Bake<'_>, failed: Option<SumsError>| {
            if let Some(error) = failed {
                console.say(format!("warning: no checkpoint for now: {error}"));
            }
            let Some(every) = self.args.preview_every else {
                return;
            };
            if last_preview.is_none_or(|last| last.elapsed() >= every) {
                last_preview = Some(Instant::now());
                if let Err(failure) = self.preview(bake) {
                    console.say(format!("warning: no preview: {:?}", failure.report));
                }
            }
        };
        let cancel = console.cancel();
        drive(
            bake,
            &self.goal,
            Some(checkpoint),
            console,
            cancel,
            &mut between,
        )
    }

    fn preview(&self, bake: &Bake<'_>) -> Result<(), Failure> {
        write_table(&bake.snapshot()?, self.dye, &self.args.output)
    }

    /// Writes what was asked for, or what there is of it.
    fn keep(
        &self,
        bake: &Bake<'_>,
        checkpoint: &mut Checkpoint,
        ended: Ended,
    ) -> Result<(), Failure> {
        let (args, console) = (self.args, self.console);
        let output = args.output.display();
        let photons = bake.photons();
        if ended == Ended::Cancelled && (args.shard.is_some() || photons == 0) {
            let path = checkpoint.path().display();
            let kept = match photons {
                0 => "stopped before there was anything to keep".to_owned(),
                _ if checkpoint.holds(bake) => format!(
                    "stopped; {path} keeps {photons} photons for the same command to go on from"
                ),
                _ => format!("stopped; {photons} photons are lost: {path} cannot be written"),
            };
            return Err(Failure::new(Blame::Interrupted, kept));
        }
        self.write(bake, ended)
            .map_err(|failure| secure(failure, bake, checkpoint))?;
        if ended == Ended::Cancelled {
            let kept = match checkpoint.holds(bake) {
                true => "holds the photons done so far, and the same command goes on from there",
                false => "is the table of the photons done so far; their sums are lost",
            };
            let kept = format!("stopped; {output} {kept}");
            return Err(Failure::new(Blame::Interrupted, kept));
        }
        if let Err(error) = checkpoint.finish(bake) {
            console.say(format!("warning: {error}"));
        }
        Ok(())
    }

    /// Writes sums or a table, and says how good it is.
    fn write(&self, bake: &Bake<'_>, ended: Ended) -> Result<(), Failure> {
        let (args, console) = (self.args, self.console);
        if let Some(shard) = args.shard {
            bake.save(&args.output)?;
            let photons = bake.photons();
            console.say(format!(
                "shard {shard}: {photons} photons; `vair merge` puts them together"
            ));
            return Ok(());
        }
        let table = bake.snapshot()?;
        // The error is estimated while the table is written: a disk is waited for, not computed for.
        let (error, written) = rayon::join(
            || bake.error(),
            || write_table(&table, self.dye, &args.output),
        );
        written?;
        report(table.tables(), console);
        self.say_error(error, bake.photons(), ended);
        if let (true, Some(cache)) = (ended != Ended::Cancelled, &self.cache) {
            store(&table, cache, console);
        }
        Ok(())
    }

    fn say_error(&self, error: f64, photons: u64, ended: Ended) {
        let error = 100.0 * error;
        self.console.say(match ended {
            Ended::Photons | Ended::Cancelled => format!("error of S about {error:.2} %"),
            Ended::Error | Ended::Time => format!(
                "error of S about {error:.2} % with {photons} photons; \
                 --photons {photons} gives the same table"
            ),
        });
    }
}

/// Keeps the photons of a bake whose output cannot be written.
fn secure(failure: Failure, bake: &Bake<'_>, checkpoint: &mut Checkpoint) -> Failure {
    let photons = bake.photons();
    let help = match checkpoint.save(bake) {
        Ok(()) => format!(
            "{} keeps the {photons} photons: once the output can be written the same command goes on from there",
            checkpoint.path().display()
        ),
        Err(error) => format!("the {photons} photons are lost: {error}"),
    };
    Failure::with_help(failure.blame, failure.report, help)
}

/// A cache that cannot be written to costs the next bake its time.
fn store(table: &Undyed, cache: &Cache, console: &Console) {
    for table in table.tables() {
        if let Err(error) = cache.put(table) {
            console.say(format!("warning: {error}"));
            return;
        }
    }
}
