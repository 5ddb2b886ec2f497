//! Inner surfaces: what no ray from outside reaches.

use std::fmt;

use mesh_core::surface::is_exposed;
use mesh_core::{measure, TriangleBvh, VertexData, VertexId};
use neural_drape::Regions;

use super::Treatment;
use crate::{Note, Pair, Source, Target};

/// Rays from each triangle that has not been seen yet.
const N_RAYS: usize = 48;
/// A connected inner surface below this share of the area is a crevice, not a part.
const LEAST_SHARE: f64 = 2e-3;
/// Inner linings are carried along by themselves from this share of the area.
const LINING_SHARE: f64 = 0.02;
/// A lining is a pocket where its rim is shorter than that of a flat disc of its area, `2 √π √A`: the lining of a mouth has
/// 1.1 to 3.5, the walls of an armpit, a groin or a fist, which the target has as well, 4.3 to 9.
const POCKET_RIM_SQUARED: f64 = 4.0 * std::f64::consts::PI;
/// A separate piece of which at least this share is hidden lies inside another: lids hide most of an eyeball.
const INNER: f64 = 0.5;
/// Inner surfaces of the target that are at least this large beside the source's are their counterparts.
const COUNTERPART: f64 = 0.5;

/// An inner surface of a source.
#[derive(Clone, Debug, PartialEq)]
pub struct InnerSurface {
    /// Its vertices, ascending.
    pub vertices: Vec<VertexId>,
    /// Its share of the area of the source, 0..=1.
    pub share: f64,
    /// Length of the rim where it goes on into the outer surface, over the root of its area; 0 for a piece of its own.
    pub rim: f64,
    /// What it is.
    pub kind: InnerKind,
}

/// What an inner surface is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InnerKind {
    /// A piece of its own without an open boundary, as an eyeball.
    ClosedPiece,
    /// A piece of its own that ends openly, as a row of teeth.
    OpenPiece,
    /// It goes on into the outer surface, as the lining of a mouth.
    Lining,
}

impl fmt::Display for InnerKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ClosedPiece => "closed piece inside",
            Self::OpenPiece => "open piece inside",
            Self::Lining => "inner lining",
        })
    }
}

impl InnerSurface {
    /// How it had best be treated.
    pub fn proposed(&self) -> Treatment {
        match self.kind {
            InnerKind::ClosedPiece => Treatment::Rigid,
            InnerKind::OpenPiece | InnerKind::Lining => Treatment::Free,
        }
    }

    /// Whether it is treated as proposed where nobody says otherwise and the target has nothing like it.
    fn is_clear(&self) -> bool {
        let is_pocket = self.rim.powi(2) < POCKET_RIM_SQUARED;
        self.kind != InnerKind::Lining || self.share >= LINING_SHARE && is_pocket
    }
}

/// The inner surfaces of a pair.
#[derive(Clone, Debug, PartialEq)]
pub struct HiddenSurfaces {
    /// Those of the source, largest first: `hidden:1`, `hidden:2` and so on.
    pub inner: Vec<InnerSurface>,
    /// Share of the target's area that no ray from outside reaches, 0..=1; 0 for a cloud.
    pub of_target: f64,
}

impl HiddenSurfaces {
    /// The inner surfaces of source and target.
    pub fn of(pair: &Pair) -> Self {
        let inner = inner_surfaces(&pair.source);
        let of_target = if inner.is_empty() {
            0.0
        } else {
            hidden_share(&pair.target)
        };
        Self { inner, of_target }
    }

    /// How an inner surface of the source is treated where nobody names any.
    pub fn unasked(&self, part: &InnerSurface) -> Treatment {
        let inside: f64 = self.clear().map(|i| i.share).sum();
        if part.is_clear() && !self.has_counterpart(inside) {
            part.proposed()
        } else {
            Treatment::Draped
        }
    }

    fn clear(&self) -> impl Iterator<Item = &InnerSurface> {
        self.inner.iter().filter(|i| i.is_clear())
    }

    fn has_counterpart(&self, inside: f64) -> bool {
        self.of_target >= COUNTERPART * inside
    }

    /// Makes inner surfaces free that nobody named, closed pieces rigid. `is_draped` marks what stays attracted.
    ///
    /// Nothing is done where the target has inner surfaces of comparable size itself: they are draped over those.
    pub(super) fn free_unnamed(
        &self,
        is_draped: &VertexData<bool>,
        regions: &mut Regions,
    ) -> Vec<Note> {
        let is_named =
            |v: &VertexId| regions.rigid[*v] || regions.attraction[*v] == 0.0 || is_draped[*v];
        let unnamed = self.clear().filter(|i| !i.vertices.iter().any(is_named));
        let unnamed: Vec<&InnerSurface> = unnamed.collect();
        let share: f64 = unnamed.iter().map(|i| i.share).sum();
        if unnamed.is_empty() || self.has_counterpart(share) {
            return Vec::new();
        }
        let (mut n_rigid, mut n_free) = (0, 0);
        for part in unnamed {
            let is_rigid = part.proposed() == Treatment::Rigid;
            *(if is_rigid { &mut n_rigid } else { &mut n_free }) += 1;
            for &v in &part.vertices {
                regions.attraction[v] = 0.0;
                regions.rigid[v] |= is_rigid;
            }
        }
        vec![Note::InnerPartsFreed {
            share,
            n_free,
            n_rigid,
        }]
    }
}

/// Separate pieces that lie mostly inside, and connected inner surfaces of the others, largest first.
pub fn inner_surfaces(source: &Source) -> Vec<InnerSurface> {
    let (mesh, triangulation) = (source.mesh(), source.triangulation());
    let is_seen = is_exposed(source.bvh(), N_RAYS);
    let areas = measure::triangle_areas(triangulation, source.rest());
    let total: f64 = areas.iter().sum();
    let n = mesh.n_vertices();
    let (mut own, mut hidden) = (VertexData::new(n, 0.0), VertexData::new(n, 0.0));
    for ((t, area), &seen) in triangulation.triangles().iter().zip(&areas).zip(&is_seen) {
        for &v in t {
            own[v] += area / 3.0;
            hidden[v] += if seen { 0.0 } else { area / 3.0 };
        }
    }
    let mut found = Vec::new();
    let mut is_taken = VertexData::new(n, false);
    let pieces = triangulation.connected_groups(|v| triangulation.is_used(v));
    for piece in pieces.iter().filter(|_| pieces.len() > 1) {
        let sum = |of: &VertexData<f64>| piece.iter().map(|&v| of[v]).sum::<f64>();
        let (area, inside) = (sum(&own), sum(&hidden));
        if area > 0.0 && inside >= INNER * area && area < 0.5 * total {
            piece.iter().for_each(|&v| is_taken[v] = true);
            let is_open = piece.iter().any(|&v| mesh.is_boundary_vertex(v));
            found.push(InnerSurface {
                share: area / total,
                rim: 0.0,
                kind: if is_open {
                    InnerKind::OpenPiece
                } else {
                    InnerKind::ClosedPiece
                },
                vertices: piece.clone(),
            });
        }
    }
    let is_inside = |v: VertexId| !is_taken[v] && own[v] > 0.0 && hidden[v] == own[v];
    for vertices in triangulation.connected_groups(is_inside) {
        let share = vertices.iter().map(|&v| own[v]).sum::<f64>() / total;
        if share >= LEAST_SHARE {
            found.push(InnerSurface {
                rim: rim(source, &vertices),
                vertices,
                share,
                kind: InnerKind::Lining,
            });
        }
    }
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    found
}

/// Length of the edges that bound the triangles of these vertices inside the surface, over the root of the area of those.
fn rim(source: &Source, vertices: &[VertexId]) -> f64 {
    let (triangulation, rest) = (source.triangulation(), source.rest());
    let mut is_in = VertexData::new(rest.len(), false);
    vertices.iter().for_each(|&v| is_in[v] = true);
    let triangles = triangulation.triangles();
    let is_inside = |t: &u32| triangles[*t as usize].iter().all(|&v| is_in[v]);
    let bounds = |e: &usize| {
        let sides = triangulation.edge_triangles(*e);
        sides.len() > 1 && sides.iter().filter(|t| is_inside(t)).count() == 1
    };
    let edges = triangulation.edges();
    let length: f64 = (0..edges.len())
        .filter(bounds)
        .map(|e| (rest[edges[e][0]] - rest[edges[e][1]]).norm())
        .sum();
    let areas = (0..triangles.len() as u32).filter(is_inside);
    let areas = areas.map(|t| measure::triangle_area(triangles[t as usize].map(|v| rest[v])));
    let area = areas.sum::<f64>();
    if area > 0.0 {
        length / area.sqrt()
    } else {
        f64::INFINITY
    }
}

/// Share of the target's area that no ray from outside reaches; 0 for a cloud.
fn hidden_share(target: &Target) -> f64 {
    let corners = target.triangles();
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A large lining is carried along by itself where it is a pocket, not where it is the walls of a groin.
    #[test]
    fn a_crevice_is_draped() {
        let lining = |rim| InnerSurface {
            vertices: Vec::new(),
            share: 0.03,
            rim,
            kind: InnerKind::Lining,
        };
        let surfaces = HiddenSurfaces {
            inner: vec![lining(6.0), lining(1.5)],
            of_target: 0.0,
        };
        let treatments: Vec<Treatment> =
            surfaces.inner.iter().map(|i| surfaces.unasked(i)).collect();
        assert_eq!(treatments, [Treatment::Draped, Treatment::Free]);
    }
}
