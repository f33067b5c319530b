//! Frames, the unicube map and Fresnel equations.

pub mod frame;
pub mod fresnel;
pub mod unicube;
