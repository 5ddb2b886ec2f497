//! A report as a table for people.

use std::fmt;

use mesh_core::io::printable;

use crate::distances::TargetKind;
use crate::report::{CurveFit, Defects, LandmarkFit, Report};

/// Lengths are printed in hundredths of the box side, like the paper's table.
const HUNDREDTHS: f64 = 1e2;
/// Squared lengths, likewise.
const TEN_THOUSANDTHS: f64 = 1e4;

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:<26}{:>10.4}   1 is best",
            "Q_transfer", self.q_transfer
        )?;
        writeln!(
            f,
            "{:<26}{:>10.4}   1 is undistorted",
            "Dirichlet, equal areas", self.dirichlet
        )?;
        writeln!(
            f,
            "{:<26}{:>10.4}   each in its box",
            "Dirichlet, raw", self.dirichlet_raw
        )?;
        writeln!(f)?;
        write_distances(f, self)?;
        writeln!(f)?;
        write_defects(f, &self.defects)?;
        if let Some(fit) = &self.landmarks {
            writeln!(f)?;
            write_landmarks(f, fit)?;
        }
        for (row, fit) in self.curves.iter().enumerate() {
            write_curve(f, row, fit)?;
        }
        if let Some(error) = &self.truth {
            let [mean, p95, max] = [error.mean, error.p95, error.max].map(|d| d * HUNDREDTHS);
            writeln!(f)?;
            writeln!(
                f,
                "from the truth, e-2        mean {mean:.3}, 95 % below {p95:.3}, worst {max:.3}"
            )?;
        }
        Ok(())
    }
}

fn write_distances(f: &mut fmt::Formatter<'_>, report: &Report) -> fmt::Result {
    let (there, back) = (&report.to_target, &report.to_draped);
    let rows = [
        (
            "largest (Hausdorff), e-2",
            HUNDREDTHS,
            there.max,
            back.max,
            Some(report.hausdorff),
        ),
        (
            "mean, e-2",
            HUNDREDTHS,
            there.mean_l2,
            back.mean_l2,
            Some(report.mean_l2_sum()),
        ),
        (
            "mean square, e-4",
            TEN_THOUSANDTHS,
            there.mean_squared,
            back.mean_squared,
            Some(report.mean_squared_sum()),
        ),
        ("50 % below, e-2", HUNDREDTHS, there.p50, back.p50, None),
        ("90 % below, e-2", HUNDREDTHS, there.p90, back.p90, None),
        ("99 % below, e-2", HUNDREDTHS, there.p99, back.p99, None),
    ];
    writeln!(
        f,
        "{:<26}{:>10}{:>12}{:>12}",
        "distance", "to target", "to result", "max or sum"
    )?;
    for (name, unit, there, back, both) in rows {
        write!(f, "{name:<26}{:>10.4}{:>12.4}", there * unit, back * unit)?;
        match both {
            Some(both) => writeln!(f, "{:>12.4}", both * unit)?,
            None => writeln!(f)?,
        }
    }
    match report.target_kind {
        TargetKind::Surface => writeln!(f, "exact, point to surface; 1 is the longest side of the target's box"),
        TargetKind::Cloud => writeln!(
            f,
            "the target is a point cloud: to result exact, to target the nearest point; 1 is the longest side of its box"
        ),
    }
}

fn write_defects(f: &mut fmt::Formatter<'_>, defects: &Defects) -> fmt::Result {
    let count = |f: &mut fmt::Formatter<'_>, name: &str, n: usize| writeln!(f, "{name:<26}{n:>10}");
    count(f, "folded edges", defects.folds)?;
    writeln!(
        f,
        "{:<26}{:>10}   {} in all",
        "skinny triangles, new", defects.skinny_new, defects.skinny
    )?;
    if let Some(n) = defects.opposed_faces {
        count(f, "triangles facing inwards", n)?;
    }
    count(f, "crossings, new", defects.crossings)?;
    writeln!(
        f,
        "{:<26}{:>10}   {} in all",
        "self-intersections, new", defects.self_intersections_new, defects.self_intersections
    )?;
    let (min, mean) = (defects.quality_min, defects.quality_mean);
    writeln!(
        f,
        "{:<26}{mean:>10.4}   worst {min:.4}",
        "triangle quality, mean"
    )?;
    writeln!(
        f,
        "{:<26}{:>10.4}   degrees",
        "corner angle change, mean", defects.angle_deviation_deg
    )
}

fn write_curve(f: &mut fmt::Formatter<'_>, row: usize, fit: &CurveFit) -> fmt::Result {
    let name = fit.name.as_deref().map(printable);
    let name = name.map_or(format!("curve {row}"), |name| format!("curve {name}"));
    let [rms, max] = [fit.rms, fit.max].map(|d| d * HUNDREDTHS);
    writeln!(f, "{name:<26}rms {rms:.3}, worst {max:.3}")
}

fn write_landmarks(f: &mut fmt::Formatter<'_>, fit: &LandmarkFit) -> fmt::Result {
    let [rms, max] = [fit.rms, fit.max].map(|d| d * HUNDREDTHS);
    writeln!(f, "landmarks, e-2             rms {rms:.3}, worst {max:.3}")?;
    for (row, residual) in fit.residuals.iter().enumerate() {
        let name = match &residual.name {
            Some(name) => printable(name).into_owned(),
            None => format!("landmark {row}"),
        };
        writeln!(f, "  {name:<24}{:>10.4}", residual.distance * HUNDREDTHS)?;
    }
    Ok(())
}
