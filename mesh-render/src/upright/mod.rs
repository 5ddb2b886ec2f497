//! Which way is up, found from the shapes.
//!
//! What has feet stands on them. Along each of the six axes of the file the surface is flooded from below: what is wet
//! falls into parts that rise from the ground and join higher up, and these are feet. A horse has three beside the
//! first one, each joined after the length of a leg, on its hooves, and none on its nose. Nothing that is mirrored across
//! a plane has its up across that plane. Where landmarks are named, feet lie below everything else and eyes above mouths.

mod feet;
mod names;
mod outline;

use mesh_draping::landmarks::{source_symmetry, target_symmetry, Symmetry};
use mesh_draping::{Pair, Source, Target};
use nalgebra::Matrix3;

use crate::Up;
use outline::Outline;

/// Evidence for each axis of [`Up::AXES`] to point up, in longest sides of the box.
type Evidence = [f64; 6];

/// Less evidence says nothing.
const LEAST: f64 = 0.1;
/// Of the evidence for the best axis, the next best may have at most so much less than all.
const CONFIDENT: f64 = 0.4;
/// A shape is symmetric if its mirror image is nearer to it than this on the mean, in longest sides of its box.
const SYMMETRIC: f64 = 0.01;
/// The cosine of the angle (40°) up to which an axis of the source is taken for one of the target.
const SAME_AXIS: f64 = 0.766;

/// Which way is up, and how sure that is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Upright {
    /// What points up; +Y where the shapes do not tell.
    pub up: Up,
    /// By which share the evidence for the best axis exceeds that for the next best, 0 to 1; 0 where the shapes do not tell.
    pub confidence: f64,
}

impl Upright {
    /// Which way is up in the target's coordinates. `turn` turns the source as the target stands.
    ///
    /// Evidence of both shapes and of the names of landmarks is added up. An axis of the source is taken for the axis of
    /// the target that `turn` brings it near to, and for a direction of its own where there is no such axis.
    pub fn of_pair(pair: &Pair, turn: &Matrix3<f64>) -> Self {
        let mut of_source = source_evidence(&pair.source);
        let named = names::evidence(&pair.landmarks, pair.source.rest());
        add(&mut of_source, &named);
        let of_target = target_evidence(&pair.target);
        let mut candidates = Up::AXES.map(|(axis, _)| axis).to_vec();
        let mut evidence = of_target.to_vec();
        for (&(axis, _), amount) in Up::AXES.iter().zip(of_source) {
            let Some(turned) = Up::along(&(turn * axis.direction())) else {
                continue;
            };
            let nearest = turned.nearest_axis();
            let is_near = nearest.direction().dot(&turned.direction()) > SAME_AXIS;
            let row = candidates.iter().position(|c| is_near && *c == nearest);
            match row {
                Some(row) => evidence[row] += amount,
                None => {
                    candidates.push(turned);
                    evidence.push(amount);
                }
            }
        }
        Self::best(&candidates, &evidence)
    }

    /// Which way is up in the coordinates of a shape that stands alone.
    pub fn of_shape(shape: &Target) -> Self {
        Self::best(&Up::AXES.map(|(axis, _)| axis), &target_evidence(shape))
    }

    fn best(candidates: &[Up], evidence: &[f64]) -> Self {
        let mut order: Vec<usize> = (0..candidates.len()).collect();
        order.sort_by(|&a, &b| evidence[b].total_cmp(&evidence[a]));
        let (best, next) = (evidence[order[0]], evidence[order[1]]);
        let confidence = if best > 0.0 { 1.0 - next / best } else { 0.0 };
        if best < LEAST || confidence < CONFIDENT {
            return Self {
                up: Up::Y,
                confidence: 0.0,
            };
        }
        Self {
            up: candidates[order[0]],
            confidence,
        }
    }
}

fn add(sum: &mut Evidence, more: &Evidence) {
    sum.iter_mut()
        .zip(more)
        .for_each(|(sum, more)| *sum += more);
}

fn source_evidence(source: &Source) -> Evidence {
    let outline = Outline::of_mesh(source.triangulation(), source.rest());
    in_plane(feet::evidence(&outline), &source_symmetry(source))
}

fn target_evidence(target: &Target) -> Evidence {
    in_plane(
        feet::evidence(&Outline::of_target(target)),
        &target_symmetry(target),
    )
}

/// The evidence without that for the axis across which the shape is mirrored.
fn in_plane(mut evidence: Evidence, symmetry: &Symmetry) -> Evidence {
    if symmetry.misfit < SYMMETRIC {
        evidence[2 * symmetry.axis] = 0.0;
        evidence[2 * symmetry.axis + 1] = 0.0;
    }
    evidence
}

#[cfg(test)]
mod tests {
    use mesh_core::{Landmark, Point3, PolygonSoup, VertexId};
    use mesh_draping::Seams;

    use super::*;

    /// A corner of a box and the opposite one.
    type Block = [[i32; 3]; 2];

    /// A map of space.
    type Map = fn(Point3) -> Point3;

    /// A body on four legs, with a head and a tail; +Y up.
    const ANIMAL: [Block; 7] = [
        [[0, 4, 0], [3, 7, 8]],
        [[0, 0, 0], [1, 4, 1]],
        [[2, 0, 0], [3, 4, 1]],
        [[0, 0, 7], [1, 4, 8]],
        [[2, 0, 7], [3, 4, 8]],
        [[1, 6, 8], [2, 9, 11]],
        [[1, 6, -3], [2, 7, 0]],
    ];
    /// A person with lowered arms; +Y up.
    const PERSON: [Block; 7] = [
        [[0, 0, 0], [1, 6, 1]],
        [[2, 0, 0], [3, 6, 1]],
        [[0, 0, 1], [1, 1, 3]],
        [[2, 0, 1], [3, 1, 3]],
        [[0, 6, 0], [3, 11, 2]],
        [[1, 11, 0], [2, 14, 2]],
        [[-1, 5, 0], [4, 10, 1]],
    ];
    /// A head on a neck that ends flat, with a nose and two ears; +Y up.
    const HEAD: [Block; 5] = [
        [[0, 4, 0], [6, 12, 7]],
        [[1, 0, 1], [5, 4, 5]],
        [[2, 7, 7], [4, 9, 9]],
        [[-1, 7, 2], [0, 10, 4]],
        [[6, 7, 2], [7, 10, 4]],
    ];

    /// The surface of unit cubes in blocks, one mesh of quads, mapped.
    fn solid(blocks: &[Block], map: impl Fn(Point3) -> Point3) -> PolygonSoup {
        let is_inside = |c: [i32; 3]| {
            let is_in = |[low, high]: &Block| (0..3).all(|k| (low[k]..high[k]).contains(&c[k]));
            blocks.iter().any(is_in)
        };
        let mut soup = PolygonSoup {
            positions: Vec::new(),
            faces: Vec::new(),
        };
        let cubes = (0..24 * 24 * 24).map(|k| [k / 576 - 6, k / 24 % 24 - 6, k % 24 - 6]);
        for cube in cubes.filter(|c| is_inside(*c)) {
            for (axis, side) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)] {
                let mut beside = cube;
                beside[axis] += 2 * side - 1;
                if is_inside(beside) {
                    continue;
                }
                let corner = |(u, v): (i32, i32)| {
                    let mut p = cube;
                    p[axis] += side;
                    p[(axis + 1) % 3] += u;
                    p[(axis + 2) % 3] += v;
                    map(Point3::from(p.map(f64::from)))
                };
                let mut quad = [(0, 0), (1, 0), (1, 1), (0, 1)].map(corner);
                if side == 0 {
                    quad.reverse();
                }
                let first = soup.positions.len() as u32;
                soup.positions.extend(quad);
                soup.faces.push((first..first + 4).collect());
            }
        }
        soup.weld(0.0).soup
    }

    /// Maps that lay what stands along +Y along each axis, and that axis.
    fn lying() -> [(Up, Map); 6] {
        [
            (Up::X, |p| Point3::new(p.y, p.z, p.x)),
            (Up::MINUS_X, |p| Point3::new(-p.y, p.x, p.z)),
            (Up::Y, |p| p),
            (Up::MINUS_Y, |p| Point3::new(-p.x, -p.y, p.z)),
            (Up::Z, |p| Point3::new(p.z, p.x, p.y)),
            (Up::MINUS_Z, |p| Point3::new(p.x, p.z, -p.y)),
        ]
    }

    fn pair(source: PolygonSoup, target: PolygonSoup, landmarks: Vec<Landmark>) -> Pair {
        Pair {
            source: Source::of_soup(source, Seams::EXACT).unwrap(),
            target: Target::of_soup(target).unwrap(),
            landmarks,
        }
    }

    #[test]
    fn what_has_feet_is_stood_on_them() {
        for (up, map) in lying() {
            for blocks in [&ANIMAL, &PERSON] {
                let shape = Target::of_soup(solid(blocks, map)).unwrap();
                let found = Upright::of_shape(&shape);
                assert_eq!(found.up, up);
                assert!(found.confidence > 0.5, "{up}: {}", found.confidence);
            }
        }
    }

    #[test]
    fn a_cloud_is_stood_up_as_its_surface_is() {
        let (up, map) = lying()[4];
        let surface = Target::of_soup(solid(&ANIMAL, map)).unwrap();
        let mut rng = mesh_core::sampling::SeededRng::new(3);
        let samples = surface.judged().sample(12_000, &mut rng);
        let points = samples.iter().map(|s| s.point).collect();
        let cloud = Target::of_points(points, None).unwrap();
        assert_eq!(Upright::of_shape(&cloud).up, up);
    }

    #[test]
    fn pieces_stand_together() {
        let (up, map) = lying()[1];
        let mut soup = PolygonSoup {
            positions: Vec::new(),
            faces: Vec::new(),
        };
        for block in ANIMAL {
            soup.append(solid(&[block], map));
        }
        let source = Source::of_soup(soup, Seams::EXACT).unwrap();
        let alone = Upright::best(&Up::AXES.map(|(axis, _)| axis), &source_evidence(&source));
        assert_eq!(alone.up, up);
    }

    #[test]
    fn a_head_stays_as_its_file_has_it() {
        for (_, map) in lying() {
            let shape = Target::of_soup(solid(&HEAD, map)).unwrap();
            let kept = Upright {
                up: Up::Y,
                confidence: 0.0,
            };
            assert_eq!(Upright::of_shape(&shape), kept);
        }
    }

    #[test]
    fn the_rim_of_an_opening_is_no_foot() {
        let mut soup = solid(&ANIMAL, |p| p);
        let is_sole = |face: &Vec<u32>| face.iter().all(|&v| soup.positions[v as usize].y < 0.5);
        let kept = soup.faces.iter().filter(|face| !is_sole(face)).cloned();
        soup.faces = kept.collect();
        let shape = Target::of_soup(soup).unwrap();
        assert_eq!(Upright::of_shape(&shape).confidence, 0.0);
    }

    #[test]
    fn eyes_and_mouth_with_names_stand_a_head_up() {
        let (up, map) = lying()[4];
        let head = solid(&HEAD, map);
        let mark = |name: &str, at: Point3| {
            let at = map(at);
            let distance = |v: &usize| (head.positions[*v] - at).norm();
            let nearest =
                (0..head.positions.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            Landmark {
                name: Some(name.to_owned()),
                ..Landmark::new(VertexId::new(nearest.unwrap()), at)
            }
        };
        let landmarks = vec![
            mark("left eye", Point3::new(5.0, 10.0, 7.0)),
            mark("right eye", Point3::new(1.0, 10.0, 7.0)),
            mark("mouth", Point3::new(3.0, 5.0, 7.0)),
        ];
        let pair = pair(head.clone(), head, landmarks);
        assert_eq!(Upright::of_pair(&pair, &Matrix3::identity()).up, up);
    }

    #[test]
    fn a_target_without_feet_stands_as_the_source_that_is_turned_to_it() {
        let ball = mesh_core::shapes::icosphere(3);
        let pair = pair(solid(&ANIMAL, |p| p), ball, Vec::new());
        let quarter = nalgebra::Rotation3::from_euler_angles(std::f64::consts::FRAC_PI_2, 0.0, 0.0);
        assert_eq!(Upright::of_pair(&pair, quarter.matrix()).up, Up::Z);
        let eighth =
            nalgebra::Rotation3::from_euler_angles(0.5 * std::f64::consts::FRAC_PI_2, 0.0, 0.0);
        let oblique = Upright::of_pair(&pair, eighth.matrix()).up;
        assert!((oblique.direction() - eighth * Up::Y.direction()).norm() < 1e-12);
    }
}
