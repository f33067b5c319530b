//! A million strands of eight points grown and written: `cargo bench --bench export [-- SKIN [STRANDS]]`.
//! Seconds of all cores together (what others do on the machine counts little) and of the clock. Files
//! go to the folder for temporary files: `TMPDIR=/dev/shm` leaves the disk out.

mod clock;

use clock::processor_seconds;
use std::error::Error;
use std::time::Instant;
use vair::export::asset::{AssetSettings, Parts, Profile, Reader, levels, write};
use vair::groom::{GroomSettings, grow};
use vair::progress::{Cancel, Silent};
use vair::{skin, species};

const STRANDS: usize = 1_000_000;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1).filter(|arg| !arg.starts_with('-'));
    let name = args.next().unwrap_or_else(|| "body".to_owned());
    let strands = args.next().map_or(Ok(STRANDS), |n| n.parse())?;
    let fox = species::load("red-fox", &[])?;
    let settings = GroomSettings {
        strands: Some(strands),
        seed: 0,
    };
    let cancel = Cancel::default();
    let (used, passed) = (processor_seconds(), Instant::now());
    let skin = timed("skin", || skin::load(&name))?;
    let groom = timed("grown", || grow(&skin, &fox, &settings, &Silent, &cancel))?;
    let three = timed("widths of three levels", || levels(&groom, &skin, &fox, 3))?;
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("fox.usdc");
    let write_for = |what: &str, reader: Option<Reader>, count: usize| {
        let profile = reader.map(|reader| Profile::of(&[reader]));
        let settings = AssetSettings {
            profile: profile.unwrap_or_default(),
            ..AssetSettings::default()
        };
        let parts = Parts {
            groom: &groom,
            skin: &skin,
            species: &fox,
            levels: &three[..count],
            looks: &[],
            coats: &[],
            seed: 0,
        };
        let written = timed(what, || write(&path, &parts, &settings, &Silent, &cancel));
        written.map_err(Box::<dyn Error>::from)?;
        println!("{:>41.0} MB", std::fs::metadata(&path)?.len() as f64 / 1e6);
        Ok::<(), Box<dyn Error>>(())
    };
    write_for("written for all, three levels", None, 3)?;
    say("all of this, as `vair export` does", used, passed);
    write_for("written for all, one level", None, 1)?;
    write_for("written for Blender, one level", Some(Reader::Blender), 1)?;
    write_for("written for Storm, one level", Some(Reader::Storm), 1)?;
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let most = status.lines().find(|line| line.starts_with("VmHWM"));
    println!("most memory: {}", most.unwrap_or("unknown"));
    Ok(())
}

fn timed<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let (used, passed) = (processor_seconds(), Instant::now());
    let done = work();
    say(what, used, passed);
    done
}

/// * `used`, `passed`: when it began.
fn say(what: &str, used: f64, passed: Instant) {
    println!(
        "{what:<36} {:6.2} s of processors, {:6.2} s of the clock",
        processor_seconds() - used,
        passed.elapsed().as_secs_f64()
    );
}
