//! A bake that runs in passes and can be looked at while it does.

use super::goal::{Ended, Goal, first_check, next_check};
use super::noise::{Noise, Norm};
use super::pass::{self, of_node};
use super::plan::Plan;
use super::settings::check;
use super::shot::Shot;
use super::tally::Tally;
use super::{BakeError, Settings};
use crate::fiber::Fiber;
use crate::math::unicube::Unicube;
use crate::progress::{Cancel, Progress};
use crate::species::Structure;
use crate::table::{Nodes, Provenance, Undyed};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
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
    plan: Plan,
    nodes: Nodes,
    cube: Unicube,
    norm: Norm,
    workers: Option<usize>,
    done: RwLock<Done>,
    hand: Mutex<Hand>,
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
struct Done {
    /// Photons of the bake that are in the sums.
    span: Range<u64>,
    /// By channel and node.
    tallies: Vec<Tally>,
    error: f64,
}

/// What only the driving thread uses.
struct Hand {
    /// The pass under way, empty between passes.
    fresh: Vec<Mutex<Tally>>,
    /// Photons a second of the last pass.
    pace: Option<f64>,
    /// Photons of the last pass.
    last: u64,
    /// Where the error is held against the goal next.
    check: u64,
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
        Self::of(fibers, settings)
    }
}

impl<'a> Bake<'a> {
    /// A bake of a fiber that is built already, of one channel.
    ///
    /// # Errors
    /// Settings out of range.
    pub fn of_fiber(fiber: &'a Fiber, settings: &Settings) -> Result<Self, BakeError> {
        Self::of(vec![Held::Lent(fiber)], settings)
    }

    fn of(fibers: Vec<Held<'a>>, settings: &Settings) -> Result<Self, BakeError> {
        check(settings)?;
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
            fibers,
            plan,
            cube,
        })
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

    /// The table of what is done so far.
    ///
    /// * `provenance`: what is known of the table's origin; seed, events, program and content hash are
    ///   filled in here. The content hash is that of a bake of so many photons.
    ///
    /// # Errors
    /// [`BakeError::Stopped`] before the first pass is done.
    pub fn snapshot(&self, provenance: &Provenance) -> Result<Undyed, BakeError> {
        let done = self.done();
        let photons = done.span.end - done.span.start;
        self.plan.tables(&done.tallies, photons, provenance)
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
        progress.begin("baking", self.plan.settings.photons * channels, "photons");
        progress.advance(self.photons() * channels);
    }

    /// One pass: about a second, less at first. `None` if there is more to do. A cancelled pass
    /// leaves nothing behind.
    ///
    /// On the threads of the rayon pool it is called from.
    pub fn refine(&self, goal: &Goal, progress: &dyn Progress, cancel: &Cancel) -> Option<Ended> {
        let mut hand = self.hand.lock().unwrap_or_else(PoisonError::into_inner);
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
        None
    }

    /// How many photons the next pass flies, or why there is none.
    fn next_pass(&self, hand: &Hand, end: u64, goal: &Goal) -> Result<u64, Ended> {
        let left = self.plan.settings.photons.saturating_sub(end);
        if left == 0 {
            return Err(Ended::Photons);
        }
        let nodes = self.plan.settings.bins as u64;
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
                    settings: &self.plan.settings,
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
        done.error = noise
            .chunks(self.nodes.len())
            .map(|channel| Noise::sum(channel.iter().copied()).relative())
            .fold(0.0, f64::max);
        done.error
    }

    fn done(&self) -> RwLockReadGuard<'_, Done> {
        self.done.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn done_mut(&self) -> RwLockWriteGuard<'_, Done> {
        self.done.write().unwrap_or_else(PoisonError::into_inner)
    }
}

impl std::fmt::Debug for Bake<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let done = self.done();
        f.debug_struct("Bake")
            .field("settings", &self.plan.settings)
            .field("span", &done.span)
            .field("error", &done.error)
            .finish_non_exhaustive()
    }
}
