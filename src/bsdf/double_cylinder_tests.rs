use super::*;
use crate::sampling::Rng;
use crate::table::Model;

fn direction(theta: f32, phi: f32) -> Vec3 {
    let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
    Vec3::new(ct * cp, ct * sp, st)
}

/// Narrow and wide, clear and dark, all the way to no medulla and to one that fills the strand.
fn all() -> [DoubleCylinderParameters; 4] {
    let usual = DoubleCylinderParameters::default();
    [
        usual,
        DoubleCylinderParameters {
            sigma_a: Rgb::new(0.0, 0.4, 2.0),
            beta_m: 0.15,
            beta_n: 0.2,
            alpha_deg: -3.0,
            layers: 1.7,
            kappa: 0.9,
            sigma_m_s: 0.6,
            path_s: 0.7,
            beta_m_s: 0.3,
            rho_s: 0.8,
            back_s: 0.2,
            beta_m_b: 0.9,
            rho_b: 0.1,
            ..usual
        },
        DoubleCylinderParameters {
            sigma_a: Rgb::ZERO,
            beta_m: 0.8,
            beta_n: 0.9,
            eta: 1.3,
            layers: 0.2,
            kappa: 1.0,
            sigma_m_s: 15.0,
            rho_s: 0.0,
            rho_b: 0.95,
            back_s: 1.0,
            ..usual
        },
        DoubleCylinderParameters {
            kappa: 0.0,
            back_s: 0.0,
            ..usual
        },
    ]
}

/// Inclination of the viewer and place across the strand.
const SEEN: [(f32, f32); 4] = [(0.0, 0.0), (0.5, 0.6), (-1.1, -0.95), (1.45, 0.3)];

/// Sum over the sphere by even steps of both angles, of density and pdf.
fn over_the_sphere(lobe: &DoubleCylinderLobe<'_>) -> ([f64; 3], f64) {
    // A wrapped Cauchy of mean cosine 0.95 needs its columns.
    let (rows, columns) = (300, 360);
    let step = f64::from(PI) / f64::from(rows) * f64::from(TAU) / f64::from(columns);
    let (mut sum, mut all) = ([0.0; 3], 0.0);
    for i in 0..rows * columns {
        let theta = PI * (((i / columns) as f32 + 0.5) / rows as f32 - 0.5);
        let phi = TAU * ((i % columns) as f32 + 0.5) / columns as f32;
        let (density, pdf) = lobe.density_and_pdf(direction(theta, phi));
        let area = f64::from(theta.cos()) * step;
        for (sum, density) in sum.iter_mut().zip(density.to_array()) {
            *sum += area * f64::from(density);
        }
        all += area * f64::from(pdf);
    }
    (sum, all)
}

#[test]
fn every_lobe_and_their_sum_carry_their_energy() {
    for p in all() {
        let model = DoubleCylinder::new(&p);
        for (theta, h) in SEEN {
            let lobe = model.lobe_at(direction(theta, 0.0), h);
            let carries = |lobe: &DoubleCylinderLobe<'_>, energy: Rgb, name: &str| {
                let (sum, pdf) = over_the_sphere(lobe);
                for (sum, energy) in sum.into_iter().zip(energy.to_array()) {
                    let off = (sum - f64::from(energy)).abs();
                    assert!(off < 1e-4, "{name} at {theta} {h}: {sum} {energy}, {p:?}");
                }
                assert!((pdf - 1.0).abs() < 1e-4, "pdf at {theta} {h}: {pdf}, {p:?}");
            };
            carries(&lobe, lobe.albedo(), "all");
            let energy = lobe.straight.energies();
            for (k, name) in Model::DoubleCylinder.lobes()[..4].iter().enumerate() {
                let mut only = lobe;
                let own = std::array::from_fn(|i| if i == k { energy[i] } else { Rgb::ZERO });
                only.straight = lobe.straight.with_energies(own);
                only.scattered = Rgb::ZERO;
                carries(&only, energy[k], name);
            }
            for (k, name) in ["TTs", "TRTs"].iter().enumerate() {
                let mut scattering = *lobe.scattering;
                let share = scattering.share[k];
                scattering.share[1 - k] = 0.0;
                scattering.share[k] = 1.0;
                let only = DoubleCylinderLobe {
                    scattering: &scattering,
                    straight: lobe.straight.with_energies([Rgb::ZERO; 4]),
                    scattered: share * lobe.scattered,
                    ..lobe
                };
                carries(&only, share * lobe.scattered, name);
            }
        }
    }
}

/// Without pigment no light is lost, whatever the medulla does.
#[test]
fn clear_strands_lose_no_light() {
    let mut rng = Rng::new(4, 0);
    for p in all() {
        let model = DoubleCylinder::new(&DoubleCylinderParameters {
            sigma_a: Rgb::ZERO,
            ..p
        });
        for _ in 0..500 {
            let theta = 3.0 * (rng.uniform_f32() - 0.5);
            let h = 2.0 * rng.uniform_f32() - 1.0;
            let albedo = model.lobe_at(direction(theta, 0.0), h).albedo();
            let off = (albedo - 1.0).abs().max_element();
            assert!(off < 2e-5, "{theta} {h}: {albedo}, {p:?}");
        }
    }
}

/// Half a layer is one surface, and without a medulla it is Chiang's model; so it is with a medulla that
/// does not scatter where nothing absorbs.
#[test]
fn without_a_medulla_it_is_the_model_of_chiang() {
    let usual = DoubleCylinderParameters::default();
    let none = DoubleCylinderParameters {
        kappa: 0.0,
        ..usual
    };
    let clear = DoubleCylinderParameters {
        sigma_a: Rgb::ZERO,
        sigma_m_s: 0.0,
        ..usual
    };
    let mut rng = Rng::new(5, 0);
    for p in [none, clear] {
        let chiang = Chiang::new(&ChiangParameters {
            sigma_a: p.sigma_a,
            ..ChiangParameters::default()
        });
        let double = DoubleCylinder::new(&DoubleCylinderParameters { layers: 0.5, ..p });
        for _ in 0..1000 {
            let wo = direction(3.0 * (rng.uniform_f32() - 0.5), 0.0);
            let h = 1.98 * (rng.uniform_f32() - 0.5);
            let (chiang, double) = (chiang.lobe_at(wo, h), double.lobe_at(wo, h));
            let u = [rng.uniform_f32(), rng.uniform_f32(), rng.uniform_f32()];
            let (drawn, same) = (chiang.sample(u).unwrap(), double.sample(u).unwrap());
            assert!((drawn.wi - same.wi).length() < 1e-5, "{wo} {h} {u:?}");
            let (expected, pdf) = chiang.density_and_pdf(drawn.wi);
            let (found, its) = double.density_and_pdf(drawn.wi);
            let off = (found / expected - 1.0).abs().max_element();
            assert!(off < 1e-5, "{wo} {h} {}: {found} {expected}", drawn.wi);
            assert!((its / pdf - 1.0).abs() < 1e-5, "{wo} {h}: {its} {pdf}");
        }
    }
}

/// The model that is fitted to tables is written down on its own, in double precision, as means over the
/// width. Both take the same forty offsets.
#[test]
fn its_mean_over_the_width_is_the_far_field_model() {
    const OFFSETS: i32 = 40;
    const POINTS: usize = 12;
    let names = Model::DoubleCylinder.parameters();
    for p in &all()[..2] {
        let value = |name: &&str| {
            f64::from(match *name {
                "eta" => p.eta,
                "beta_m" => p.beta_m,
                "beta_n" => p.beta_n,
                "alpha_deg" => p.alpha_deg,
                "layers" => p.layers,
                "kappa" => p.kappa,
                "sigma_m_s" => p.sigma_m_s,
                "beta_m_s" => p.beta_m_s,
                "rho_s" => p.rho_s,
                "path_s" => p.path_s,
                "back_s" => p.back_s,
                "beta_m_b" => p.beta_m_b,
                "rho_b" => p.rho_b,
                other => panic!("{other}"),
            })
        };
        let shared: Vec<f64> = names.iter().map(value).collect();
        let model = DoubleCylinder::new(p);
        for theta_o in [0.1, -0.9] {
            let lobes: Vec<_> = (1 - 2 * OFFSETS..2 * OFFSETS)
                .step_by(2)
                .map(|i| {
                    let h = i as f32 / (2 * OFFSETS) as f32;
                    model.lobe_at(direction(theta_o, 0.0), h)
                })
                .collect();
            for theta in [-1.2f32, -0.3, 0.0, 0.8] {
                let edges = [-0.001, 0.001].map(|off| f64::from(theta) + off);
                let far = [0, 1, 2].map(|channel| {
                    let sigma = f64::from(p.sigma_a[channel]);
                    let far = Model::DoubleCylinder;
                    far.far_field(f64::from(theta_o), &edges, &shared, sigma)[0]
                });
                for column in 0..36 {
                    let at = |k: usize| {
                        let at = (column as f32 + (k as f32 + 0.5) / POINTS as f32) / 36.0;
                        let toward = [-1.0, 1.0].map(|sign| direction(theta, sign * PI * at));
                        let of = |lobe: &DoubleCylinderLobe<'_>| {
                            toward.map(|wi| lobe.density_and_pdf(wi).0)
                        };
                        lobes.iter().flat_map(of).sum::<Rgb>() / (2 * lobes.len()) as f32
                    };
                    let near = (0..POINTS).map(at).sum::<Rgb>() / POINTS as f32;
                    for (near, far) in near.to_array().into_iter().zip(&far) {
                        let most = far.iter().copied().fold(0.0, f64::max);
                        let off = (f64::from(near) - far[column]).abs() / most;
                        assert!(
                            off < 2e-3,
                            "{theta_o} to {theta}, column {column}: {near} {far:?}, {p:?}"
                        );
                    }
                }
            }
        }
    }
}

/// Mean weight of samples is the albedo; what a sample says of itself is what looking at it says.
#[test]
fn samples_carry_the_albedo() {
    let mut rng = Rng::new(6, 0);
    for p in all() {
        let model = DoubleCylinder::new(&p);
        for (theta, h) in SEEN {
            let lobe = model.lobe_at(direction(theta, 0.0), h);
            let n = 50_000;
            let (mut sum, mut square) = (Rgb::ZERO, Rgb::ZERO);
            for _ in 0..n {
                let u = [rng.uniform_f32(), rng.uniform_f32(), rng.uniform_f32()];
                let sample = lobe.sample(u).unwrap();
                assert!((sample.wi.length() - 1.0).abs() < 1e-5);
                let (density, pdf) = lobe.density_and_pdf(sample.wi);
                assert!(
                    (pdf / sample.pdf - 1.0).abs() < 1e-3,
                    "{pdf} {}",
                    sample.pdf
                );
                let off = density - sample.weight * sample.pdf;
                assert!(off.abs().max_element() < 1e-3 * sample.pdf);
                sum += sample.weight / n as f32;
                square += sample.weight * sample.weight / n as f32;
            }
            let error = ((square - sum * sum).max(Rgb::ZERO) / n as f32).map(f32::sqrt) + 2e-4;
            let z = ((sum - lobe.albedo()) / error).abs().max_element();
            assert!(z < 4.5, "{sum} {} {z}", lobe.albedo());
        }
    }
}

/// A mantle of pigment around a medulla that scatters everything shows where scattered light goes.
#[test]
fn light_is_scattered_on_and_back() {
    let toward = |back_s: f32, phi: f32| {
        let model = DoubleCylinder::new(&DoubleCylinderParameters {
            sigma_m_s: 50.0,
            kappa: 0.99,
            back_s,
            rho_s: 0.5,
            rho_b: 0.5,
            ..DoubleCylinderParameters::default()
        });
        let lobe = model.lobe_at(direction(0.0, 0.0), 0.2);
        lobe.density_and_pdf(direction(0.9, phi)).0.x
    };
    // (1 + rho)^2 / (1 - rho)^2 of the two ends of a wrapped Cauchy, less R.
    assert!(toward(0.0, PI) > 6.0 * toward(0.0, 0.0));
    assert!(toward(1.0, 0.0) > 6.0 * toward(1.0, PI));
}

#[test]
fn wrapped_cauchys_are_drawn_as_they_say() {
    for rho in [0.0f32, 0.3, 0.95] {
        let cauchy = WrappedCauchy::new(rho);
        // The share between two quantiles is what lies between them, in closed form and as a sum.
        let (mut sum, n) = (0.0, 20_000);
        let (mut before, mut cosine) = (cauchy.sample(0.0), 0.0);
        assert!((before.abs() - PI).abs() < 1e-5);
        for i in 1..=n {
            let u = i as f32 / n as f32;
            let angle = if i == n { PI } else { cauchy.sample(u) };
            let step = f64::from(angle - if i == 1 { -PI } else { before });
            let middle = 0.5 * (angle + if i == 1 { -PI } else { before });
            sum += step * f64::from(cauchy.density(middle.cos()));
            cosine += f64::from(middle.cos()) / f64::from(n);
            before = angle;
            assert!((sum - f64::from(u)).abs() < 2e-4, "{rho} {u}: {sum}");
        }
        assert!((cosine - f64::from(rho)).abs() < 2e-4, "{rho}: {cosine}");
    }
}
