//! Vair: animal fur from the micro-structure up.
//!
//! Data flows one way:
//!
//! ```text
//! species -> fiber -> bake -> table -> bsdf -+
//!    \                                       +-> scene -> render -> image
//!     +---> groom <- skin -------------------+
//! ```
//!
//! A [`species`] preset describes an animal's hair classes. [`fiber`] turns one station of one class
//! into closed geometry, [`bake`] shoots photons at it, [`table`] stores where they went, [`bsdf`]
//! makes tables usable by a renderer. [`groom`] grows strands on a [`skin`]; [`scene`] gathers
//! everything that [`render`] needs; [`image`] writes pictures.

mod accel;
pub mod assembly;
pub mod bake;
pub mod blame;
pub mod bsdf;
pub mod check;
pub mod cli;
pub mod color;
mod cursor;
pub mod export;
pub mod fiber;
pub mod gallery;
pub mod groom;
mod hex;
pub mod image;
pub mod io;
pub mod math;
pub mod mesh_file;
pub mod micrograph;
mod pages;
mod polyline_file;
pub mod progress;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod scene_file;
pub mod skin;
pub mod species;
pub mod table;
pub mod usd_file;
pub mod vdb_file;

/// Name and version of this program, as its files say who made them.
pub(crate) const PROGRAM: &str = concat!("vair ", env!("CARGO_PKG_VERSION"));
