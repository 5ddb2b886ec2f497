//! What there is to say about one result.

use mesh_core::{FaceData, FaceId, VertexData};

use crate::distances::TargetKind;

/// Every figure about one result. Lengths are in longest sides of the target's box.
///
/// `Display` gives a table for people; [`Self::figures`] the figures by name.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Report {
    /// Whether the target has triangles or points only.
    pub target_kind: TargetKind,
    /// Vertices of the source.
    pub n_vertices: usize,
    /// Faces of the source, polygons counted once.
    pub n_faces: usize,
    /// Score, 1 is best ([`crate::q_transfer`] with τ = 5).
    pub q_transfer: f64,
    /// Dirichlet energy with both areas scaled to 1; 1 is no distortion ([`crate::dirichlet_unit_area`]).
    pub dirichlet: f64,
    /// The same with rest in its own unit box and draped in the target's: sizes are not made equal.
    pub dirichlet_raw: f64,
    /// Largest distance between the surfaces, either way ([`crate::hausdorff_sampled`]).
    pub hausdorff: f64,
    /// Distances from the draped mesh to the target.
    pub to_target: DistanceSummary,
    /// Distances from the target to the draped mesh.
    pub to_draped: DistanceSummary,
    /// What is bent or broken.
    pub defects: Defects,
    /// How well the landmarks are met; none without landmarks.
    pub landmarks: Option<LandmarkFit>,
    /// How well curves are met, in order.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Vec::is_empty"))]
    pub curves: Vec<CurveFit>,
    /// How far vertices are from where they belong; none where that is not known.
    pub truth: Option<TruthError>,
    /// Where the defects are.
    pub places: Places,
    /// Distance of every vertex to the target.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub vertex_distances: VertexData<f64>,
    /// Stretch of every face ([`crate::face_stretch`]).
    #[cfg_attr(feature = "serde", serde(skip))]
    pub face_stretch: FaceData<f64>,
}

/// Distances one way. Means are over points uniform by area, the rest over the vertices too.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct DistanceSummary {
    /// Mean distance.
    pub mean_l2: f64,
    /// Mean squared distance.
    pub mean_squared: f64,
    /// Half of the distances are below this.
    pub p50: f64,
    /// 90 % of the distances are below this.
    pub p90: f64,
    /// 99 % of the distances are below this.
    pub p99: f64,
    /// Largest distance: the one-sided Hausdorff distance.
    pub max: f64,
}

/// What is bent or broken, counted over the triangles of the rest triangulation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Defects {
    /// Mean absolute change of the corner angles, in degrees.
    pub angle_deviation_deg: f64,
    /// Smallest triangle quality Q_f.
    pub quality_min: f64,
    /// Mean triangle quality Q_f.
    pub quality_mean: f64,
    /// Triangles with Q_f < 0.1.
    pub skinny: usize,
    /// Those of them that were not skinny at rest.
    pub skinny_new: usize,
    /// Edges folded over that were not at rest ([`crate::folded_edges`]).
    pub folds: usize,
    /// Triangles that face against the target; none where its normals have no sign.
    pub opposed_faces: Option<usize>,
    /// Pairs of triangles that pass through each other ([`crate::self_intersections`]).
    pub self_intersections: usize,
    /// Those of them that did not at rest.
    pub self_intersections_new: usize,
    /// Those of these that share no corner ([`crate::new_crossings`]).
    pub crossings: usize,
}

/// How well the landmarks are met that were marked one by one.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LandmarkFit {
    /// Root of the mean squared distance of those with a weight above 0.
    pub rms: f64,
    /// Their largest distance.
    pub max: f64,
    /// Each landmark, in the order given.
    pub residuals: Vec<LandmarkResidual>,
}

/// How far one landmark is from where it belongs.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LandmarkResidual {
    /// What the user calls it.
    pub name: Option<String>,
    /// How far it is off.
    pub distance: f64,
}

/// How far a curve is from where it belongs, over its landmarks.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CurveFit {
    /// What the user calls it.
    pub name: Option<String>,
    /// Root of the mean squared distance.
    pub rms: f64,
    /// Largest distance.
    pub max: f64,
}

/// Distance of the vertices in use from where they belong.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TruthError {
    /// Mean over the vertices.
    pub mean: f64,
    /// 95 % of the vertices are closer than this.
    pub p95: f64,
    /// The worst vertex.
    pub max: f64,
}

/// Faces of the source with a defect, each once, in file order.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Places {
    /// Skinny now, not at rest.
    #[cfg_attr(feature = "serde", serde(serialize_with = "rows"))]
    pub skinny_new: Vec<FaceId>,
    /// On either side of a folded edge.
    #[cfg_attr(feature = "serde", serde(serialize_with = "rows"))]
    pub folded: Vec<FaceId>,
    /// Facing against the target.
    #[cfg_attr(feature = "serde", serde(serialize_with = "rows"))]
    pub opposed: Vec<FaceId>,
    /// Passing through another face, not at rest.
    #[cfg_attr(feature = "serde", serde(serialize_with = "rows"))]
    pub self_intersecting_new: Vec<FaceId>,
}

#[cfg(feature = "serde")]
fn rows<S: serde::Serializer>(faces: &[FaceId], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(faces.iter().map(|f| f.index()))
}

impl Report {
    /// Sum of the mean distances of both directions.
    pub fn mean_l2_sum(&self) -> f64 {
        self.to_target.mean_l2 + self.to_draped.mean_l2
    }

    /// Sum of the mean squared distances of both directions.
    pub fn mean_squared_sum(&self) -> f64 {
        self.to_target.mean_squared + self.to_draped.mean_squared
    }

    /// All figures by name, in a fixed order; those that do not apply to this result are left out.
    pub fn figures(&self) -> Vec<(&'static str, f64)> {
        let (there, back, defects) = (&self.to_target, &self.to_draped, &self.defects);
        let mut figures = vec![
            ("q_transfer", self.q_transfer),
            ("dirichlet", self.dirichlet),
            ("dirichlet_raw", self.dirichlet_raw),
            ("hausdorff", self.hausdorff),
            ("hausdorff_result_to_target", there.max),
            ("hausdorff_target_to_result", back.max),
            ("mean_l2_result_to_target", there.mean_l2),
            ("mean_l2_target_to_result", back.mean_l2),
            ("mean_l2_sum", self.mean_l2_sum()),
            ("mean_sq_result_to_target", there.mean_squared),
            ("mean_sq_target_to_result", back.mean_squared),
            ("mean_sq_sum", self.mean_squared_sum()),
            ("p99_sum", there.p99 + back.p99),
            ("angle_deviation_deg", defects.angle_deviation_deg),
            ("quality_min", defects.quality_min),
            ("quality_mean", defects.quality_mean),
            ("skinny", defects.skinny as f64),
            ("skinny_new", defects.skinny_new as f64),
            ("folds", defects.folds as f64),
            ("self_intersections", defects.self_intersections as f64),
            (
                "self_intersections_new",
                defects.self_intersections_new as f64,
            ),
            ("crossings", defects.crossings as f64),
            ("vertices", self.n_vertices as f64),
            ("faces", self.n_faces as f64),
        ];
        figures.extend(defects.opposed_faces.map(|n| ("opposed_faces", n as f64)));
        if let Some(fit) = &self.landmarks {
            figures.extend([("landmark_rms", fit.rms), ("landmark_max", fit.max)]);
        }
        if let Some(error) = &self.truth {
            figures.extend([
                ("truth_mean", error.mean),
                ("truth_p95", error.p95),
                ("truth_max", error.max),
            ]);
        }
        figures
    }
}
