//! Frames, turns, exponentials, the unicube map and Fresnel equations.

pub mod decay;
pub mod frame;
pub mod fresnel;
pub mod symmetry;
pub mod turn;
pub mod unicube;
