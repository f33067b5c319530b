//! Hair models in closed form in place of tables, to see what tables add.

use super::AssemblyError;
use crate::bake::BakeError;
use crate::bsdf::{
    Chiang, ChiangParameters, DoubleCylinder, DoubleCylinderParameters, HairMaterial,
};
use crate::color::Rgb;
use crate::progress::{Cancel, Progress};
use crate::table::{Fit, Model, ScatterTable};

/// Materials whose tables have become a model, as near to them as it comes.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// In the order of what they stand for.
    pub materials: Vec<HairMaterial>,
    /// Relative L2 distance of S from each table, mean of the colors.
    pub errors: Vec<f64>,
}

/// A hair model in place of each table. A fit takes seconds.
///
/// # Errors
/// Tables that tell azimuths apart, since the models cannot, or [`BakeError::Stopped`].
pub fn fitted(
    materials: &[HairMaterial],
    model: Model,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Fitted, AssemblyError> {
    let tables = |material: &HairMaterial| match material {
        HairMaterial::Tables(tables) => tables.values().len(),
        _ => 0,
    };
    let count = materials.iter().map(tables).sum::<usize>();
    progress.begin("fitting", count as u64, "tables");
    let mut errors = Vec::with_capacity(count);
    let mut fit = |table: &ScatterTable| {
        if cancel.is_cancelled() {
            return Err(AssemblyError::from(BakeError::Stopped));
        }
        let fit = model.fit(&table.maps(), &[0, 1, 2])?;
        errors.push(fit.error.iter().sum::<f64>() / fit.error.len() as f64);
        progress.advance(1);
        Ok(fit)
    };
    let mut material = |material: &HairMaterial| {
        let HairMaterial::Tables(tables) = material else {
            return Ok(material.clone());
        };
        Ok(match model {
            Model::Chiang => {
                let one = |fit: Fit| Chiang::new(&chiang(&fit));
                HairMaterial::Chiang(tables.try_map(|table| fit(table).map(one))?)
            }
            Model::DoubleCylinder => {
                let one = |fit: Fit| DoubleCylinder::new(&double_cylinder(&fit));
                HairMaterial::DoubleCylinder(tables.try_map(|table| fit(table).map(one))?)
            }
        })
    };
    let materials = materials.iter().map(&mut material);
    let materials = materials.collect::<Result<_, AssemblyError>>()?;
    progress.finish();
    Ok(Fitted { materials, errors })
}

fn number(fit: &Fit, name: &str) -> f32 {
    fit.parameter(name).unwrap_or_default() as f32
}

fn absorption(fit: &Fit) -> Rgb {
    Rgb::from_array(std::array::from_fn(|c| fit.absorption[c] as f32))
}

fn chiang(fit: &Fit) -> ChiangParameters {
    ChiangParameters {
        sigma_a: absorption(fit),
        beta_m: number(fit, "beta_m"),
        beta_n: number(fit, "beta_n"),
        alpha_deg: number(fit, "alpha_deg"),
        eta: number(fit, "eta"),
    }
}

fn double_cylinder(fit: &Fit) -> DoubleCylinderParameters {
    DoubleCylinderParameters {
        sigma_a: absorption(fit),
        beta_m: number(fit, "beta_m"),
        beta_n: number(fit, "beta_n"),
        alpha_deg: number(fit, "alpha_deg"),
        eta: number(fit, "eta"),
        layers: number(fit, "layers"),
        kappa: number(fit, "kappa"),
        sigma_m_s: number(fit, "sigma_m_s"),
        path_s: number(fit, "path_s"),
        beta_m_s: number(fit, "beta_m_s"),
        rho_s: number(fit, "rho_s"),
        back_s: number(fit, "back_s"),
        beta_m_b: number(fit, "beta_m_b"),
        rho_b: number(fit, "rho_b"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every number of a model is one that its fit has, and is put where it belongs.
    #[test]
    fn all_numbers_of_a_fit_are_taken() {
        let names = [
            "eta",
            "beta_m",
            "beta_n",
            "alpha_deg",
            "layers",
            "kappa",
            "sigma_m_s",
            "beta_m_s",
            "rho_s",
            "path_s",
            "back_s",
            "beta_m_b",
            "rho_b",
        ];
        let numbered = names.iter().enumerate();
        let fit = Fit {
            model: Model::DoubleCylinder,
            shared: numbered.map(|(i, &name)| (name, i as f64)).collect(),
            absorption: vec![20.0, 21.0, 22.0],
            error: vec![0.0; 3],
            lobes: Vec::new(),
        };
        assert_eq!(Model::DoubleCylinder.parameters(), names);
        assert_eq!(Model::Chiang.parameters(), names[..4]);
        let chiang = chiang(&fit);
        let p = double_cylinder(&fit);
        assert_eq!(p.sigma_a, Rgb::new(20.0, 21.0, 22.0));
        let found = [
            p.eta,
            p.beta_m,
            p.beta_n,
            p.alpha_deg,
            p.layers,
            p.kappa,
            p.sigma_m_s,
            p.beta_m_s,
            p.rho_s,
            p.path_s,
            p.back_s,
            p.beta_m_b,
            p.rho_b,
        ];
        assert_eq!(found, std::array::from_fn(|i| i as f32));
        let found = [chiang.eta, chiang.beta_m, chiang.beta_n, chiang.alpha_deg];
        assert_eq!(found, [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(chiang.sigma_a, p.sigma_a);
    }
}
