//! Which scale lies on top along a line.

/// Ranks of the rows that show on a line: those that end higher than every row before, cyclically.
pub(super) fn visible(ends: &[f64], period: f64) -> Vec<usize> {
    let before = ends.iter().fold(f64::NEG_INFINITY, |m, &e| m.max(e)) - period;
    ends.iter()
        .scan(before, |highest, &end| {
            let shows = end > *highest;
            *highest = highest.max(end);
            Some(shows)
        })
        .enumerate()
        .filter_map(|(k, shows)| shows.then_some(k))
        .collect()
}

/// Lower envelope of `offset_k + (z - z_k)^2` over the seeds and their periodic images: the seeds
/// of one period that show, in order, with the upper end of each.
pub(super) fn envelope(
    seeds: &[(f64, f64)],
    period: f64,
    offset: impl Fn(usize) -> f64,
) -> Vec<(usize, f64)> {
    let n = seeds.len();
    // Three images: what shows in the middle one is free of end effects.
    let image = |j: usize| {
        let z = seeds[j % n].0 + ((j / n) as f64 - 1.0) * period;
        (2.0 * z, -(z * z) - offset(j % n))
    };
    let meet = |i: usize, j: usize| {
        let ((si, ci), (sj, cj)) = (image(i), image(j));
        (ci - cj) / (sj - si)
    };
    let mut hull: Vec<usize> = Vec::new();
    for j in 0..3 * n {
        while let Some(&top) = hull.last() {
            if image(j).0 - image(top).0 < 1e-12 {
                // Same height: the nearer seed hides the other everywhere.
                if image(j).1 <= image(top).1 {
                    break;
                }
            } else if hull.len() < 2 || meet(hull[hull.len() - 2], top) < meet(top, j) {
                break;
            }
            hull.pop();
        }
        match hull.last() {
            Some(&top) if image(j).0 - image(top).0 < 1e-12 => {}
            _ => hull.push(j),
        }
    }
    hull.windows(2)
        .filter(|w| (n..2 * n).contains(&w[0]))
        .map(|w| (w[0] % n, meet(w[0], w[1])))
        .collect()
}

/// Lifts ends that ripples have pushed below their predecessor.
pub(super) fn ascend(shown: &mut [(usize, f64)], period: f64) {
    let highest = shown.iter().fold(f64::NEG_INFINITY, |m, s| m.max(s.1));
    let mut lo = highest - period;
    for (_, end) in shown {
        *end = end.max(lo);
        lo = *end;
    }
}
