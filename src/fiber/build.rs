//! A fiber from its structure.

use super::cortex::Pigment;
use super::medulla::{Homogeneous, Medulla, Voids};
use super::optics::OpticalParts;
use super::pattern::Pattern;
use super::scales::Scales;
use super::section::Section;
use super::surface::Surface;
use super::triangles::{Maker, Triangles, twisted};
use super::{Fiber, FiberError, fusi};
use crate::species::{CuticlePattern, FiberMesh, MedullaKind, Structure};
use std::f64::consts::TAU;

impl Fiber {
    /// Builds the geometry of a structure. `seed` places scales and voids.
    ///
    /// # Errors
    /// When the parts do not fit into each other: a section that folds over itself, scales higher than a third of the radius, a
    /// medulla that reaches the cuticle, septa thicker than the rungs' distance, cells wider than the
    /// medulla, films thicker than globules, a froth denser than spheres can be packed, fusi in a
    /// cortex thinner than they are.
    pub fn build(structure: &Structure, seed: u64) -> Result<Self, FiberError> {
        if let Some(mesh) = &structure.mesh {
            return Self::from_mesh(mesh, structure);
        }
        let mut fiber = Self::straight(structure, seed)?;
        fiber.twist = twist_of(structure);
        if fiber.twist != 0.0 {
            // No ray is straight in a frame that turns with the section: triangles are traced.
            let mesh = twisted(&fiber.mesh(), fiber.period_um, fiber.twist);
            let is_medium = fiber.medulla.medium.is_some();
            let own = Maker::Own {
                overlap: matches!(fiber.medulla.voids, Voids::Bodies(_)) || fiber.fusi.is_some(),
            };
            let triangles = Triangles::new(&mesh, is_medium, fiber.twist, own)?;
            fiber.triangles = Some(Box::new(triangles));
        }
        Ok(fiber)
    }

    /// The fiber without its twist.
    fn straight(structure: &Structure, seed: u64) -> Result<Self, FiberError> {
        let section = Section::of(structure)?;
        let cuticle = &structure.cuticle;
        if cuticle.pattern != CuticlePattern::Smooth && cuticle.height_um > section.b / 3.0 {
            return Err(FiberError::ScalesTooHigh {
                height_um: cuticle.height_um,
                radius_um: section.b,
            });
        }
        let flat = cuticle.height_um <= 0.0 || cuticle.pattern == CuticlePattern::Smooth;
        let lines = section.lines(section.line_count(flat));
        let mut pattern = if flat {
            None
        } else {
            Pattern::new(cuticle, &lines, section.circumference(), seed)
        };
        let period_um = Medulla::period_um(structure, pattern.as_ref().map(|p| p.period_um));
        if pattern.is_none() && !section.is_ellipse() {
            pattern = Some(Pattern::bare(&lines, period_um));
        }
        let surface = pattern.map_or(Surface::Smooth, |pattern| {
            let scales = Scales::new(&pattern, &lines);
            Surface::Scales(Box::new(match section.is_ellipse() {
                true => scales,
                false => scales.with_clearance(),
            }))
        });
        let bounding_radius_um = match &surface {
            Surface::Scales(scales) if !section.is_ellipse() => {
                scales.bounding_um([section.a, section.b])
            }
            _ => section.a * surface.rho_max(),
        };
        let medulla = Medulla::new(structure, &section, &surface, period_um, seed)?;
        let cortex = (medulla.ratio, surface.rho_min() / section.rho_min());
        let fusi = fusi::build(
            structure.cortex.fusi_per_mm,
            &section,
            cortex,
            period_um,
            seed,
        )?;
        let semi = [section.a, section.b];
        let pigment = Pigment::new(
            structure,
            (semi, &section.radii()),
            medulla.ratio,
            period_um,
            seed,
        );
        let optics = OpticalParts::new(structure, medulla.medium.as_ref());
        Ok(Self {
            structure: structure.clone(),
            section,
            surface,
            medulla,
            fusi: fusi.map(Box::new),
            pigment,
            triangles: None,
            twist: 0.0,
            period_um,
            bounding_radius_um,
            optics,
        })
    }

    fn from_mesh(mesh: &FiberMesh, structure: &Structure) -> Result<Self, FiberError> {
        let is_medium = matches!(structure.medulla.kind, MedullaKind::Medium { .. });
        let twist = twist_of(structure);
        let triangles = Triangles::new(mesh, is_medium, twist, Maker::Designer)?;
        let section = Section::of(structure)?;
        let medium = medium_of_mesh(structure);
        let period_um = triangles.period_um();
        Ok(Self {
            structure: structure.clone(),
            surface: Surface::Smooth,
            medulla: Medulla::none(),
            fusi: None,
            pigment: Pigment::new(
                structure,
                ([section.a, section.b], &[1.0]),
                0.0,
                period_um,
                0,
            ),
            section,
            bounding_radius_um: triangles.radius_um,
            triangles: Some(Box::new(triangles)),
            twist,
            period_um,
            optics: OpticalParts::new(structure, medium.as_ref()),
        })
    }
}

/// What a mesh's outline of a medulla holds if that is a medium.
pub(super) fn medium_of_mesh(structure: &Structure) -> Option<Homogeneous> {
    match structure.medulla.kind {
        MedullaKind::Medium {
            scattering_per_um,
            asymmetry,
        } => Some(Homogeneous {
            scattering_per_um,
            asymmetry,
            pigment: structure.medulla.pigment,
        }),
        _ => None,
    }
}

/// Radians per micrometer.
fn twist_of(structure: &Structure) -> f64 {
    TAU * structure.twist_turns_per_cm * 1e-4
}
