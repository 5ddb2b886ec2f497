//! Pairs: a template at rest, and another individual's surface in other triangles.

use std::fmt::{self, Write as _};
use std::str::FromStr;

use mesh_core::measure::triangle_area;
use mesh_core::sampling::{SeededRng, TriangleSampler};
use mesh_core::{Aabb, Point3, PolygonSoup, TriangleBvh, Vector3};
use serde_json::json;

use crate::individual::Individual;
use crate::remesh::{normal, remeshed};
use crate::template::{write_positions, Template};

/// In what state the target's surface is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Triangles, closed.
    Mesh,
    /// Points on the surface with normals, evenly drawn, without noise.
    Cloud,
    /// Triangles with corners of their own, each moved a little.
    Cracked,
    /// The triangles that can be seen from one side, half from the front: an open surface.
    HalfScan,
}

impl Variant {
    /// All there are.
    pub const ALL: [Self; 4] = [Self::Mesh, Self::Cloud, Self::Cracked, Self::HalfScan];

    /// Its name, as on a command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Cloud => "cloud",
            Self::Cracked => "cracked",
            Self::HalfScan => "half-scan",
        }
    }
}

impl fmt::Display for Variant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that no state of a target has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownVariant;

impl fmt::Display for UnknownVariant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("use mesh, cloud, cracked or half-scan")
    }
}

impl std::error::Error for UnknownVariant {}

impl FromStr for Variant {
    type Err = UnknownVariant;

    fn from_str(name: &str) -> Result<Self, UnknownVariant> {
        let named = Self::ALL.into_iter().find(|variant| variant.name() == name);
        named.ok_or(UnknownVariant)
    }
}

/// What is asked of a pair.
#[derive(Clone, Debug)]
pub struct PairConfig {
    /// How often the quads of the control mesh are split in four for the source. 1 gives some 3 000 vertices, 0 some
    /// 800.
    pub n_splits: usize,
    /// Vertices of the target before anything is taken away, or points of a cloud.
    pub n_target_vertices: usize,
    /// State of the target.
    pub variant: Variant,
    /// Number of landmarks; all there are where there are fewer.
    pub n_landmarks: usize,
    /// Parts whose places are no landmarks, such as `tail`.
    pub without: Vec<String>,
    /// Seed of the target's vertices.
    pub seed: u64,
}

impl PairConfig {
    /// A mesh of 8 000 vertices as target of a source of some 3 000, with 16 landmarks.
    pub const fn standard() -> Self {
        Self {
            n_splits: 1,
            n_target_vertices: 8_000,
            variant: Variant::Mesh,
            n_landmarks: 16,
            without: Vec::new(),
            seed: 0,
        }
    }
}

/// A source, a target of another shape in other triangles, and where each vertex of the source truly belongs.
#[derive(Clone, Debug)]
pub struct CreaturePair {
    /// The source.
    pub source: Template,
    /// The target; without faces for a cloud.
    pub target: PolygonSoup,
    /// The closed surface that the target was made from: the target itself, if that is a mesh.
    pub surface: PolygonSoup,
    /// A normal for each vertex of a cloud.
    pub normals: Option<Vec<Vector3>>,
    /// The true place of each vertex of the source, on the smooth surface that the target is an image of.
    pub truth: Vec<Point3>,
    /// Names, vertices of the source and their true places.
    pub landmarks: Vec<TrueLandmark>,
}

/// A place whose counterpart is known.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueLandmark {
    /// Its name.
    pub name: String,
    /// The vertex of the source that is there.
    pub vertex: usize,
    /// Where it truly belongs.
    pub target: Point3,
}

impl CreaturePair {
    /// The pair of two individuals.
    ///
    /// # Panics
    /// If they are of different plans.
    pub fn new(source: &Individual, target: &Individual, config: &PairConfig) -> Self {
        assert_eq!(source.plan(), target.plan(), "individuals of one plan");
        let template = Template::new(source, config.n_splits);
        let truth = Template::new(target, config.n_splits).soup.positions;
        let mut rng = SeededRng::new(config.seed);
        let n = config.n_target_vertices;
        let surface = remeshed(&target.cage(), n, &mut rng);
        let (target, normals) = varied(&surface, n, config.variant, &mut rng);
        let landmarks = landmarks(&template, &truth, config);
        Self {
            source: template,
            target,
            surface,
            normals,
            truth,
            landmarks,
        }
    }

    /// Where each vertex of the source belongs, as a PLY file with the source's quads.
    pub fn truth_ply(&self) -> String {
        ply(
            &PolygonSoup {
                positions: self.truth.clone(),
                faces: self.source.soup.faces.clone(),
            },
            None,
        )
    }

    /// The target as a PLY file, with the normals of a cloud.
    pub fn target_ply(&self) -> String {
        ply(&self.target, self.normals.as_deref())
    }

    /// The closed surface that the target was made from, as an OBJ file.
    pub fn surface_obj(&self) -> String {
        let mut obj =
            String::from("# A creature built in code: another individual, in other triangles\n");
        write_positions(&mut obj, &self.surface.positions);
        for face in &self.surface.faces {
            let corners = face.iter().map(|v| format!(" {}", v + 1));
            let _ = writeln!(obj, "f{}", corners.collect::<String>());
        }
        obj
    }

    /// The landmarks as a file: `{"landmarks": [{"name", "source": {"vertex"}, "target": {"point"}}]}`.
    pub fn landmarks_json(&self) -> String {
        let entry = |l: &TrueLandmark| json!({"name": l.name, "source": {"vertex": l.vertex}, "target": {"point": l.target.coords.as_slice()}});
        let entries: Vec<_> = self.landmarks.iter().map(entry).collect();
        format!("{:#}\n", json!({ "landmarks": entries }))
    }
}

fn landmarks(template: &Template, truth: &[Point3], config: &PairConfig) -> Vec<TrueLandmark> {
    let is_left_out = |part: usize| config.without.contains(&template.part_names[part]);
    let places = template
        .places
        .iter()
        .filter(|place| !is_left_out(place.part));
    let landmark = |place: &crate::template::Place| TrueLandmark {
        name: place.name.clone(),
        vertex: place.vertex,
        target: truth[place.vertex],
    };
    places.take(config.n_landmarks).map(landmark).collect()
}

/// Displacement of the corners of cracked triangles, in longest sides of the box.
const CRACKS: f64 = 5e-4;

fn varied(
    mesh: &PolygonSoup,
    n: usize,
    variant: Variant,
    rng: &mut SeededRng,
) -> (PolygonSoup, Option<Vec<Vector3>>) {
    match variant {
        Variant::Mesh => (mesh.clone(), None),
        Variant::Cloud => {
            let (positions, normals) = cloud(mesh, n, rng);
            (
                PolygonSoup {
                    positions,
                    faces: Vec::new(),
                },
                Some(normals),
            )
        }
        Variant::Cracked => (cracked(mesh, rng), None),
        Variant::HalfScan => (seen(mesh, Vector3::new(0.8, 0.3, 0.5)), None),
    }
}

fn corners(mesh: &PolygonSoup) -> Vec<[Point3; 3]> {
    let corner = |f: &Vec<u32>| [0, 1, 2].map(|k| mesh.positions[f[k] as usize]);
    mesh.faces.iter().map(corner).collect()
}

fn cloud(mesh: &PolygonSoup, n: usize, rng: &mut SeededRng) -> (Vec<Point3>, Vec<Vector3>) {
    let corners = corners(mesh);
    let sampler = TriangleSampler::new(corners.iter().copied().map(triangle_area));
    let mut places = sampler.sample(n, rng);
    rng.shuffle(&mut places);
    let point = |(t, w): &(usize, [f64; 3])| {
        let terms = corners[*t].iter().zip(w).map(|(p, w)| p.coords * *w);
        Point3::from(terms.sum::<Vector3>())
    };
    let normal = |(t, _): &(usize, [f64; 3])| {
        normal(&mesh.positions, &mesh.faces[*t]).unwrap_or_else(Vector3::y)
    };
    (
        places.iter().map(point).collect(),
        places.iter().map(normal).collect(),
    )
}

fn cracked(mesh: &PolygonSoup, rng: &mut SeededRng) -> PolygonSoup {
    let size = CRACKS * Aabb::of(&mesh.positions).longest_side();
    let mut positions = Vec::with_capacity(3 * mesh.faces.len());
    for corner in corners(mesh).iter().flatten() {
        let shift = Vector3::from_fn(|_, _| rng.uniform_in(-size..size));
        positions.push(corner + shift);
    }
    let faces = (0..mesh.faces.len() as u32).map(|t| vec![3 * t, 3 * t + 1, 3 * t + 2]);
    PolygonSoup {
        faces: faces.collect(),
        positions,
    }
}

/// The triangles whose middle can be seen from far away in `direction`, over the vertices that they use.
fn seen(mesh: &PolygonSoup, direction: Vector3) -> PolygonSoup {
    let corners = corners(mesh);
    let lift = 1e-6 * Aabb::of(&mesh.positions).longest_side();
    let bvh = TriangleBvh::new(corners.clone());
    let is_seen = |t: &usize| {
        let face = &mesh.faces[*t];
        let Some(normal) = normal(&mesh.positions, face) else {
            return false;
        };
        let [a, b, c] = corners[*t];
        let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        normal.dot(&direction) > 0.0
            && bvh
                .first_hit(&(middle + normal * lift), &direction)
                .is_none()
    };
    let faces: Vec<&Vec<u32>> = (0..corners.len())
        .filter(is_seen)
        .map(|t| &mesh.faces[t])
        .collect();
    let mut row_of: Vec<Option<u32>> = vec![None; mesh.positions.len()];
    let mut positions = Vec::new();
    let mut row = |v: u32| {
        *row_of[v as usize].get_or_insert_with(|| {
            positions.push(mesh.positions[v as usize]);
            positions.len() as u32 - 1
        })
    };
    let faces = faces
        .into_iter()
        .map(|f| f.iter().map(|&v| row(v)).collect())
        .collect();
    PolygonSoup { positions, faces }
}

fn ply(soup: &PolygonSoup, normals: Option<&[Vector3]>) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\n",
        soup.positions.len()
    );
    let directions = if normals.is_some() {
        ["", "n"].as_slice()
    } else {
        &[""]
    };
    for prefix in directions {
        for axis in ["x", "y", "z"] {
            let _ = writeln!(text, "property double {prefix}{axis}");
        }
    }
    if !soup.faces.is_empty() {
        let _ = writeln!(
            text,
            "element face {}\nproperty list uchar int vertex_indices",
            soup.faces.len()
        );
    }
    text.push_str("end_header\n");
    for (v, p) in soup.positions.iter().enumerate() {
        let _ = write!(text, "{:.7} {:.7} {:.7}", p.x, p.y, p.z);
        if let Some(n) = normals.map(|normals| normals[v]) {
            let _ = write!(text, " {:.7} {:.7} {:.7}", n.x, n.y, n.z);
        }
        text.push('\n');
    }
    for face in &soup.faces {
        let corners = face.iter().map(|v| format!(" {v}")).collect::<String>();
        let _ = writeln!(text, "{}{corners}", face.len());
    }
    text
}
