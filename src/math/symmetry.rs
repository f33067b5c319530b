//! The symmetry of a fiber's section, and which query azimuths it makes the same.
//!
//! An azimuth here is an angle around the fiber from the major axis of the section (x of the fiber's
//! own frame) toward its minor axis (y), radians. A mirror image of the fiber sees a query from the
//! mirrored azimuth, and its light leaves mirrored: azimuths that symmetry makes the same share one
//! map, read with `phi` or with `-phi`.

use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Mirror planes that hold the fiber's axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Symmetry {
    /// None: all azimuths differ.
    #[default]
    None,
    /// The one through the minor axis, `x -> -x`: bent and dented sections.
    MinorAxis,
    /// Those through both axes, and so half a turn as well: ellipses.
    BothAxes,
}

impl Symmetry {
    /// The azimuths that stand for all others, from and to, in turns.
    pub fn range_turns(self) -> [f64; 2] {
        match self {
            Self::None => [0.0, 1.0],
            Self::MinorAxis => [-0.25, 0.25],
            Self::BothAxes => [0.0, 0.25],
        }
    }

    /// How many azimuths are the same, mirrored or not.
    pub fn images(self) -> usize {
        match self {
            Self::None => 1,
            Self::MinorAxis => 2,
            Self::BothAxes => 4,
        }
    }

    /// One of the azimuths that are the same as `turns`, in turns and in `[0, 1]` if `turns` is in
    /// range, and whether it is seen mirrored.
    ///
    /// * `image`: 0 to `images() - 1`; 0 is `turns` itself, up to whole turns.
    #[inline]
    pub fn image(self, turns: f64, image: usize) -> (f64, bool) {
        match (self, image) {
            (Self::MinorAxis, 0) if turns < 0.0 => (turns + 1.0, false),
            (_, 0) => (turns, false),
            (_, 1) => (0.5 - turns, true),
            (_, 2) => (0.5 + turns, false),
            _ => (1.0 - turns, true),
        }
    }

    /// The azimuth in range that is the same as any, radians, and whether it is seen mirrored.
    pub fn fold(self, azimuth: f64) -> (f64, bool) {
        match self {
            Self::None => (azimuth.rem_euclid(TAU), false),
            Self::MinorAxis => {
                let turned = (azimuth + PI).rem_euclid(TAU) - PI;
                if turned.abs() <= FRAC_PI_2 {
                    (turned, false)
                } else {
                    (PI.copysign(turned) - turned, true)
                }
            }
            Self::BothAxes => {
                let turned = azimuth.rem_euclid(PI);
                if turned <= FRAC_PI_2 {
                    (turned, false)
                } else {
                    (PI - turned, true)
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Symmetry; 3] = [Symmetry::None, Symmetry::MinorAxis, Symmetry::BothAxes];

    /// A lopsided function of query azimuth and exit azimuth with the symmetry of an ellipse or of a
    /// bean, written down with no help from the code above.
    fn seen(symmetry: Symmetry, query: f64, phi: f64) -> f64 {
        let exit = query + phi;
        let dent = |angle: f64| match symmetry {
            Symmetry::None => (angle - 0.4).cos() + 0.3 * (2.0 * angle).sin(),
            Symmetry::MinorAxis => angle.sin() + 0.5 * (2.0 * angle).cos(),
            Symmetry::BothAxes => (2.0 * angle).cos() + 0.2 * (4.0 * angle).cos(),
        };
        dent(query) + 1.7 * dent(exit) + 0.3 * dent(0.5 * (query + exit)).powi(2) + phi.cos()
    }

    #[test]
    fn folded_azimuths_see_the_same() {
        for symmetry in ALL {
            let [from, to] = symmetry.range_turns();
            for i in -70..70 {
                let azimuth = 0.1 * f64::from(i);
                let (folded, mirrored) = symmetry.fold(azimuth);
                assert!((from * TAU - 1e-12..=to * TAU + 1e-12).contains(&folded));
                for phi in [0.3, 1.1, -2.0] {
                    let turned = if mirrored { -phi } else { phi };
                    let off = seen(symmetry, azimuth, phi) - seen(symmetry, folded, turned);
                    assert!(off.abs() < 1e-12, "{symmetry:?} {azimuth} {phi}: {off}");
                }
            }
        }
    }

    #[test]
    fn images_fold_back_and_cover_the_turn() {
        for symmetry in ALL {
            let [from, to] = symmetry.range_turns();
            let mut eighths = [0; 8];
            for i in 0..80 {
                let turns = from + (to - from) * (f64::from(i) + 0.5) / 80.0;
                for image in 0..symmetry.images() {
                    let (at, mirrored) = symmetry.image(turns, image);
                    assert!((0.0..=1.0).contains(&at), "{symmetry:?} {turns} {image}");
                    let (folded, again) = symmetry.fold(at * TAU);
                    assert_eq!(again, mirrored);
                    assert!((folded - turns * TAU).abs() < 1e-12);
                    eighths[(8.0 * at) as usize] += 1;
                }
            }
            assert!(
                eighths.iter().all(|&n| n == 10 * symmetry.images()),
                "{eighths:?}"
            );
        }
    }
}
