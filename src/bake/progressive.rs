//! A bake that runs in passes and can be looked at while it does.

use super::content::Recipe;
use super::goal::{Ended, Goal, first_check, next_check};
use super::noise::{Noise, Norm};
use super::pass::{self, of_node};
use super::plan::Plan;
use super::settings::check;
use super::shot::Shot;
use super::sums_file::Header;
use super::tally::Tally;
use super::{BakeError, Settings, Shard};
use crate::fiber::Fiber;
use crate::math::unicube::Unicube;
use crate::progress::{Cancel, Progress};
use crate::species::Structure;
use crate::table::{Nodes, Provenance, Undyed};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::time::Instant;

/// Seconds that a pass aims for. Adding one to the sums takes some ten milliseconds: shorter and that
/// is felt, longer and a cancelled pass throws away more.
const PASS_SECONDS: f64 = 1.0;
/// Photons a node of the first pass: enough for a rough table, a few hundredths of a second.
const FIRST_PASS: u64 = 1024;
/// A pass may be so many times as long as the one before, whose speed it is planned with.
const GROWTH: f64 = 4.0;

/// A photon bake of one fiber, or of three alike where its materials differ by color.
///
/// One thread drives it, with [`Bake::run`] or pass by pass with [`Bake::refine`]. Any other may at
/// any time ask how far it is and take a table; what they see are whole passes. Photon `t` is the
/// same whenever and wherever it is flown and sums are integers: a table depends on how many photons
/// it has, not on passes, threads or pauses.
pub struct Bake<'a> {
    fibers: Vec<Held<'a>>,
    pub(super) header: Header,
    /// Photons to be flown.
    pub(super) range: Range<u64>,
    nodes: Nodes,
    cube: Unicube,
    norm: Norm,
    workers: Option<usize>,
    done: RwLock<Done>,
    pub(super) hand: Mutex<Hand>,
}

/// A fiber of its own or one that is lent.
enum Held<'a> {
    Own(Box<Fiber>),
    Lent(&'a Fiber),
}

impl Held<'_> {
    fn get(&self) -> &Fiber {
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
    /// By channel and node.
    pub(super) tallies: Vec<Tally>,
    error: f64,
}

/// What only the driving thread uses.
pub(super) struct Hand {
    /// The pass under way, empty between passes.
    fresh: Vec<Mutex<Tally>>,
    /// Photons a second of the last pass.
    pace: Option<f64>,
    /// Photons of the last pass.
    last: u64,
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
        let plan = Plan::new(&lent, settings);
        let cube = Unicube::new(settings.face);
        let tallies = || (0..plan.units()).map(|_| plan.empty_tally());
        Ok(Self {
            nodes: plan.nodes(),
            norm: Norm::new(&cube, plan.folded),
            workers: None,
            done: RwLock::new(Done {
                span: 0..0,
                tallies: tallies().collect(),
                error: f64::INFINITY,
            }),
            hand: Mutex::new(Hand {
                fresh: tallies().map(Mutex::new).collect(),
                pace: None,
                last: 0,
                check: first_check(settings.bins),
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
        self.header.shards = shard.of;
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
    /// three channels the worst.
    pub fn error(&self) -> f64 {
        self.done().error
    }

    /// The table of what is done so far. Its content hash is that of a bake of so many photons.
    ///
    /// # Errors
    /// [`BakeError::Stopped`] before the first pass is done.
    pub fn snapshot(&self) -> Result<Undyed, BakeError> {
        let done = self.done();
        let photons = done.span.end - done.span.start;
        let Header {
            plan, provenance, ..
        } = &self.header;
        plan.tables(&done.tallies, photons, provenance)
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

    /// One pass: about a second, less at first. `None` if there is more to do. A cancelled pass
    /// leaves nothing behind.
    ///
    /// On the threads of the rayon pool it is called from.
    pub fn refine(&self, goal: &Goal, progress: &dyn Progress, cancel: &Cancel) -> Option<Ended> {
        let mut hand = lock(&self.hand);
        let (end, error) = (self.done().span.end, self.error());
        if let Some(goal) = goal.error
            && end >= hand.check
        {
            if error <= goal {
                return Some(Ended::Error);
            }
            hand.check = next_check(end, error, goal);
        }
        let count = match self.next_pass(&hand, end, goal) {
            Ok(count) => count,
            Err(ended) => return Some(ended),
        };
        let span = end..end + count;
        let start = Instant::now();
        if !self.fly(&span, &hand, progress, cancel) {
            hand.fresh.par_iter_mut().for_each(|tally| {
                tally
                    .get_mut()
                    .unwrap_or_else(PoisonError::into_inner)
                    .clear();
            });
            return Some(Ended::Cancelled);
        }
        let error = self.add(&span, &mut hand);
        hand.pace = Some(count as f64 / start.elapsed().as_secs_f64().max(1e-9));
        hand.last = count;
        progress.note(&format!("error {:.2} %", 100.0 * error));
        if let Some(photons) = self.forecast(&hand, span.end, error, goal) {
            let channels = self.fibers.len() as u64;
            progress.expect((photons - self.range.start) * channels);
        }
        None
    }

    /// Where the bake will end if a goal comes before its last photon.
    fn forecast(&self, hand: &Hand, end: u64, error: f64, goal: &Goal) -> Option<u64> {
        let by_error = goal
            .error
            .map(|goal| (end - self.range.start) as f64 * (error / goal).powi(2));
        let by_time = goal.until.zip(hand.pace).map(|(until, pace)| {
            let left = until.saturating_duration_since(Instant::now());
            (end - self.range.start) as f64 + pace * left.as_secs_f64()
        });
        let least = by_error.into_iter().chain(by_time).reduce(f64::min)?;
        let forecast = self.range.start.saturating_add(least as u64);
        Some(forecast.clamp(end, self.range.end))
    }

    /// Takes over the sums of a span.
    pub(super) fn take_over(&self, span: Range<u64>, tallies: Vec<Tally>, check: u64) {
        let mut hand = lock(&self.hand);
        let mut done = self.done_mut();
        let noise: Vec<Noise> = tallies
            .par_iter()
            .enumerate()
            .map(|(unit, tally)| {
                let node = unit % self.nodes.len();
                self.norm.of(&self.cube, &self.nodes, node, tally)
            })
            .collect();
        *done = Done {
            span,
            tallies,
            error: Noise::of_channels(&noise, self.nodes.len()),
        };
        hand.check = check;
    }

    /// How many photons the next pass flies, or why there is none.
    fn next_pass(&self, hand: &Hand, end: u64, goal: &Goal) -> Result<u64, Ended> {
        let left = self.range.end.saturating_sub(end);
        if left == 0 {
            return Err(Ended::Photons);
        }
        let nodes = self.header.plan.settings.bins as u64;
        let mut count = match hand.pace {
            None => FIRST_PASS * nodes,
            Some(pace) => {
                let mut seconds = PASS_SECONDS;
                if let Some(until) = goal.until {
                    let remaining = until.saturating_duration_since(Instant::now());
                    seconds = seconds.min(remaining.as_secs_f64());
                }
                let count = (pace * seconds).min(hand.last as f64 * GROWTH) as u64;
                // A pass of fewer than a few photons a node is not worth its addition.
                if goal.until.is_some() && count < 16 * nodes {
                    return Err(Ended::Time);
                }
                count.max(nodes)
            }
        };
        if goal.error.is_some() && end < hand.check {
            count = count.min(hand.check - end);
        }
        Ok(count.min(left))
    }

    fn fly(
        &self,
        span: &Range<u64>,
        hand: &Hand,
        progress: &dyn Progress,
        cancel: &Cancel,
    ) -> bool {
        let shots = self.fibers.iter().flat_map(|fiber| {
            (0..self.nodes.len()).map(move |node| {
                let shot = Shot {
                    fiber: fiber.get(),
                    settings: &self.header.plan.settings,
                    nodes: &self.nodes,
                    cube: &self.cube,
                    node,
                };
                (shot, of_node(span, self.nodes.len(), node))
            })
        });
        let workers = rayon::current_num_threads();
        let workers = self.workers.map_or(workers, |most| workers.min(most));
        pass::fly(shots.collect(), &hand.fresh, workers, progress, cancel)
    }

    /// Adds the pass to the sums and says how noisy they are now.
    fn add(&self, span: &Range<u64>, hand: &mut Hand) -> f64 {
        let mut done = self.done_mut();
        let noise: Vec<Noise> = done
            .tallies
            .par_iter_mut()
            .zip(&mut hand.fresh)
            .enumerate()
            .map(|(unit, (sum, fresh))| {
                let fresh = fresh.get_mut().unwrap_or_else(PoisonError::into_inner);
                sum.add(fresh);
                fresh.clear();
                let node = unit % self.nodes.len();
                self.norm.of(&self.cube, &self.nodes, node, sum)
            })
            .collect();
        done.span.end = span.end;
        done.error = Noise::of_channels(&noise, self.nodes.len());
        done.error
    }

    pub(super) fn done(&self) -> RwLockReadGuard<'_, Done> {
        self.done.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn done_mut(&self) -> RwLockWriteGuard<'_, Done> {
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
            .field("error", &done.error)
            .finish_non_exhaustive()
    }
}
