//! A result explained: where it is worst and why, how near it is part by part, and what to try.

use std::fmt;

use mesh_core::{measure, FaceId, Landmark, Point3, Positions, TriangleBvh, VertexData, VertexId};
use mesh_metrics::{percentiles, Counterparts, Report};
use serde::{Serialize, Serializer};

use crate::landmarks::Label;
use crate::Pair;

/// Places nearer to each other than this, in longest sides of the target's box, are one.
const SAME_PLACE: f64 = 0.08;
/// A place is named if it is this far off, likewise.
const WORTH_NAMING: f64 = 0.01;
/// How many places are named, each way.
const N_PLACES: usize = 3;
/// How many places are named where the surface runs through itself.
const N_CROSSINGS: usize = 5;
/// A landmark this near, likewise, gives a place its name.
const NEAR_LANDMARK: f64 = 0.2;
/// From this distance on, likewise, one shape probably reaches beyond the other.
const FAR_BEYOND: f64 = 0.1;
/// Target vertices that are looked at, at most.
const N_PROBES: usize = 20_000;
/// Regions are told one by one up to this many.
const MAX_REGIONS: usize = 16;

/// Where a result is worst, how near it is, and what to try.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Explanation {
    /// The worst places, worst first.
    pub places: Vec<WorstPlace>,
    /// Where surfaces run through each other that did not at rest, the largest places first.
    pub crossings: Vec<CrossingPlace>,
    /// Distances of what has a counterpart, all together and part by part.
    pub regions: Vec<RegionDistances>,
    /// What to try.
    pub advice: Vec<Advice>,
}

/// A place where result and target are far apart. `Display` says it in neutral words.
#[derive(Clone, Debug, PartialEq)]
pub struct WorstPlace {
    /// What is wrong there.
    pub kind: PlaceKind,
    /// Where, in the target's coordinates.
    pub point: Point3,
    /// Distance in longest sides of the target's box.
    pub distance: f64,
    /// The landmark near it, and how far that is, likewise.
    pub near: Option<(Label, f64)>,
}

/// A place where the result runs through itself. `Display` says it in neutral words.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossingPlace {
    /// Where, in the target's coordinates.
    pub point: Point3,
    /// Faces that run through others around it.
    pub n_faces: usize,
    /// The landmark near it, and how far that is, in longest sides of the target's box.
    pub near: Option<(Label, f64)>,
}

/// Why result and target are apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaceKind {
    /// The result does not reach the target.
    NotReached,
    /// The target ends there, and the result goes on.
    TargetEnds,
    /// The target is there, and nothing of the result.
    NotCovered,
}

/// Something to try. `Display` says it in neutral words; how to do it is for the application to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Advice {
    /// One shape reaches far beyond the other: say which is only a part of the other.
    SayWhatIsPartial,
    /// One more landmark may help.
    AddLandmark,
}

/// Distances to the target over the vertices of a part, in longest sides of the target's box.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RegionDistances {
    /// The name of the part.
    pub name: String,
    /// How many vertices it has.
    pub n_vertices: usize,
    /// By the area of the vertices.
    pub mean: f64,
    /// Half of the vertices are nearer.
    pub p50: f64,
    /// Nine in ten are nearer.
    pub p90: f64,
    /// All but one in a hundred are nearer.
    pub p99: f64,
    /// The farthest.
    pub max: f64,
}

/// Writes where a place is.
fn write_place(
    f: &mut fmt::Formatter<'_>,
    near: Option<&(Label, f64)>,
    point: &Point3,
) -> fmt::Result {
    if let Some((label, distance)) = near {
        write!(f, "{:.0} % from {label}, ", 100.0 * distance)?;
    }
    let Point3 { coords: p } = point;
    write!(f, "at ({:.4}, {:.4}, {:.4}): ", p.x, p.y, p.z)
}

impl fmt::Display for CrossingPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_place(f, self.near.as_ref(), &self.point)?;
        let n = self.n_faces;
        write!(f, "the surface runs through itself there, {n} of its faces")
    }
}

impl Serialize for CrossingPlace {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Told {
            text: String,
            point: [f64; 3],
            n_faces: usize,
        }
        Told {
            text: self.to_string(),
            point: self.point.coords.into(),
            n_faces: self.n_faces,
        }
        .serialize(serializer)
    }
}

impl fmt::Display for WorstPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_place(f, self.near.as_ref(), &self.point)?;
        let percent = 100.0 * self.distance;
        match self.kind {
            PlaceKind::NotReached => {
                write!(
                    f,
                    "{percent:.1} % from the target, the target is not reached"
                )
            }
            PlaceKind::TargetEnds => {
                write!(f, "{percent:.1} % from the target, the target ends there")
            }
            PlaceKind::NotCovered => write!(f, "target {percent:.1} % away, no source area there"),
        }?;
        f.write_str("; add a landmark or accept")
    }
}

impl Serialize for WorstPlace {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Told {
            text: String,
            point: [f64; 3],
            distance: f64,
        }
        Told {
            text: self.to_string(),
            point: self.point.coords.into(),
            distance: self.distance,
        }
        .serialize(serializer)
    }
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SayWhatIsPartial => {
                "one shape reaches far beyond the other: say which is only a part of the other"
            }
            Self::AddLandmark => "one more landmark, where it would help most",
        })
    }
}

impl Serialize for Advice {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl Explanation {
    /// Where the worst places are and those where the surface runs through itself, in the target's coordinates.
    pub fn marks(&self) -> Vec<Point3> {
        let worst = self.places.iter().map(|p| p.point);
        worst
            .chain(self.crossings.iter().map(|p| p.point))
            .collect()
    }
}

/// Explains a result that was judged.
pub(crate) fn explain(
    pair: &Pair,
    draped: &Positions,
    report: &Report,
    counterparts: &Counterparts,
) -> Explanation {
    let case = Case::new(pair, draped, &report.vertex_distances, counterparts);
    let mut places = case.of_source();
    places.extend(case.of_target());
    places.sort_by(|a, b| b.distance.total_cmp(&a.distance));
    let advice = case.advice(&places);
    Explanation {
        crossings: case.crossings(&report.places.self_intersecting_new),
        regions: case.regions(),
        places,
        advice,
    }
}

struct Case<'a> {
    pair: &'a Pair,
    draped: &'a Positions,
    distances: &'a VertexData<f64>,
    counterparts: &'a Counterparts,
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
        counterparts: &'a Counterparts,
    ) -> Self {
        let surface = pair.target.judged();
        let hits = surface.closest_points(draped.as_slice());
        let counts = draped
            .ids()
            .zip(&hits)
            .map(|(v, hit)| {
                let is_used = !pair.source.mesh().outgoing(v).is_empty();
                is_used && counterparts.has_vertex(v, hit, surface.as_ref())
            })
            .collect();
        Self {
            side: surface.bounds().longest_side(),
            pair,
            draped,
            distances,
            counterparts,
            counts,
        }
    }

    /// Places of the source that are far from the target.
    fn of_source(&self) -> Vec<WorstPlace> {
        let counted = self.draped.ids().filter(|&v| self.counts[v]);
        let far = counted.map(|v| (self.distances[v], self.draped[v]));
        let surface = self.pair.target.judged();
        peaks(far.collect(), SAME_PLACE * self.side)
            .into_iter()
            .map(|(distance, point)| {
                let hit = surface.closest_point(&point);
                let kind = if surface.is_on_boundary(&hit.location) {
                    PlaceKind::TargetEnds
                } else {
                    PlaceKind::NotReached
                };
                self.place(distance, point, kind)
            })
            .collect()
    }

    /// Places of the target that are far from the result.
    fn of_target(&self) -> Vec<WorstPlace> {
        if self.counterparts.mesh_ends {
            return Vec::new();
        }
        let source = &self.pair.source;
        let bvh = TriangleBvh::new(source.triangulation().corners(self.draped).collect());
        let vertices = self.pair.target.judged().vertices();
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
            .map(|(distance, point)| self.place(distance, point, PlaceKind::NotCovered))
            .collect()
    }

    fn place(&self, distance: f64, point: Point3, kind: PlaceKind) -> WorstPlace {
        WorstPlace {
            kind,
            near: self.landmark_near(&point),
            point,
            distance,
        }
    }

    /// Places where faces run through others: each is a face and all those around it; those with the most come first.
    fn crossings(&self, faces: &[FaceId]) -> Vec<CrossingPlace> {
        let mesh = self.pair.source.mesh();
        let middle = |&f: &FaceId| {
            let corners = mesh.face_vertices(f).iter();
            let sum: mesh_core::Vector3 = corners.map(|&v| self.draped[v].coords).sum();
            Point3::from(sum / mesh.face_vertices(f).len().max(1) as f64)
        };
        let mut left: Vec<Point3> = faces.iter().map(middle).collect();
        let apart = SAME_PLACE * self.side;
        let mut places = Vec::new();
        while let Some(&point) = left.first() {
            let n = left.len();
            left.retain(|p| (p - point).norm() > apart);
            places.push(CrossingPlace {
                near: self.landmark_near(&point),
                n_faces: n - left.len(),
                point,
            });
        }
        places.sort_by_key(|place| std::cmp::Reverse(place.n_faces));
        places.truncate(N_CROSSINGS);
        places
    }

    /// The landmark that gives a place its name.
    fn landmark_near(&self, point: &Point3) -> Option<(Label, f64)> {
        let landmarks: Vec<&Landmark> = Landmark::marked(&self.pair.landmarks).collect();
        let far = landmarks.iter().enumerate();
        let far = far.map(|(k, l)| ((l.target - point).norm() / self.side, k));
        let (distance, k) = far.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let label = Label::new(k, landmarks[k].name.as_deref());
        (distance < NEAR_LANDMARK).then_some((label, distance))
    }

    /// Distances over all that counts, then over each named region.
    fn regions(&self) -> Vec<RegionDistances> {
        let triangulation = self.pair.source.triangulation();
        let mut areas = VertexData::new(self.draped.len(), 0.0);
        let corners = triangulation.corners(self.draped);
        for (t, corners) in triangulation.triangles().iter().zip(corners) {
            t.iter()
                .for_each(|&v| areas[v] += measure::triangle_area(corners) / 3.0);
        }
        let summary = |name: String, vertices: &mut dyn Iterator<Item = VertexId>| {
            let list: Vec<(f64, f64)> = vertices
                .filter(|&v| self.counts[v])
                .map(|v| (self.distances[v], areas[v]))
                .collect();
            region(name, &list)
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
        let Some(file) = self.pair.source.file() else {
            return Vec::new();
        };
        let (contents, mesh) = (file.contents(), self.pair.source.mesh());
        let lists = [&contents.groups, &contents.objects, &contents.materials];
        let Some(list) = lists.into_iter().find(|list| list.len() > 1) else {
            return Vec::new();
        };
        let part = |named: &mesh_core::io::NamedFaces| {
            let rows = named.faces.iter().cloned().flatten();
            let faces = rows.filter(|&row| row < mesh.n_faces());
            let mut vertices: Vec<VertexId> = faces
                .flat_map(|row| mesh.face_vertices(FaceId::new(row)))
                .copied()
                .collect();
            vertices.sort_unstable();
            vertices.dedup();
            (named.name.clone(), vertices)
        };
        list.iter().map(part).collect()
    }

    /// What to try, from what is seen.
    fn advice(&self, places: &[WorstPlace]) -> Vec<Advice> {
        let mut advice = Vec::new();
        let worst = places.first().map_or(0.0, |p| p.distance);
        let is_partial = self.counterparts.mesh_ends || self.counterparts.target_ends;
        if worst > FAR_BEYOND && !is_partial {
            advice.push(Advice::SayWhatIsPartial);
        }
        if !places.is_empty() {
            advice.push(Advice::AddLandmark);
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
fn region(name: String, list: &[(f64, f64)]) -> Option<RegionDistances> {
    if list.is_empty() {
        return None;
    }
    let distances = list.iter().map(|(d, _)| *d);
    let [p50, p90, p99, max] = percentiles(distances, [0.5, 0.9, 0.99, 1.0]);
    let area: f64 = list.iter().map(|(_, a)| a).sum();
    let weighted: f64 = list.iter().map(|(d, a)| d * a).sum();
    Some(RegionDistances {
        name,
        n_vertices: list.len(),
        mean: if area > 0.0 { weighted / area } else { p50 },
        p50,
        p90,
        p99,
        max,
    })
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
        let list: Vec<(f64, f64)> = list.collect();
        let r = region("r".to_owned(), &list).unwrap();
        assert_eq!(
            (r.p50, r.p90, r.p99, r.max, r.mean),
            (50.0, 90.0, 99.0, 100.0, 100.0)
        );
        assert_eq!(region("empty".to_owned(), &[]), None);
    }
}
