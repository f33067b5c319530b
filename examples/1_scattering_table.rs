//! Bakes one fiber and asks the table what a renderer would: how much light comes back, and where
//! it came from.
//!
//! `cargo run --release --example 1_scattering_table`

use std::error::Error;
use vair::bake::{Settings, bake};
use vair::fiber::Fiber;
use vair::math::frame;
use vair::progress::{Cancel, Silent};
use vair::species;
use vair::table::{Provenance, ScatterTable};

fn main() -> Result<(), Box<dyn Error>> {
    let fox = species::load("red-fox", &[])?;
    let guard = &fox.classes[0];
    let shield = &guard.stations[guard.stations.len() - 1];

    let fiber = Fiber::build(&shield.structure, 0)?;
    let settings = Settings {
        photons: 1_000_000,
        ..Settings::cone()
    };
    let baked = bake(
        &fiber,
        &settings,
        Provenance::default(),
        &Silent,
        &Cancel::default(),
    )?;

    // One bake serves every pigment.
    for (i, band) in guard.pigment.iter().enumerate() {
        let table = ScatterTable::from(baked.table.dye(band.absorption_per_um())?);
        let wo = frame::direction(30f64.to_radians(), 0.0).as_vec3();
        let lobe = table.lobe(wo);
        println!("band {i} from the tip: albedo {:.3}", lobe.albedo());
        if let Some(wi) = lobe.sample([0.3, 0.7, 0.2]) {
            println!(
                "  light from {wi:.3} arrives with density {:.3}",
                lobe.density(wi)
            );
        }
    }
    Ok(())
}
