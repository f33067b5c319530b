//! Runs of a node, cut in two again and again, until they are as many parts as a node has children.

use super::bounds::Bounds;
use super::leaf::RUNS;
use crate::accel::lanes::CHILDREN;
use glam::{Vec3A, Vec4};
use rayon::prelude::*;

/// Bins along an axis.
const BINS: usize = 16;
/// Runs up to which so few bins do: a sixteenth of the builder's time, for 1.7 percent more leaves.
const FEW: usize = 16;
const FEW_BINS: usize = 8;
/// Runs from which on bins are filled on several threads, and how many are filled at a time.
const MANY: usize = 1 << 17;
const SOME: usize = 1 << 15;
/// Leaves of a child at most.
pub(super) const LEAVES: usize = 2;

/// A run along the axes of a node: a box, and the number in a lane that boxes do not use, so that a third less is moved.
#[derive(Clone, Copy)]
pub(super) struct Item {
    lo: Vec4,
    hi: Vec4,
}

/// An exponent with which every number up to 2^27 is a number of single precision that nothing is slow with.
const EXPONENT: u32 = 1 << 30;

impl Item {
    /// * `number`: at most 2^27.
    pub(super) fn new(bounds: Bounds, number: u32) -> Self {
        Self {
            lo: bounds.lo.extend(f32::from_bits(EXPONENT | number)),
            hi: bounds.hi.extend(0.0),
        }
    }

    pub(super) fn number(&self) -> u32 {
        self.lo.w.to_bits() & !EXPONENT
    }

    fn bounds(&self) -> Bounds {
        Bounds {
            lo: Vec3A::from_vec4(self.lo),
            hi: Vec3A::from_vec4(self.hi),
        }
    }
}

/// Runs next to each other in the list of a node.
pub(super) struct Group {
    pub(super) begin: usize,
    end: usize,
    pub(super) bounds: Bounds,
    /// Around their [`Bounds::middle`].
    middles: Bounds,
}

impl Group {
    fn new(items: &[Item], begin: usize, end: usize) -> Self {
        let one = |item: &Item| {
            let bounds = item.bounds();
            (bounds, Bounds::at(bounds.middle()))
        };
        let both = |a: (Bounds, Bounds), b: (Bounds, Bounds)| (a.0.with(b.0), a.1.with(b.1));
        let none = (Bounds::NONE, Bounds::NONE);
        let items = &items[begin..end];
        let (bounds, middles) = match items.len() > MANY {
            true => items.par_iter().map(one).reduce(|| none, both),
            false => items.iter().map(one).fold(none, both),
        };
        Self {
            begin,
            end,
            bounds,
            middles,
        }
    }

    pub(super) fn count(&self) -> usize {
        self.end - self.begin
    }
}

/// Sorts runs into the parts of a node.
///
/// * `is_even`: runs are halved, whatever that costs.
pub(super) fn deal(items: &mut [Item], is_even: bool) -> Vec<Group> {
    let mut groups = vec![Group::new(items, 0, items.len())];
    while groups.len() < CHILDREN {
        let size = |i: usize| match is_even {
            true => groups[i].count() as f32,
            false => groups[i].bounds.area(),
        };
        let largest = |least: usize| {
            (0..groups.len())
                .filter(|&i| groups[i].count() > least)
                .max_by(|&a, &b| size(a).total_cmp(&size(b)).then(b.cmp(&a)))
        };
        let Some(i) = largest(LEAVES * RUNS).or_else(|| largest(RUNS)) else {
            break;
        };
        let whole = groups.swap_remove(i);
        groups.extend(cut(items, &whole, is_even));
    }
    groups.sort_unstable_by_key(|g| g.begin);
    groups
}

/// Sorts the runs of a group into two, neither of them empty.
///
/// * `items`: all of the node.
fn cut(items: &mut [Item], whole: &Group, is_even: bool) -> [Group; 2] {
    let size = whole.middles.hi - whole.middles.lo;
    if is_even || size.max_element() <= 0.0 {
        let (axis, half) = (size.max_position(), whole.count() / 2);
        items[whole.begin..whole.end].select_nth_unstable_by(half, |a, b| {
            let at = |item: &Item| item.bounds().middle()[axis];
            at(a).total_cmp(&at(b)).then(a.number().cmp(&b.number()))
        });
        let middle = whole.begin + half;
        return [(whole.begin, middle), (middle, whole.end)]
            .map(|(begin, end)| Group::new(items, begin, end));
    }
    match whole.count() > FEW {
        true => cut_by_bins::<BINS>(items, whole),
        false => cut_by_bins::<FEW_BINS>(items, whole),
    }
}

/// What is in bins along each axis, and how many.
type Bins<const N: usize> = [[(Bounds, usize); N]; 3];

fn join(a: (Bounds, usize), b: (Bounds, usize)) -> (Bounds, usize) {
    (a.0.with(b.0), a.1 + b.1)
}

/// [`cut`] where that costs a ray least.
///
/// * `whole`: with middles that differ. * `N`: a power of two.
fn cut_by_bins<const N: usize>(items: &mut [Item], whole: &Group) -> [Group; 2] {
    let items = &mut items[whole.begin..whole.end];
    let Bounds { lo, hi } = whole.middles;
    let scale = (0.9999 * N as f32) / (hi - lo).max(Vec3A::splat(f32::MIN_POSITIVE));
    let bins_of = |middle: Vec3A| {
        // 1.5 times 2^23: what is added to it is rounded to a whole number, in the lowest bits. Conversions that saturate
        // took a quarter of the builder's time.
        const WHOLE: f32 = 12_582_912.0;
        let at = (middle - lo) * scale - 0.5 + WHOLE;
        at.to_array().map(|at| at.to_bits() as usize % N)
    };
    let none = [[(Bounds::NONE, 0); N]; 3];
    let sort = |items: &[Item]| {
        let mut bins: Bins<N> = none;
        for item in items {
            let item = item.bounds();
            for (bins, bin) in bins.iter_mut().zip(bins_of(item.middle())) {
                let (bounds, count) = &mut bins[bin];
                *bounds = bounds.with(item);
                *count += 1;
            }
        }
        bins
    };
    let both = |a: Bins<N>, b: Bins<N>| {
        std::array::from_fn(|axis| std::array::from_fn(|k| join(a[axis][k], b[axis][k])))
    };
    let bins = match items.len() > MANY {
        true => (items.par_chunks(SOME)).map(sort).reduce(|| none, both),
        false => sort(items),
    };
    // The first and the last bin of the axis that is longest have something.
    let (axis, place) = cheapest(&bins).unwrap_or(((hi - lo).max_position(), N / 2));
    let mut first = 0;
    let mut middles = [Bounds::NONE; 2];
    for i in 0..items.len() {
        let middle = items[i].bounds().middle();
        let side = usize::from(bins_of(middle)[axis] >= place);
        middles[side] = middles[side].with(Bounds::at(middle));
        items.swap(first, i);
        first += 1 - side;
    }
    let (lower, upper) = bins[axis].split_at(place);
    let [bounds, others] = [lower, upper].map(|bins| {
        let all = bins.iter().map(|(bounds, _)| *bounds);
        all.fold(Bounds::NONE, Bounds::with)
    });
    let middle = whole.begin + first;
    let group = |begin, end, bounds, middles| Group {
        begin,
        end,
        bounds,
        middles,
    };
    [
        group(whole.begin, middle, bounds, middles[0]),
        group(middle, whole.end, others, middles[1]),
    ]
}

/// Axis and first bin of the second part, of all cuts that leave something on both sides.
fn cheapest<const N: usize>(bins: &Bins<N>) -> Option<(usize, usize)> {
    let cost = |(bounds, count): (Bounds, usize)| bounds.area() * count.div_ceil(RUNS) as f32;
    let mut best = None;
    let mut least = f32::INFINITY;
    for (axis, bins) in bins.iter().enumerate() {
        let mut above = [f32::INFINITY; N];
        let mut sum = (Bounds::NONE, 0);
        for k in (1..N).rev() {
            sum = join(sum, bins[k]);
            if sum.1 > 0 {
                above[k] = cost(sum);
            }
        }
        let mut sum = (Bounds::NONE, 0);
        for k in 1..N {
            sum = join(sum, bins[k - 1]);
            if sum.1 > 0 && cost(sum) + above[k] < least {
                least = cost(sum) + above[k];
                best = Some((axis, k));
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the sizes of the boxes, parts of one size: else the tree's depth has no bound.
    #[test]
    fn even_parts_have_one_size() {
        let count = 800;
        let mut items: Vec<Item> = (0..count)
            .map(|number| {
                let lo = 1.02f32.powi(number as i32) * Vec3A::new(1.0, 0.3, 0.1);
                Item::new(Bounds { lo, hi: 1.01 * lo }, number)
            })
            .collect();
        let groups = deal(&mut items, true);
        let counts: Vec<usize> = groups.iter().map(Group::count).collect();
        assert_eq!(counts, [count as usize / CHILDREN; CHILDREN]);
    }

    /// What is known of parts without another look is what a look finds, and no run is lost.
    #[test]
    fn parts_are_what_their_runs_are() {
        let mut rng = crate::sampling::Rng::new(2, 0);
        for count in [9, 40, 3000, MANY + 1] {
            let mut items: Vec<Item> = (0..count as u32)
                .map(|number| {
                    let [a, b] = [1.0, 0.1].map(|size| {
                        Vec3A::from_array(std::array::from_fn(|_| size * rng.uniform_f32()))
                    });
                    Item::new(Bounds { lo: a, hi: a + b }, number)
                })
                .collect();
            let groups = deal(&mut items, false);
            assert_eq!(groups.iter().map(Group::count).sum::<usize>(), count);
            for group in &groups {
                let again = Group::new(&items, group.begin, group.end);
                for (known, found) in [(group.bounds, again.bounds), (group.middles, again.middles)]
                {
                    assert_eq!((known.lo, known.hi), (found.lo, found.hi));
                }
            }
            let mut numbers: Vec<u32> = items.iter().map(Item::number).collect();
            numbers.sort_unstable();
            assert!(numbers.into_iter().eq(0..count as u32));
        }
    }
}
