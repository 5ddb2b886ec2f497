//! The whole method from a program of your own: `cargo run --release -p drape-cli --example library -- SOURCE TARGET OUT`
//!
//! Without landmarks, so source and target must stand alike; `Landmark::new(vertex, point)` adds them.

use std::sync::Arc;

use mesh_core::{io, Landmark, TargetSurface, TriangleSoup, Triangulation};
use mesh_init::{initialize, InitConfig, InitInput};
use mesh_metrics::{evaluate, EvaluationConfig, EvaluationInput};
use neural_drape::{Drape, DrapeConfig, DrapeInput};

fn main() -> anyhow::Result<()> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let [source, target, out] = paths.as_slice() else {
        anyhow::bail!("give SOURCE TARGET OUT");
    };
    let file = io::read_mesh(source)?;
    // Vertices that the file splits along seams of texture coordinates or normals move as one.
    let weld = file.soup().weld(0.0);
    let (mesh, rest) = weld.soup.clone().into_halfedge()?;
    let target: Arc<dyn TargetSurface> = Arc::new(TriangleSoup::new(io::read_soup(target)?)?);
    let landmarks: Vec<Landmark> = Vec::new();

    let input = InitInput {
        mesh: &mesh,
        rest: &rest,
        landmarks: &landmarks,
        target_frame: target.principal_frame(),
    };
    let initial = initialize(input, &InitConfig::standard())?.positions;

    let rest = Arc::new(rest);
    let input = DrapeInput {
        triangulation: &Arc::new(Triangulation::new(&mesh, &rest)),
        rest: &rest,
        initial: &initial,
        target: &target,
        landmarks: &landmarks,
    };
    let mut drape = Drape::new(input, DrapeConfig::standard())?;
    while let Some(_step) = drape.step()? {
        // Read drape.positions(), call drape.set_landmarks(..), or stop, at any step.
    }
    let draped = drape.positions();

    let report = evaluate(
        EvaluationInput {
            mesh: &mesh,
            rest: &rest,
            draped: &draped,
            target: target.as_ref(),
            landmarks: &landmarks,
            truth: None,
        },
        &EvaluationConfig::standard(),
    )?;
    file.write(out, &weld.spread(draped.as_slice()).into())?;
    anyhow::ensure!(
        report.defects.folds == 0,
        "{} edges fold over",
        report.defects.folds
    );
    Ok(())
}
