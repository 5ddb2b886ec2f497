//! The page of one run: pictures, figures, curves, landmarks, settings.

mod chart;
pub mod html;

use std::fmt::Write as _;

use mesh_core::{Positions, VertexData};
use mesh_draping::landmarks::Label;
use mesh_draping::Outcome;

use crate::gallery::{Gallery, DISTANCE_AT_TOP, STRETCH_AT_TOP, TRUTH_AT_TOP};
use crate::{Image, RenderError, View};
use html::{escape, figure, heat_legend, section, table};

/// The report page of a drape: one file that needs no other.
pub struct Page<'a> {
    /// What the page is called.
    pub title: &'a str,
    /// The drape.
    pub outcome: &'a Outcome,
    /// Its pictures.
    pub gallery: &'a Gallery<'a>,
    /// From where they are taken.
    pub views: &'a [View],
    /// What deserves attention, in the application's words.
    pub warnings: &'a [String],
    /// How long the drape took on the clock, in seconds.
    pub seconds: Option<f64>,
    /// What the drape took: names and values.
    pub times: &'a [(String, String)],
    /// Where each vertex belongs, if known.
    pub truth: Option<&'a Positions>,
}

impl Page<'_> {
    /// The page.
    ///
    /// # Errors
    /// A picture that cannot be encoded.
    pub fn to_html(&self) -> Result<String, RenderError> {
        let run = self.outcome;
        let mut body = format!(
            "<h1>{}</h1>\n<p class=\"soft\">{}</p>\n",
            escape(self.title),
            escape(&self.subtitle())
        );
        body += &cards(run, self.seconds);
        body += &warnings(self.warnings);
        body += &section("Pictures", &self.pictures()?);
        body += &section("Worst places", &worst_places(run));
        body += &section("Heat maps", &self.heat_maps()?);
        body += &section("Distances by region", &regions(run));
        body += &section("Figures", &figures(run));
        body += &section("Landmarks", &landmarks(run));
        body += &section("Loss", &curves(run));
        body += &section("Time and memory", &times(self.times));
        let fold = format!(
            "<details><summary>preset {}, as TOML</summary><pre>{}</pre></details>\n",
            escape(&run.preset.name),
            escape(&run.preset.to_toml())
        );
        body += &section("Settings", &fold);
        Ok(html::page(self.title, &body))
    }

    fn subtitle(&self) -> String {
        let (report, preset) = (&self.outcome.report, &self.outcome.preset);
        let n_landmarks = report
            .landmarks
            .as_ref()
            .map_or(0, |fit| fit.residuals.len());
        format!(
            "{} vertices, {} faces · {n_landmarks} landmarks · preset {}, seed {}",
            report.n_vertices, report.n_faces, preset.name, preset.drape.seed
        )
    }

    fn pictures(&self) -> Result<String, RenderError> {
        let (gallery, run) = (self.gallery, self.outcome);
        let mut rows = String::new();
        for &view in self.views {
            let row = [
                ("source, turned as the target", gallery.source(view)),
                ("target", gallery.target(view)),
                (
                    "initial deformation",
                    gallery.initial(&run.by_landmarks, view),
                ),
                ("result", gallery.result(&run.draped, view)),
            ];
            rows += &figures_of(row)?;
        }
        let up = gallery.up();
        Ok(format!(
            "<div class=\"pictures\">{rows}</div>\n<p class=\"soft\">Up in all pictures: {up} of the target's file.</p>\n"
        ))
    }

    fn heat_maps(&self) -> Result<String, RenderError> {
        let distance = &self.outcome.report.vertex_distances;
        let marks = self.outcome.explanation.marks();
        let pictures = self.views.iter().map(|&view| {
            let (gallery, draped) = (self.gallery, &self.outcome.draped);
            let image = gallery.marked_heat(draped, distance, DISTANCE_AT_TOP, &marks, view);
            ("distance to the target, worst places marked", image)
        });
        let mut html = format!("<div class=\"pictures\">{}</div>\n", figures_of(pictures)?);
        html += &heat_legend("0", &percent_of_side(DISTANCE_AT_TOP));
        html += &self.heat_row(
            "stretch",
            &self
                .gallery
                .stretch_at_vertices(&self.outcome.report.face_stretch),
            STRETCH_AT_TOP,
        )?;
        html += &heat_legend("undistorted", &format!("{} or more", 1.0 + STRETCH_AT_TOP));
        if let Some(truth) = self.truth {
            let error = self.outcome.distances_from(truth);
            html += &self.heat_row("distance from the true place", &error, TRUTH_AT_TOP)?;
            html += &heat_legend("0", &percent_of_side(TRUTH_AT_TOP));
        }
        Ok(html)
    }

    fn heat_row(
        &self,
        caption: &str,
        values: &VertexData<f64>,
        top: f64,
    ) -> Result<String, RenderError> {
        let draped = &self.outcome.draped;
        let pictures = self
            .views
            .iter()
            .map(|&view| (caption, self.gallery.heat(draped, values, top, view)));
        Ok(format!(
            "<div class=\"pictures\">{}</div>\n",
            figures_of(pictures)?
        ))
    }
}

fn percent_of_side(share: f64) -> String {
    format!("{} % of the target's longest side", share * 100.0)
}

fn figures_of<'c>(
    pictures: impl IntoIterator<Item = (&'c str, Image)>,
) -> Result<String, RenderError> {
    let figures = pictures
        .into_iter()
        .map(|(caption, image)| Ok(figure(&image.data_uri()?, caption)));
    figures.collect()
}

/// The figures that tell most, large.
fn cards(run: &Outcome, seconds: Option<f64>) -> String {
    let r = &run.report;
    let mut cards = vec![
        ("Q transfer, 1 is best", format!("{:.3}", r.q_transfer)),
        (
            "Hausdorff, % of side",
            format!("{:.2}", 100.0 * r.hausdorff),
        ),
        (
            "mean distance, % of side",
            format!("{:.3}", 100.0 * r.mean_l2_sum()),
        ),
        ("Dirichlet, 1 is undistorted", format!("{:.3}", r.dirichlet)),
        ("new folds", r.defects.folds.to_string()),
        ("new skinny faces", r.defects.skinny_new.to_string()),
        ("new crossings", r.defects.crossings.to_string()),
    ];
    cards.extend(
        r.landmarks
            .as_ref()
            .map(|fit| ("landmark RMS, % of side", format!("{:.2}", 100.0 * fit.rms))),
    );
    cards.extend(
        r.truth
            .as_ref()
            .map(|t| ("mean error, % of side", format!("{:.3}", 100.0 * t.mean))),
    );
    cards.extend(seconds.map(|s| ("seconds", format!("{s:.1}"))));
    let cards = cards.iter().map(|(name, value)| {
        format!("<div class=\"card\"><b>{value}</b><span>{name}</span></div>")
    });
    format!("<div class=\"cards\">{}</div>\n", cards.collect::<String>())
}

fn warnings(warnings: &[String]) -> String {
    let items: String = warnings
        .iter()
        .map(|w| format!("<li>{}</li>", escape(w)))
        .collect();
    section(
        "Warnings",
        &if items.is_empty() {
            items
        } else {
            format!("<ul class=\"bad\">{items}</ul>\n")
        },
    )
}

/// The worst places and what to try, as a list.
fn worst_places(run: &Outcome) -> String {
    let explanation = &run.explanation;
    let places = explanation.places.iter().map(ToString::to_string);
    let crossings = explanation.crossings.iter().map(ToString::to_string);
    let advice = explanation.advice.iter().map(|a| format!("try: {a}"));
    let items: String = places
        .chain(crossings)
        .chain(advice)
        .map(|text| format!("<li>{}</li>", escape(&text)))
        .collect();
    if items.is_empty() {
        return items;
    }
    format!("<ol>{items}</ol>\n")
}

/// Percentiles of the distances, a row for each region.
fn regions(run: &Outcome) -> String {
    let mut html = String::from(
        "<table><tr><th></th><td>mean</td><td>half</td><td>90 %</td><td>99 %</td><td>all</td></tr>",
    );
    for r in &run.explanation.regions {
        let _ = write!(html, "<tr><th>{}</th>", escape(&r.name));
        for d in [r.mean, r.p50, r.p90, r.p99, r.max] {
            let _ = write!(html, "<td>{:.3}</td>", 100.0 * d);
        }
        html.push_str("</tr>");
    }
    html + "</table>\n<p class=\"soft\">Distance of the vertices to the target, in % of its longest side.</p>\n"
}

fn figures(run: &Outcome) -> String {
    let rows = run
        .report
        .figures()
        .into_iter()
        .map(|(name, value)| (name.replace('_', " "), number(value)));
    format!(
        "{}<p class=\"soft\">Lengths are in longest sides of the target's box; distances from point to surface.</p>\n",
        table(rows)
    )
}

fn number(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e9 {
        format!("{value:.0}")
    } else {
        // Five digits whatever the size: a mean square is a few millionths.
        let digits = (4.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
        format!("{value:.digits$}")
    }
}

/// Each landmark with a bar as long as its distance, and each curve with that of its worst place.
fn landmarks(run: &Outcome) -> String {
    let report = &run.report;
    let fit = report.landmarks.iter();
    let residuals = fit.flat_map(|fit| fit.residuals.iter()).enumerate();
    let rows = residuals.map(|(k, r)| (Label::new(k, r.name.as_deref()), r.distance, None));
    let curves = report.curves.iter().enumerate();
    let curves = curves.map(|(k, c)| {
        let label = Label::of_curve(k, c.name.as_deref());
        (label, c.max, Some(c.rms))
    });
    let rows: Vec<(Label, f64, Option<f64>)> = rows.chain(curves).collect();
    if rows.is_empty() {
        return String::new();
    }
    let longest = rows.iter().map(|row| row.1).fold(0.0, f64::max);
    let mut html = String::from("<table>");
    for (label, distance, rms) in rows {
        let width = if longest > 0.0 {
            160.0 * distance / longest
        } else {
            0.0
        };
        let rms = rms.map(|rms| format!(" at worst, {:.3} % RMS", 100.0 * rms));
        let _ = write!(
            html,
            "<tr><th>{}</th><td><i class=\"bar\" style=\"width:{width:.0}px\"></i>{:.3} %{}</td></tr>",
            escape(&label.to_string()),
            100.0 * distance,
            rms.unwrap_or_default()
        );
    }
    html + "</table>\n<p class=\"soft\">Distance from where it belongs, in % of the target's longest side.</p>\n"
}

fn curves(run: &Outcome) -> String {
    let charts: String = run.history.curves.iter().map(chart::chart).collect();
    if charts.is_empty() {
        charts
    } else {
        format!("<div class=\"charts\">{charts}</div>\n")
    }
}

fn times(times: &[(String, String)]) -> String {
    if times.is_empty() {
        return String::new();
    }
    table(times.iter().cloned())
}
