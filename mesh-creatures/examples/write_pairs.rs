//! Writes pairs as files: `write_pairs FOLDER PLAN ANGLE RATIO N_LANDMARKS SEEDS`, e.g. `pairs quadruped 60 1.75 16 5`.

use std::fs;
use std::path::Path;

use mesh_creatures::{CreaturePair, Dial, Individual, PairConfig, Plan};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [folder, plan, angle, ratio, n_landmarks, seeds] = args.as_slice() else {
        return Err("write_pairs FOLDER PLAN ANGLE RATIO N_LANDMARKS SEEDS".into());
    };
    let plan: Plan = plan.parse()?;
    let dial = Dial {
        angle: angle.parse()?,
        ratio: ratio.parse()?,
    };
    for seed in 0..seeds.parse()? {
        let target = Individual::drawn(plan, seed, dial);
        let config = PairConfig {
            n_landmarks: n_landmarks.parse()?,
            seed,
            ..PairConfig::standard()
        };
        let pair = CreaturePair::new(&Individual::template(plan), &target, &config);
        let folder = Path::new(folder).join(format!("{plan}_{angle}_{ratio}_{seed}"));
        fs::create_dir_all(&folder)?;
        fs::write(folder.join("source.obj"), pair.source.to_obj())?;
        fs::write(folder.join("target.obj"), pair.surface_obj())?;
        fs::write(folder.join("truth.ply"), pair.truth_ply())?;
        fs::write(folder.join("landmarks.json"), pair.landmarks_json())?;
    }
    Ok(())
}
