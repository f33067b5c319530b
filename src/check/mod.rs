//! Reads files of fur back and tells what each program will refuse, ignore or misread.
//!
//! Twenty rules ([`RULES`]) of what is known of readers, by measurement, from their sources or from what
//! their users ran into. The files may be anyone's; what they refer to beside them is followed.

mod attributes;
mod beside;
mod consumer;
mod curves;
mod extent;
mod finding;
mod frames;
mod groom;
mod hair;
mod layer;
mod material;
mod package;
mod rule;
mod schema;
mod stage;
mod views;
mod volume;
mod widths;

pub use consumer::Consumer;
pub use finding::{Finding, Severity};
pub use rule::{Described, RULES, Rule};
pub use schema::json_schema;

use crate::blame::Blame;
use crate::io::{FileError, read_bounded};
use crate::usd_file::{self, UsdFileError};
use crate::vdb_file::{self, VdbFileError};
use finding::Findings;
use frames::Region;
use std::path::Path;

/// Longest file that is read, bytes.
const LONGEST: u64 = 4 << 30;

/// What to hold files against.
#[derive(Clone, Debug, Default)]
pub struct CheckSettings {
    /// Who is to read them; empty for all but viewers of packages.
    pub profile: Vec<Consumer>,
    /// Strands that every file should have, if that is known.
    pub strands: Option<u64>,
}

/// A file that cannot be checked.
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    /// A name that says nothing of what is in the file.
    #[error(
        "{file}: it cannot be checked, the name must end in .usda, .usdc, .usd, .usdz, .vdb or .hair"
    )]
    Suffix {
        /// The file.
        file: String,
    },
    /// Points or arrays for programs of one's own.
    #[error(
        "{file}: it holds points that no program reads as fur by itself, so there are no rules for it: \
         check the .usdc or .hair of the same strands"
    )]
    Plain {
        /// The file.
        file: String,
    },
    /// The file could not be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A broken layer.
    #[error("{file}: {error}")]
    Usd {
        /// The file.
        file: String,
        /// What is wrong.
        error: UsdFileError,
    },
    /// A broken hair file.
    #[error("{file}: {error}")]
    Hair {
        /// The file.
        file: String,
        /// What is wrong.
        error: String,
    },
    /// A broken file of grids.
    #[error("{file}: {error}")]
    Vdb {
        /// The file.
        file: String,
        /// What is wrong.
        error: VdbFileError,
    },
}

impl CheckError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::File(error) => error.blame(),
            _ => Blame::Input,
        }
    }
}

/// What is known of files after they were looked at.
#[derive(Debug, Default)]
pub struct Checked {
    /// File by file, those of each in the order of the rules.
    pub findings: Vec<Finding>,
    /// Files that could not be looked at, in their order.
    pub refused: Vec<Refused>,
}

/// A file that could not be looked at, and why.
#[derive(Debug)]
pub struct Refused {
    /// The path as it was given.
    pub file: String,
    /// Why.
    pub error: CheckError,
}

/// Checks files, each by itself and strands against grids where there are both.
pub fn check<P: AsRef<Path>>(files: &[P], settings: &CheckSettings) -> Checked {
    let (mut checked, mut regions) = (Checked::default(), Vec::new());
    for path in files {
        let path = path.as_ref();
        let file = path.to_string_lossy();
        let mut findings = Findings::new(&file, &settings.profile);
        match check_file(path, settings, &mut findings) {
            Ok(own) => {
                // Against those of the files before.
                frames::check_frames(&regions, &own, &mut findings);
                frames::check_frames(&own, &regions, &mut findings);
                regions.extend(own);
            }
            Err(error) => checked.refused.push(Refused {
                file: file.to_string(),
                error,
            }),
        }
        findings.all.sort_by_key(|f| f.rule);
        checked.findings.append(&mut findings.all);
    }
    checked
}

fn check_file(
    path: &Path,
    settings: &CheckSettings,
    findings: &mut Findings<'_>,
) -> Result<Vec<Region>, CheckError> {
    let file = path.to_string_lossy().into_owned();
    match suffix(path).as_str() {
        "vdb" => {
            let facts = vdb_file::read(&read_bounded(path, LONGEST)?);
            let facts = facts.map_err(|error| CheckError::Vdb {
                file: file.clone(),
                error,
            })?;
            volume::check_file(&facts, findings);
            Ok(frames::regions_of_file(&file, &facts))
        }
        "usd" | "usda" | "usdc" | "usdz" => {
            let bytes = read_bounded(path, LONGEST)?;
            let broken = |error| CheckError::Usd {
                file: file.clone(),
                error,
            };
            if suffix(path) == "usdz" {
                package::check(&usd_file::members(&bytes).map_err(broken)?, findings);
            }
            let layer = usd_file::parse(&bytes).map_err(broken)?;
            drop(bytes);
            Ok(views::check(&layer, path, settings, findings))
        }
        "hair" => {
            let bytes = read_bounded(path, LONGEST)?;
            let lie = hair::check(&file, &bytes, settings.strands, findings);
            lie.map_err(|error| CheckError::Hair { file, error })
        }
        "npz" | "ply" | "glb" | "pbrt" => Err(CheckError::Plain { file }),
        _ => Err(CheckError::Suffix { file }),
    }
}

/// Suffix of a file's name, in lower case.
fn suffix(path: &Path) -> String {
    let suffix = path.extension().and_then(|e| e.to_str());
    suffix.unwrap_or_default().to_ascii_lowercase()
}
