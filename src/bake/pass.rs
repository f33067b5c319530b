//! One pass: a span of photons over all nodes, flown on all threads.

use super::shot::Shot;
use super::tally::Tally;
use crate::progress::{Cancel, Progress};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Photons that one thread flies between two looks at the cancel flag and the common counter. Some
/// milliseconds: less and the counter is felt, more and the last thread of a pass is waited for.
const BATCH: u64 = 1024;

/// Photons are dealt to the nodes in turn: photon `t` of a bake is number `t / nodes` of node
/// `t % nodes`. So any span of a bake is even over the nodes, and the photons of one node are the
/// range that this gives.
pub(super) fn of_node(span: &Range<u64>, nodes: usize, node: usize) -> Range<u64> {
    let (nodes, node) = (nodes as u64, node as u64);
    let before = |t: u64| t / nodes + u64::from(node < t % nodes);
    before(span.start)..before(span.end)
}

/// The photons of one node that are still to be flown.
struct Unit<'a> {
    shot: Shot<'a>,
    next: AtomicU64,
    end: u64,
    sum: &'a Mutex<Tally>,
}

impl Unit<'_> {
    fn take(&self) -> Option<Range<u64>> {
        // A plain look first, so that the counter does not run on for ever.
        if self.next.load(Ordering::Relaxed) >= self.end {
            return None;
        }
        let start = self.next.fetch_add(BATCH, Ordering::Relaxed);
        (start < self.end).then(|| start..(start + BATCH).min(self.end))
    }
}

/// Flies the span of every shot and adds to the sum beside it. False if cancelled; the sums are
/// then a part of the pass and of no use.
///
/// Every worker begins at another node and helps at those of others when its own are done. The first
/// at a node adds to its sum directly; who comes to help adds up apart and hands in at the end. So
/// a thread's sums are one node's, a few megabytes that stay in its cache, and the photon loop
/// knows no locks. Integer sums do not depend on who flew what.
pub(super) fn fly(
    shots: Vec<(Shot<'_>, Range<u64>)>,
    sums: &[Mutex<Tally>],
    workers: usize,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> bool {
    let units: Vec<Unit<'_>> = shots
        .into_iter()
        .zip(sums)
        .map(|((shot, range), sum)| Unit {
            shot,
            next: AtomicU64::new(range.start),
            end: range.end,
            sum,
        })
        .collect();
    let work = |worker: usize| {
        let first = worker * units.len() / workers;
        let (before, after) = units.split_at(first);
        let mut apart: Option<Tally> = None;
        for unit in after.iter().chain(before) {
            let Some(batch) = unit.take() else { continue };
            if let Ok(mut sum) = unit.sum.try_lock() {
                fly_unit(unit, batch, &mut sum, progress, cancel);
            } else {
                let apart = apart.get_or_insert_with(|| unit.shot.empty_tally());
                fly_unit(unit, batch, apart, progress, cancel);
                unit.sum
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .add(apart);
                apart.clear();
            }
            if cancel.is_cancelled() {
                return;
            }
        }
    };
    (0..workers).into_par_iter().with_max_len(1).for_each(work);
    !cancel.is_cancelled()
}

fn fly_unit(
    unit: &Unit<'_>,
    first: Range<u64>,
    tally: &mut Tally,
    progress: &dyn Progress,
    cancel: &Cancel,
) {
    let (mut next, mut under_way) = (Some(first), 0);
    let mut advance = || {
        progress.advance(under_way);
        if cancel.is_cancelled() {
            return None;
        }
        let batch = next.take().or_else(|| unit.take());
        under_way = batch.as_ref().map_or(0, |batch| batch.end - batch.start);
        batch
    };
    unit.shot.fly(&mut advance, tally);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_are_dealt_evenly_and_without_gaps() {
        let nodes = 7;
        for node in 0..nodes {
            let mut next = 0;
            for span in [0..1, 1..5, 5..5, 5..300, 300..1_000_003] {
                let range = of_node(&span, nodes, node);
                assert_eq!(range.start, next);
                let dealt = span.filter(|t| *t as usize % nodes == node).count();
                assert_eq!((range.end - range.start) as usize, dealt);
                next = range.end;
            }
        }
    }
}
