//! What plans are written with: tubes of sections, drawn out of patches of a control mesh.

use mesh_core::{Point3, Vector3};

use super::Body;
use crate::cage::{unit, Cage, Section};
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

    /// Makes the faces a part of this name.
    pub(super) fn rename(&mut self, faces: &[usize], part: &str) {
        let part = self.cage.part(part);
        faces.iter().for_each(|&face| self.cage.parts[face] = part);
    }

    /// Names the middle of a patch.
    pub(super) fn mark(&mut self, name: &str, patch: &[usize]) {
        self.cage.mark(name, patch, false);
    }

    /// Names the middle of a patch that is the end of something.
    pub(super) fn tip(&mut self, name: &str, patch: &[usize]) {
        self.cage.mark(name, patch, true);
    }

    /// Names the middle of the two faces of a ring that lie farthest towards `direction`.
    pub(super) fn mark_top(&mut self, name: &str, ring: &[usize], direction: Vector3) {
        let pair = self.cage.ranked(ring, direction);
        self.mark(name, &pair[..2]);
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

/// A stop on the way of a tube: middle, half axes, skin.
pub(super) type Stop = (Point3, [f64; 2], Skin);

/// Rings along a way from `start`, each across the mean of the directions to and from it, with their first half axes
/// towards `side`.
pub(super) fn along(start: Point3, stops: &[Stop], side: Vector3) -> Vec<Section> {
    let mut sections = Vec::with_capacity(stops.len());
    let mut last = start;
    for (k, (center, radii, skin)) in stops.iter().enumerate() {
        let to = unit(center - last);
        let from = stops.get(k + 1).map_or(to, |next| unit(next.0 - center));
        sections.push(Section::across(*center, to + from, side, *radii, skin));
        last = *center;
    }
    sections
}
