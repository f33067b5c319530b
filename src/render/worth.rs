//! Which paths are worth following: roulette and splitting by the light that a path may still bring to the eye, against that
//! of the place the camera sees (Vorba and Křivánek 2016).
//!
//! What comes of a point is about its throughput times how bright it is there. Paths that wander into the dark end, paths
//! that come out into the light go on several ways, so that all bring about as much. How bright it is is known roughly;
//! where it is not, only the throughput counts.

use crate::color::Rgb;

/// Scattering events before roulette may end a path ahead of its ray. At 1 dark fur pays more in noise than it saves,
/// at 8 pale fur takes 1.6 times the time for the same noise.
const ROULETTE_FROM: u32 = 2;

/// Share of the light at a scattering point that reaches the eye, below which paths may end there, where nothing is known of
/// the light. At 1 pale fur has a sixth more error for an eighth less time, at 0.5 a tenth less for an eighth more.
const WORTH_FOLLOWING: f32 = 0.7;

/// The same ahead of a ray where it is decided at its end what the place there is worth. At 0.35, with 0.5 and 1 below, a bear
/// has a twelfth more error for a twenty-fifth fewer rays.
const WORTH_A_RAY: f32 = 0.25;

/// Worth of a place, in that of the first one, below which paths may end: see [`WORTH_A_RAY`].
const WORTH_SHADING: f32 = 0.35;

/// Worth that each way of a path has at least where it goes on several ways.
const WORTH_A_WAY: f32 = 0.7;

/// Most ways from a point.
const MOST_WAYS: u32 = 4;

/// Scattering events after which paths do not split, so that their ways stay few and the stack low.
const SPLIT_UNTIL: u32 = 32;

/// Added to how bright it is, since it is known roughly: places that are thought to be dark may be lit.
const DIM: f32 = 0.02;

/// Decides what becomes of one path.
pub(super) struct Worth {
    /// Brightness of the first place; `None` if it is not known.
    first: Option<f32>,
}

/// What becomes of a path at a point.
pub(super) struct Fate {
    /// Probability that it goes on; what it carries is divided by it.
    pub(super) survival: f32,
    /// Ways in which it goes on, each with its part.
    pub(super) copies: u32,
}

impl Worth {
    /// * `glow`: mean radiance at the first place over that where nothing is in the way; `None` if it is not known.
    pub(super) fn new(glow: Option<f32>) -> Self {
        Self {
            first: glow.map(|glow| glow + DIM),
        }
    }

    /// Probability of sending the ray that continues a path, `depth` events behind the first.
    pub(super) fn before_ray(&self, throughput: Rgb, depth: u32) -> f32 {
        if depth < ROULETTE_FROM {
            return 1.0;
        }
        let worth = match self.first {
            Some(_) => WORTH_A_RAY,
            None => WORTH_FOLLOWING,
        };
        (throughput.max_element() / worth).min(1.0)
    }

    /// What becomes of a path that has come to a place, before anything is done there.
    ///
    /// * `glow`: as that of the first place.
    pub(super) fn on_arrival(&self, throughput: Rgb, glow: Option<f32>, depth: u32) -> Fate {
        let (Some(first), Some(glow)) = (self.first, glow) else {
            return Fate {
                survival: 1.0,
                copies: 1,
            };
        };
        let worth = throughput.max_element() * (glow + DIM) / first;
        let most = if depth < SPLIT_UNTIL { MOST_WAYS } else { 1 };
        Fate {
            survival: (worth / WORTH_SHADING).min(1.0),
            copies: ((worth / WORTH_A_WAY) as u32).clamp(1, most),
        }
    }
}
