//! Frames, turns, exponentials, steps, the unicube map and Fresnel equations.

pub mod decay;
pub mod ease;
pub mod frame;
pub mod fresnel;
pub mod symmetry;
pub mod turn;
pub mod unicube;
