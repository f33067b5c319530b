//! Files for other programs.

pub mod vdb;
