//! The control mesh of a creature: closed, all quads, made by drawing patches of faces out into tubes.

use mesh_core::{Point3, Vector3};

use crate::skin::Skin;
use crate::subdivision::Refinement;

/// A control mesh with its parts, skinning weights and marked places.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cage {
    pub(crate) positions: Vec<Point3>,
    pub(crate) skins: Vec<Skin>,
    pub(crate) faces: Vec<[u32; 4]>,
    /// For each face the row of its part.
    pub(crate) parts: Vec<usize>,
    pub(crate) part_names: Vec<String>,
    pub(crate) marks: Vec<Mark>,
    pub(crate) choices: Choices,
}

/// What was chosen by where things are while a control mesh was built.
///
/// The template chooses, all others do as it did: else another individual's proportions might choose otherwise, and its
/// vertices would not be those of the template.
#[derive(Clone, Debug, Default)]
pub(crate) struct Choices {
    made: Vec<Vec<usize>>,
    /// Those of the template, for all others.
    given: Option<Vec<Vec<usize>>>,
}

impl Choices {
    /// To do as was done here.
    pub(crate) fn followed(self) -> Self {
        Self {
            made: Vec::new(),
            given: Some(self.made),
        }
    }

    fn make(&mut self, choose: impl FnOnce() -> Vec<usize>) -> Vec<usize> {
        let choice = match &self.given {
            Some(given) => given[self.made.len()].clone(),
            None => choose(),
        };
        self.made.push(choice.clone());
        choice
    }
}

/// A named place.
#[derive(Clone, Debug)]
pub(crate) struct Mark {
    pub(crate) name: String,
    /// The vertices of the vertex, edge or face whose middle it is.
    pub(crate) element: Vec<u32>,
    pub(crate) part: usize,
    /// Whether it is the end of something.
    pub(crate) is_tip: bool,
}

/// An elliptic ring across a tube.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    pub(crate) center: Point3,
    /// Half axes of the ellipse that the smooth surface comes close to; `a × b` points along the tube.
    pub(crate) a: Vector3,
    pub(crate) b: Vector3,
    pub(crate) skin: Skin,
}

impl Section {
    /// A ring across `direction`, whose first half axis, of length `radii[0]`, points to `side` as nearly as it can.
    pub(crate) fn across(
        center: Point3,
        direction: Vector3,
        side: Vector3,
        radii: [f64; 2],
        skin: &Skin,
    ) -> Self {
        let d = unit(direction);
        let a = unit(side - d * d.dot(&side));
        Self {
            center,
            a: a * radii[0],
            b: d.cross(&a) * radii[1],
            skin: skin.clone(),
        }
    }

    /// The control points of a ring of `n`, the first on the first axis or half a step from it.
    ///
    /// A closed cubic B-spline over `n` even points of a circle has its knots at `(2 + cos 2π/n) / 3` of the radius.
    fn ring(&self, n: usize, starts_on_axis: bool) -> Vec<Point3> {
        let step = std::f64::consts::TAU / n as f64;
        let start = if starts_on_axis { 0.0 } else { step / 2.0 };
        let widening = 3.0 / (2.0 + step.cos());
        let point = |k: usize| {
            let (sin, cos) = (start + step * k as f64).sin_cos();
            self.center + (self.a * cos + self.b * sin) * widening
        };
        (0..n).map(point).collect()
    }
}

impl Cage {
    /// The row of the part of this name, which is added if it is new.
    pub(crate) fn part(&mut self, name: &str) -> usize {
        match self.part_names.iter().position(|n| n == name) {
            Some(row) => row,
            None => {
                self.part_names.push(name.to_owned());
                self.part_names.len() - 1
            }
        }
    }

    /// Two patches of 2 × 2 quads back to back on one ring of eight, the first of which faces along it.
    pub(crate) fn pillow(&mut self, section: &Section, part: usize) -> [Vec<usize>; 2] {
        let first = self.positions.len() as u32;
        for p in section.ring(8, true) {
            self.add_vertex(p, &section.skin);
        }
        let front = self.add_vertex(section.center, &section.skin);
        let back = self.add_vertex(section.center, &section.skin);
        let ring = |k: u32| first + k % 8;
        let quad = |k: u32| [front, ring(2 * k), ring(2 * k + 1), ring(2 * k + 2)];
        let turned = |k: u32| [back, ring(2 * k + 2), ring(2 * k + 1), ring(2 * k)];
        let fronts = (0..4).map(|k| self.add_face(quad(k), part)).collect();
        let backs = (0..4).map(|k| self.add_face(turned(k), part)).collect();
        [fronts, backs]
    }

    fn add_vertex(&mut self, position: Point3, skin: &Skin) -> u32 {
        self.positions.push(position);
        self.skins.push(skin.clone());
        self.positions.len() as u32 - 1
    }

    fn add_face(&mut self, face: [u32; 4], part: usize) -> usize {
        self.faces.push(face);
        self.parts.push(part);
        self.faces.len() - 1
    }

    /// Draws a patch of faces out to `section`: the patch becomes its end, a ring of quads its side, which is returned.
    ///
    /// # Panics
    /// If the patch is no disc with at most one vertex inside.
    pub(crate) fn extrude(
        &mut self,
        patch: &[usize],
        section: &Section,
        part: usize,
    ) -> Vec<usize> {
        let loop_ = self.boundary_loop(patch);
        let n = loop_.len();
        let center = middle(loop_.iter().map(|&v| self.positions[v as usize]));
        // A patch of 2 × 2 has a vertex in the middle of each side, a strip has none at its ends.
        let ring = section.ring(n, patch.len() == 4 && n == 8);
        let positions = &self.positions;
        let agreement = |shift: usize| -> f64 {
            let pair = |k: usize| {
                let old = positions[loop_[k] as usize] - center;
                old.dot(&(ring[(k + shift) % n] - section.center))
            };
            (0..n).map(pair).sum()
        };
        let best = || (0..n).max_by(|&s, &t| agreement(s).total_cmp(&agreement(t)));
        let shift = self.choices.make(|| best().into_iter().collect())[0];
        let new: Vec<u32> = (0..n)
            .map(|k| self.add_vertex(ring[(k + shift) % n], &section.skin))
            .collect();
        self.move_patch(patch, [&loop_, &new], section);
        patch.iter().for_each(|&f| self.parts[f] = part);
        (0..n)
            .map(|k| {
                let next = (k + 1) % n;
                self.add_face([loop_[k], loop_[next], new[next], new[k]], part)
            })
            .collect()
    }

    /// Hangs the faces of a patch onto the new ring; the vertex inside, which no other face has, goes along.
    fn move_patch(&mut self, patch: &[usize], [old, new]: [&[u32]; 2], section: &Section) {
        let mut inner: Vec<u32> = Vec::new();
        for &f in patch {
            for corner in &mut self.faces[f] {
                match old.iter().position(|o| o == corner) {
                    Some(row) => *corner = new[row],
                    None => inner.push(*corner),
                }
            }
        }
        inner.dedup();
        assert!(inner.len() <= 1, "at most one vertex inside a patch");
        for v in inner {
            self.positions[v as usize] = section.center;
            self.skins[v as usize] = section.skin.clone();
        }
    }

    /// The boundary of a patch, with the patch on its left.
    fn boundary_loop(&self, patch: &[usize]) -> Vec<u32> {
        let edges: Vec<[u32; 2]> = patch
            .iter()
            .flat_map(|&f| (0..4).map(move |k| [self.faces[f][k], self.faces[f][(k + 1) % 4]]))
            .collect();
        let outer: Vec<[u32; 2]> = edges
            .iter()
            .copied()
            .filter(|&[a, b]| !edges.contains(&[b, a]))
            .collect();
        let mut loop_ = vec![outer[0][0]];
        let mut at = outer[0][1];
        while at != loop_[0] {
            loop_.push(at);
            let next = outer.iter().find(|[a, _]| *a == at);
            at = next.expect("the boundary of a patch is closed")[1];
        }
        assert_eq!(loop_.len(), outer.len(), "a patch is a disc");
        loop_
    }

    /// The middle of the boundary of a patch.
    pub(crate) fn patch_center(&self, patch: &[usize]) -> Point3 {
        let loop_ = self.boundary_loop(patch);
        middle(loop_.iter().map(|&v| self.positions[v as usize]))
    }

    pub(crate) fn face_center(&self, f: usize) -> Point3 {
        middle(self.faces[f].iter().map(|&v| self.positions[v as usize]))
    }

    /// The face of `faces` whose middle lies farthest towards `direction`.
    pub(crate) fn facing(&mut self, faces: &[usize], direction: Vector3) -> usize {
        self.ranked(faces, direction)[0]
    }

    /// `faces`, those that lie farthest towards `direction` first.
    pub(crate) fn ranked(&mut self, faces: &[usize], direction: Vector3) -> Vec<usize> {
        let along = |cage: &Self, f: usize| cage.face_center(f).coords.dot(&direction);
        let values: Vec<f64> = faces.iter().map(|&f| -along(self, f)).collect();
        self.sorted_by(faces, &values)
    }

    /// The `n` of `faces` whose middles are closest to `point`.
    pub(crate) fn nearest(&mut self, faces: &[usize], point: &Point3, n: usize) -> Vec<usize> {
        let away = |f: &usize| (self.face_center(*f) - point).norm();
        let values: Vec<f64> = faces.iter().map(away).collect();
        let mut sorted = self.sorted_by(faces, &values);
        sorted.truncate(n);
        sorted
    }

    /// The vertices of the newest ring of `n`, those that lie farthest towards `direction` first.
    pub(crate) fn newest(&mut self, n: usize, direction: Vector3) -> Vec<usize> {
        let last = self.positions.len();
        let rows: Vec<usize> = (last - n..last).collect();
        let values: Vec<f64> = rows
            .iter()
            .map(|&v| -self.positions[v].coords.dot(&direction))
            .collect();
        self.sorted_by(&rows, &values)
    }

    /// `rows` by their values, in the order of the template.
    fn sorted_by(&mut self, rows: &[usize], values: &[f64]) -> Vec<usize> {
        self.choices.make(|| {
            let mut order: Vec<usize> = (0..rows.len()).collect();
            order.sort_by(|&j, &k| values[j].total_cmp(&values[k]));
            order.into_iter().map(|k| rows[k]).collect()
        })
    }

    /// Names the middle of a patch: its vertex inside, its edge inside, or the middle of its one face.
    pub(crate) fn mark(&mut self, name: &str, patch: &[usize], is_tip: bool) {
        let first = self.faces[patch[0]];
        let in_all = |v: &u32| patch.iter().all(|&f| self.faces[f].contains(v));
        let element: Vec<u32> = first.iter().copied().filter(in_all).collect();
        assert!(matches!(element.len(), 1 | 2 | 4), "a patch has one middle");
        self.marks.push(Mark {
            name: name.to_owned(),
            element,
            part: self.parts[patch[0]],
            is_tip,
        });
    }

    /// Every quad split in four, once, by Catmull and Clark's rules; face `f` becomes the faces `4f` to `4f + 3`.
    pub(crate) fn refined(&self) -> Self {
        let refinement = Refinement::new(self.positions.len(), &self.faces);
        let marks = self.marks.iter().map(|mark| Mark {
            element: vec![refinement.row_of_middle(&mark.element)],
            ..mark.clone()
        });
        Self {
            positions: refinement.apply(&self.positions),
            skins: refinement.blend(&self.skins),
            marks: marks.collect(),
            parts: self.parts.iter().flat_map(|&p| [p; 4]).collect(),
            part_names: self.part_names.clone(),
            choices: self.choices.clone(),
            faces: refinement.faces,
        }
    }
}

/// The faces that `faces` have become in [`Cage::refined`].
pub(crate) fn children(faces: &[usize]) -> Vec<usize> {
    faces.iter().flat_map(|f| 4 * f..4 * f + 4).collect()
}

pub(crate) fn middle(points: impl ExactSizeIterator<Item = Point3>) -> Point3 {
    let n = points.len() as f64;
    Point3::from(points.map(|p| p.coords).sum::<Vector3>() / n)
}

/// `v` with length 1; the zero vector stays.
pub(crate) fn unit(v: Vector3) -> Vector3 {
    v.try_normalize(0.0).unwrap_or(v)
}
