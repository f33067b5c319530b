//! A bake that runs in passes and can be looked at while it does.

use super::content::Recipe;
use super::goal::{Ended, Goal, first_check};
use super::noise::Norm;
use super::plan::Plan;
use super::reconstruct::Reconstruction;
use super::settings::{check, check_sides};
use super::sums_file::Header;
use super::tally::Tally;
use super::{BakeError, Settings, Shard};
use crate::fiber::Fiber;
use crate::math::unicube::Unicube;
use crate::progress::{Cancel, Progress};
use crate::species::Structure;
use crate::table::{Nodes, Provenance, Undyed};
use std::ops::Range;
use std::sync::{
    Mutex, MutexGuard, OnceLock, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard,
};
use std::time::{Duration, Instant};

/// A photon bake of one fiber, or of three alike where its materials differ by color.
///
/// One thread drives it, with [`Bake::run`] or pass by pass with [`Bake::refine`]. Any other may at
/// any time ask how far it is and take a table; what they see are whole passes. Photon `t` is the
/// same whenever and wherever it is flown and sums are integers: a table depends on how many photons
/// it has, not on passes, threads or pauses.
pub struct Bake<'a> {
    pub(super) fibers: Vec<Held<'a>>,
    pub(super) header: Header,
    /// Photons to be flown.
    pub(super) range: Range<u64>,
    pub(super) nodes: Nodes,
    pub(super) cube: Unicube,
    pub(super) norm: Norm,
    pub(super) filter: Option<Reconstruction>,
    /// What making the filter took, or the norm if there is none.
    pub(super) making: Duration,
    pub(super) workers: Option<usize>,
    done: RwLock<Done>,
    pub(super) hand: Mutex<Hand>,
}

/// A fiber of its own or one that is lent.
pub(super) enum Held<'a> {
    Own(Box<Fiber>),
    Lent(&'a Fiber),
}

impl Held<'_> {
    pub(super) fn get(&self) -> &Fiber {
        match self {
            Self::Own(fiber) => fiber,
            Self::Lent(fiber) => fiber,
        }
    }
}

/// The sums of all whole passes.
pub(super) struct Done {
    /// Photons of the bake that are in the sums.
    pub(super) span: Range<u64>,
    /// By channel and node; none before the first pass.
    pub(super) tallies: Vec<Tally>,
    /// Estimated when it is asked for: that takes as long as filtering a table does.
    pub(super) error: OnceLock<f64>,
}

/// What only the driving thread uses.
pub(super) struct Hand {
    /// The pass under way, empty between passes; none where the sums of the last one were taken over.
    pub(super) fresh: Vec<Mutex<Tally>>,
    /// Photons a second of the last pass.
    pub(super) pace: Option<f64>,
    /// Photons of the last pass.
    pub(super) last: u64,
    /// Seconds that adding it to the sums took.
    pub(super) adding: f64,
    /// When the error was reported last, and how long estimating it took.
    pub(super) reported: Option<(Instant, Duration)>,
    /// Where the error is held against the goal next.
    pub(super) check: u64,
}

impl Bake<'static> {
    /// A bake of a structure: its fiber is built, one a channel where materials differ by color.
    ///
    /// # Errors
    /// Settings out of range; a fiber that cannot be built.
    pub fn new(structure: &Structure, settings: &Settings) -> Result<Self, BakeError> {
        check(settings)?;
        let build = |structure: &Structure| {
            Fiber::build(structure, settings.seed).map(|fiber| Held::Own(Box::new(fiber)))
        };
        let fibers = if structure.is_colored() {
            let channels = [0, 1, 2].map(|channel| structure.channel(channel));
            channels.iter().map(build).collect::<Result<_, _>>()?
        } else {
            vec![build(structure)?]
        };
        Self::of(fibers, Recipe::new(structure, settings), settings)
    }
}

impl<'a> Bake<'a> {
    /// A bake of a fiber that is built already, of one channel.
    ///
    /// # Errors
    /// Settings out of range.
    pub fn of_fiber(fiber: &'a Fiber, settings: &Settings) -> Result<Self, BakeError> {
        check(settings)?;
        let recipe = Recipe::new(fiber.structure(), settings);
        Self::of(vec![Held::Lent(fiber)], recipe, settings)
    }

    fn of(fibers: Vec<Held<'a>>, recipe: Recipe, settings: &Settings) -> Result<Self, BakeError> {
        let lent: Vec<&Fiber> = fibers.iter().map(Held::get).collect();
        check_sides(&lent, settings)?;
        let plan = Plan::new(&lent, settings);
        let cube = Unicube::new(settings.face);
        let start = Instant::now();
        let (norm, filter) = rayon::join(
            || Norm::new(&cube, plan.folds_maps()),
            || plan.filter(&cube),
        );
        let making = (filter.as_ref()).map_or(start.elapsed(), Reconstruction::took);
        Ok(Self {
            nodes: plan.nodes(),
            norm,
            filter,
            making,
            workers: None,
            done: RwLock::new(Done {
                span: 0..0,
                tallies: Vec::new(),
                error: OnceLock::new(),
            }),
            hand: Mutex::new(Hand {
                fresh: Vec::new(),
                pace: None,
                last: 0,
                adding: 0.0,
                reported: None,
                check: first_check(settings.nodes()),
            }),
            header: Header::new(recipe, plan),
            range: 0..settings.photons,
            fibers,
            cube,
        })
    }

    /// Only a part of the bake: [`Bake::save`] gives sums that [`super::Sums::merge`] puts together
    /// with those of the other parts. Before the first pass.
    pub fn with_shard(mut self, shard: Shard) -> Self {
        self.range = shard.span(self.header.plan.settings.photons);
        self.header.shards = shard.of();
        let done = self.done.get_mut().unwrap_or_else(PoisonError::into_inner);
        done.span = self.range.start..self.range.start;
        self
    }

    /// What is known of the origin of the tables, and the absorption per micrometer that tables of
    /// three channels are to be dyed with. Seed, events, program and content hash are filled in by
    /// the bake.
    pub fn with_origin(mut self, provenance: Provenance, dye: Option<[f64; 3]>) -> Self {
        self.header.provenance = provenance;
        self.header.dye = dye;
        self
    }

    /// Keeps sums and tables within so many bytes by using fewer threads, which each need their own.
    /// The fiber itself, some megabytes, does not count.
    ///
    /// # Errors
    /// [`BakeError::Memory`] if one thread needs more.
    pub fn with_memory(mut self, limit: u64) -> Result<Self, BakeError> {
        let (fixed, each) = self.header.plan.memory();
        let workers = limit.saturating_sub(fixed) / each;
        if workers == 0 {
            return Err(BakeError::Memory {
                needed: fixed + each,
                limit,
            });
        }
        self.workers = Some(usize::try_from(workers).unwrap_or(usize::MAX));
        Ok(self)
    }

    /// Photons to be flown, of each channel.
    pub fn photons_wanted(&self) -> u64 {
        self.range.end - self.range.start
    }

    /// Photons in the sums, of each channel.
    pub fn photons(&self) -> u64 {
        let span = &self.done().span;
        span.end - span.start
    }

    /// Relative L2 error of S at the clear level, over all queries and exits within 73 degrees of
    /// the normal plane, estimated from the counts; infinite as long as noise hides everything. Of
    /// three channels the worst; of several azimuths those of the first and the last. Estimated when it is
    /// first asked for after a pass, which takes about as long as [`Bake::snapshot`].
    pub fn error(&self) -> f64 {
        let done = self.done();
        if let Some(error) = done.error.get() {
            return *error;
        }
        let error = self.estimate(&done.tallies);
        // Another thread may have been faster, with the same result.
        *done.error.get_or_init(|| error)
    }

    /// The table of what is done so far. Its content hash is that of a bake of so many photons.
    ///
    /// # Errors
    /// [`BakeError::Stopped`] before the first pass is done; [`BakeError::Part`] for shards other than the first, whose
    /// photons are not those of any whole bake.
    pub fn snapshot(&self) -> Result<Undyed, BakeError> {
        if self.range.start != 0 {
            return Err(BakeError::Part);
        }
        let done = self.done();
        let photons = done.span.end - done.span.start;
        let Header {
            plan, provenance, ..
        } = &self.header;
        plan.tables(&done.tallies, self.filter.as_ref(), photons, provenance)
    }

    /// Runs until the photons of the settings are flown, the goal is met or it is cancelled.
    pub fn run(&self, goal: &Goal, progress: &dyn Progress, cancel: &Cancel) -> Ended {
        self.begin(progress);
        let ended = loop {
            if let Some(ended) = self.refine(goal, progress, cancel) {
                break ended;
            }
        };
        progress.finish();
        ended
    }

    /// Opens the bake's stage of a progress report; [`Progress::finish`] is the caller's.
    pub fn begin(&self, progress: &dyn Progress) {
        let channels = self.fibers.len() as u64;
        progress.begin("baking", self.photons_wanted() * channels, "photons");
        progress.advance(self.photons() * channels);
    }

    pub(super) fn done(&self) -> RwLockReadGuard<'_, Done> {
        self.done.read().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn done_mut(&self) -> RwLockWriteGuard<'_, Done> {
        self.done.write().unwrap_or_else(PoisonError::into_inner)
    }
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl std::fmt::Debug for Bake<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let done = self.done();
        f.debug_struct("Bake")
            .field("settings", &self.header.plan.settings)
            .field("span", &done.span)
            .field("error", &done.error.get())
            .finish_non_exhaustive()
    }
}
