//! Parts of the source that are not draped like the rest: free ones, rigid ones, and those the target does not cover.

use mesh_core::{nearest_rotation, Positions, Triangulation, Vector3, VertexData, VertexId};
use mesh_loss::{LocalShape, Matches, Overlap};
use mesh_operators::{
    bilaplacian, cotan_laplacian, voronoi_mass, FixedSolve, FixedSolveScratch, SpaceExtension,
};
use nalgebra::Matrix3;

use crate::input::check_length;
use crate::{DrapeError, StateReader, StateWriter};

/// The field that passive pieces follow has at most this many centres.
const MAX_CENTRES: usize = 500;

/// How each vertex of the source is treated.
#[derive(Clone, Debug, PartialEq)]
pub struct Regions {
    /// How strongly target and vertex attract each other, 0..=1. Where it is 0 the surface is free: it attracts nothing,
    /// and structure carries it along.
    pub attraction: VertexData<f64>,
    /// Vertices that move with their rigid neighbours as one body, in the shape they have at rest.
    pub rigid: VertexData<bool>,
}

impl Regions {
    /// Nothing is free or rigid.
    pub fn none(n_vertices: usize) -> Self {
        Self {
            attraction: VertexData::new(n_vertices, 1.0),
            rigid: VertexData::new(n_vertices, false),
        }
    }

    /// Whether nothing is free or rigid.
    pub fn is_none(&self) -> bool {
        self.attraction.iter().all(|&a| a == 1.0) && !self.rigid.iter().any(|&r| r)
    }

    pub(crate) fn check(&self, n_vertices: usize) -> Result<(), DrapeError> {
        let lengths = [
            ("the attraction of the regions", self.attraction.len()),
            ("the rigid regions", self.rigid.len()),
        ];
        for (what, found) in lengths {
            check_length(what, found, n_vertices)?;
        }
        match self.attraction.iter().find(|a| !(0.0..=1.0).contains(*a)) {
            Some(&value) => Err(DrapeError::Setting {
                name: "attraction".to_owned(),
                value,
                expected: "between 0 and 1",
            }),
            None => Ok(()),
        }
    }
}

/// A vertex with fewer pairs than this share of what its area makes expect has no counterpart for now.
const FEW_PAIRS: f64 = 0.2;
/// So often the shape of each one-ring is spread over a part without a counterpart at the end.
const N_RELAXATIONS: usize = 100;
/// What is so near a landmark stays then, in longest sides: a single vertex that is held makes a spike.
const HELD_AROUND: f64 = 0.015;

/// The regions of one drape, ready to be applied. Coordinates are those of the unit frame.
pub(crate) struct Guidance {
    attraction: VertexData<f64>,
    bodies: Vec<Body>,
    /// Vertices of pieces that nothing attracts: they follow the space around them.
    passive: Vec<VertexId>,
    /// All others.
    active: Vec<VertexId>,
    initial: Positions,
    is_trivial: bool,
    /// Weight of the pairs of each vertex since parts last followed the rest.
    pairs: VertexData<f64>,
}

/// Who follows the rest in one correction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Follow {
    /// Rigid bodies take their shape.
    Bodies,
    /// Pieces that nothing attracts go with the space around them, too, which takes a solve.
    Pieces,
    /// Holes in what is attracted close by the smoothest displacement from the initial shape, too; another solve.
    All,
    /// As for pieces, and holes take the shape that they had initially as far as it fits in.
    End,
}

/// Vertices that move as one, and their shape about its centre, in the size it starts with.
struct Body {
    vertices: Vec<VertexId>,
    shape: Vec<Vector3>,
}

impl Guidance {
    /// `is_uncovered` marks what the target does not cover; it attracts nothing either.
    pub(crate) fn new(
        triangulation: &Triangulation,
        rest: &Positions,
        initial: &Positions,
        regions: &Regions,
        is_uncovered: &VertexData<bool>,
    ) -> Self {
        let n = initial.len();
        let attraction: VertexData<f64> = regions
            .attraction
            .ids()
            .map(|v| {
                if is_uncovered[v] {
                    0.0
                } else {
                    regions.attraction[v]
                }
            })
            .collect();
        let bodies = triangulation
            .connected_groups(|v| regions.rigid[v])
            .into_iter()
            .filter(|group| group.len() > 1)
            .map(|vertices| Body::new(vertices, rest, initial))
            .collect();
        let is_passive = |v: &VertexId| regions.attraction[*v] == 0.0 || regions.rigid[*v];
        let mut passive: Vec<VertexId> = triangulation
            .connected_groups(|v| triangulation.is_used(v))
            .into_iter()
            .filter(|piece| piece.iter().all(is_passive))
            .flatten()
            .collect();
        passive.sort_unstable();
        let mut is_passive_piece = VertexData::new(n, false);
        passive.iter().for_each(|&v| is_passive_piece[v] = true);
        let active: Vec<VertexId> = initial
            .ids()
            .filter(|&v| triangulation.is_used(v) && !is_passive_piece[v])
            .collect();
        if active.is_empty() {
            passive.clear();
        }
        Self {
            is_trivial: attraction.iter().all(|&a| a == 1.0),
            attraction,
            bodies,
            passive,
            active,
            initial: initial.clone(),
            pairs: VertexData::new(n, 0.0),
        }
    }

    /// How strongly target and vertex attract each other: 0 where the vertex is free or the target does not cover it.
    pub(crate) fn attraction(&self) -> &VertexData<f64> {
        &self.attraction
    }

    /// Vertices that move as bodies.
    pub(crate) fn rigid(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.bodies
            .iter()
            .flat_map(|body| body.vertices.iter().copied())
    }

    /// Notes which vertices have pairs, for [`Follow::All`]; where both shapes are whole, all have.
    pub(crate) fn note(&mut self, matches: &Matches, overlap: Overlap) {
        if self.is_trivial && !overlap.mesh_exceeds {
            return;
        }
        for m in matches.to_target.iter().chain(&matches.to_mesh) {
            for (&v, w) in m.triangle.iter().zip(m.barycentric) {
                self.pairs[v] += w;
            }
        }
    }

    /// Writes which vertices had pairs.
    pub(crate) fn save(&self, state: &mut StateWriter) {
        self.pairs.iter().for_each(|&p| state.real(p));
    }

    /// Takes what [`Self::save`] wrote.
    pub(crate) fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), DrapeError> {
        self.pairs.iter_mut().try_for_each(|p| {
            *p = state.real()?;
            Ok(())
        })
    }

    /// What each vertex of a body, a passive piece or a hole must move by to be where it belongs; none where nothing
    /// must. In holes, the vertices of `held` stay, and what is near them.
    pub(crate) fn correction(
        &mut self,
        triangulation: &Triangulation,
        x: &Positions,
        follow: Follow,
        held: &[VertexId],
    ) -> Result<Option<VertexData<Vector3>>, DrapeError> {
        let mut unmatched = match follow {
            Follow::All | Follow::End => self.without_pairs(triangulation, x),
            Follow::Bodies | Follow::Pieces => Vec::new(),
        };
        let moves_passive = follow != Follow::Bodies && !self.passive.is_empty();
        if self.bodies.is_empty() && !moves_passive && unmatched.is_empty() {
            return Ok(None);
        }
        let mut moved = x.clone();
        if follow == Follow::End {
            let is_far = |v: &VertexId| held.iter().all(|&h| (x[*v] - x[h]).norm() > HELD_AROUND);
            unmatched.retain(is_far);
            let shape = LocalShape::new(triangulation, &self.initial);
            (0..N_RELAXATIONS).for_each(|_| shape.relax(&mut moved, &unmatched));
        } else {
            self.follow(triangulation, &unmatched, &mut moved);
        }
        if moves_passive {
            let points: Vec<_> = self.active.iter().map(|&v| self.initial[v]).collect();
            let moves: Vec<_> = self
                .active
                .iter()
                .map(|&v| x[v] - self.initial[v])
                .collect();
            let field = SpaceExtension::new(&points, &moves, MAX_CENTRES)?;
            for &v in &self.passive {
                moved[v] = self.initial[v] + field.displacement_at(&self.initial[v]);
            }
        }
        self.bodies
            .iter()
            .for_each(|body| body.straighten(&mut moved));
        Ok(Some(
            moved.iter().zip(x.iter()).map(|(a, b)| a - b).collect(),
        ))
    }
}

impl Guidance {
    /// Vertices of connected parts that nothing attracted since this was last asked, with attracted ones all around: a
    /// part that ends openly, as shoulders do, keeps its shape by structure alone.
    fn without_pairs(&mut self, triangulation: &Triangulation, x: &Positions) -> Vec<VertexId> {
        let area = vertex_areas(triangulation, x);
        let pairs = std::mem::replace(&mut self.pairs, VertexData::new(x.len(), 0.0));
        let total: f64 = pairs.iter().sum();
        if total <= 0.0 {
            return Vec::new();
        }
        let paired = self.active.iter().filter(|&&v| pairs[v] > 0.0);
        let density = total / paired.map(|&v| area[v]).sum::<f64>().max(f64::MIN_POSITIVE);
        let mut is_unmatched = VertexData::new(x.len(), false);
        for &v in &self.active {
            is_unmatched[v] = area[v] > 0.0 && pairs[v] < FEW_PAIRS * density * area[v];
        }
        let is_boundary = boundary(triangulation);
        triangulation
            .connected_groups(|v| is_unmatched[v])
            .into_iter()
            .filter(|part| !part.iter().any(|&v| is_boundary[v]))
            .flatten()
            .collect()
    }

    /// Moves the vertices of `unmatched` by the smoothest displacement from the initial shape that the others allow; not at
    /// all where that is not determined.
    fn follow(&self, triangulation: &Triangulation, unmatched: &[VertexId], x: &mut Positions) {
        if unmatched.is_empty() || unmatched.len() >= self.active.len() {
            return;
        }
        let mut is_unmatched = VertexData::new(x.len(), false);
        unmatched.iter().for_each(|&v| is_unmatched[v] = true);
        let held: Vec<VertexId> = x.ids().filter(|&v| !is_unmatched[v]).collect();
        let mass = voronoi_mass(triangulation, &self.initial);
        let energy = bilaplacian(&cotan_laplacian(triangulation, &self.initial), &mass);
        let Ok(solve) = FixedSolve::new(&energy, &held) else {
            return;
        };
        let mut moves: Vec<Vector3> = x.iter().zip(&self.initial).map(|(a, b)| a - b).collect();
        solve.solve_in_place(&mut moves, &mut FixedSolveScratch::default());
        for &v in unmatched {
            x[v] = self.initial[v] + moves[v.index()];
        }
    }
}

impl Body {
    /// The shape at rest, in the size of the body at `initial`.
    fn new(vertices: Vec<VertexId>, rest: &Positions, initial: &Positions) -> Self {
        let shape = centred(&vertices, rest).1;
        let now = centred(&vertices, initial).1;
        let spread = |shape: &[Vector3]| shape.iter().map(Vector3::norm_squared).sum::<f64>();
        let turned = turn(&shape, &now);
        let fitted: f64 = shape
            .iter()
            .zip(&now)
            .map(|(a, b)| (turned * a).dot(b))
            .sum();
        let scale = if spread(&shape) > 0.0 {
            (fitted / spread(&shape)).max(0.0)
        } else {
            0.0
        };
        Self {
            vertices,
            shape: shape.iter().map(|p| p * scale).collect(),
        }
    }

    /// Puts the shape where its vertices are, turned as they are.
    fn straighten(&self, x: &mut Positions) {
        let (centre, now) = centred(&self.vertices, x);
        let rotation = turn(&self.shape, &now);
        for (&v, p) in self.vertices.iter().zip(&self.shape) {
            x[v] = (centre + rotation * p).into();
        }
    }
}

fn centred(vertices: &[VertexId], x: &Positions) -> (Vector3, Vec<Vector3>) {
    let centre = vertices.iter().map(|&v| x[v].coords).sum::<Vector3>() / vertices.len() as f64;
    let around = vertices.iter().map(|&v| x[v].coords - centre).collect();
    (centre, around)
}

/// The rotation that brings `from` nearest to `to`.
fn turn(from: &[Vector3], to: &[Vector3]) -> Matrix3<f64> {
    let pairs = from.iter().zip(to);
    nearest_rotation(&pairs.map(|(a, b)| b * a.transpose()).sum())
}

/// Which vertices lie on an edge that does not have a triangle on either side: an open boundary, or where surfaces branch.
fn boundary(triangulation: &Triangulation) -> VertexData<bool> {
    let mut is_boundary = VertexData::new(triangulation.n_vertices(), false);
    for (e, edge) in triangulation.edges().iter().enumerate() {
        if triangulation.edge_triangles(e).len() != 2 {
            edge.iter().for_each(|&v| is_boundary[v] = true);
        }
    }
    is_boundary
}

/// A third of the area of the triangles at each vertex.
fn vertex_areas(triangulation: &Triangulation, x: &Positions) -> VertexData<f64> {
    let mut area = VertexData::new(x.len(), 0.0);
    let triangles = triangulation.triangles().iter();
    for (t, corners) in triangles.zip(triangulation.corners(x)) {
        let share = mesh_core::measure::triangle_area(corners) / 3.0;
        t.iter().for_each(|&v| area[v] += share);
    }
    area
}
