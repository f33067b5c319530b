//! Known distances come out, noise is taken out.

use super::*;
use crate::math::frame;
use crate::math::unicube::Unicube;
use crate::sampling::Rng;
use crate::table::{Ledger, Mode, Nodes, PHOTON, Provenance, StructureTable};

/// S of a smooth lobe about the specular cone.
fn lobe(theta_q: f64, w: glam::DVec3) -> f64 {
    let off = frame::theta_of(w) + theta_q;
    0.08 * (-8.0 * off * off).exp() * (1.3 - w.x)
}

/// A table of the lobe with two levels, the second a quarter of the first, `photons` of noise (none
/// if infinite).
fn table(bins: usize, res: usize, photons: f64, seed: u64) -> StructureTable {
    let nodes = Nodes::new(Mode::Cone, bins);
    let cube = Unicube::new(res);
    let mut rng = Rng::new(seed, 0);
    let (mut flux, mut error, mut ledger) = (Vec::new(), Vec::new(), Vec::new());
    for &center in &nodes.centers {
        let mut clear = Vec::new();
        for texel in 0..cube.texels() {
            let (w, _) = cube.direction(texel, 0.5, 0.5);
            let mean = lobe(center, w) * frame::theta_of(w).cos() * cube.solid_angle(texel);
            let (f, relative) = if photons.is_finite() {
                let n = poisson(mean * photons, &mut rng);
                (n / photons, 1.0 / n.sqrt())
            } else {
                (mean, 0.0)
            };
            clear.push(f as f32);
            error.push(relative as f32);
        }
        for share in [1.0f32, 0.25] {
            let level: Vec<f32> = clear.iter().map(|f| f * share).collect();
            let sum: f64 = level.iter().map(|&f| f64::from(f)).sum();
            let escaped = (sum * (PHOTON << 20) as f64) as u64;
            ledger.push(Ledger {
                emitted: PHOTON << 20,
                escaped,
                absorbed: (PHOTON << 20) - escaped,
                ..Ledger::default()
            });
            flux.extend(level);
        }
    }
    StructureTable {
        nodes,
        res,
        levels: vec![0.0, 1.0],
        radius_um: 40.0,
        flux,
        error,
        ledger,
        provenance: Provenance::default(),
    }
}

/// Knuth's product of uniforms, for small means.
fn poisson(mean: f64, rng: &mut Rng) -> f64 {
    let (floor, mut product, mut n) = ((-mean).exp(), rng.uniform(), 0.0);
    while product > floor {
        product *= rng.uniform();
        n += 1.0;
    }
    n
}

#[test]
fn a_scaled_table_is_off_by_its_scale() {
    let b = table(8, 16, f64::INFINITY, 0);
    let mut a = b.clone();
    a.flux.iter_mut().for_each(|f| *f *= 1.1);
    let compared = compare(&a, &b, THETA_MAX_DEG).unwrap();
    assert!(compared.by_texel);
    for channel in &compared.channels {
        assert!((channel.total.error - 0.1).abs() < 1e-6, "{channel:?}");
        assert!((channel.largest - 0.1).abs() < 1e-6);
        assert!(
            channel
                .bins
                .iter()
                .all(|b| (b.difference.error - 0.1).abs() < 1e-6)
        );
    }
}

#[test]
fn noise_is_taken_out() {
    let exact = table(8, 16, f64::INFINITY, 0);
    let (a, b) = (table(8, 16, 2e4, 1), table(8, 16, 2e4, 2));
    let compared = compare(&a, &b, THETA_MAX_DEG).unwrap();
    let clear = compared.channels[0].total;
    assert!(clear.error > 0.1, "{clear:?}");
    assert!((clear.error / clear.noise - 1.0).abs() < 0.03, "{clear:?}");
    assert!(clear.debiased < 0.25 * clear.error, "{clear:?}");
    // A true distance of 30 % shows through as much noise.
    let mut far = a.clone();
    far.flux.iter_mut().for_each(|f| *f *= 1.3);
    for reference in [&b, &exact] {
        let found = compare(&far, reference, THETA_MAX_DEG).unwrap().channels[0].total;
        assert!((found.debiased - 0.3).abs() < 0.04, "{found:?}");
    }
}

#[test]
fn other_nodes_and_faces_are_compared_by_look_up() {
    let fine = table(48, 64, f64::INFINITY, 0);
    let errors = [(16, 32), (32, 64)].map(|(bins, res)| {
        let coarse = table(bins, res, f64::INFINITY, 0);
        let compared = compare(&coarse, &fine, THETA_MAX_DEG).unwrap();
        assert!(!compared.by_texel);
        assert!(compared.channels[0].bins.len() <= bins);
        compared.channels[0].total.error
    });
    // Steps of texels and interpolation, less with more of both.
    assert!(
        errors[0] < 0.06 && errors[1] < 0.7 * errors[0],
        "{errors:?}"
    );
}

#[test]
fn only_what_can_be_compared_is() {
    let a = table(4, 4, f64::INFINITY, 0);
    let dyed = a.dye([0.01; 3]).unwrap();
    assert!(matches!(
        compare(&a, &dyed, 73.0),
        Err(TableError::Request(_))
    ));
    for angle in [0.0, -1.0, 91.0, f64::NAN] {
        assert!(compare(&a, &a, angle).is_err());
    }
    let mut other = a.clone();
    other.levels[1] = 0.7;
    assert_eq!(compare(&a, &other, 73.0).unwrap().channels.len(), 1);
    assert!(
        compare(&a, &a, 73.0)
            .unwrap()
            .headline()
            .unwrap()
            .total
            .error
            == 0.0
    );
}
