//! Writing an asset, and how large it will be.

use super::{AssetSettings, Column, Layout, Parts, check, tree};
use crate::export::usd::{self, Form, Layer};
use crate::export::{ExportError, Format};
use crate::io::{AtomicFile, FileError};
use crate::progress::{Cancel, Progress};
use crate::skin::Skin;
use std::io;
use std::path::{Path, PathBuf};

/// How many times as large text is as the binary form.
pub const TEXT_FACTOR: u64 = 4;

/// Bytes of an asset in binary form, to some ten percent; text takes [`TEXT_FACTOR`] times as many.
///
/// * `size`: strands and control points of the finest level. * `levels`: of detail, each with a quarter
///   of the strands of the one before. * `coats`: to choose from, taken to be of one shape.
pub fn estimate(
    skin: &Skin,
    [strands, points]: [usize; 2],
    levels: usize,
    coats: usize,
    settings: &AssetSettings,
) -> u64 {
    let wanted =
        Column::ALL.map(|column| settings.profile.wants(column).then(|| column.original()));
    let (mut of_strand, mut of_point) = (0, 16);
    for column in Column::ALL.iter().filter(|c| wanted.contains(&Some(**c))) {
        let (strand, point) = column.bytes();
        of_strand += strand;
        // All that points have is color.
        of_point += point * coats.max(1);
    }
    let full = strands * of_strand + settings.curves.total(strands, points) * of_point;
    let share: f64 = (0..levels.max(1))
        .map(|level| 0.25f64.powi(level as i32))
        .sum();
    // A vertex of the skin has place, normal, color and texture coordinates.
    let skin = (32 + 12 * coats.max(1)) * skin.positions.len() + 6 * skin.triangles.len();
    (full as f64 * share) as u64 + skin as u64
}

/// Writes a groom as a component asset, every file of it whole or not at all.
///
/// The bytes are a function of the arguments alone, not of the number of threads.
///
/// # Errors
/// [`ExportError`]: a groom that readers would drop, the file, or stopped.
pub fn write(
    path: &Path,
    parts: &Parts<'_>,
    settings: &AssetSettings,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<(), ExportError> {
    let Format::Usd(form) = Format::of(path)? else {
        return Err(ExportError::Suffix {
            path: path.to_owned(),
        });
    };
    check(parts.groom)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let job = Job { progress, cancel };
    let size = [parts.groom.strands(), parts.groom.points.len()];
    let size = estimate(
        parts.skin,
        size,
        parts.levels.len(),
        parts.coats.len(),
        settings,
    );
    if settings.layout == Layout::Single {
        let size = size * if form == Form::Text { TEXT_FACTOR } else { 1 };
        return job.write(path, &tree::layer(parts, settings, &name), form, size);
    }
    // The payload first: what refers to it must not be there without it.
    let payload = payload_of(path);
    let payload_name = payload.file_name().unwrap_or_default().to_string_lossy();
    let layer = tree::layer(parts, settings, &payload_name);
    job.write(&payload, &layer, Form::Binary, size)?;
    let interface = tree::interface(parts, settings, &name, &payload_name);
    job.write(path, &interface, form, 10_000)
}

/// Where the payload of an interface goes.
pub fn payload_of(interface: &Path) -> PathBuf {
    interface.with_extension("payload.usdc")
}

struct Job<'j> {
    progress: &'j dyn Progress,
    cancel: &'j Cancel,
}

impl Job<'_> {
    fn write(
        &self,
        path: &Path,
        layer: &Layer<'_>,
        form: Form,
        size: u64,
    ) -> Result<(), ExportError> {
        self.progress.begin("writing", size, "bytes");
        let mut file = AtomicFile::create(path)?;
        let written = usd::write(layer, form, &mut file, &mut |bytes| {
            self.progress.advance(bytes);
            if self.cancel.is_cancelled() {
                return Err(io::Error::other("stopped"));
            }
            Ok(())
        });
        self.progress.finish();
        match written {
            Err(_) if self.cancel.is_cancelled() => Err(ExportError::Cancelled),
            Err(error) => Err(FileError::new("write", path, error).into()),
            Ok(()) => Ok(file.commit()?),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::asset::{Curves, Profile, Reader, levels};
    use crate::groom::{GroomSettings, grow};
    use crate::progress::Silent;
    use crate::{skin, species};

    /// Without the curves for viewports, which come on top.
    #[test]
    fn files_are_as_large_as_foretold() {
        let skin = skin::load("tress").unwrap();
        let fox = species::load("red-fox", &[]).unwrap();
        let settings = GroomSettings {
            strands: Some(6000),
            seed: 0,
        };
        let cancel = Cancel::default();
        let groom = grow(&skin, &fox, &settings, &Silent, &cancel).unwrap();
        let parts = Parts {
            groom: &groom,
            skin: &skin,
            species: &fox,
            levels: &levels(&groom, &skin, &fox, 1).unwrap(),
            looks: &[],
            coats: &[],
            seed: 0,
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fox.usdc");
        for curves in [
            Curves::Pinned,
            Curves::Phantom,
            Curves::Bezier,
            Curves::Linear,
        ] {
            for readers in [&[][..], &[Reader::Unreal], &[Reader::Blender]] {
                let settings = AssetSettings {
                    curves,
                    profile: Profile::of(readers),
                    no_proxy: true,
                    no_guides: true,
                    ..AssetSettings::default()
                };
                write(&path, &parts, &settings, &Silent, &cancel).unwrap();
                let size = std::fs::metadata(&path).unwrap().len() as f64;
                let foretold = estimate(&skin, [6000, groom.points.len()], 1, 0, &settings) as f64;
                let off = foretold / size - 1.0;
                println!("{curves:?} {readers:?}: {:.1} %", 100.0 * off);
                assert!(
                    off.abs() < 0.02,
                    "{curves:?} {readers:?}: {size} {foretold}"
                );
            }
        }
    }
}
