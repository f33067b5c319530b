//! Meshes that are fibers, and meshes that are not.

use super::solid::Solid;
use super::topology::close;
use super::twist::mesh_of;
use crate::fiber::tests::all;
use crate::fiber::{Fiber, MeshPart, Region};
use crate::sampling::Rng;
use crate::species::{FiberMesh, Structure};
use glam::DVec3;
use rayon::prelude::*;

fn as_mesh(parts: &[MeshPart], period_um: f64) -> FiberMesh {
    mesh_of(parts, period_um, "test.glb")
}

fn remodeled(fiber: &Fiber) -> Fiber {
    let structure = Structure {
        mesh: Some(as_mesh(&fiber.mesh(), fiber.period_um())),
        ..fiber.structure().clone()
    };
    Fiber::build(&structure, 0).unwrap()
}

/// Own exports are closed, match at the ends, and hold the same regions.
#[test]
fn own_meshes_are_the_fibers_they_came_from() {
    let few = ["glass", "mink under", "chinchilla", "flat seal"];
    for (name, fiber) in all().into_iter().filter(|(name, _)| few.contains(name)) {
        let mesh = remodeled(&fiber);
        assert_eq!(mesh.warnings(), [""; 0], "{name}");
        let reach = 1.05 * fiber.bounding_radius_um();
        let n = 5_000;
        let mut differ = 0;
        let mut seen = [0; Region::COUNT];
        for k in 0..n {
            let mut rng = Rng::new(3, k);
            let mut random = |scale: f64| scale * (2.0 * rng.uniform() - 1.0);
            let p = DVec3::new(
                random(reach),
                random(reach),
                random(3.0 * fiber.period_um()),
            );
            let region = fiber.region_at(p);
            seen[region as usize] += 1;
            differ += u64::from(mesh.region_at(p) != region);
        }
        // Flat pieces cut off slivers: 1e-4 of the volume of cylinders, some more of round voids.
        assert!(differ < n / 200, "{name}: {differ} of {n} differ, {seen:?}");
        assert!(seen[Region::Outside as usize] > 0);
    }
}

/// Every export of the library is closed in single precision: what is written can be baked.
#[test]
fn exports_of_the_library_are_closed() {
    let all: Vec<_> = crate::species::ids().collect();
    let wrong: Vec<String> = (all.into_par_iter())
        .flat_map_iter(|id| {
            let species = crate::species::load(id, &[]).unwrap();
            let classes = species.classes.into_iter();
            classes.map(move |mut class| {
                // The widest medulla of a class is as a rule that of its last station but one.
                let count = class.stations.len();
                let station = class.stations.swap_remove(count.saturating_sub(2));
                (format!("{id} {}", class.name), station)
            })
        })
        .filter_map(|(name, station)| {
            let straight = Structure {
                twist_turns_per_cm: 0.0,
                ..station.structure
            };
            let fiber = Fiber::build(&straight, 1).unwrap();
            let mesh = as_mesh(&fiber.mesh(), fiber.period_um());
            let is_medium = fiber.medulla.medium.is_some();
            let solid = Solid::new(&mesh, is_medium, 0.0);
            let closed = solid.and_then(|mut solid| close(&mut solid)).err();
            closed.map(|error| format!("{name} {}: {error}", station.at))
        })
        .collect();
    assert_eq!(wrong, [""; 0]);
}
