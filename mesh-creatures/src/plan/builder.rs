//! What plans are written with: tubes of sections, drawn out of patches of a control mesh.

use mesh_core::{Point3, Vector3};

use super::Body;
use crate::cage::{Cage, Section};
use crate::skeleton::{Freedom, Skeleton};
use crate::skin::Skin;

pub(super) fn point(x: f64, y: f64, z: f64) -> Point3 {
    Point3::new(x, y, z)
}

pub(super) fn vector(x: f64, y: f64, z: f64) -> Vector3 {
    Vector3::new(x, y, z)
}

/// Half of each.
pub(super) fn joint(one: usize, other: usize) -> Skin {
    Skin::between(one, other, 0.5)
}

/// The right or the left of a creature that looks along +Z.
#[derive(Clone, Copy)]
pub(super) struct Side {
    pub(super) name: &'static str,
    /// Sign of x.
    pub(super) sign: f64,
    /// The face that grows there.
    pub(super) face: usize,
}

/// A body that is being built.
#[derive(Default)]
pub(super) struct Builder {
    pub(super) cage: Cage,
    pub(super) skeleton: Skeleton,
}

impl Builder {
    /// A builder that chooses as `template` did.
    pub(super) fn following(template: Self) -> Self {
        let choices = template.cage.choices.followed();
        Self {
            cage: Cage {
                choices,
                ..Cage::default()
            },
            ..Self::default()
        }
    }

    pub(super) fn bone(&mut self, parent: usize, pivot: Point3, freedoms: &[Freedom]) -> usize {
        self.skeleton.add(Some(parent), pivot, freedoms)
    }

    pub(super) fn root(&mut self, pivot: Point3) -> usize {
        self.skeleton.add(None, pivot, &[])
    }

    /// Two patches back to back, the first of which is then drawn out through the other sections: end, start and the
    /// rings between.
    pub(super) fn trunk(&mut self, sections: &[Section], part: &str) -> Trunk {
        let part = self.cage.part(part);
        let [end, start] = self.cage.pillow(&sections[0], part);
        let rings = sections[1..].iter();
        let rings = rings
            .map(|section| self.cage.extrude(&end, section, part))
            .collect();
        Trunk { start, rings, end }
    }

    /// Draws a patch out through sections; the rings of faces between them.
    pub(super) fn tube(
        &mut self,
        patch: &[usize],
        sections: &[Section],
        part: &str,
    ) -> Vec<Vec<usize>> {
        let part = self.cage.part(part);
        sections
            .iter()
            .map(|section| self.cage.extrude(patch, section, part))
            .collect()
    }

    /// The faces of a ring that lie farthest towards `direction` on the left, and towards its mirror image on the right.
    pub(super) fn sides(&mut self, ring: &[usize], direction: Vector3) -> [Side; 2] {
        [("right", -1.0), ("left", 1.0)].map(|(name, sign)| {
            let towards = vector(sign * direction.x, direction.y, direction.z);
            Side {
                name,
                sign,
                face: self.cage.facing(ring, towards),
            }
        })
    }

    pub(super) fn mark(&mut self, name: &str, patch: &[usize]) {
        self.cage.mark(name, patch);
    }

    pub(super) fn finished(self) -> Body {
        Body {
            cage: self.cage,
            skeleton: self.skeleton,
        }
    }
}

/// The faces of a trunk.
pub(super) struct Trunk {
    pub(super) start: Vec<usize>,
    pub(super) rings: Vec<Vec<usize>>,
    pub(super) end: Vec<usize>,
}

/// A ring across `direction` whose first half axis points to +X.
pub(super) fn ring(center: Point3, direction: Vector3, radii: [f64; 2], skin: &Skin) -> Section {
    Section::across(center, direction, Vector3::x(), radii, skin)
}
