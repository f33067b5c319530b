//! The voxels that a straight piece passes through (Amanatides and Woo 1987).

use glam::{DVec3, IVec3};

/// Visits the voxels between two points with the part of the way that lies in each.
///
/// * `from`, `to`: in voxels, where voxel `i` reaches from `i - 0.5` to `i + 0.5`.
/// * `visit(voxel, t0, t1)`: the parts follow one another from 0 to 1 without gap or overlap.
pub(super) fn walk(from: DVec3, to: DVec3, mut visit: impl FnMut(IVec3, f64, f64)) {
    let (from, to) = (from + 0.5, to + 0.5);
    let mut voxel = from.floor().as_ivec3();
    let last = to.floor().as_ivec3();
    let way = to - from;
    // Each crossing brings one coordinate one step nearer to the last voxel's: no rounding of the
    // parts can lead past it.
    let steps = (last - voxel).abs();
    let mut left = steps.to_array();
    let crossing = |axis: usize, voxel: &IVec3| {
        let forward = f64::from(u8::from(way[axis] > 0.0));
        (f64::from(voxel[axis]) + forward - from[axis]) / way[axis]
    };
    let mut next: [f64; 3] = std::array::from_fn(|axis| match left[axis] {
        0 => f64::INFINITY,
        _ => crossing(axis, &voxel),
    });
    let mut t = 0.0;
    loop {
        let axis = (0..3).fold(0, |least, axis| {
            if next[axis] < next[least] {
                axis
            } else {
                least
            }
        });
        if next[axis] == f64::INFINITY {
            break;
        }
        let until = next[axis].clamp(t, 1.0);
        visit(voxel, t, until);
        t = until;
        voxel[axis] += if way[axis] > 0.0 { 1 } else { -1 };
        left[axis] -= 1;
        next[axis] = match left[axis] {
            0 => f64::INFINITY,
            _ => crossing(axis, &voxel),
        };
    }
    visit(voxel, t, 1.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    #[test]
    fn parts_follow_one_another_and_lie_in_their_voxels() {
        let mut rng = Rng::new(3, 0);
        let mut vec = |size: f64| {
            DVec3::from_array(std::array::from_fn(|_| {
                (f64::from(rng.uniform_f32()) - 0.5) * size
            }))
        };
        for i in 0..2000 {
            let from = vec(10.0);
            let mut to = from + vec([0.3, 3.0, 30.0][i % 3]);
            if i % 5 == 0 {
                to.y = from.y;
            }
            let (mut end, mut before) = (0.0, None);
            walk(from, to, |voxel, t0, t1| {
                assert!(t0 == end && t1 >= t0);
                end = t1;
                let middle = from.lerp(to, 0.5 * (t0 + t1)) + 0.5;
                let off = middle - voxel.as_dvec3();
                assert!(
                    off.cmpge(DVec3::splat(-1e-9)).all()
                        && off.cmple(DVec3::splat(1.0 + 1e-9)).all()
                );
                if let Some(before) = before {
                    let step: IVec3 = voxel - before;
                    assert_eq!(step.abs().element_sum(), 1);
                }
                before = Some(voxel);
            });
            assert_eq!(end, 1.0);
        }
    }

    #[test]
    fn a_piece_of_no_length_stays_in_its_voxel() {
        let mut seen = Vec::new();
        walk(DVec3::splat(2.4), DVec3::splat(2.4), |v, a, b| {
            seen.push((v, a, b))
        });
        assert_eq!(seen, [(IVec3::splat(2), 0.0, 1.0)]);
    }
}
