//! The demo's pair as files, like any user's.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use mesh_core::io::write_atomic;
use mesh_core::{Point3, Vector3};
use serde_json::json;

use super::creature::{marks, on_source, on_target, source_net, target_net, QUADS_A_SIDE};

/// Where the files of the demo are.
#[derive(Clone, Debug)]
pub(crate) struct DemoFiles {
    pub(crate) source: PathBuf,
    pub(crate) target: PathBuf,
    pub(crate) landmarks: PathBuf,
    pub(crate) truth: PathBuf,
}

/// Writes source, target, landmarks and truth into `folder`, which is made if it is not there.
pub(crate) fn write(folder: &Path) -> anyhow::Result<DemoFiles> {
    fs::create_dir_all(folder)
        .with_context(|| format!("{}: the folder cannot be made", folder.display()))?;
    let files = DemoFiles {
        source: folder.join("source.obj"),
        target: folder.join("target.obj"),
        landmarks: folder.join("landmarks.json"),
        truth: folder.join("truth.obj"),
    };
    let (directions, quads) = source_net();
    let places = |place: fn(&Vector3) -> Point3| directions.iter().map(place).collect::<Vec<_>>();
    write_atomic(
        &files.source,
        source_obj("source", &places(on_source), &quads).as_bytes(),
    )?;
    write_atomic(
        &files.truth,
        source_obj("truth", &places(on_target), &quads).as_bytes(),
    )?;

    let (target_directions, triangles) = target_net();
    let target: Vec<Point3> = target_directions.iter().map(on_target).collect();
    write_atomic(&files.target, target_obj(&target, &triangles).as_bytes())?;
    write_atomic(&files.landmarks, landmarks(&directions)?.as_bytes())?;
    Ok(files)
}

/// Quads with a texture atlas of 3 × 2 tiles, one for each side of the cube they are blown up from.
fn source_obj(name: &str, positions: &[Point3], quads: &[Vec<u32>]) -> String {
    let mut obj = format!("# Built by drape demo: quads, denser around features\no {name}\n");
    write_positions(&mut obj, positions);
    let n = QUADS_A_SIDE;
    for tile in 0..6 {
        for i in 0..=n {
            for j in 0..=n {
                let u = (tile % 3) as f64 + i as f64 / n as f64;
                let v = (tile / 3) as f64 + j as f64 / n as f64;
                let _ = writeln!(obj, "vt {:.6} {:.6}", u / 3.0, v / 2.0);
            }
        }
    }
    for (row, quad) in quads.iter().enumerate() {
        if row % (n * n) == 0 {
            let _ = writeln!(obj, "g side_{}\ns 1", row / (n * n));
        }
        let corners = quad
            .iter()
            .zip(texture_corners(row))
            .map(|(v, vt)| format!(" {}/{}", v + 1, vt + 1));
        let _ = writeln!(obj, "f{}", corners.collect::<String>());
    }
    obj
}

/// Rows of the texture coordinates of a quad of [`mesh_core::shapes::quad_sphere`], which lists its quads side by
/// side, column by column, and turns those of every other side around.
fn texture_corners(row: usize) -> [usize; 4] {
    let n = QUADS_A_SIDE;
    let (tile, i, j) = (row / (n * n), row / n % n, row % n);
    let at = |i: usize, j: usize| tile * (n + 1) * (n + 1) + i * (n + 1) + j;
    let mut corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
    if tile % 2 == 0 {
        corners.reverse();
    }
    corners
}

fn target_obj(positions: &[Point3], triangles: &[Vec<u32>]) -> String {
    let mut obj = String::from(
        "# Built by drape demo: another shape, other triangles, another order\no target\n",
    );
    write_positions(&mut obj, positions);
    for t in triangles {
        let _ = writeln!(obj, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    obj
}

fn write_positions(obj: &mut String, positions: &[Point3]) {
    for p in positions {
        let _ = writeln!(obj, "v {:.6} {:.6} {:.6}", p.x, p.y, p.z);
    }
}

/// Marks the source vertex that is nearest to each place, and where it truly belongs.
fn landmarks(directions: &[Vector3]) -> anyhow::Result<String> {
    let entries: Vec<_> = marks()
        .map(|(name, mark)| {
            let far = |d: &Vector3| (d - mark).norm_squared();
            let nearest = (0..directions.len()).min_by(|&a, &b| far(&directions[a]).total_cmp(&far(&directions[b])));
            let vertex = nearest.unwrap_or(0);
            let target = on_target(&directions[vertex]);
            json!({"name": name, "source": {"vertex": vertex}, "target": {"point": [target.x, target.y, target.z]}})
        })
        .collect();
    Ok(serde_json::to_string_pretty(
        &json!({ "landmarks": entries }),
    )?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn every_texture_coordinate_belongs_to_one_vertex() {
        let (_, quads) = source_net();
        let mut vertex_of = BTreeMap::new();
        for (row, quad) in quads.iter().enumerate() {
            for (vt, &v) in texture_corners(row).into_iter().zip(quad) {
                assert_eq!(*vertex_of.entry(vt).or_insert(v), v, "texture row {vt}");
            }
        }
        assert_eq!(vertex_of.len(), 6 * (QUADS_A_SIDE + 1) * (QUADS_A_SIDE + 1));
    }

    #[test]
    fn landmarks_name_different_vertices() {
        let text = landmarks(&source_net().0).unwrap();
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        let list = json["landmarks"].as_array().unwrap();
        let vertices: std::collections::BTreeSet<u64> = list
            .iter()
            .map(|l| l["source"]["vertex"].as_u64().unwrap())
            .collect();
        assert_eq!(vertices.len(), list.len());
    }
}
