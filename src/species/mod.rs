//! Species presets: what an animal's hairs are made of, and where each number comes from.

pub mod model;

pub use model::*;
