//! The two sides of a body.

use crate::math::ease::smoothstep;
use glam::Vec3;

/// Which places of a body are mirror images of each other.
///
/// A body lies on both sides of a plane. A head that is turned has one of its own, and on the neck the one passes
/// into the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Mirror {
    body: Plane,
    head: Option<Head>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Plane {
    origin: Vec3,
    /// To one side, unit.
    normal: Vec3,
}

#[derive(Clone, Debug, PartialEq)]
struct Head {
    plane: Plane,
    /// Along the neck toward the head, unit.
    along: Vec3,
    /// Way along the neck from the plane's origin where the head's plane begins to count, and where it alone does.
    from: [f32; 2],
}

impl Plane {
    /// From a place to its mirror image.
    fn across(&self, place: Vec3) -> Vec3 {
        -2.0 * (place - self.origin).dot(self.normal) * self.normal
    }
}

impl Mirror {
    /// A body that is straight.
    ///
    /// * `origin`: in its middle plane. * `side`: across it, unit.
    pub fn new(origin: Vec3, side: Vec3) -> Self {
        let body = Plane {
            origin,
            normal: side,
        };
        Self { body, head: None }
    }

    /// The same with a head that is turned.
    ///
    /// * `origin`, `side`: of the head's own middle plane, to the same side as that of the body.
    /// * `along`: the direction of the neck, unit; `from`: way along it, from `origin`, where the head's plane
    ///   begins to count, and where it alone does, meters, ascending.
    pub fn with_head(self, origin: Vec3, side: Vec3, along: Vec3, from: [f32; 2]) -> Self {
        let plane = Plane {
            origin,
            normal: side,
        };
        let head = Some(Head { plane, along, from });
        Self { head, ..self }
    }

    /// The place on the one side that a place of the other side is the mirror image of, and the mirrored normal;
    /// `None` on that side itself.
    pub fn fold(&self, place: Vec3, normal: Vec3) -> Option<(Vec3, Vec3)> {
        let head = self.head.as_ref().map(|head| {
            let along = (place - head.plane.origin).dot(head.along);
            (head.plane, smoothstep(head.from[0], head.from[1], along))
        });
        let blend = |of: &dyn Fn(&Plane) -> Vec3| match &head {
            Some((plane, share)) => of(&self.body).lerp(of(plane), *share),
            None => of(&self.body),
        };
        let side = blend(&|plane| plane.normal);
        let across = blend(&|plane| plane.across(place));
        if across.dot(side) <= 0.0 {
            return None;
        }
        let turned = blend(&|plane| normal - 2.0 * normal.dot(plane.normal) * plane.normal);
        Some((place + across, turned.normalize_or(normal)))
    }
}

#[cfg(test)]
mod tests {
    use crate::skin;

    /// Mirror images of the body's right side are its left side, but for the tail, which lies on one side.
    #[test]
    fn the_other_side_of_the_body_is_its_mirror_image() {
        let skin = skin::load("body").unwrap();
        let mirror = skin.mirror.clone().unwrap();
        let points = skin.positions.iter().zip(&skin.normals);
        let (mut folded, mut off) = (0, 0);
        for (&p, &n) in points.step_by(17) {
            let Some((q, m)) = mirror.fold(p, n) else {
                continue;
            };
            assert!(
                mirror
                    .fold(q, m)
                    .is_none_or(|(back, _)| back.distance(q) < 0.006)
            );
            let all = skin.positions.iter().zip(&skin.normals);
            let near = all.min_by(|a, b| a.0.distance(q).total_cmp(&b.0.distance(q)));
            let (at, normal) = near.unwrap();
            folded += 1;
            off += usize::from(at.distance(q) > 0.005 || normal.dot(m) < 0.7);
        }
        assert!(folded > 300, "{folded}");
        assert!(off * 20 < folded, "{off} of {folded}");
    }
}
