use super::*;
use crate::sampling::Rng;

fn direction(theta: f32, phi: f32) -> Vec3 {
    let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
    Vec3::new(ct * cp, ct * sp, st)
}

fn model(sigma_a: [f32; 3], beta_m: f32, beta_n: f32, alpha_deg: f32, eta: f32) -> Chiang {
    Chiang::new(&ChiangParameters {
        sigma_a: sigma_a.into(),
        beta_m,
        beta_n,
        alpha_deg,
        eta,
    })
}

/// `eval_pdf` of the `hair` plugin of Mitsuba 3.9.1 (scalar_rgb), whose tilt has the other sign where its
/// local Y axis is the tangent, root to tip. Its series for the Bessel function ends after ten terms, which
/// leaves out half a per cent of the last but third value.
#[test]
fn agrees_with_mitsuba() {
    let models = [
        model([0.1, 0.3, 0.9], 0.3, 0.3, -2.0, 1.55),
        model([0.0, 0.5, 2.0], 0.15, 0.5, 3.0, 1.4),
        model([0.05, 0.2, 0.4], 0.7, 0.1, 0.0, 1.7),
    ];
    // Model; theta of wo; theta and phi of wi; h; density of R, G, B; pdf by luminance.
    let known: [(usize, [f32; 4], [f32; 3]); 9] = [
        (
            0,
            [-0.994442, -0.631655, 1.867902, 0.156108],
            [2.71632e-05, 6.36711e-06, 8.61331e-08],
        ),
        (
            0,
            [-0.974091, -0.160495, -0.129882, -0.646496],
            [0.0213134, 0.00855645, 0.000557403],
        ),
        (
            0,
            [0.562985, -0.927187, -0.674385, 0.031806],
            [0.00156796, 0.000924957, 0.000522384],
        ),
        (
            1,
            [-0.166493, 0.208317, 1.474594, 0.866908],
            [0.0410787, 0.0384478, 0.0373163],
        ),
        (
            1,
            [-0.517917, 0.356513, 1.216539, -0.393831],
            [0.00248686, 0.000514145, 0.000198805],
        ),
        (
            1,
            [-1.196424, 1.136305, -1.249912, -0.353427],
            [0.456119, 0.410361, 0.407336],
        ),
        (
            2,
            [0.940107, 0.204391, -0.17788, 0.519226],
            [0.000662356, 0.000235432, 6.01818e-05],
        ),
        (
            2,
            [-1.12717, 0.496716, -0.779688, -0.77738],
            [0.154936, 0.0772222, 0.0306436],
        ),
        (
            2,
            [0.3852, 1.035513, -1.815415, 0.247171],
            [0.000226738, 8.93646e-05, 2.6006e-05],
        ),
    ];
    for (i, [theta_o, theta_i, phi, h], expected) in known {
        let lobe = models[i].lobe_at(direction(theta_o, 0.0), h);
        let (density, _) = lobe.density_and_pdf(direction(theta_i, phi));
        let off = (density / Rgb::from(expected) - 1.0).abs().max_element();
        assert!(off < 6e-3, "{density} is not {expected:?}");
    }
}

/// Energies of R, TT, TRT and the rest of a clear cylinder of index 1.55, means over its width
/// (integrals of the Fresnel equations).
#[test]
fn energies_are_those_of_the_cylinder() {
    let clear = model([0.0; 3], 0.3, 0.3, 2.0, 1.55);
    for (theta, expected) in [
        (0.0f32, [0.074955, 0.861791, 0.055672, 0.007582]),
        (30.0, [0.086181, 0.842768, 0.061419, 0.009632]),
        (60.0, [0.173474, 0.697349, 0.102011, 0.027166]),
        (85.0, [0.687590, 0.103656, 0.068140, 0.140613]),
    ] {
        let mut mean = [0.0f32; LOBES];
        let n = 4000;
        for i in 0..n {
            let h = 2.0 * (i as f32 + 0.5) / n as f32 - 1.0;
            let lobe = clear.lobe_at(direction(theta.to_radians(), 0.0), h);
            for (mean, energy) in mean.iter_mut().zip(lobe.energy) {
                *mean += energy.y / n as f32;
            }
        }
        for (mean, expected) in mean.iter().zip(expected) {
            assert!(
                (mean - expected as f32).abs() < 2e-4,
                "{theta}: {mean:?} {expected}"
            );
        }
    }
}

/// The integral of the density is the albedo, by sums over all directions; 1 if nothing is absorbed.
#[test]
fn loses_no_light() {
    for (beta_m, beta_n) in [(0.15, 0.2), (0.3, 0.3), (0.9, 1.0)] {
        for sigma in [0.0, 0.4] {
            let model = model([sigma, 2.0 * sigma, 0.0], beta_m, beta_n, 2.0, 1.55);
            for (theta, h) in [(0.0, 0.0), (0.5, 0.6), (-1.1, -0.95), (1.5, 0.3)] {
                let lobe = model.lobe_at(direction(theta, 0.0), h);
                // Even steps of the sine of the inclination are even solid angles.
                let (rows, columns) = (2000, 720);
                let mut sum = glam::DVec3::ZERO;
                for i in 0..rows * columns {
                    let sin = 2.0 * ((i / columns) as f32 + 0.5) / rows as f32 - 1.0;
                    let phi = TAU * ((i % columns) as f32 + 0.5) / columns as f32;
                    let wi = direction(sin.asin(), phi);
                    sum += lobe.density_and_pdf(wi).0.as_dvec3();
                }
                let sum = (sum * 4.0 * std::f64::consts::PI / f64::from(rows * columns)).as_vec3();
                let off = (sum - lobe.albedo()).abs().max_element();
                assert!(
                    off < 2e-3,
                    "{beta_m} {sigma} {theta} {h}: {sum} {}",
                    lobe.albedo()
                );
                if sigma == 0.0 {
                    assert!((lobe.albedo() - 1.0).abs().max_element() < 1e-5);
                }
            }
        }
    }
}

/// Where both directions have one inclination but for its sign, no scales tilt them and the width is
/// averaged, light and viewer may be exchanged. Elsewhere the model is not reciprocal.
#[test]
fn is_reciprocal_where_it_should_be() {
    let model = model([0.2, 0.4, 0.8], 0.3, 0.25, 0.0, 1.55);
    let mean = |theta_o: f32, theta_i: f32, phi: f32| {
        let n = 2000;
        let at = |i: i32| {
            let h = 2.0 * (i as f32 + 0.5) / n as f32 - 1.0;
            let lobe = model.lobe_at(direction(theta_o, 0.0), h);
            let cos_i = theta_i.cos();
            lobe.density_and_pdf(direction(theta_i, phi)).0 / cos_i
        };
        (0..n).map(at).sum::<Rgb>() / n as f32
    };
    for theta in [0.0, 0.4, 1.0] {
        for phi in [0.3, 1.5, 3.0] {
            for other in [theta, -theta] {
                let (there, back) = (mean(theta, other, phi), mean(other, theta, -phi));
                assert!((there / back - 1.0).abs().max_element() < 1e-3);
            }
        }
    }
}

/// Mean weight of samples is the albedo, mean of 1 / pdf over samples covers the sphere only as far as
/// the density does; both with independent numbers.
#[test]
fn samples_carry_the_albedo() {
    let model = model([0.1, 0.5, 2.0], 0.25, 0.4, 3.0, 1.55);
    let mut rng = Rng::new(8, 0);
    for (theta, h) in [(0.2, 0.4), (-0.9, -0.8), (1.3, 0.0)] {
        let lobe = model.lobe_at(direction(theta, 0.0), h);
        let n = 200_000;
        let (mut sum, mut square) = (Rgb::ZERO, Rgb::ZERO);
        for _ in 0..n {
            let u = [rng.uniform_f32(), rng.uniform_f32(), rng.uniform_f32()];
            let sample = lobe.sample(u).unwrap();
            assert!((sample.wi.length() - 1.0).abs() < 1e-5);
            sum += sample.weight / n as f32;
            square += sample.weight * sample.weight / n as f32;
        }
        let error = ((square - sum * sum).max(Rgb::ZERO) / n as f32).map(f32::sqrt) + 2e-4;
        let z = ((sum - lobe.albedo()) / error).abs().max_element();
        assert!(z < 4.5, "{sum} {} {z}", lobe.albedo());
    }
}

/// Where a ray meets the strand beside its axis, R leaves as from a mirror there.
#[test]
fn reflects_to_the_side_it_was_met() {
    let model = model([9.0; 3], 0.05, 0.05, 0.0, 1.55);
    let lobe = model.lobe_at(direction(0.0, 0.0), 0.5);
    // sin(30 degrees) = 0.5: the mirror sends light to 60 degrees.
    let at = |degrees: f32| {
        lobe.density_and_pdf(direction(0.0, degrees.to_radians()))
            .0
            .x
    };
    assert!(at(60.0) > 20.0 * at(-60.0) && at(60.0) > at(50.0) && at(60.0) > at(70.0));
}

/// The model written down again in double precision, with the library's functions, the Bessel function as an
/// integral and no case of its own for anything.
fn exactly(p: &ChiangParameters, wo: Vec3, h: f64, wi: Vec3) -> [f64; 3] {
    use std::f64::consts::{FRAC_PI_8, PI, TAU};
    let (m, n, eta) = (f64::from(p.beta_m), f64::from(p.beta_n), f64::from(p.eta));
    let variance = (0.726 * m + 0.812 * m * m + 3.7 * m.powi(20)).powi(2);
    let scale = FRAC_PI_8.sqrt() * (0.265 * n + 1.194 * n * n + 5.372 * n.powi(22));
    let alpha = f64::from(p.alpha_deg).to_radians();
    let inclination = |w: Vec3| f64::from(w.z).asin();
    let (theta_o, theta_i) = (inclination(wo), inclination(wi));
    let bravais = (eta * eta - theta_o.sin().powi(2)).sqrt() / theta_o.cos();
    let (gamma_i, gamma_t) = ((-h).asin(), (-h / bravais).asin());
    let cos_t = (1.0 - (theta_o.sin() / eta).powi(2)).sqrt();
    let f = fresnel::dielectric(theta_o.cos() * gamma_i.cos(), eta).0;
    let azimuth = f64::from(wi.y).atan2(f64::from(wi.x));
    let around = |p: f64| {
        let exit = 2.0 * p * gamma_t - 2.0 * gamma_i + p * PI;
        let off = azimuth - exit - TAU * ((azimuth - exit) / TAU).round();
        let cumulative = |x: f64| 1.0 / (1.0 + (-x / scale).exp());
        let e = (-off.abs() / scale).exp();
        e / (scale * (1.0 + e).powi(2)) / (cumulative(PI) - cumulative(-PI))
    };
    let along = |v: f64, tilt: f64| {
        let theta = theta_o + tilt;
        let (a, b) = (
            theta_i.cos() * theta.cos().abs() / v,
            theta_i.sin() * theta.sin() / v,
        );
        let steps = 4000;
        let bessel =
            (0..steps).map(|k| (a * ((TAU * f64::from(k) / f64::from(steps)).cos() - 1.0)).exp());
        let bessel = bessel.sum::<f64>() / f64::from(steps);
        bessel * (a - b - 1.0 / v).exp() / (v * (1.0 - (-2.0 / v).exp()))
    };
    [p.sigma_a.x, p.sigma_a.y, p.sigma_a.z].map(|sigma| {
        let t = (-2.0 * f64::from(sigma) * gamma_t.cos() / cos_t).exp();
        let tt = (1.0 - f) * (1.0 - f) * t;
        f * along(variance, 2.0 * alpha) * around(0.0)
            + tt * along(0.25 * variance, -alpha) * around(1.0)
            + tt * t * f * along(4.0 * variance, -4.0 * alpha) * around(2.0)
            + tt * t * f * t * f / (1.0 - f * t) * along(4.0 * variance, 0.0) / TAU
    })
}

#[test]
fn agrees_with_double_precision() {
    let mut rng = Rng::new(9, 0);
    for (beta_m, beta_n, alpha_deg) in [(0.3, 0.3, 2.0), (0.15, 0.2, -3.0), (0.9, 0.7, 0.0)] {
        let parameters = ChiangParameters {
            beta_m,
            beta_n,
            alpha_deg,
            ..ChiangParameters::default()
        };
        let model = Chiang::new(&parameters);
        for _ in 0..400 {
            let theta = 3.0 * (rng.uniform_f32() - 0.5);
            let wo = direction(theta, 0.0);
            let h = 1.98 * (rng.uniform_f32() - 0.5);
            let lobe = model.lobe_at(wo, h);
            let u = [rng.uniform_f32(), rng.uniform_f32(), rng.uniform_f32()];
            let sample = lobe.sample(u).unwrap();
            let (found, pdf) = lobe.density_and_pdf(sample.wi);
            let exact = exactly(&parameters, wo, f64::from(h), sample.wi);
            for (found, exact) in found.to_array().into_iter().zip(exact) {
                let off = (f64::from(found) / exact - 1.0).abs();
                assert!(
                    off < 5e-5,
                    "{beta_m} {wo} {h} {}: {found} {exact} {off}",
                    sample.wi
                );
            }
            // What sampling knows already of a direction is what looking at it says.
            assert!((pdf / sample.pdf - 1.0).abs() < 5e-5);
            assert!(
                (sample.weight * sample.pdf / found - 1.0)
                    .abs()
                    .max_element()
                    < 5e-5
            );
        }
    }
}
