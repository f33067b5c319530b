//! Four runs of two segments.

use super::super::ribbon::{Seen, Segments};
use super::Run;
use super::line::Line;
use crate::accel::lanes::{Lanes, Numbers};
use glam::{Vec3, Vec4, Vec4Swizzles};

/// Runs of a leaf at most.
pub(super) const RUNS: usize = 4;

/// Joints of a leaf.
const JOINTS: usize = 3 * RUNS;

/// Whether the next leaf belongs to the same child of a node.
const FOLLOWED: u8 = 1 << 7;

/// Joints counted in steps from a corner, in two lines of a cache. The joints of a run are `k`, `k + 4` and `k + 8`,
/// so that its segments are lanes `k` and `k + 4` and all lanes end four joints after they begin.
#[derive(Clone, Debug)]
#[repr(C, align(128))]
pub(super) struct Leaf {
    /// Of twelve joints the places along x, y and z, and the half widths.
    joints: [u16; 4 * JOINTS],
    corner: Vec3,
    /// Exponents of two: the step of places and that of widths.
    step: [i8; 2],
    /// Which lanes there are, a bit each.
    used: u8,
    /// Runs with which their strands end, a bit each, and [`FOLLOWED`].
    last: u8,
    /// Number of each run.
    runs: [u32; RUNS],
}

const _: () = assert!(size_of::<Leaf>() == 128);

impl Leaf {
    /// * `joints`: of the scene. * `numbers`: of one to four runs. * `is_followed`: by a leaf of the same child of
    ///   a node.
    pub(super) fn new(joints: &[Vec4], runs: &[Run], numbers: &[u32], is_followed: bool) -> Self {
        let number = |k: usize| numbers[k.min(numbers.len() - 1)];
        let mut all = [Vec4::ZERO; JOINTS];
        let (mut used, mut last) = (0, u8::from(is_followed) * FOLLOWED);
        for k in 0..RUNS {
            let run = runs[number(k) as usize];
            for i in 0..3 {
                all[k + 4 * i] = joints[run.joint as usize + i.min(run.segments as usize)];
            }
            if k < numbers.len() {
                used |= (1 << k) | u8::from(run.segments == 2) << (k + 4);
                last |= u8::from(run.is_last) << k;
            }
        }
        let lo = all.iter().fold(Vec4::INFINITY, |a, b| a.min(*b));
        let hi = all.iter().fold(Vec4::NEG_INFINITY, |a, b| a.max(*b));
        let exponent = |size: f32| {
            let least = (size.max(1e-30) / 65_000.0).log2().ceil();
            least.clamp(-100.0, 100.0) as i8
        };
        let width = exponent(hi.w);
        // Not so fine beside the widths that their squares could be too large.
        let place = exponent((hi - lo).xyz().max_element()).max(width - 4);
        let mut leaf = Self {
            joints: [0; 4 * JOINTS],
            corner: lo.xyz(),
            step: [place, width],
            used,
            last,
            runs: std::array::from_fn(number),
        };
        let [place, width] = leaf.steps();
        for (k, joint) in all.iter().enumerate() {
            // To the nearest: none is negative.
            let at = (joint.xyz() - leaf.corner) / place + 0.5;
            for axis in 0..3 {
                leaf.joints[JOINTS * axis + k] = at[axis] as u16;
            }
            leaf.joints[JOINTS * 3 + k] = (joint.w / width + 0.5) as u16;
        }
        leaf
    }

    #[inline(always)]
    fn steps(&self) -> [f32; 2] {
        self.step.map(|e| power(e.into()))
    }

    /// Joint `0..=2` of a run `0..4`.
    pub(super) fn joint(&self, run: usize, joint: usize) -> Vec4 {
        let [place, width] = self.steps();
        let j = [0, 1, 2, 3].map(|axis| f32::from(self.joints[JOINTS * axis + run + 4 * joint]));
        (self.corner + place * Vec3::new(j[0], j[1], j[2])).extend(width * j[3])
    }

    /// Joints of all runs: where a run goes on in another that one has the joint.
    pub(super) fn joints(&self) -> impl Iterator<Item = Vec4> + '_ {
        self.numbers().flat_map(move |(k, _)| {
            let segments = 1 + usize::from(self.used >> (k + 4) & 1);
            let joints = segments + usize::from(self.last >> k & 1);
            (0..joints).map(move |joint| self.joint(k, joint))
        })
    }

    #[inline(always)]
    pub(super) fn is_followed(&self) -> bool {
        self.last & FOLLOWED != 0
    }

    /// Number of the run of a lane.
    #[inline(always)]
    pub(super) fn run(&self, lane: usize) -> u32 {
        self.runs[lane % RUNS]
    }

    /// The runs that are there, with their place in the leaf.
    pub(super) fn numbers(&self) -> impl Iterator<Item = (usize, u32)> + '_ {
        (0..RUNS)
            .filter(|k| self.used >> k & 1 == 1)
            .map(|k| (k, self.runs[k]))
    }

    /// Which segments a ray meets ahead of its start and up to `limit`, a bit each, and how far along it.
    #[inline(always)]
    pub(super) fn meets<L: Lanes>(&self, line: &Line, limit: f32) -> (u32, L::Eight) {
        let points = [
            self.row::<L>(0),
            self.row::<L>(JOINTS),
            self.row::<L>(2 * JOINTS),
        ];
        // Sixteen that end with those of the twelve joints.
        let widths = self.row::<L>(3 * JOINTS - 4);
        let [place, width] = self.step.map(i32::from);
        // All in steps, of which the origin may be many away.
        let from = (line.origin - self.corner.extend(0.0)) * power(-place);
        let Seen {
            across: [x, y],
            depth,
        } = line.across.see(&points, from);
        let segments = Segments {
            root: Seen {
                across: [L::head(x), L::head(y)],
                depth: L::head(depth),
            },
            tip: Seen {
                across: [L::middle(x), L::middle(y)],
                depth: L::middle(depth),
            },
            widths: [L::middle(widths), L::tail(widths)],
        };
        let (is_met, depth) = segments.meet(power((width - place).max(-100)));
        let t = depth.mul(L::Eight::splat(power(place)));
        let t = L::Eight::splat(line.ahead).add(t);
        let is_met = is_met & t.le(L::Eight::splat(limit)) & !t.le(L::Eight::splat(0.0));
        (is_met & u32::from(self.used), t)
    }

    /// Sixteen numbers from one on.
    #[inline(always)]
    fn row<L: Lanes>(&self, first: usize) -> L::Sixteen {
        match self.joints[first..].first_chunk() {
            Some(row) => L::words(row),
            None => L::Sixteen::splat(0.0),
        }
    }
}

/// Two to the power of `e`, -126 to 127.
#[inline(always)]
fn power(e: i32) -> f32 {
    f32::from_bits(((e + 127) as u32) << 23)
}
