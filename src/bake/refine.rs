//! The passes of a bake: how long, flown, added to the sums.

use super::goal::{Ended, Goal, next_check};
use super::noise::Noise;
use super::pass::{self, of_node};
use super::progressive::{Bake, Done, Hand, lock};
use super::shot::Shot;
use super::tally::Tally;
use crate::math::has_wide_registers;
use crate::progress::{Cancel, Progress};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Seconds that a pass aims for: longer, and a cancelled one throws away more.
const PASS_SECONDS: f64 = 1.0;
/// But it is to take so many times as long as what follows it: adding it to the sums, and estimating the
/// error, or these would be felt.
const AMORTIZED: f64 = 20.0;
/// Passes shorter than this have no error reported, seconds.
const REPORTED: f64 = 0.5;
/// What filtering a node takes over what making the filter does, and what estimating the error does: 0.41 to 0.45
/// and 0.25 to 0.28 in processor time, a little more for certainty. Less and tables come late, more and photons are
/// missing.
const AFTER: Shares = Shares {
    tabling: 0.5,
    estimating: 0.3,
};
/// Likewise with wide registers, of which making has less: 0.27 to 0.5 and 0.17 to 0.28 of the clock.
const AFTER_WIDE: Shares = Shares {
    tabling: 0.45,
    estimating: 0.27,
};
/// Photons a node of the first pass: enough for a rough table, a few hundredths of a second.
const FIRST_PASS: u64 = 1024;
/// A pass may be so many times as long as the one before, whose speed it is planned with.
const GROWTH: f64 = 4.0;
/// With a deadline passes take this share of the time that is left, so that the last is short and ends on
/// time, whatever the one before was wrong about.
const SHARE: f64 = 0.8;
/// But none shorter than this is planned, seconds: it would end late by a batch or two.
const SHORT: f64 = 0.02;

/// Times of a node over that of making the filter.
struct Shares {
    tabling: f64,
    estimating: f64,
}

fn shares() -> Shares {
    match has_wide_registers() {
        true => AFTER_WIDE,
        false => AFTER,
    }
}

impl Bake<'_> {
    /// One pass: about a second, less at first. `None` if there is more to do. A cancelled pass
    /// leaves nothing behind.
    ///
    /// On the threads of the rayon pool it is called from.
    pub fn refine(&self, goal: &Goal, progress: &dyn Progress, cancel: &Cancel) -> Option<Ended> {
        let mut hand = lock(&self.hand);
        let end = self.done().span.end;
        let done = end - self.range.start;
        if let Some(goal) = goal.error
            && done >= hand.check
        {
            let error = self.error();
            if error <= goal {
                return Some(Ended::Error);
            }
            hand.check = next_check(done, error, goal);
        }
        let count = match self.next_pass(&hand, end, goal) {
            Ok(count) => count,
            Err(ended) => return Some(ended),
        };
        if hand.fresh.is_empty() {
            let plan = &self.header.plan;
            let units = (0..plan.units()).into_par_iter().with_max_len(1);
            hand.fresh = units.map(|_| Mutex::new(plan.empty_tally())).collect();
        }
        let mut span = end..end + count;
        let start = Instant::now();
        let mut flown = self.fly_timed(&span, &mut hand, progress, cancel);
        // With a deadline the pass goes on to its second: another one would fetch twice as much memory.
        let joins = goal.until.is_some() && goal.error.is_none();
        while flown && joins && start.elapsed().as_secs_f64() < PASS_SECONDS {
            let Ok(count) = self.next_pass(&hand, span.end, goal) else {
                break;
            };
            let more = span.end..span.end + count;
            flown = self.fly_timed(&more, &mut hand, progress, cancel);
            span.end = more.end;
        }
        let count = span.end - span.start;
        if !flown {
            hand.fresh.par_iter_mut().for_each(|tally| {
                tally
                    .get_mut()
                    .unwrap_or_else(PoisonError::into_inner)
                    .clear();
            });
            return Some(Ended::Cancelled);
        }
        let adding = Instant::now();
        self.add(&span, &mut hand);
        hand.adding = adding.elapsed().as_secs_f64();
        let seconds = start.elapsed().as_secs_f64().max(1e-9);
        if goal.until.is_none() {
            hand.pace = Some(count as f64 / seconds);
        }
        self.report(&mut hand, seconds, goal, progress);
        None
    }

    /// Flies photons and takes down how fast they were; `false` if it was cancelled.
    fn fly_timed(
        &self,
        span: &Range<u64>,
        hand: &mut Hand,
        progress: &dyn Progress,
        cancel: &Cancel,
    ) -> bool {
        let start = Instant::now();
        let flown = self.fly(span, hand, progress, cancel);
        hand.last = span.end - span.start;
        hand.pace = Some(hand.last as f64 / start.elapsed().as_secs_f64().max(1e-9));
        flown
    }

    /// Tells how large the error is and where the bake will end, if a pass was long enough for that.
    fn report(&self, hand: &mut Hand, seconds: f64, goal: &Goal, progress: &dyn Progress) {
        let end = self.done().span.end;
        if goal.error.is_none()
            && let Some(photons) = self.forecast(hand, end, f64::INFINITY, goal)
        {
            self.foretell(photons, progress);
        }
        // Time for a table is not to be spent on its error.
        let busy = goal.until.is_some_and(|until| {
            let left = until.saturating_duration_since(Instant::now());
            left < (self.tabling() + self.estimating()).mul_f64(AMORTIZED)
        });
        if busy {
            return;
        }
        let due = match hand.reported {
            None => seconds >= REPORTED,
            Some((last, took)) => last.elapsed() >= took.mul_f64(AMORTIZED),
        };
        if !due {
            return;
        }
        let start = Instant::now();
        let error = self.error();
        hand.reported = Some((Instant::now(), start.elapsed()));
        progress.note(&format!("error {:.2} %", 100.0 * error));
        if let Some(photons) = self.forecast(hand, end, error, goal) {
            self.foretell(photons, progress);
        }
    }

    fn foretell(&self, photons: u64, progress: &dyn Progress) {
        progress.expect((photons - self.range.start) * self.fibers.len() as u64);
    }

    /// What [`Bake::snapshot`] will take, foretold from what making the filter took on the same threads: neither depends
    /// on photons, so the two keep their ratio on any machine and under any steady load.
    pub fn tabling(&self) -> Duration {
        self.for_all_nodes(shares().tabling)
    }

    /// Likewise what [`Bake::error`] will take after that.
    pub fn estimating(&self) -> Duration {
        self.for_all_nodes(shares().estimating)
    }

    fn for_all_nodes(&self, share: f64) -> Duration {
        self.making.mul_f64(share * self.header.plan.units() as f64)
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
        *self.done_mut() = Done {
            span,
            tallies,
            error: OnceLock::new(),
        };
        hand.check = check;
    }

    /// The error of sums.
    pub(super) fn estimate(&self, tallies: &[Tally]) -> f64 {
        if tallies.is_empty() {
            return f64::INFINITY;
        }
        let filter = self.filter.as_ref();
        let noise: Vec<Noise> = tallies
            .chunks(self.nodes.len())
            .flat_map(|channel| self.norm.of_nodes(&self.cube, &self.nodes, channel, filter))
            .collect();
        Noise::of_channels(&noise, self.nodes.len())
    }

    /// How many photons the next pass flies, or why there is none.
    fn next_pass(&self, hand: &Hand, end: u64, goal: &Goal) -> Result<u64, Ended> {
        let left = self.range.end.saturating_sub(end);
        if left == 0 {
            return Err(Ended::Photons);
        }
        let nodes = self.nodes.len() as u64;
        let mut count = match hand.pace {
            None => FIRST_PASS * nodes,
            Some(pace) => {
                let mut seconds = PASS_SECONDS.max(AMORTIZED * hand.adding);
                if let Some(until) = goal.until {
                    let now = Instant::now() + self.tabling();
                    let left = until.saturating_duration_since(now).as_secs_f64();
                    let share = if SHARE * left > SHORT { SHARE } else { 1.0 };
                    seconds = seconds.min(share * left);
                }
                let count = (pace * seconds).min(hand.last as f64 * GROWTH) as u64;
                // A pass of fewer than a few photons a node is not worth its addition.
                if goal.until.is_some() && count < 16 * nodes {
                    return Err(Ended::Time);
                }
                count.max(nodes)
            }
        };
        let done = end - self.range.start;
        if goal.error.is_some() && done < hand.check {
            count = count.min(hand.check - done);
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
                let settings = &self.header.plan.settings;
                let shot = Shot::new(fiber.get(), settings, &self.nodes, &self.cube, node);
                (shot, of_node(span, self.nodes.len(), node))
            })
        });
        let workers = rayon::current_num_threads();
        let workers = self.workers.map_or(workers, |most| workers.min(most));
        pass::fly(shots.collect(), &hand.fresh, workers, progress, cancel)
    }

    /// Adds the pass to the sums.
    fn add(&self, span: &Range<u64>, hand: &mut Hand) {
        let mut done = self.done_mut();
        if done.tallies.is_empty() {
            let fresh = std::mem::take(&mut hand.fresh).into_iter();
            let fresh =
                fresh.map(|tally| tally.into_inner().unwrap_or_else(PoisonError::into_inner));
            done.tallies = fresh.collect();
        }
        let sums = done.tallies.par_iter_mut().zip(&mut hand.fresh);
        sums.for_each(|(sum, fresh)| {
            let fresh = fresh.get_mut().unwrap_or_else(PoisonError::into_inner);
            if sum.is_empty() {
                std::mem::swap(sum, fresh);
            } else {
                sum.add(fresh);
                fresh.clear();
            }
        });
        done.span.end = span.end;
        done.error = OnceLock::new();
    }
}
