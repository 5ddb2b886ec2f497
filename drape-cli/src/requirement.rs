//! `--require 'q>=0.85,folds=0'`: what a result must fulfil, checked after the run.

use std::fmt;
use std::process::ExitCode;
use std::str::FromStr;

/// Figures that a requirement may name, in the order of a report.
const NAMES: [&str; 34] = [
    "q_transfer",
    "dirichlet",
    "dirichlet_raw",
    "hausdorff",
    "hausdorff_result_to_target",
    "hausdorff_target_to_result",
    "mean_l2_result_to_target",
    "mean_l2_target_to_result",
    "mean_l2_sum",
    "mean_sq_result_to_target",
    "mean_sq_target_to_result",
    "mean_sq_sum",
    "p99_sum",
    "angle_deviation_deg",
    "quality_min",
    "quality_mean",
    "skinny",
    "skinny_new",
    "folds",
    "self_intersections",
    "self_intersections_new",
    "crossings",
    "vertices",
    "faces",
    "opposed_faces",
    "landmark_rms",
    "landmark_max",
    "truth_mean",
    "truth_p95",
    "truth_max",
    "left_out",
    "cpu_seconds",
    "wall_seconds",
    "peak_mb",
];

/// A list of conditions, all of which must hold.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Requirements(Vec<Condition>);

/// `figure operator bound`
#[derive(Clone, Debug, PartialEq)]
struct Condition {
    figure: &'static str,
    relation: Relation,
    bound: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Relation {
    AtLeast,
    AtMost,
    Above,
    Below,
    Equal,
}

/// Longer spellings first: `>=` must not be read as `>`.
const RELATIONS: [(&str, Relation); 6] = [
    (">=", Relation::AtLeast),
    ("<=", Relation::AtMost),
    ("==", Relation::Equal),
    (">", Relation::Above),
    ("<", Relation::Below),
    ("=", Relation::Equal),
];

impl FromStr for Requirements {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text
            .split(',')
            .map(str::trim)
            .filter(|part| !part.is_empty());
        let conditions = parts.map(str::parse).collect::<Result<Vec<_>, _>>()?;
        if conditions.is_empty() {
            return Err("names no condition; write for example q>=0.85,folds=0".to_owned());
        }
        Ok(Self(conditions))
    }
}

impl FromStr for Condition {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, relation, bound) = RELATIONS
            .iter()
            .find_map(|&(sign, relation)| {
                text.split_once(sign)
                    .map(|(name, bound)| (name.trim(), relation, bound.trim()))
            })
            .ok_or_else(|| format!("'{text}' has no >=, <=, >, < or ="))?;
        let name = if name == "q" { "q_transfer" } else { name };
        let figure = NAMES.into_iter().find(|n| *n == name).ok_or_else(|| {
            format!(
                "there is no figure '{name}'; there are q, {}",
                NAMES.join(", ")
            )
        })?;
        let number = bound.parse().ok().filter(|bound: &f64| !bound.is_nan());
        let bound = number.ok_or_else(|| format!("'{bound}' in '{text}' is not a number"))?;
        Ok(Self {
            figure,
            relation,
            bound,
        })
    }
}

impl Condition {
    fn holds(&self, value: f64) -> bool {
        match self.relation {
            Relation::AtLeast => value >= self.bound,
            Relation::AtMost => value <= self.bound,
            Relation::Above => value > self.bound,
            Relation::Below => value < self.bound,
            Relation::Equal => value == self.bound,
        }
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = RELATIONS
            .iter()
            .find(|(_, r)| *r == self.relation)
            .map_or("", |(sign, _)| sign);
        write!(f, "{} {} {}", self.figure, sign, self.bound)
    }
}

impl Requirements {
    /// Says what does not hold and gives the exit code for it: 1, or success where all holds.
    pub(crate) fn verdict(&self, figures: &[(&'static str, f64)]) -> ExitCode {
        let unmet = self.unmet(figures);
        for reason in &unmet {
            eprintln!("not met: {reason}");
        }
        ExitCode::from(u8::from(!unmet.is_empty()))
    }

    /// What does not hold, in words. A figure that is not there does not hold.
    pub(crate) fn unmet(&self, figures: &[(&'static str, f64)]) -> Vec<String> {
        let reason = |condition: &Condition| {
            let value = figures
                .iter()
                .find(|(name, _)| *name == condition.figure)
                .map(|(_, value)| *value);
            match value {
                Some(value) if condition.holds(value) => None,
                Some(value) => Some(format!("{condition} is required, but it is {value}")),
                None => Some(format!(
                    "{condition} is required, but this run has no such figure"
                )),
            }
        };
        self.0.iter().filter_map(reason).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIGURES: [(&str, f64); 2] = [("q_transfer", 0.9), ("folds", 0.0)];

    fn unmet(text: &str) -> Vec<String> {
        text.parse::<Requirements>().unwrap().unmet(&FIGURES)
    }

    #[test]
    fn conditions_hold_or_not() {
        assert!(unmet("q>=0.85,folds=0").is_empty());
        assert!(unmet("q >= 0.9, q <= 0.9, q > 0.8, q < 1, folds == 0,").is_empty());
        assert_eq!(
            unmet("q>0.9"),
            ["q_transfer > 0.9 is required, but it is 0.9"]
        );
        assert_eq!(unmet("truth_mean<1").len(), 1);
    }

    #[test]
    fn mistakes_are_named() {
        let error = |text: &str| text.parse::<Requirements>().unwrap_err();
        assert!(error("quality=1").contains("no figure 'quality'"));
        assert!(error("q>=good").contains("'good'"));
        assert!(error("q>=nan").contains("'nan'"));
        assert!(error("q 3").contains("has no"));
        assert!(error(" , ").contains("no condition"));
    }

    #[test]
    fn every_figure_of_a_report_can_be_required() {
        let (mesh, rest) = mesh_core::shapes::quad_sphere(2).into_halfedge().unwrap();
        let target = mesh_core::TriangleSoup::new(mesh_core::shapes::icosphere(1)).unwrap();
        let landmark = mesh_core::Landmark::new(mesh_core::VertexId::new(0), rest.as_slice()[0]);
        let input = mesh_draping::mesh_metrics::EvaluationInput {
            triangulation: &mesh_core::Triangulation::new(&mesh, &rest),
            rest: &rest,
            draped: &rest,
            target: &target,
            landmarks: &[landmark],
            truth: Some(&rest),
        };
        let config = mesh_draping::mesh_metrics::EvaluationConfig {
            n_samples: 10,
            seed: 0,
        };
        let figures = mesh_draping::mesh_metrics::evaluate(input, &config)
            .unwrap()
            .figures();
        assert!(figures.iter().all(|(name, _)| NAMES.contains(name)));
    }
}
