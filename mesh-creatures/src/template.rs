//! The quads of a plan: a surface whose every vertex has its counterpart on every other individual of the plan.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use mesh_core::{Point3, PolygonSoup};

use crate::cage::{middle, Cage, Mark};
use crate::individual::Individual;
use crate::plan::Plan;
use crate::subdivision::{limit, Refinement};

/// The quads of an individual at one fineness, closed and of genus 0.
#[derive(Clone, Debug)]
pub struct Template {
    /// Vertices and quads, which turn outwards.
    pub soup: PolygonSoup,
    /// For each corner of each face its texture coordinates, in 0..1: every quad of the control mesh has a tile.
    pub uvs: Vec<[[f64; 2]; 4]>,
    /// For each face the row of its part.
    pub parts: Vec<usize>,
    /// The names of the parts.
    pub part_names: Vec<String>,
    /// Named places, so that the first few are far apart.
    pub places: Vec<Place>,
}

/// A named place of a template.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Its name, such as `left ear tip`.
    pub name: String,
    /// The vertex that is there.
    pub vertex: usize,
    /// Row of the part that it belongs to.
    pub part: usize,
}

impl Template {
    /// The surface of `individual`, with the quads of its control mesh split in four `n_splits` times.
    ///
    /// Vertices lie where they end when the control mesh is subdivided for ever, so that all finenesses lie on one smooth
    /// surface and each has the vertices of the coarser ones, in the same rows. Without a split, places that are middles
    /// of quads or of edges are left out.
    pub fn new(individual: &Individual, n_splits: usize) -> Self {
        let cage = individual.cage();
        let mut uvs = tiles(cage.faces.len());
        let mut refined = cage;
        for _ in 0..n_splits {
            refined = refined.refined();
            uvs = uvs.iter().flat_map(split_tile).collect();
        }
        let places = places(&refined, &order(individual.plan()));
        Self {
            soup: PolygonSoup {
                positions: limit(&refined.positions, &refined.faces),
                faces: refined.faces.iter().map(|f| f.to_vec()).collect(),
            },
            uvs,
            parts: refined.parts,
            part_names: refined.part_names,
            places,
        }
    }

    /// An OBJ file with texture coordinates, and a group for each part.
    pub fn to_obj(&self) -> String {
        let mut obj = String::from("# A creature built in code: quads over a smooth surface\n");
        write_positions(&mut obj, &self.soup.positions);
        let (rows, corners) = self.uv_rows();
        for [u, v] in rows {
            let _ = writeln!(obj, "vt {u:.6} {v:.6}");
        }
        for (part, name) in self.part_names.iter().enumerate() {
            let _ = writeln!(obj, "g {}", name.replace(' ', "_"));
            let of_part = (0..self.soup.faces.len()).filter(|&f| self.parts[f] == part);
            for f in of_part {
                let pairs = self.soup.faces[f].iter().zip(&corners[f]);
                let text = pairs.map(|(v, vt)| format!(" {}/{}", v + 1, vt + 1));
                let _ = writeln!(obj, "f{}", text.collect::<String>());
            }
        }
        obj
    }

    /// Every texture coordinate once, and for each corner its row: two faces share one where they share the vertex.
    fn uv_rows(&self) -> (Vec<[f64; 2]>, Vec<Vec<usize>>) {
        let mut rows = Vec::new();
        let mut row_of: BTreeMap<(u32, [u64; 2]), usize> = BTreeMap::new();
        let mut corners = Vec::with_capacity(self.uvs.len());
        for (face, uvs) in self.soup.faces.iter().zip(&self.uvs) {
            let row = |(&v, uv): (&u32, &[f64; 2])| {
                *row_of.entry((v, uv.map(f64::to_bits))).or_insert_with(|| {
                    rows.push(*uv);
                    rows.len() - 1
                })
            };
            corners.push(face.iter().zip(uvs).map(row).collect());
        }
        (rows, corners)
    }
}

pub(crate) fn write_positions(obj: &mut String, positions: &[Point3]) {
    for p in positions {
        let _ = writeln!(obj, "v {:.7} {:.7} {:.7}", p.x, p.y, p.z);
    }
}

/// The smooth surface of a control mesh, with quads split in four `n_splits` times.
pub(crate) fn smooth(cage: &Cage, n_splits: usize) -> PolygonSoup {
    let (mut positions, mut faces) = (cage.positions.clone(), cage.faces.clone());
    for _ in 0..n_splits {
        let refinement = Refinement::new(positions.len(), &faces);
        positions = refinement.apply(&positions);
        faces = refinement.faces;
    }
    PolygonSoup {
        positions: limit(&positions, &faces),
        faces: faces.iter().map(|f| f.to_vec()).collect(),
    }
}

/// Part of a tile's side that is left free on each side of it.
const TILE_MARGIN: f64 = 1.0 / 16.0;

/// The corners of a tile for each of `n` quads, in rows of a square.
fn tiles(n: usize) -> Vec<[[f64; 2]; 4]> {
    let across = (n as f64).sqrt().ceil() as usize;
    let side = 1.0 / across as f64;
    let tile = |f: usize| {
        let [u, v] = [f % across, f / across].map(|k| (k as f64 + TILE_MARGIN) * side);
        let wide = side * (1.0 - 2.0 * TILE_MARGIN);
        [[u, v], [u + wide, v], [u + wide, v + wide], [u, v + wide]]
    };
    (0..n).map(tile).collect()
}

/// The tiles of the four quads that a quad is split into.
fn split_tile(corners: &[[f64; 2]; 4]) -> [[[f64; 2]; 4]; 4] {
    let mean = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|i| 0.5 * (a[i] + b[i]));
    let middle = mean(corners[0], corners[2]);
    [0, 1, 2, 3].map(|k| {
        let [at, next, last] = [k, k + 1, k + 3].map(|j| corners[j % 4]);
        [at, mean(at, next), middle, mean(last, at)]
    })
}

/// The marked places, in order.
fn places(cage: &Cage, order: &[usize]) -> Vec<Place> {
    let place = |&k: &usize| Place {
        name: cage.marks[k].name.clone(),
        vertex: cage.marks[k].element[0] as usize,
        part: cage.marks[k].part,
    };
    let is_vertex = |k: &&usize| cage.marks[**k].element.len() == 1;
    order.iter().filter(is_vertex).map(place).collect()
}

/// The rows of a plan's places: first the farthest from their mean, then always the farthest from all before it, on the
/// template at rest, where the end of something counts as twice as far.
fn order(plan: Plan) -> Vec<usize> {
    let cage = Individual::template(plan).cage().refined();
    let place = |mark: &Mark| cage.positions[mark.element[0] as usize];
    let points: Vec<Point3> = cage.marks.iter().map(place).collect();
    let mean = middle(points.iter().copied());
    let mut distances: Vec<f64> = points.iter().map(|p| (p - mean).norm()).collect();
    let mut order: Vec<usize> = Vec::with_capacity(points.len());
    let weight = |k: usize| if cage.marks[k].is_tip { 2.0 } else { 1.0 };
    while order.len() < points.len() {
        let left = (0..points.len()).filter(|k| !order.contains(k));
        // Left and right are equally far but for rounding: then the right, which was marked first.
        let farther = |best: usize, k: usize| {
            if weight(k) * distances[k] > weight(best) * distances[best] + 1e-9 {
                k
            } else {
                best
            }
        };
        let next = left.reduce(farther).unwrap_or(0);
        if order.is_empty() {
            distances.fill(f64::INFINITY);
        }
        order.push(next);
        for (d, p) in distances.iter_mut().zip(&points) {
            *d = d.min((p - points[next]).norm());
        }
    }
    order
}
