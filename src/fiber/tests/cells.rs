//! The walk from cell to cell meets what a search among all bodies meets.

use super::super::medulla::Voids;
use super::super::{Fiber, Region};
use super::kinds;
use super::walk::launch;
use crate::sampling::Rng;
use glam::DVec3;

/// Where a straight line passes voids longer than rounding, and the normals where it enters them.
fn chords(fiber: &Fiber, mut p: DVec3, dir: DVec3) -> Vec<(f64, f64, DVec3)> {
    let (mut region, mut from, mut way, mut chords) = (Region::Outside, None, 0.0, Vec::new());
    let mut begin = (0.0, DVec3::ZERO);
    while let Some(hit) = fiber.next_hit(p, dir, region, from) {
        p += hit.t * dir;
        way += hit.t;
        if hit.to == Region::Void {
            begin = (way, hit.normal);
        } else if region == Region::Void && way > begin.0 + 1e-3 {
            chords.push((begin.0, way, begin.1));
        }
        (region, from) = (hit.to, Some(hit.state));
    }
    chords
}

#[test]
fn cells_are_the_bodies_that_they_stand_for() {
    let mut seen = 0;
    for (name, structure) in kinds::structures() {
        let fiber = Fiber::build(&structure, 7).unwrap();
        let mut plain = fiber.clone();
        let Voids::Bodies(bodies) = &mut plain.medulla.voids else {
            continue;
        };
        if !bodies.fill() {
            continue;
        }
        seen += 1;
        **bodies = (**bodies).clone().with_cells(None);
        let mut count = 0;
        for path in 0..6000 {
            let (p, dir) = launch(&fiber, &mut Rng::new(51, path));
            let (walked, searched) = (chords(&fiber, p, dir), chords(&plain, p, dir));
            assert_eq!(walked.len(), searched.len(), "{name} {path}");
            for (a, b) in walked.iter().zip(&searched) {
                let off = (a.0 - b.0).abs().max((a.1 - b.1).abs());
                assert!(off < 1e-4, "{name} {path}: {a:?} {b:?}");
                assert!((a.2 - b.2).length() < 1e-4, "{name} {path}: {a:?} {b:?}");
            }
            count += walked.len();
        }
        assert!(count > 10_000, "{name}: {count}");
    }
    // The lattice and the S channel.
    assert_eq!(seen, 2);
}
