//! What is in a mesh file, in numbers and words.

use std::collections::BTreeMap;
use std::fmt;

use mesh_core::io::{printable, MeshFile};
use mesh_core::{measure, Aabb, HalfedgeMesh, Triangulation};
use serde::Serialize;

use mesh_draping::Seams;

/// What [`Inspection::of`] finds.
#[derive(Debug, Serialize)]
pub(crate) struct Inspection {
    format: &'static str,
    vertices: usize,
    /// Different places among the vertices: fewer where the file is split along seams. What follows is about these.
    places: usize,
    unused_vertices: usize,
    faces: usize,
    faces_by_corners: BTreeMap<usize, usize>,
    degenerate_faces: usize,
    triangles_below_quality_0_1: usize,
    pieces: usize,
    boundary_loops: usize,
    non_manifold_edges: usize,
    /// Handles; none where the surface is not a manifold.
    genus: Option<usize>,
    box_min: [f64; 3],
    box_max: [f64; 3],
    area: f64,
    texture_coordinates: usize,
    normals: usize,
    objects: Vec<Named>,
    groups: Vec<Named>,
    materials: Vec<Named>,
    smoothing_groups: usize,
    morph_targets: usize,
    skins: usize,
    animations: usize,
    references: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Named {
    name: String,
    faces: usize,
}

impl Inspection {
    pub(crate) fn of(file: &MeshFile) -> anyhow::Result<Self> {
        let contents = file.contents();
        file.soup().check()?;
        let n_vertices = file.soup().positions.len();
        let soup = &Seams::EXACT.weld(file.soup().clone()).soup;
        let mesh = HalfedgeMesh::from_faces(soup.positions.len(), &soup.faces)?;
        let positions = soup.positions.iter().copied().collect();
        let triangulation = Triangulation::new(&mesh, &positions);
        let used = mesh
            .vertices()
            .filter(|&v| !mesh.outgoing(v).is_empty())
            .count();
        let unused_vertices = mesh.n_vertices() - used;
        let bounds = Aabb::of(&soup.positions);
        let named = |list: &[mesh_core::io::NamedFaces]| {
            let entry = |n: &mesh_core::io::NamedFaces| Named {
                name: n.name.clone(),
                faces: n.n_faces(),
            };
            list.iter().map(entry).collect()
        };
        let mut faces_by_corners = BTreeMap::new();
        for face in &soup.faces {
            *faces_by_corners.entry(face.len()).or_insert(0) += 1;
        }
        Ok(Self {
            format: file.format().name(),
            vertices: n_vertices,
            places: mesh.n_vertices(),
            unused_vertices,
            faces: mesh.n_faces(),
            faces_by_corners,
            degenerate_faces: mesh
                .faces()
                .filter(|&f| mesh.face_vertices(f).is_empty())
                .count(),
            triangles_below_quality_0_1: triangulation
                .corners(&positions)
                .filter(|&t| measure::triangle_quality(t) < 0.1)
                .count(),
            pieces: triangulation.pieces().n - unused_vertices,
            boundary_loops: mesh.boundary_loops().len(),
            non_manifold_edges: mesh.n_cut_edges(),
            genus: genus(&mesh, triangulation.pieces().n, used, unused_vertices),
            box_min: bounds.min.coords.into(),
            box_max: bounds.max.coords.into(),
            area: measure::triangle_areas(&triangulation, &positions)
                .iter()
                .sum(),
            texture_coordinates: contents.n_uvs,
            normals: contents.n_normals,
            objects: named(&contents.objects),
            groups: named(&contents.groups),
            materials: named(&contents.materials),
            smoothing_groups: contents.n_smoothing_groups,
            morph_targets: contents.n_morph_targets,
            skins: contents.n_skins,
            animations: contents.n_animations,
            references: contents.references.clone(),
        })
    }
}

/// Handles of an orientable surface: `V − E + F + loops = 2 · pieces − 2 g`; none if it is no manifold.
fn genus(mesh: &HalfedgeMesh, n_pieces: usize, n_used: usize, n_unused: usize) -> Option<usize> {
    let n_faces = mesh
        .faces()
        .filter(|&f| !mesh.face_vertices(f).is_empty())
        .count();
    let has_one_fan = |v| fan_size(mesh, v) == mesh.outgoing(v).len();
    let is_manifold = mesh.n_cut_edges() == 0 && mesh.vertices().all(has_one_fan);
    if !is_manifold || n_faces == 0 {
        return None;
    }
    let twice = 2 * (n_pieces - n_unused) as i64
        - (n_used as i64 - mesh.n_edges() as i64
            + n_faces as i64
            + mesh.boundary_loops().len() as i64);
    usize::try_from(twice / 2).ok()
}

/// How many halfedges leave `v` in the fan of its first one; all of them where the surface is a manifold.
fn fan_size(mesh: &HalfedgeMesh, v: mesh_core::VertexId) -> usize {
    let Some(&first) = mesh.outgoing(v).first() else {
        return 0;
    };
    let (mut h, mut n) = (first, 0);
    loop {
        n += 1;
        h = mesh.next(mesh.twin(h));
        if h == first || n > mesh.outgoing(v).len() {
            return n;
        }
    }
}

impl fmt::Display for Inspection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows = [self.elements(), self.surface(), self.extras()];
        rows.iter()
            .flatten()
            .try_for_each(|(name, value)| writeln!(f, "{name:<22}{value}"))
    }
}

type TextRow = (&'static str, String);

impl Inspection {
    fn elements(&self) -> Vec<TextRow> {
        let n_unused = if self.faces > 0 {
            self.unused_vertices
        } else {
            0
        };
        let unused = noted(n_unused, "that no face uses");
        let split = match self.vertices - self.places {
            0 => String::new(),
            _ => format!(" at {} places: split along seams", self.places),
        };
        vec![
            ("format", self.format.to_owned()),
            ("vertices", format!("{}{split}{unused}", self.vertices)),
            ("faces", faces_in_words(self)),
            (
                "box",
                format!("{} to {}", corner(self.box_min), corner(self.box_max)),
            ),
        ]
    }

    fn surface(&self) -> Vec<TextRow> {
        if self.faces == 0 {
            return vec![(
                "",
                "a point cloud: it can be a target, not a source".to_owned(),
            )];
        }
        let skinny = format!(
            "{} with Q_f below 0.1",
            count(self.triangles_below_quality_0_1)
        );
        let genus = self
            .genus
            .map_or("not defined: no manifold".to_owned(), |g| g.to_string());
        vec![
            ("area", format!("{:.6}", self.area)),
            ("skinny triangles", skinny),
            ("pieces", self.pieces.to_string()),
            ("boundary loops", count(self.boundary_loops)),
            ("non-manifold edges", count(self.non_manifold_edges)),
            ("genus", genus),
        ]
    }

    fn extras(&self) -> Vec<TextRow> {
        let references = printable(&self.references.join(", ")).into_owned();
        vec![
            ("texture coordinates", count(self.texture_coordinates)),
            ("normals", count(self.normals)),
            ("smoothing groups", count(self.smoothing_groups)),
            ("objects", names(&self.objects)),
            ("groups", names(&self.groups)),
            ("materials", names(&self.materials)),
            ("morph targets", count(self.morph_targets)),
            ("skins", count(self.skins)),
            ("animations", count(self.animations)),
            (
                "names other files",
                if references.is_empty() {
                    "none".to_owned()
                } else {
                    references
                },
            ),
        ]
    }
}

fn count(n: usize) -> String {
    if n == 0 {
        "none".to_owned()
    } else {
        n.to_string()
    }
}

fn noted(n: usize, what: &str) -> String {
    if n == 0 {
        String::new()
    } else {
        format!(", {n} {what}")
    }
}

fn faces_in_words(inspection: &Inspection) -> String {
    let arity = |(&corners, &n): (&usize, &usize)| match corners {
        3 => format!("{n} triangles"),
        4 => format!("{n} quads"),
        k => format!("{n} with {k} corners"),
    };
    let parts: Vec<String> = inspection.faces_by_corners.iter().map(arity).collect();
    let degenerate = noted(
        inspection.degenerate_faces,
        "without three different corners",
    );
    match parts.as_slice() {
        [] => "none".to_owned(),
        [all] => format!("{all}{degenerate}"),
        several => format!("{}: {}{degenerate}", inspection.faces, several.join(", ")),
    }
}

fn corner([x, y, z]: [f64; 3]) -> String {
    format!("({x:.4}, {y:.4}, {z:.4})")
}

/// The first names and how many there are.
fn names(list: &[Named]) -> String {
    const SHOWN: usize = 6;
    if list.is_empty() {
        return "none".to_owned();
    }
    let shown: Vec<String> = list
        .iter()
        .take(SHOWN)
        .map(|n| format!("{} ({} faces)", printable(&n.name), n.faces))
        .collect();
    let more = if list.len() > SHOWN {
        format!(", {} more", list.len() - SHOWN)
    } else {
        String::new()
    };
    format!("{}{more}", shown.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::{shapes, PolygonSoup};

    fn inspect(soup: &PolygonSoup) -> Inspection {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        mesh_core::io::write_soup(&path, soup).unwrap();
        Inspection::of(&mesh_core::io::read_mesh(&path).unwrap()).unwrap()
    }

    /// A ring of `n` × `n` quads.
    fn torus(n: u32) -> PolygonSoup {
        let mut soup = PolygonSoup::default();
        for i in 0..n {
            for j in 0..n {
                let [a, b] = [i, j].map(|k| std::f64::consts::TAU * f64::from(k) / f64::from(n));
                let r = 2.0 + b.cos();
                soup.positions
                    .push(mesh_core::Point3::new(r * a.cos(), r * a.sin(), b.sin()));
                let at = |i: u32, j: u32| (i % n) * n + j % n;
                soup.faces
                    .push(vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        soup
    }

    #[test]
    fn genus_of_known_surfaces() {
        assert_eq!(inspect(&shapes::prism(5)).genus, Some(0));
        assert_eq!(inspect(&shapes::open_grid(3, 2)).genus, Some(0));
        assert_eq!(inspect(&torus(6)).genus, Some(1));
    }

    #[test]
    fn defects_are_counted() {
        let mut soup = shapes::open_grid(2, 1);
        soup.positions.push(mesh_core::Point3::new(0.5, 0.5, 1.0));
        soup.positions.push(mesh_core::Point3::new(9.0, 9.0, 9.0));
        soup.faces.push(vec![1, 4, 6]);
        let found = inspect(&soup);
        assert_eq!((found.non_manifold_edges, found.genus), (1, None));
        assert_eq!((found.unused_vertices, found.pieces), (1, 1));
        assert_eq!(found.faces_by_corners, BTreeMap::from([(3, 1), (4, 2)]));
        assert!(found.to_string().contains("1 triangles, 2 quads"));
    }

    #[test]
    fn two_fans_at_one_vertex_are_no_manifold() {
        let mut soup = shapes::open_grid(1, 1);
        soup.positions
            .extend([[-1.0, 0.0, 0.0], [-1.0, -1.0, 0.0]].map(mesh_core::Point3::from));
        soup.faces.push(vec![0, 4, 5]);
        assert_eq!(inspect(&soup).genus, None);
    }
}
