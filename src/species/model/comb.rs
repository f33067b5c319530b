//! The lay of the hair: combing curves and whorls.

use crate::skin::Landmark;
use serde::Serialize;

/// Lines and whorls along which hair lies, in place of the lay of the skin.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Comb {
    /// Lines that hair follows.
    #[serde(rename = "curve", skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<CombCurve>,
    /// Whorls that hair turns about.
    #[serde(rename = "whorl", skip_serializing_if = "Vec::is_empty")]
    pub whorls: Vec<Whorl>,
}

impl Comb {
    /// Whether hair keeps the lay of the skin.
    pub fn is_empty(&self) -> bool {
        self.curves.is_empty() && self.whorls.is_empty()
    }
}

/// Lines on the skin from root to tip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CombCurve {
    /// Two or more points each.
    pub lines: Vec<Vec<[f32; 3]>>,
    /// Whether the lines are in meters, Y up, whatever the file of the skin is; else they are placed like it.
    pub is_placed: bool,
    /// How far the pull reaches, millimeters.
    pub radius_mm: f64,
    /// Share of the way to the line's direction, on it, 0..1.
    pub strength: f64,
}

/// A place that hair turns about.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Whorl {
    /// Its center.
    pub center: WhorlCenter,
    /// How far the pull reaches, millimeters.
    pub radius_mm: f64,
    /// Share of the way to the whorl's direction, near the center, 0..1.
    pub strength: f64,
    /// Which way hair goes round.
    pub hand: Hand,
    /// Angle between the hair and the way out near the center, degrees, 0 a star .. 180 into the center.
    pub spiral_deg: f64,
    /// The same at the radius.
    pub rim_deg: f64,
}

/// Where a whorl is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WhorlCenter {
    /// In the coordinates of the skin's file.
    Point([f32; 3]),
    /// At each place of a landmark.
    Landmark(Landmark),
}

/// A sense of rotation, seen from outside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hand {
    /// To the left around the center.
    #[default]
    CounterClockwise,
    /// To the right.
    Clockwise,
}
