//! Inner surfaces: what no ray from outside reaches.

use drape_studio::Treatment;
use mesh_core::surface::is_exposed;
use mesh_core::{measure, TriangleBvh, VertexData, VertexId};
use neural_drape::Regions;

use super::{bvh, pieces};
use crate::input::{Pair, Source};

/// Rays from each triangle that has not been seen yet.
const N_RAYS: usize = 48;
/// A connected inner surface below this share of the area is a crevice, not a part.
const LEAST_SHARE: f64 = 2e-3;
/// Inner linings are carried along by themselves from this share of the area; less may be an armpit.
const LINING_SHARE: f64 = 0.02;
/// A separate piece of which at least this share is hidden lies inside another: lids hide most of an eyeball.
const INNER: f64 = 0.5;
/// Inner surfaces of the target that are at least this large beside the source's are their counterparts.
const COUNTERPART: f64 = 0.5;

/// An inner surface of a source.
pub(crate) struct Inner {
    /// Its vertices, ascending.
    pub(crate) vertices: Vec<VertexId>,
    /// Its share of the area of the source.
    pub(crate) share: f64,
    /// Whether it is a piece of its own.
    pub(crate) is_piece: bool,
    /// Whether it has no open boundary: a body, not a lining.
    pub(crate) is_closed: bool,
}

impl Inner {
    /// How it had best be treated.
    pub(crate) fn proposed(&self) -> Treatment {
        if self.is_piece && self.is_closed {
            Treatment::Rigid
        } else {
            Treatment::Free
        }
    }

    /// What it is, in words.
    pub(crate) fn kind(&self) -> &'static str {
        match (self.is_piece, self.is_closed) {
            (true, true) => "closed piece inside",
            (true, false) => "open piece inside",
            (false, _) => "inner lining",
        }
    }

    pub(crate) fn kind_in_short(&self) -> &'static str {
        match (self.is_piece, self.is_closed) {
            (true, true) => "closed",
            (true, false) => "open",
            (false, _) => "lining",
        }
    }

    /// Whether it is treated as proposed where nobody says otherwise and the target has nothing like it.
    fn is_clear(&self) -> bool {
        self.is_piece || self.share >= LINING_SHARE
    }
}

/// The inner surfaces of a pair.
pub(crate) struct Hidden {
    /// Those of the source, largest first: `hidden:1`, `hidden:2` and so on.
    pub(crate) inner: Vec<Inner>,
    /// Share of the target's area that no ray from outside reaches.
    of_target: f64,
}

impl Hidden {
    pub(crate) fn of(pair: &Pair) -> Self {
        let inner = inner_surfaces(&pair.source);
        let of_target = if inner.is_empty() {
            0.0
        } else {
            hidden_share(pair)
        };
        Self { inner, of_target }
    }

    /// How an inner surface of the source is treated where nobody names any.
    pub(crate) fn unasked(&self, part: &Inner) -> Treatment {
        let inside: f64 = self.clear().map(|i| i.share).sum();
        if part.is_clear() && !self.has_counterpart(inside) {
            part.proposed()
        } else {
            Treatment::Draped
        }
    }

    fn clear(&self) -> impl Iterator<Item = &Inner> {
        self.inner.iter().filter(|i| i.is_clear())
    }

    fn has_counterpart(&self, inside: f64) -> bool {
        self.of_target >= COUNTERPART * inside
    }
}

/// Separate pieces that lie mostly inside, and connected inner surfaces of the others, largest first.
pub(crate) fn inner_surfaces(source: &Source) -> Vec<Inner> {
    let is_seen = seen_triangles(source);
    let areas = measure::triangle_areas(&source.triangulation, &source.rest);
    let total: f64 = areas.iter().sum();
    let n = source.mesh.n_vertices();
    let (mut own, mut hidden) = (VertexData::new(n, 0.0), VertexData::new(n, 0.0));
    for ((t, area), &seen) in source
        .triangulation
        .triangles()
        .iter()
        .zip(&areas)
        .zip(&is_seen)
    {
        for &v in t {
            own[v] += area / 3.0;
            hidden[v] += if seen { 0.0 } else { area / 3.0 };
        }
    }
    let mut found = Vec::new();
    let mut is_taken = VertexData::new(n, false);
    let pieces = pieces(source);
    for piece in pieces.iter().filter(|_| pieces.len() > 1) {
        let sum = |of: &VertexData<f64>| piece.iter().map(|&v| of[v]).sum::<f64>();
        let (area, inside) = (sum(&own), sum(&hidden));
        if area > 0.0 && inside >= INNER * area && area < 0.5 * total {
            piece.iter().for_each(|&v| is_taken[v] = true);
            found.push(Inner {
                share: area / total,
                is_piece: true,
                is_closed: !piece.iter().any(|&v| source.mesh.is_boundary_vertex(v)),
                vertices: piece.clone(),
            });
        }
    }
    let is_inside = |v: VertexId| !is_taken[v] && own[v] > 0.0 && hidden[v] == own[v];
    let inside = source
        .triangulation
        .connected_groups(source.mesh.n_vertices(), is_inside);
    for vertices in inside {
        let share = vertices.iter().map(|&v| own[v]).sum::<f64>() / total;
        if share >= LEAST_SHARE {
            found.push(Inner {
                vertices,
                share,
                is_piece: false,
                is_closed: false,
            });
        }
    }
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    found
}

/// Makes inner surfaces free that no one named, closed pieces rigid; says so. `is_draped` marks what stays attracted.
///
/// Nothing is done where the target has inner surfaces of comparable size itself: they are draped over those.
pub(super) fn add_inner_pieces(
    hidden: &Hidden,
    is_draped: &VertexData<bool>,
    regions: &mut Regions,
) -> Vec<String> {
    let is_named =
        |v: &VertexId| regions.rigid[*v] || regions.attraction[*v] == 0.0 || is_draped[*v];
    let inner: Vec<&Inner> = hidden
        .clear()
        .filter(|i| !i.vertices.iter().any(is_named))
        .collect();
    let inside: f64 = inner.iter().map(|i| i.share).sum();
    if inner.is_empty() || hidden.has_counterpart(inside) {
        return Vec::new();
    }
    let (mut n_rigid, mut n_free, mut share) = (0, 0, 0.0);
    for part in inner {
        share += part.share;
        if part.proposed() == Treatment::Rigid {
            n_rigid += 1;
            part.vertices.iter().for_each(|&v| regions.rigid[v] = true);
        } else {
            n_free += 1;
        }
        part.vertices
            .iter()
            .for_each(|&v| regions.attraction[v] = 0.0);
    }
    vec![format!(
        "inner parts of the source ({:.1} % of its area) attract nothing: {n_free} carried along, {n_rigid} as rigid \
         bodies",
        100.0 * share
    )]
}

/// Share of the target's area that no ray from outside reaches; 0 for a cloud.
fn hidden_share(pair: &Pair) -> f64 {
    let model = &pair.target.model;
    let corners: Vec<_> = model
        .facets
        .iter()
        .map(|f| f.corners.map(|v| model.positions[v]))
        .collect();
    if corners.is_empty() {
        return 0.0;
    }
    let areas: Vec<f64> = corners.iter().map(|&t| measure::triangle_area(t)).collect();
    let seen = is_exposed(&TriangleBvh::new(corners), N_RAYS);
    let hidden: f64 = areas
        .iter()
        .zip(&seen)
        .filter(|(_, &s)| !s)
        .map(|(a, _)| a)
        .sum();
    hidden / areas.iter().sum::<f64>().max(f64::MIN_POSITIVE)
}

fn seen_triangles(source: &Source) -> Vec<bool> {
    is_exposed(&bvh(source), N_RAYS)
}
