//! What is asked for closest points while a pose is searched: a surface, or discs in its stead.

use std::sync::Arc;

use mesh_core::sampling::{SeededRng, TrianglePlace, TriangleSampler};
use mesh_core::{
    PointCloud, Positions, SurfelCloud, TargetSurface, TriangleBvh, Triangulation, UnitFrame,
    Vector3,
};

/// Surfaces of more triangles, or target vertices, than this are searched as discs, ...
pub(super) const LARGE: usize = 20_000;
/// ... of which there are so many.
pub(super) const N_DISCS: usize = 16_384;

/// A place with its normal, where there is one.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub(super) point: Vector3,
    pub(super) normal: Option<Vector3>,
}

/// A surface, and discs at random places of it in its stead where it is large.
pub(super) struct Side<'a> {
    pub(super) surface: Surface<'a>,
    pub(super) discs: Option<SurfelCloud>,
}

pub(super) enum Surface<'a> {
    /// In its own coordinates, and how they become those of the box.
    Target(&'a dyn TargetSurface, UnitFrame),
    /// In those of the box.
    Source(TriangleBvh),
}

/// What is asked for closest points.
#[derive(Clone, Copy)]
pub(super) enum Detail {
    /// The discs, where there are any.
    Discs,
    /// The surface itself.
    Exact,
}

impl Side<'_> {
    /// The closest place to a point of the box; the row of the hit becomes the hint for the next query nearby.
    pub(super) fn closest(&self, p: &Vector3, hint: &mut u32, detail: Detail) -> Option<Place> {
        let at = (*p).into();
        let (hit, point, normal) = match (&self.discs, detail, &self.surface) {
            (Some(discs), Detail::Discs, _) => {
                let hit = discs.closest_point_from(&at, *hint);
                (hit, hit.point, discs.normal(&hit.location))
            }
            (_, _, Surface::Target(target, frame)) => {
                let hit = target.closest_point_from(&frame.from_unit(&at), *hint);
                (hit, frame.to_unit(&hit.point), target.normal(&hit.location))
            }
            (_, _, Surface::Source(bvh)) => {
                let hit = bvh.closest_point_from(&at, *hint)?;
                let corners = bvh.triangle(hit.location.row());
                (hit, hit.point, mesh_core::measure::triangle_normal(corners))
            }
        };
        *hint = hit.location.row();
        Some(Place {
            point: point.coords,
            normal,
        })
    }
}

/// Discs at these places; none where a place has no normal.
pub(super) fn in_discs(places: &[Place]) -> Option<SurfelCloud> {
    let points = places.iter().map(|p| p.point.into()).collect();
    let normals: Option<Vec<Vector3>> = places.iter().map(|p| p.normal).collect();
    let cloud = PointCloud::new(points, Some(normals?)).ok()?;
    Some(SurfelCloud::new(Arc::new(cloud)))
}

/// Random places of the source, uniform by area.
pub(super) fn sample_source(
    triangulation: &Triangulation,
    x: &Positions,
    n: usize,
    rng: &mut SeededRng,
) -> Vec<Place> {
    let areas = triangulation
        .corners(x)
        .map(mesh_core::measure::triangle_area);
    let places = TriangleSampler::new(areas).sample(n, rng);
    let place = |(t, w): TrianglePlace| {
        let corners = triangulation.triangles()[t].map(|v| x[v]);
        Place {
            point: corners.iter().zip(w).map(|(p, w)| p.coords * w).sum(),
            normal: mesh_core::measure::triangle_normal(corners),
        }
    };
    let mut source: Vec<Place> = places.into_iter().map(place).collect();
    rng.shuffle(&mut source);
    source
}

/// Random places of the target, in the frame of its box.
pub(super) fn sample_target(
    target: &dyn TargetSurface,
    frame: &UnitFrame,
    n: usize,
    rng: &mut SeededRng,
) -> Vec<Place> {
    let mut samples = target.sample(n, rng);
    rng.shuffle(&mut samples);
    let place = |s: &mesh_core::SurfaceSample| Place {
        point: frame.to_unit(&s.point).coords,
        normal: target.normal(&s.location),
    };
    samples.iter().map(place).collect()
}
