//! What was decided without being asked, as values.

use std::fmt;

use mesh_core::io::{Finding, MeshFile};

/// From this share on, what is left out of a shape is most of it.
const MOST: f64 = 0.5;

/// Which of the two shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// The mesh that is deformed.
    Source,
    /// The shape that it is draped over.
    Target,
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Source => "source",
            Self::Target => "target",
        })
    }
}

/// Something that was assumed, left out or repaired on the way. `Display` says it in neutral words; how to decide
/// otherwise is for the application to say.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// A file was read although it contradicts itself, or not all of it was read.
    File {
        /// Whose file it is.
        shape: Shape,
        /// What was found in it.
        finding: Finding,
    },
    /// Triangles of the target are no part of its outer surface.
    TrianglesLeftOut {
        /// How many have no area.
        n_slivers: usize,
        /// How many are in crumbs and fins.
        n_crumbs: usize,
        /// How many are of inner walls that no ray from outside reaches.
        n_hidden: usize,
        /// Their share of the target's area, 0..=1.
        share: f64,
    },
    /// Points of the target lie far from all others.
    PointsLeftOut {
        /// How many.
        n: usize,
        /// Of how many.
        n_points: usize,
    },
    /// Points of the target scatter about the surface.
    PointsScatter {
        /// By how much, in longest sides of the target's box.
        scatter: f64,
        /// How many are so far off that they were left out.
        n_left_out: usize,
    },
    /// What the target does not show was taken from the shapes of a population.
    Completed {
        /// How many vertices were moved.
        n_vertices: usize,
        /// How much of the way to where the population expects them, 0..=1: what it explains of what is seen.
        trust: f64,
    },
    /// Too few landmarks say how the source stands: it was found by its shape.
    PoseAssumed {
        /// How many landmarks there are.
        n_landmarks: usize,
        /// By how much the source was turned, in degrees.
        turn_deg: f64,
        /// How far source and target are apart then, on the mean, in longest sides of the target's box.
        cost: f64,
    },
    /// Another pose fits nearly as well.
    PoseAmbiguous {
        /// By how much the source is turned from the one to the other, in degrees.
        turn_deg: f64,
        /// As in [`Self::PoseAssumed`].
        cost: f64,
    },
    /// Inner parts of the source attract nothing.
    InnerPartsFreed {
        /// Their share of the source's area, 0..=1.
        share: f64,
        /// How many are carried along.
        n_free: usize,
        /// How many move as rigid bodies.
        n_rigid: usize,
    },
    /// The source is dense: a coarse stand-in was draped first and carried it.
    StandIn {
        /// Vertices of the stand-in.
        n_vertices: usize,
        /// Vertices of the source.
        n_source: usize,
    },
    /// A part of one shape lies beyond the other, and was left out.
    LeftOut {
        /// The shape that reaches beyond.
        shape: Shape,
        /// The share of its area that lies beyond, 0..=1.
        share: f64,
    },
    /// Folds and skinny triangles were taken out at the end.
    Repaired {
        /// How many.
        n: usize,
    },
    /// Triangles that ran through each other and do not at rest were parted at the end.
    Uncrossed {
        /// How many pairs.
        n: usize,
    },
    /// Surfaces still run through each other at a place, where they do not at rest.
    CrossingLeft {
        /// A vertex there: row of the source's file.
        row: usize,
        /// How many pairs of triangles.
        n: usize,
    },
    /// A fold is left at an edge.
    FoldLeft {
        /// The ends of the edge: rows of the source's file.
        rows: [usize; 2],
    },
    /// A triangle is left skinny.
    SkinnyLeft {
        /// The corners of the triangle: rows of the source's file.
        rows: [usize; 3],
    },
}

impl Note {
    /// What was found in the file of a shape.
    pub(crate) fn of_file(file: &MeshFile, shape: Shape) -> Vec<Self> {
        let findings = file.findings().iter().cloned();
        findings
            .map(|finding| Self::File { shape, finding })
            .collect()
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::File { shape, ref finding } => write!(f, "the file of the {shape}: {finding}"),
            Self::TrianglesLeftOut { .. }
            | Self::PointsLeftOut { .. }
            | Self::PointsScatter { .. } => self.about_target(f),
            Self::PoseAssumed { .. } | Self::PoseAmbiguous { .. } => self.about_pose(f),
            Self::InnerPartsFreed {
                share,
                n_free,
                n_rigid,
            } => write!(
                f,
                "inner parts of the source ({:.1} % of its area) attract nothing: {n_free} carried along, {n_rigid} as \
                 rigid bodies",
                100.0 * share
            ),
            Self::StandIn {
                n_vertices,
                n_source,
            } => write!(
                f,
                "the source is dense: {n_vertices} of its {n_source} vertices were draped first and carried the \
                 others, then all were refined"
            ),
            Self::LeftOut { shape, share } => {
                let (percent, other) = (100.0 * share, shape.other());
                if share > MOST {
                    return write!(
                        f,
                        "MOST OF THE {}, {percent:.0} %, lies beyond the {other} and was left out: only the rest was \
                         draped",
                        shape.to_string().to_uppercase()
                    );
                }
                write!(
                    f,
                    "{percent:.0} % of the {shape} lies beyond the {other} and was left out"
                )
            }
            Self::Completed { n_vertices, trust } => write!(
                f,
                "{n_vertices} vertices that the target does not show were taken from the shapes of the prior, which explain \
                 {:.0} % of how what it shows differs from the source at rest",
                100.0 * trust
            ),
            Self::Repaired { .. }
            | Self::Uncrossed { .. }
            | Self::CrossingLeft { .. }
            | Self::FoldLeft { .. }
            | Self::SkinnyLeft { .. } => self.about_defects(f),
        }
    }
}

impl Shape {
    /// The other of the two.
    fn other(self) -> Self {
        match self {
            Self::Source => Self::Target,
            Self::Target => Self::Source,
        }
    }
}

impl Note {
    /// What was left out of the target, or smoothed.
    fn about_target(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TrianglesLeftOut {
                n_slivers,
                n_crumbs,
                n_hidden,
                share,
            } => {
                let kinds = [
                    (n_slivers, "without area"),
                    (n_crumbs, "in crumbs and fins"),
                    (n_hidden, "of inner walls that no ray from outside reaches"),
                ];
                let counted = kinds.iter().filter(|(n, _)| *n > 0);
                let list: Vec<String> = counted.map(|(n, what)| format!("{n} {what}")).collect();
                write!(
                    f,
                    "triangles of the target were left out as no part of its outer surface: {} ({:.1} % of its area)",
                    list.join(", "),
                    100.0 * share
                )
            }
            Self::PointsLeftOut { n, n_points } => write!(
                f,
                "{n} of {n_points} points of the target lie far from all others and were left out"
            ),
            Self::PointsScatter {
                scatter,
                n_left_out,
            } => write!(
                f,
                "the points of the target scatter by {:.1} % of its longest side; {n_left_out} of them were left out, \
                 and the others count where the planes of their neighbours run",
                100.0 * scatter
            ),
            _ => Ok(()),
        }
    }

    /// How the way the source stands was found.
    fn about_pose(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::PoseAssumed {
                n_landmarks,
                turn_deg,
                cost,
            } => write!(
                f,
                "{} ({}, {:.1} % of the longest side off on the mean); look at the picture",
                found_by_shape(n_landmarks),
                turned(turn_deg),
                100.0 * cost
            ),
            Self::PoseAmbiguous { turn_deg, cost } => write!(
                f,
                "turned by another {turn_deg:.0}° the source fits nearly as well ({:.1} % off): mark two or three \
                 places to decide which is front",
                100.0 * cost
            ),
            _ => Ok(()),
        }
    }

    /// What the last stage took out, and what it could not.
    fn about_defects(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Repaired { n } => {
                write!(f, "{n} folded or skinny triangles were taken out at the end")
            }
            Self::Uncrossed { n } => write!(
                f,
                "{n} pairs of triangles that ran through each other were parted at the end"
            ),
            Self::CrossingLeft { row, n } => write!(
                f,
                "{n} pairs of triangles around vertex {row} still run through each other; a landmark near it may part them"
            ),
            Self::FoldLeft { rows: [a, b] } => write!(
                f,
                "a fold is left at the edge between vertices {a} and {b}; a landmark near it may undo it"
            ),
            Self::SkinnyLeft { rows: [a, b, c] } => write!(
                f,
                "the triangle of vertices {a}, {b} and {c} is left skinny; a landmark near it may widen it"
            ),
            _ => Ok(()),
        }
    }
}

fn found_by_shape(n_landmarks: usize) -> String {
    match n_landmarks {
        0 => "no landmarks: the way the source stands was found by its shape alone".to_owned(),
        1 => "1 landmark: the way the source stands was found by its shape".to_owned(),
        n => format!("{n} landmarks: the way the source stands was found by its shape"),
    }
}

fn turned(turn_deg: f64) -> String {
    if turn_deg < 5.0 {
        "as the files stand".to_owned()
    } else {
        format!("turned by {turn_deg:.0}°")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_note_is_a_sentence_without_options() {
        let notes = [
            Note::TrianglesLeftOut {
                n_slivers: 0,
                n_crumbs: 2,
                n_hidden: 1,
                share: 0.01,
            },
            Note::PointsLeftOut { n: 1, n_points: 9 },
            Note::PointsScatter {
                scatter: 0.01,
                n_left_out: 2,
            },
            Note::PoseAssumed {
                n_landmarks: 0,
                turn_deg: 90.0,
                cost: 0.01,
            },
            Note::PoseAmbiguous {
                turn_deg: 180.0,
                cost: 0.01,
            },
            Note::InnerPartsFreed {
                share: 0.1,
                n_free: 1,
                n_rigid: 2,
            },
            Note::StandIn {
                n_vertices: 3000,
                n_source: 20_000,
            },
            Note::LeftOut {
                shape: Shape::Source,
                share: 0.25,
            },
            Note::Completed {
                n_vertices: 700,
                trust: 0.9,
            },
            Note::Repaired { n: 3 },
            Note::Uncrossed { n: 3 },
            Note::CrossingLeft { row: 1, n: 2 },
            Note::FoldLeft { rows: [1, 2] },
            Note::SkinnyLeft { rows: [1, 2, 3] },
        ];
        for note in notes {
            let text = note.to_string();
            assert!(text.len() > 30 && !text.contains("--"), "{note:?}: {text}");
        }
        let left_out = Note::LeftOut {
            shape: Shape::Source,
            share: 0.25,
        };
        let expected = "25 % of the source lies beyond the target and was left out";
        assert_eq!(left_out.to_string(), expected);
        let most = Note::LeftOut {
            shape: Shape::Target,
            share: 0.625,
        };
        assert!(most.to_string().starts_with("MOST OF THE TARGET, 62 %"));
    }
}
