//! Four runs of two segments.

use super::super::ribbon::Eight;
use super::Run;
use super::lanes::Lanes;
use super::node::Line;
use glam::{Vec3, Vec4, Vec4Swizzles};

/// Runs of a leaf at most.
pub(super) const RUNS: usize = 4;

/// Joints counted in steps from a corner, in two lines of a cache. The joints of a run are `k`, `k + 4` and `k + 8`,
/// so that its segments are lanes `k` and `k + 4` and all lanes end four joints after they begin.
#[derive(Clone, Debug)]
#[repr(C, align(128))]
pub(super) struct Leaf {
    /// Along x, y and z, and half widths.
    joints: [[u16; 12]; 4],
    corner: Vec3,
    /// Exponents of two: the step of places and that of widths.
    step: [i8; 2],
    /// Which lanes there are, a bit each.
    used: u8,
    /// Runs with which their strands end, a bit each.
    last: u8,
    /// Number of each run.
    runs: [u32; RUNS],
}

impl Leaf {
    /// * `joints`: of the scene. * `numbers`: of one to four runs.
    pub(super) fn new(joints: &[Vec4], runs: &[Run], numbers: &[u32]) -> Self {
        let number = |k: usize| numbers[k.min(numbers.len() - 1)];
        let mut all = [Vec4::ZERO; 12];
        let (mut used, mut last) = (0, 0);
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
        let place = exponent((hi - lo).xyz().max_element());
        let mut leaf = Self {
            joints: [[0; 12]; 4],
            corner: lo.xyz(),
            step: [place, exponent(hi.w)],
            used,
            last,
            runs: std::array::from_fn(number),
        };
        let [place, width] = leaf.steps();
        for (k, joint) in all.iter().enumerate() {
            let at = ((joint.xyz() - leaf.corner) / place).round();
            for axis in 0..3 {
                leaf.joints[axis][k] = at[axis] as u16;
            }
            leaf.joints[3][k] = (joint.w / width).round() as u16;
        }
        leaf
    }

    #[inline(always)]
    fn steps(&self) -> [f32; 2] {
        self.step
            .map(|e| f32::from_bits(((i32::from(e) + 127) as u32) << 23))
    }

    /// Joint `0..=2` of a run `0..4`.
    pub(super) fn joint(&self, run: usize, joint: usize) -> Vec4 {
        let [place, width] = self.steps();
        let j = self.joints.map(|all| f32::from(all[run + 4 * joint]));
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

    /// Number of the run of a lane.
    #[inline(always)]
    pub(super) fn run(&self, lane: u32) -> u32 {
        self.runs[lane as usize % 4]
    }

    /// The runs that are there, with their place in the leaf.
    pub(super) fn numbers(&self) -> impl Iterator<Item = (usize, u32)> + '_ {
        (0..RUNS)
            .filter(|k| self.used >> k & 1 == 1)
            .map(|k| (k, self.runs[k]))
    }

    /// Which segments a ray meets up to `limit`, a bit each, and where.
    #[inline(always)]
    pub(super) fn meets<L: Lanes>(&self, ray: &Line, limit: f32) -> (u32, L::F) {
        let (root, tip) = (self.ends::<L>(0), self.ends::<L>(4));
        let (hit, t) = Eight::<L> { root, tip }.intersect(ray.origin, ray.dir, limit);
        (hit & u32::from(self.used), t)
    }

    /// Eight joints from one on.
    #[inline(always)]
    fn ends<L: Lanes>(&self, first: usize) -> ([L::F; 3], L::F) {
        let [place, width] = self.steps();
        let place = L::splat(place);
        let (x, y, z) = (
            L::mul(place, L::words(part(&self.joints[0], first))),
            L::mul(place, L::words(part(&self.joints[1], first))),
            L::mul(place, L::words(part(&self.joints[2], first))),
        );
        let at = [
            L::add(L::splat(self.corner.x), x),
            L::add(L::splat(self.corner.y), y),
            L::add(L::splat(self.corner.z), z),
        ];
        let width = L::mul(L::splat(width), L::words(part(&self.joints[3], first)));
        (at, width)
    }
}

#[inline(always)]
fn part(all: &[u16; 12], first: usize) -> &[u16; 8] {
    match all[first..].first_chunk() {
        Some(part) => part,
        None => &[0; 8],
    }
}
