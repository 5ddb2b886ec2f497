//! The result in words: where it is worst and why, how near it is region by region, and what to try.

use std::fmt::Write as _;

use mesh_core::{measure, Point3, Positions, TriangleBvh, VertexData, VertexId};
use serde::Serialize;

use crate::input::Pair;
use crate::landmarks::label;

/// Places nearer to each other than this, in longest sides of the target's box, are one.
const SAME_PLACE: f64 = 0.08;
/// A place is named if it is this far off, likewise.
const WORTH_NAMING: f64 = 0.01;
/// How many places are named, each way.
const N_PLACES: usize = 3;
/// A landmark this near, likewise, gives a place its name.
const NEAR_LANDMARK: f64 = 0.2;
/// Target vertices that are looked at, at most.
const N_PROBES: usize = 20_000;
/// Regions are told one by one up to this many.
const MAX_REGIONS: usize = 16;

/// What the run knows about parts that were left out.
pub(crate) struct Counted<'a> {
    /// How strongly each vertex was attracted; 0 where it was left out.
    pub(crate) attraction: &'a VertexData<f64>,
    /// Whether the target ends where the source goes on, or the other way round.
    pub(crate) mesh_exceeds: bool,
    pub(crate) target_exceeds: bool,
}

/// Everything there is to say.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Explanation {
    /// The worst places, worst first.
    pub(crate) places: Vec<WorstPlace>,
    /// Distances of the parts that have a counterpart, all together and region by region.
    pub(crate) regions: Vec<RegionDistances>,
    /// What to try, in words.
    pub(crate) advice: Vec<String>,
}

/// A place where the result is far from the target.
#[derive(Debug, Serialize)]
pub(crate) struct WorstPlace {
    /// In words.
    pub(crate) text: String,
    /// Where, in the target's coordinates.
    pub(crate) point: [f64; 3],
    /// Distance in longest sides of the target's box.
    pub(crate) distance: f64,
}

/// Distances to the target over the vertices of a region, in longest sides of the target's box.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct RegionDistances {
    pub(crate) name: String,
    pub(crate) n_vertices: usize,
    /// By the area of the vertices.
    pub(crate) mean: f64,
    pub(crate) p50: f64,
    pub(crate) p90: f64,
    pub(crate) p99: f64,
    pub(crate) max: f64,
}

/// Explains a result whose vertices lie `distances` from the target.
pub(crate) fn explain(
    pair: &Pair,
    draped: &Positions,
    distances: &VertexData<f64>,
    counted: &Counted<'_>,
) -> Explanation {
    let case = Case::new(pair, draped, distances, counted);
    let mut places = case.of_source();
    places.extend(case.of_target());
    places.sort_by(|a, b| b.distance.total_cmp(&a.distance));
    let advice = case.advice(&places);
    Explanation {
        regions: case.regions(),
        places,
        advice,
    }
}

struct Case<'a> {
    pair: &'a Pair,
    draped: &'a Positions,
    distances: &'a VertexData<f64>,
    counted: &'a Counted<'a>,
    /// Vertices that have a counterpart.
    counts: VertexData<bool>,
    /// Longest side of the target's box.
    side: f64,
}

impl<'a> Case<'a> {
    fn new(
        pair: &'a Pair,
        draped: &'a Positions,
        distances: &'a VertexData<f64>,
        counted: &'a Counted<'a>,
    ) -> Self {
        let surface = &pair.target.surface;
        let hits = surface.closest_points(draped.as_slice());
        let counts = draped
            .ids()
            .zip(&hits)
            .map(|(v, hit)| {
                let is_beyond = counted.mesh_exceeds && surface.is_on_boundary(&hit.location);
                let is_used = !pair.source.mesh.outgoing(v).is_empty();
                is_used && counted.attraction[v] > 0.0 && !is_beyond
            })
            .collect();
        Self {
            side: surface.bounds().longest_side(),
            pair,
            draped,
            distances,
            counted,
            counts,
        }
    }

    /// Places of the source that are far from the target.
    fn of_source(&self) -> Vec<WorstPlace> {
        let counted = self.draped.ids().filter(|&v| self.counts[v]);
        let far = counted.map(|v| (self.distances[v], self.draped[v]));
        let surface = &self.pair.target.surface;
        peaks(far.collect(), SAME_PLACE * self.side)
            .into_iter()
            .map(|(distance, point)| {
                let hit = surface.closest_point(&point);
                let why = if surface.is_on_boundary(&hit.location) {
                    "the target ends there"
                } else {
                    "the target is not reached"
                };
                self.place(
                    distance,
                    point,
                    &format!("{:.1} % from the target, {why}", 100.0 * distance),
                )
            })
            .collect()
    }

    /// Places of the target that are far from the result.
    fn of_target(&self) -> Vec<WorstPlace> {
        if self.counted.target_exceeds {
            return Vec::new();
        }
        let source = &self.pair.source;
        let bvh = TriangleBvh::new(source.triangulation.corners(self.draped).collect());
        let vertices = self.pair.target.surface.vertices();
        let step = vertices.len().div_ceil(N_PROBES).max(1);
        let probes: Vec<Point3> = vertices.into_iter().step_by(step).collect();
        let far = bvh
            .closest_points(&probes)
            .iter()
            .zip(&probes)
            .map(|(hit, p)| (hit.distance_squared.sqrt() / self.side, *p))
            .collect();
        peaks(far, SAME_PLACE * self.side)
            .into_iter()
            .map(|(distance, point)| {
                let text = format!(
                    "target {:.1} % away, no source area there",
                    100.0 * distance
                );
                self.place(distance, point, &text)
            })
            .collect()
    }

    fn place(&self, distance: f64, point: Point3, what: &str) -> WorstPlace {
        let name = self.name_of(&point);
        WorstPlace {
            text: format!("{name}: {what}; add a landmark or accept"),
            point: point.coords.into(),
            distance,
        }
    }

    /// What a user would call the place: the landmark near it, else its coordinates.
    fn name_of(&self, point: &Point3) -> String {
        let near = self
            .pair
            .landmarks
            .iter()
            .enumerate()
            .map(|(k, l)| ((l.target - point).norm() / self.side, k))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|(distance, _)| *distance < NEAR_LANDMARK);
        let at = format!("({:.4}, {:.4}, {:.4})", point.x, point.y, point.z);
        match near {
            Some((distance, k)) => {
                let name = label(k, self.pair.landmarks[k].name.as_deref());
                format!("{:.0} % from {name}, at {at}", 100.0 * distance)
            }
            None => format!("at {at}"),
        }
    }

    /// Distances over all that counts, then over each named region.
    fn regions(&self) -> Vec<RegionDistances> {
        let source = &self.pair.source;
        let mut areas = VertexData::new(self.draped.len(), 0.0);
        for (t, corners) in source
            .triangulation
            .triangles()
            .iter()
            .zip(source.triangulation.corners(self.draped))
        {
            t.iter()
                .for_each(|&v| areas[v] += measure::triangle_area(corners) / 3.0);
        }
        let summary = |name: String, vertices: &mut dyn Iterator<Item = VertexId>| {
            let list: Vec<(f64, f64)> = vertices
                .filter(|&v| self.counts[v])
                .map(|v| (self.distances[v], areas[v]))
                .collect();
            region(name, list)
        };
        let all = summary(
            "all that has a counterpart".to_owned(),
            &mut self.draped.ids(),
        );
        let mut regions: Vec<RegionDistances> = all.into_iter().collect();
        let named = self.named_parts();
        if (2..=MAX_REGIONS).contains(&named.len()) {
            for (name, vertices) in named {
                regions.extend(summary(name, &mut vertices.into_iter()));
            }
        }
        regions
    }

    /// The vertices of each group, or object, or material, whichever the file tells apart.
    fn named_parts(&self) -> Vec<(String, Vec<VertexId>)> {
        let contents = self.pair.file.contents();
        let mesh = &self.pair.source.mesh;
        let lists = [&contents.groups, &contents.objects, &contents.materials];
        let Some(list) = lists.into_iter().find(|list| list.len() > 1) else {
            return Vec::new();
        };
        let part = |named: &mesh_core::io::NamedFaces| {
            let rows = named.faces.iter().cloned().flatten();
            let faces = rows.filter(|&row| row < mesh.n_faces());
            let mut vertices: Vec<VertexId> = faces
                .flat_map(|row| mesh.face_vertices(mesh_core::FaceId::new(row)))
                .copied()
                .collect();
            vertices.sort_unstable();
            vertices.dedup();
            (named.name.clone(), vertices)
        };
        list.iter().map(part).collect()
    }

    /// What to try, from what is seen.
    fn advice(&self, places: &[WorstPlace]) -> Vec<String> {
        let mut advice = Vec::new();
        let worst = places.first().map_or(0.0, |p| p.distance);
        if worst > 0.1 && !self.counted.target_exceeds && !self.counted.mesh_exceeds {
            advice.push(
                "one shape reaches far beyond the other: try --overlap source-partial, target-partial or both"
                    .to_owned(),
            );
        }
        if !places.is_empty() {
            advice.push(
                "drape landmarks suggest tells where one more landmark would help most".to_owned(),
            );
        }
        advice
    }
}

/// The highest values, each at least [`WORTH_NAMING`] and `apart` from those before.
fn peaks(mut far: Vec<(f64, Point3)>, apart: f64) -> Vec<(f64, Point3)> {
    far.retain(|(d, _)| *d >= WORTH_NAMING);
    far.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut peaks: Vec<(f64, Point3)> = Vec::new();
    for (distance, point) in far {
        if peaks.len() == N_PLACES {
            break;
        }
        if peaks.iter().all(|(_, p)| (p - point).norm() > apart) {
            peaks.push((distance, point));
        }
    }
    peaks
}

/// Percentiles of distances over vertices, the mean by their areas; none without a vertex.
fn region(name: String, mut list: Vec<(f64, f64)>) -> Option<RegionDistances> {
    list.sort_by(|a, b| a.0.total_cmp(&b.0));
    let last = list.len().checked_sub(1)?;
    let at = |share: f64| list[(share * last as f64).round() as usize].0;
    let area: f64 = list.iter().map(|(_, a)| a).sum();
    let weighted: f64 = list.iter().map(|(d, a)| d * a).sum();
    Some(RegionDistances {
        name,
        n_vertices: list.len(),
        mean: if area > 0.0 { weighted / area } else { at(0.5) },
        p50: at(0.5),
        p90: at(0.9),
        p99: at(0.99),
        max: at(1.0),
    })
}

impl Explanation {
    /// For people.
    pub(crate) fn text(&self) -> String {
        let mut text = String::new();
        if !self.regions.is_empty() {
            text += "distance of the vertices to the target, % of its longest side\n";
            text += "      mean    half   90 %   99 %    all\n";
        }
        for r in &self.regions {
            let [mean, p50, p90, p99, max] =
                [r.mean, r.p50, r.p90, r.p99, r.max].map(|d| 100.0 * d);
            let _ = writeln!(
                text,
                "    {mean:>6.3}  {p50:>6.3} {p90:>6.3} {p99:>6.3} {max:>6.3}  {} ({} vertices)",
                r.name, r.n_vertices
            );
        }
        if !self.places.is_empty() {
            text += "worst places\n";
        }
        for (k, place) in self.places.iter().enumerate() {
            let _ = writeln!(text, "  {}. {}", k + 1, place.text);
        }
        for advice in &self.advice {
            let _ = writeln!(text, "  try: {advice}");
        }
        text
    }

    /// Where the worst places are, to mark them.
    pub(crate) fn marks(&self) -> Vec<Point3> {
        self.places.iter().map(|p| Point3::from(p.point)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_are_apart_and_worth_it() {
        let at = |x: f64| Point3::new(x, 0.0, 0.0);
        let found = peaks(
            vec![
                (0.02, at(0.0)),
                (0.05, at(0.1)),
                (0.03, at(1.0)),
                (0.001, at(5.0)),
            ],
            0.5,
        );
        assert_eq!(found, [(0.05, at(0.1)), (0.03, at(1.0))]);
    }

    #[test]
    fn percentiles_go_by_vertices_and_the_mean_by_area() {
        let list = (0..=100).map(|k| (f64::from(k), if k == 100 { 1.0 } else { 0.0 }));
        let r = region("r".to_owned(), list.collect()).unwrap();
        assert_eq!(
            (r.p50, r.p90, r.p99, r.max, r.mean),
            (50.0, 90.0, 99.0, 100.0, 100.0)
        );
        assert_eq!(region("empty".to_owned(), Vec::new()), None);
    }
}
