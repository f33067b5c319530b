//! Named places of a body, for what is said of the coat in words: "white around the nose".

use super::Skin;
use glam::Vec3;
use serde::Serialize;

/// A place of a body. Paired places are one: both eyes, all paws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Landmark {
    /// Tip of the nose.
    Nose,
    /// Under the muzzle, from its tip to the throat.
    Chin,
    /// Sides of the face below the eyes.
    Cheeks,
    /// The eyes.
    Eyes,
    /// From beside the nose over the eye to the ear, on both sides.
    EyeLine,
    /// Between the ears.
    Crown,
    /// Tips of the ears.
    Ears,
    /// From the throat down the breast to the forelegs.
    Bib,
    /// Along the middle below, from the breast to the groin.
    Belly,
    /// Along the back, from the crown to the root of the tail.
    Spine,
    /// Shoulder blades.
    Shoulders,
    /// Haunches.
    Rump,
    /// Along the tail from its root to its tip.
    Tail,
    /// Tip of the tail.
    TailTip,
    /// The paws.
    Paws,
}

impl Landmark {
    /// All of them, head to tail.
    pub const ALL: [Self; 15] = [
        Self::Nose,
        Self::Chin,
        Self::Cheeks,
        Self::Eyes,
        Self::EyeLine,
        Self::Crown,
        Self::Ears,
        Self::Bib,
        Self::Belly,
        Self::Spine,
        Self::Shoulders,
        Self::Rump,
        Self::Tail,
        Self::TailTip,
        Self::Paws,
    ];

    /// As files write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nose => "nose",
            Self::Chin => "chin",
            Self::Cheeks => "cheeks",
            Self::Eyes => "eyes",
            Self::EyeLine => "eye-line",
            Self::Crown => "crown",
            Self::Ears => "ears",
            Self::Bib => "bib",
            Self::Belly => "belly",
            Self::Spine => "spine",
            Self::Shoulders => "shoulders",
            Self::Rump => "rump",
            Self::Tail => "tail",
            Self::TailTip => "tail-tip",
            Self::Paws => "paws",
        }
    }
}

/// Points along a broken line, the ends of its pieces and some between them.
pub(super) fn along(line: &[Vec3]) -> Vec<Vec3> {
    const PIECES: usize = 12;
    let mut points: Vec<Vec3> = Vec::new();
    for ends in line.windows(2) {
        let at = |k| ends[0].lerp(ends[1], k as f32 / PIECES as f32);
        points.extend((0..PIECES).map(at));
    }
    points.extend(line.last());
    points
}

/// What can be told of an unknown body that stands with its head toward `front`: nose and tail tip
/// are its ends, paws its lowest places in front and behind on both sides, and along the middle of
/// the back and of the belly run two lines.
pub(super) fn guess(skin: &Skin, front: Vec3) -> Vec<(Landmark, Vec<Vec3>)> {
    let side = front.cross(Vec3::Y);
    let place = |p: Vec3| Vec3::new(p.dot(front), p.y, p.dot(side));
    let places: Vec<Vec3> = skin.positions.iter().map(|&p| place(p)).collect();
    let Some(&first) = places.first() else {
        return Vec::new();
    };
    let fold = |f: fn(Vec3, Vec3) -> Vec3| places.iter().copied().fold(first, f);
    let (lo, hi) = (fold(Vec3::min), fold(Vec3::max));
    let middle = 0.5 * (lo + hi);
    let best = |fits: &dyn Fn(Vec3) -> bool, value: &dyn Fn(Vec3) -> f32| {
        (0..places.len())
            .filter(|&i| fits(places[i]))
            .max_by(|&i, &j| value(places[i]).total_cmp(&value(places[j])))
            .map(|i| skin.positions[i])
    };
    let mut found = Vec::new();
    found.extend(best(&|_| true, &|p| p.x).map(|p| (Landmark::Nose, vec![p])));
    found.extend(best(&|_| true, &|p| -p.x).map(|p| (Landmark::TailTip, vec![p])));
    let paws = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(x, z)| {
        let quarter = |p: Vec3| (p.x - middle.x) * x > 0.0 && (p.z - middle.z) * z > 0.0;
        best(&quarter, &|p| -p.y)
    });
    found.push((Landmark::Paws, paws.into_iter().flatten().collect()));
    // The middle of the body, in slices across it.
    let size = hi - lo;
    let slice = |at: f32, sign: f32| {
        let x = lo.x + at * size.x;
        let near =
            |p: Vec3| (p.x - x).abs() < 0.04 * size.x && (p.z - middle.z).abs() < 0.15 * size.z;
        best(&near, &|p| sign * p.y)
    };
    for (landmark, sign) in [(Landmark::Spine, 1.0), (Landmark::Belly, -1.0)] {
        let line: Vec<Vec3> = (4..=14)
            .filter_map(|k| slice(0.05 * k as f32, sign))
            .collect();
        found.push((landmark, along(&line)));
    }
    found.retain(|(_, points)| !points.is_empty());
    found
}
