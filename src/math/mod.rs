//! Frames, turns, the unicube map and Fresnel equations.

pub mod frame;
pub mod fresnel;
pub mod turn;
pub mod unicube;
