//! Values of options that are more than a number.

use crate::blame::Blame;
use crate::bsdf::{ChiangParameters, DoubleCylinderParameters};
use crate::cli::Failure;
use crate::color::Rgb;
use crate::render::Crop;

pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let parts = text.split_once(['x', 'X']);
    let sides = parts.and_then(|(w, h)| Some([w.trim().parse().ok()?, h.trim().parse().ok()?]));
    sides.ok_or_else(|| format!("`{text}` is not a size such as 960x720"))
}

pub(super) fn crop(text: &str) -> Result<Crop, String> {
    let numbers: Result<Vec<u32>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, width, height]) => Ok(Crop {
            x,
            y,
            width,
            height,
        }),
        _ => Err(format!(
            "`{text}` is not a crop such as 200,150,64,64 (x,y,width,height)"
        )),
    }
}

/// A range of samples.
pub(super) fn samples(text: &str) -> Result<[u32; 2], String> {
    let ends = text.split_once("..");
    match ends.and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?])) {
        Some([a, b]) if a < b => Ok([a, b]),
        _ => Err(format!("`{text}` is not a range of samples such as 0..64")),
    }
}

pub(super) fn pair(text: &str) -> Result<[f32; 2], String> {
    let pair = text.split_once(',');
    let pair = pair.and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    match pair {
        Some(pair @ [a, b]) if f32::is_finite(a) && f32::is_finite(b) => Ok(pair),
        _ => Err(format!("`{text}` is not a pair of numbers such as 35,12")),
    }
}

/// What numbers of hair models may be.
const ABSORPTION: [f32; 2] = [0.0, 1e4];
const ROUGHNESS: [f32; 2] = [0.0, 1.0];
const TILT: [f32; 2] = [-20.0, 20.0];
const INDEX: [f32; 2] = [1.01, 3.0];
const SHARE: [f32; 2] = [0.0, 1.0];
const LAYERS: [f32; 2] = [0.01, 20.0];
const LENGTH: [f32; 2] = [0.0, 1e3];
const MEAN_COSINE: [f32; 2] = [0.0, 0.99];

/// Numbers of Chiang's model; those that are not given stay as they are by default.
pub(super) fn chiang(text: &str) -> Result<ChiangParameters, String> {
    let mut p = ChiangParameters::default();
    let numbers = &mut [
        ("beta_m", ROUGHNESS, &mut p.beta_m),
        ("beta_n", ROUGHNESS, &mut p.beta_n),
        ("alpha", TILT, &mut p.alpha_deg),
        ("eta", INDEX, &mut p.eta),
    ];
    read_numbers(text, &mut p.sigma_a, numbers)?;
    Ok(p)
}

/// Numbers of a double cylinder; those that are not given stay as they are by default.
pub(super) fn double_cylinder(text: &str) -> Result<DoubleCylinderParameters, String> {
    let mut p = DoubleCylinderParameters::default();
    let numbers = &mut [
        ("beta_m", ROUGHNESS, &mut p.beta_m),
        ("beta_n", ROUGHNESS, &mut p.beta_n),
        ("alpha", TILT, &mut p.alpha_deg),
        ("eta", INDEX, &mut p.eta),
        ("layers", LAYERS, &mut p.layers),
        ("kappa", SHARE, &mut p.kappa),
        ("sigma_m_s", ABSORPTION, &mut p.sigma_m_s),
        ("path_s", LENGTH, &mut p.path_s),
        ("beta_m_s", ROUGHNESS, &mut p.beta_m_s),
        ("rho_s", MEAN_COSINE, &mut p.rho_s),
        ("back_s", SHARE, &mut p.back_s),
        ("beta_m_b", ROUGHNESS, &mut p.beta_m_b),
        ("rho_b", MEAN_COSINE, &mut p.rho_b),
    ];
    read_numbers(text, &mut p.sigma_a, numbers)?;
    Ok(p)
}

/// Reads `KEY=VALUE,..`: an absorption and numbers with their ranges.
fn read_numbers(
    text: &str,
    sigma_a: &mut Rgb,
    numbers: &mut [(&str, [f32; 2], &mut f32)],
) -> Result<(), String> {
    for part in text
        .split(',')
        .map(str::trim)
        .filter(|part| !part.is_empty())
    {
        let (key, value) = part
            .split_once('=')
            .ok_or_else(|| format!("`{part}` is not KEY=VALUE"))?;
        let (key, value) = (key.trim(), value.trim());
        let within = |text: &str, [lo, hi]: [f32; 2]| {
            let number = text.trim().parse::<f32>().ok();
            number.filter(|v| (lo..=hi).contains(v))
        };
        if key == "sigma_a" {
            let colors: Option<Vec<f32>> =
                (value.split(':').map(|v| within(v, ABSORPTION))).collect();
            *sigma_a = match colors.as_deref() {
                Some(&[gray]) => Rgb::splat(gray),
                Some(&[r, g, b]) => Rgb::new(r, g, b),
                _ => {
                    return Err(format!(
                        "sigma_a is `{value}`, must be one number or R:G:B, each 0 or more"
                    ));
                }
            };
            continue;
        }
        let Some((_, range, number)) = numbers.iter_mut().find(|(name, ..)| *name == key) else {
            let known: Vec<&str> = numbers.iter().map(|(name, ..)| *name).collect();
            return Err(format!(
                "there is no `{key}`, only sigma_a, {}",
                known.join(", ")
            ));
        };
        let [lo, hi] = *range;
        **number = within(value, *range)
            .ok_or_else(|| format!("{key} is `{value}`, must be a number, {lo} to {hi}"))?;
    }
    Ok(())
}

pub(super) fn check_range(name: &str, value: f32, lo: f32, hi: f32) -> Result<f32, Failure> {
    if (lo..=hi).contains(&value) {
        return Ok(value);
    }
    Err(Failure::new(
        Blame::Input,
        format!("{name} is {value}, must be {lo} to {hi}"),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_the_hair_model_are_read() {
        let p = chiang("sigma_a=0.1:0.2:0.3, beta_m=0.2,alpha=-3").unwrap();
        assert_eq!(p.sigma_a, Rgb::new(0.1, 0.2, 0.3));
        assert_eq!((p.beta_m, p.beta_n, p.alpha_deg), (0.2, 0.3, -3.0));
        assert_eq!(chiang("sigma_a=0").unwrap().sigma_a, Rgb::ZERO);
        for (bad, said) in [
            ("sigma_a=0:1", "R:G:B"),
            ("sigma_a=-1", "R:G:B"),
            ("beta_m=2", "beta_m is `2`, must be a number, 0 to 1"),
            ("eta=1", "1.01 to 3"),
            (
                "gloss=1",
                "no `gloss`, only sigma_a, beta_m, beta_n, alpha, eta",
            ),
            ("beta_n", "`beta_n` is not KEY=VALUE"),
            ("eta=nan", "must be"),
            ("kappa=0.5", "no `kappa`"),
        ] {
            let error = chiang(bad).unwrap_err();
            assert!(error.contains(said), "{bad}: {error}");
        }
    }

    #[test]
    fn numbers_of_a_double_cylinder_are_read() {
        let p = double_cylinder("kappa=0.2,sigma_a=1,back_s = 1,layers=1.5").unwrap();
        let expected = DoubleCylinderParameters {
            sigma_a: Rgb::ONE,
            kappa: 0.2,
            back_s: 1.0,
            layers: 1.5,
            ..DoubleCylinderParameters::default()
        };
        assert_eq!(p, expected);
        for bad in [
            "rho_s=1",
            "kappa=1.1",
            "layers=0",
            "sigma_m_s=-1",
            "kappa=inf",
        ] {
            assert!(double_cylinder(bad).is_err(), "{bad}");
        }
        // What the help says is the default is.
        let usual = double_cylinder(super::super::args::DOUBLE_CYLINDER);
        assert_eq!(usual, Ok(DoubleCylinderParameters::default()));
    }
}
