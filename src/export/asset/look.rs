//! What materials are made of: Chiang's hair model with numbers, and how well it stands for the hair.

/// The looks of one hair class.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassLook {
    /// Position along the hair whose structure was fitted, 0 root .. 1 tip.
    pub station: f64,
    /// For each part of the coat's pattern, that of the species itself first: one a zone of pigment, from
    /// the tip to the root. Never empty.
    pub parts: Vec<Vec<HairLook>>,
}

/// Chiang et al. 2016, "A practical and controllable hair and fur model for production path tracing".
#[derive(Clone, Debug, PartialEq)]
pub struct HairLook {
    /// Index of refraction.
    pub ior: f64,
    /// Longitudinal roughness, 0..1.
    pub longitudinal: f64,
    /// Azimuthal roughness, 0..1.
    pub azimuthal: f64,
    /// Tilt of the scales, degrees: R leaves toward the root by twice as much.
    pub tilt_deg: f64,
    /// Absorption per radius of the hair, linear Rec.709.
    pub absorption: [f64; 3],
    /// Relative L2 distance of S from the table, per channel.
    pub error: [f64; 3],
    /// The same for each lobe.
    pub lobes: Vec<LobeError>,
}

/// How well a lobe is met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeError {
    /// `R`, `TT`, `TRT`, `TRRT+`.
    pub name: &'static str,
    /// Share of the light of the table that falls to it.
    pub table: f64,
    /// Share of the light of the model.
    pub model: f64,
    /// Relative L2 distance of S among the light that falls to it.
    pub error: f64,
}

impl HairLook {
    /// Mean error of the channels.
    pub fn mean_error(&self) -> f64 {
        self.error.iter().sum::<f64>() / 3.0
    }

    /// Longitudinal variance and azimuthal logistic scale of the R lobe, as MaterialX wants them: its
    /// `chiang_hair_roughness` node, which some of its backends lack, in numbers.
    pub(super) fn roughness(&self) -> [f64; 2] {
        let (m, n) = (
            self.longitudinal.clamp(0.001, 1.0),
            self.azimuthal.clamp(0.001, 1.0),
        );
        let v = 0.726 * m + 0.812 * m * m + 3.7 * m.powi(20);
        [v * v, 0.265 * n + 1.194 * n * n + 5.372 * n.powi(22)]
    }

    /// `cuticle_angle` of MaterialX: 0 to 1 for a tilt of -90 to 90 degrees.
    pub(super) fn cuticle_angle(&self) -> f64 {
        0.5 + self.tilt_deg / 180.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_nodes() {
        let look = HairLook {
            ior: 1.55,
            longitudinal: 0.3,
            azimuthal: 0.4,
            tilt_deg: 3.0,
            absorption: [0.0; 3],
            error: [0.1, 0.2, 0.3],
            lobes: Vec::new(),
        };
        // By hand: (0.2178 + 0.07308 + 3.7 x 0.3^20)^2 and 0.106 + 0.19104 + 5.372 x 0.4^22.
        let [v, s] = look.roughness();
        assert!((v - 0.084_611_2).abs() < 1e-6, "{v}");
        assert!((s - 0.297_04).abs() < 1e-5, "{s}");
        assert!((look.cuticle_angle() - 0.516_666_7).abs() < 1e-6);
        assert!((look.mean_error() - 0.2).abs() < 1e-12);
    }
}
