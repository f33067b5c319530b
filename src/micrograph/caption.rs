//! What a caption says about a fiber.

use super::Subject;
use crate::species::{
    Continuity, CuticlePattern, FiberMesh, Margin, MedullaKind, MeshRole, Section, Structure,
};
use std::path::Path;

/// The facts of a fiber in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Facts {
    /// Common and scientific name.
    pub title: String,
    /// Class of hair and place along it.
    pub place: String,
    /// Size and shape of the section.
    pub size: String,
    /// Pattern, number, pitch, height and tilt of the scales.
    pub cuticle: String,
    /// Type, index and air of the medulla.
    pub medulla: String,
}

impl Facts {
    /// The facts of a subject.
    pub fn of(subject: &Subject) -> Self {
        let structure = &subject.station.structure;
        let species = subject.species;
        let title = if species.latin.is_empty() {
            species.name.clone()
        } else {
            format!("{}  {}", species.name, species.latin)
        };
        let at = subject.station.at;
        Self {
            title,
            place: format!("{} hair at {at:.2} of its length", subject.class.name),
            size: size(structure),
            cuticle: cuticle(structure),
            medulla: medulla(structure, subject.fiber.air_fraction()),
        }
    }
}

/// Tilt of the scales, degrees; 0 for a bare cylinder.
pub fn tilt_deg(structure: &Structure) -> f64 {
    let cuticle = &structure.cuticle;
    if cuticle.pattern == CuticlePattern::Smooth {
        return 0.0;
    }
    (cuticle.height_um / cuticle.pitch_um).atan().to_degrees()
}

fn size(structure: &Structure) -> String {
    let shape = match structure.section {
        Section::Ellipse if structure.aspect == 1.0 => "round".to_owned(),
        Section::Ellipse => format!("oval, aspect {:.2}", structure.aspect),
        Section::Superellipse { .. } => format!("oblong, aspect {:.2}", structure.aspect),
        Section::DumbBell => format!("dumb-bell, aspect {:.2}", structure.aspect),
        Section::ConcavoConvex { .. } => format!("concavo-convex, aspect {:.2}", structure.aspect),
        Section::Bean { .. } => format!("bean-shaped, aspect {:.2}", structure.aspect),
    };
    format!("{} \u{b5}m thick, {shape}", brief(structure.diameter_um))
}

/// The parts of a mesh in one of some roles: how many triangles, and from which file. `None` without
/// any.
fn of_mesh(mesh: &FiberMesh, roles: &[MeshRole]) -> Option<String> {
    let wanted = |part: &&u32| {
        let role = mesh.roles.get(**part as usize);
        role.is_some_and(|role| roles.contains(role))
    };
    let count = mesh.content.mesh().part.iter().filter(wanted).count();
    let file = Path::new(&mesh.file).file_name()?.to_string_lossy();
    (count > 0).then(|| format!("{count} triangles of {file}"))
}

fn cuticle(structure: &Structure) -> String {
    if let Some(mesh) = &structure.mesh {
        let triangles = of_mesh(mesh, &[MeshRole::Cuticle, MeshRole::Riser]);
        return format!("cuticle: {}", triangles.as_deref().unwrap_or("none"));
    }
    let cuticle = &structure.cuticle;
    if cuticle.pattern == CuticlePattern::Smooth {
        return "cuticle: smooth".to_owned();
    }
    let margin = match cuticle.margin {
        Margin::Smooth => "",
        Margin::Crenate => " with crenate margins",
        Margin::Rippled => " with rippled margins",
        Margin::Scalloped => " with scalloped margins",
        Margin::Dentate => " with dentate margins",
    };
    format!(
        "cuticle: {}{margin}, {} round, pitch {} \u{b5}m, step {} \u{b5}m, tilt {:.1}\u{b0}",
        cuticle.pattern.name().replace('-', " "),
        cuticle.around,
        brief(cuticle.pitch_um),
        brief(cuticle.height_um),
        tilt_deg(structure)
    )
}

fn medulla(structure: &Structure, air: f64) -> String {
    let medulla = &structure.medulla;
    let inside = if medulla.void_ior < 1.1 {
        "air"
    } else {
        "flooded voids"
    };
    if let Some(mesh) = &structure.mesh {
        let triangles = of_mesh(mesh, &[MeshRole::Medulla, MeshRole::Void]);
        let mut text = format!("medulla: {}", triangles.as_deref().unwrap_or("none"));
        if air > 0.0 {
            text += &format!(", {:.0} % {inside}", 100.0 * air);
        }
        return text;
    }
    if medulla.kind == MedullaKind::None || medulla.ratio <= 0.0 {
        return "medulla: none".to_owned();
    }
    let runs = match medulla.continuity {
        Continuity::Continuous => "",
        Continuity::Interrupted => "interrupted ",
        Continuity::Fragmentary => "fragmentary ",
    };
    let kind = medulla.kind.name().replace('-', " ");
    let index = medulla.ratio;
    let mut text = format!("medulla: {runs}{kind}, index {index:.2}");
    if air > 0.0 {
        text += &format!(", {:.0} % {inside}", 100.0 * air);
    }
    text
}

/// Two decimals at most.
fn brief(value: f64) -> String {
    ((100.0 * value).round() / 100.0).to_string()
}
