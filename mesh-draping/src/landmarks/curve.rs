//! Curves cut into landmarks: lines on source and target that belong together, matched by arc length.

use std::sync::Arc;

use mesh_core::{
    Curve, CurveShare, Landmark, LandmarkKind, MeshPoint, Point3, Positions, VertexId,
};
use mesh_operators::surface_path;

use super::LandmarkProblem;
use crate::{Shape, Source};

/// Landmarks are this far apart along the source, in longest sides of its box, where that gives neither too few nor too many.
const SPACING: f64 = 0.01;
const FEWEST_STEPS: usize = 8;
const MOST_STEPS: usize = 32;
/// All landmarks of a curve together count as much as landmarks this far apart along it would, in longest sides; as one at
/// least.
const LENGTH_OF_ONE: f64 = 0.1;
/// A line is closed whose ends are nearer to each other than this share of its length.
const CLOSED: f64 = 1e-6;
/// Places of a line; one that is closed names its first twice.
const FEWEST_PLACES: usize = 2;
const FEWEST_CLOSED: usize = 4;

/// The landmarks of a curve: places of the source, evenly spaced along the shortest ways that join its places, each with the
/// point at the same share of the length of the target's line.
///
/// With ℓ the length along the source over the longest side of its box, `n = ⌈ℓ / 0.01⌉` steps, 8 to 32; a curve with ends has
/// n + 1 landmarks, a closed one n. Together they count as `max(1, ℓ / 0.1)` landmarks times the weight of the curve, each the
/// same, and none more than one: a curve leads as landmarks along it would, and does not outweigh them by their number.
///
/// # Errors
/// Too few places, a line without length, closed on one shape only, or places of the source that no triangles join.
///
/// ```
/// use mesh_core::{shapes, Curve, MeshPoint, Point3, VertexId};
/// use mesh_draping::{landmarks, Seams, Source};
/// let source = Source::of_soup(shapes::open_grid(10, 10), Seams::EXACT)?;
/// let lower_side = [0, 10].map(|v| MeshPoint::vertex(VertexId::new(v)));
/// let hem = Curve {
///     name: Some("hem".to_owned()),
///     source: lower_side.to_vec(),
///     target: [[0.0, 0.0, 1.0], [0.0, 4.0, 1.0], [4.0, 4.0, 1.0]].map(Point3::from).to_vec(),
///     weight: 1.0,
/// };
/// let cut = landmarks::cut(hem, &source).expect("it can be cut");
/// assert_eq!(cut.len(), 33);
/// assert!((cut[16].target - Point3::new(0.0, 4.0, 1.0)).norm() < 1e-9);
/// assert!((cut[16].source.position(source.rest()) - Point3::new(5.0, 0.0, 0.0)).norm() < 1e-9);
/// # Ok::<(), mesh_draping::Error>(())
/// ```
pub fn cut(curve: Curve, source: &Source) -> Result<Vec<Landmark>, LandmarkProblem> {
    let few = |shape, n, least| Err(LandmarkProblem::FewPlaces { shape, n, least });
    let numbers = [
        (Shape::Source, curve.source.len()),
        (Shape::Target, curve.target.len()),
    ];
    if let Some((shape, n)) = numbers.into_iter().find(|(_, n)| *n < FEWEST_PLACES) {
        return few(shape, n, FEWEST_PLACES);
    }
    let way = way(&curve.source, source)?;
    let rest = source.rest();
    let on_source = Line::new(
        way.iter().map(|p| p.position(rest)).collect(),
        Shape::Source,
    )?;
    let on_target = Line::new(curve.target.clone(), Shape::Target)?;
    let is_closed = on_source.is_closed();
    match (is_closed, on_target.is_closed()) {
        (true, false) => return Err(closed_on(Shape::Source, Shape::Target)),
        (false, true) => return Err(closed_on(Shape::Target, Shape::Source)),
        _ => {}
    }
    if let Some((shape, n)) = numbers
        .into_iter()
        .find(|(_, n)| is_closed && *n < FEWEST_CLOSED)
    {
        return few(shape, n, FEWEST_CLOSED);
    }

    let length = on_source.length() / source.bounds().longest_side();
    let n_steps = ((length / SPACING).ceil() as usize).clamp(FEWEST_STEPS, MOST_STEPS);
    let n = if is_closed { n_steps } else { n_steps + 1 };
    let weight = curve.weight;
    let of = CurveShare {
        curve: Arc::new(curve),
        share: ((length / LENGTH_OF_ONE).max(1.0) / n as f64).min(1.0),
    };
    let landmark = |k: usize| {
        let share = k as f64 / n_steps as f64;
        let (row, t) = on_source.at(share);
        Landmark {
            name: None,
            source: between(&way[row], &way[row + 1], t),
            target: on_target.point(share),
            kind: LandmarkKind::Soft,
            weight,
            curve: Some(of.clone()),
        }
    };
    Ok((0..n).map(landmark).collect())
}

fn closed_on(closed: Shape, open: Shape) -> LandmarkProblem {
    LandmarkProblem::ClosedOnOne { closed, open }
}

/// The shortest way along the source from place to place.
fn way(places: &[MeshPoint], source: &Source) -> Result<Vec<MeshPoint>, LandmarkProblem> {
    let rest: &Positions = source.rest();
    let mut way = vec![places[0]];
    for (first, ends) in places.windows(2).enumerate() {
        let next = surface_path(source.triangulation(), rest, &ends[0], &ends[1]);
        let next = next.ok_or(LandmarkProblem::NoWay { first })?;
        way.extend(next.into_iter().skip(1));
    }
    Ok(way)
}

/// The place between two places in one triangle.
fn between(a: &MeshPoint, b: &MeshPoint, t: f64) -> MeshPoint {
    let mut vertices: Vec<VertexId> = Vec::with_capacity(3);
    let mut weights = [0.0; 3];
    for (place, share) in [(a, 1.0 - t), (b, t)] {
        for (&v, w) in place.vertices.iter().zip(place.weights) {
            if w * share == 0.0 {
                continue;
            }
            let row = vertices.iter().position(|&known| known == v);
            let row = row.unwrap_or_else(|| {
                vertices.push(v);
                vertices.len() - 1
            });
            weights[row] += w * share;
        }
    }
    let corner = |k: usize| vertices.get(k).copied().unwrap_or(vertices[0]);
    MeshPoint::barycentric([corner(0), corner(1), corner(2)], weights)
}

/// A polyline and the lengths along it.
struct Line {
    points: Vec<Point3>,
    /// From the start to each point.
    along: Vec<f64>,
}

impl Line {
    fn new(points: Vec<Point3>, shape: Shape) -> Result<Self, LandmarkProblem> {
        let mut along = vec![0.0];
        for ends in points.windows(2) {
            along.push(along[along.len() - 1] + (ends[1] - ends[0]).norm());
        }
        let line = Self { points, along };
        // NaN is not above anything.
        match line.length() > 0.0 {
            true => Ok(line),
            false => Err(LandmarkProblem::NoLength { shape }),
        }
    }

    fn length(&self) -> f64 {
        self.along[self.along.len() - 1]
    }

    fn is_closed(&self) -> bool {
        let ends = self.points[0] - self.points[self.points.len() - 1];
        ends.norm() <= CLOSED * self.length()
    }

    /// The segment at a share of the length, and where in it.
    fn at(&self, share: f64) -> (usize, f64) {
        let length = share * self.length();
        let after = self.along.partition_point(|&along| along <= length);
        let row = after.clamp(1, self.along.len() - 1) - 1;
        let segment = self.along[row + 1] - self.along[row];
        let t = if segment > 0.0 {
            (length - self.along[row]) / segment
        } else {
            0.0
        };
        (row, t.clamp(0.0, 1.0))
    }

    fn point(&self, share: f64) -> Point3 {
        let (row, t) = self.at(share);
        let (a, b) = (self.points[row], self.points[row + 1]);
        a + (b - a) * t
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Seams;
    use mesh_core::shapes;

    fn vertices(rows: &[usize]) -> Vec<MeshPoint> {
        let place = |&row: &usize| MeshPoint::vertex(VertexId::new(row));
        rows.iter().map(place).collect()
    }

    fn curve(source: &[usize], target: &[[f64; 3]]) -> Curve {
        Curve {
            name: None,
            source: vertices(source),
            target: target.iter().map(|&p| p.into()).collect(),
            weight: 1.0,
        }
    }

    fn grid() -> Source {
        Source::of_soup(shapes::open_grid(10, 10), Seams::EXACT).unwrap()
    }

    #[test]
    fn landmarks_lie_evenly_and_count_as_a_few() {
        let source = grid();
        let cut = cut(curve(&[0, 10, 120], &[[0.0; 3], [5.0, 0.0, 0.0]]), &source).unwrap();
        assert_eq!(cut.len(), MOST_STEPS + 1);
        for (k, l) in cut.iter().enumerate() {
            let along = 20.0 * k as f64 / MOST_STEPS as f64;
            let at = Point3::new(along.min(10.0), (along - 10.0).max(0.0), 0.0);
            assert!((l.source.position(source.rest()) - at).norm() < 1e-9);
            assert!((l.target.x - along / 4.0).abs() < 1e-9);
        }
        // Twice the longest side, as much as twenty landmarks along it.
        let pull: f64 = cut.iter().map(Landmark::pull).sum();
        assert!((pull - 20.0).abs() < 1e-9, "{pull}");
    }

    #[test]
    fn a_closed_curve_has_no_landmark_twice() {
        let around = [0, 10, 120, 110, 0];
        let corners = [
            [0., 0., 1.],
            [3., 0., 1.],
            [3., 3., 1.],
            [0., 3., 1.],
            [0., 0., 1.],
        ];
        let cut = cut(curve(&around, &corners), &grid()).unwrap();
        assert_eq!(cut.len(), MOST_STEPS);
        assert!(cut[1..].iter().all(|l| l.target != cut[0].target));
    }

    #[test]
    fn places_that_nothing_joins_are_named() {
        let mut soup = shapes::open_grid(2, 2);
        let apart = soup
            .positions
            .iter()
            .map(|p| Point3::new(p.x + 5.0, p.y, p.z));
        let apart: Vec<Point3> = apart.collect();
        let faces = soup.faces.clone();
        soup.positions.extend(apart);
        soup.faces
            .extend(faces.iter().map(|f| f.iter().map(|v| v + 9).collect()));
        let source = Source::of_soup(soup, Seams::EXACT).unwrap();
        let across = curve(&[0, 8, 12], &[[0.0; 3], [1.0, 0.0, 0.0]]);
        let told = cut(across, &source).unwrap_err().to_string();
        assert!(told.contains("joins its places 1 and 2"), "{told}");
    }

    #[test]
    fn what_cannot_be_cut_is_named() {
        let line = [[0.0; 3], [1.0, 0.0, 0.0]];
        let round = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]];
        let cases = [
            (curve(&[0], &line), "has 1 places on the source"),
            (curve(&[0, 10], &line[..1]), "has 1 places on the target"),
            (curve(&[0, 0], &line), "has no length on the source"),
            (
                curve(&[0, 10], &[[1.0; 3]; 3]),
                "has no length on the target",
            ),
            (
                curve(&[0, 10], &round),
                "closed on the target but has two ends on the source",
            ),
            (curve(&[0, 10, 0], &round), "has 3 places on the source"),
        ];
        for (curve, expected) in cases {
            let told = cut(curve, &grid()).unwrap_err().to_string();
            assert!(told.contains(expected), "{told} lacks {expected}");
        }
    }
}
