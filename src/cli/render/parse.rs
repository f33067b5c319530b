//! Values of options that are more than a number.

use crate::blame::Blame;
use crate::bsdf::ChiangParameters;
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

/// Numbers of the hair model; those that are not given stay as they are by default.
pub(super) fn chiang(text: &str) -> Result<ChiangParameters, String> {
    let mut p = ChiangParameters::default();
    for part in text.split(',').filter(|part| !part.trim().is_empty()) {
        let refused = || {
            format!(
                "`{part}` is not one of sigma_a=R:G:B (or one number), beta_m=0..1, beta_n=0..1, \
                 alpha=DEGREES, eta=1.01..3"
            )
        };
        let (key, value) = part.split_once('=').ok_or_else(refused)?;
        let in_range = |lo: f32, hi: f32| {
            let number = value.trim().parse::<f32>().ok();
            number.filter(|v| (lo..=hi).contains(v)).ok_or_else(refused)
        };
        match key.trim() {
            "sigma_a" => {
                let numbers: Option<Vec<f32>> = (value.split(':'))
                    .map(|v| v.trim().parse().ok().filter(|v| (0.0..=1e4).contains(v)))
                    .collect();
                p.sigma_a = match numbers.as_deref() {
                    Some(&[gray]) => Rgb::splat(gray),
                    Some(&[r, g, b]) => Rgb::new(r, g, b),
                    _ => return Err(refused()),
                };
            }
            "beta_m" => p.beta_m = in_range(0.0, 1.0)?,
            "beta_n" => p.beta_n = in_range(0.0, 1.0)?,
            "alpha" => p.alpha_deg = in_range(-20.0, 20.0)?,
            "eta" => p.eta = in_range(1.01, 3.0)?,
            _ => return Err(refused()),
        }
    }
    Ok(p)
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
        for bad in [
            "sigma_a=0:1",
            "beta_m=2",
            "eta=1",
            "gloss=1",
            "beta_n",
            "eta=nan",
        ] {
            assert!(chiang(bad).is_err(), "{bad}");
        }
    }
}
