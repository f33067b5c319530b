//! A million strands of eight points grown and written: `cargo bench --bench export [-- SKIN]`. Seconds
//! of all cores together (what others do on the machine counts little) and of the clock.

mod clock;

use clock::processor_seconds;
use std::time::Instant;
use vair::export::asset::{AssetSettings, Parts, Profile, Reader, levels, write};
use vair::groom::{GroomSettings, grow};
use vair::progress::{Cancel, Silent};
use vair::{skin, species};

const STRANDS: usize = 1_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().skip(1).find(|arg| !arg.starts_with('-'));
    let skin = skin::load(name.as_deref().unwrap_or("body"))?;
    let fox = species::load("red-fox", &[])?;
    let settings = GroomSettings {
        strands: Some(STRANDS),
        seed: 0,
    };
    let cancel = Cancel::default();
    let groom = timed("grown", || grow(&skin, &fox, &settings, &Silent, &cancel))?;
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("fox.usdc");
    let blender = AssetSettings {
        profile: Profile::of(&[Reader::Blender]),
        ..AssetSettings::default()
    };
    let storm = AssetSettings {
        profile: Profile::of(&[Reader::Storm]),
        ..AssetSettings::default()
    };
    for (what, settings, count) in [
        ("written for Storm, one level", storm, 1),
        ("written for Blender, one level", blender, 1),
        ("written for all, one level", AssetSettings::default(), 1),
        ("written for all, three levels", AssetSettings::default(), 3),
    ] {
        timed(what, || -> Result<(), Box<dyn std::error::Error>> {
            let levels = levels(&groom, &skin, &fox, count)?;
            let parts = Parts {
                groom: &groom,
                skin: &skin,
                species: &fox,
                levels: &levels,
                looks: &[],
                coats: &[],
                seed: 0,
            };
            Ok(write(&path, &parts, &settings, &Silent, &cancel)?)
        })?;
        println!("{:>41.0} MB", std::fs::metadata(&path)?.len() as f64 / 1e6);
    }
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let most = status.lines().find(|line| line.starts_with("VmHWM"));
    println!("most memory: {}", most.unwrap_or("unknown"));
    Ok(())
}

fn timed<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let (used, passed) = (processor_seconds(), Instant::now());
    let done = work();
    println!(
        "{what:<32} {:6.2} s of processors, {:6.2} s of the clock",
        processor_seconds() - used,
        passed.elapsed().as_secs_f64()
    );
    done
}
