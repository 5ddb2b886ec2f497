//! What the page draws of a shape, as bytes.
//!
//! Little-endian: four u32 (vertices, triangles, edges, 1 where normals follow), then f32 positions in the frame of the
//! shape's box, u32 corners of the triangles, u32 ends of the polygons' edges, f32 normals.

use axum::body::Bytes;
use mesh_core::{Point3, PolygonSoup, Positions, UnitFrame, Vector3};

/// The buffers of one shape.
#[derive(Clone, Debug)]
pub(crate) struct DisplayBuffers {
    pub(crate) bytes: Bytes,
    pub(crate) n_vertices: usize,
    pub(crate) n_faces: usize,
}

impl DisplayBuffers {
    /// Triangles to shade, and the sides of the polygons as lines.
    pub(crate) fn of_mesh(frame: &UnitFrame, soup: &PolygonSoup, triangles: Vec<[u32; 3]>) -> Self {
        let edges = edges(&soup.faces);
        let mut bytes = header(soup.positions.len(), triangles.len(), edges.len(), 0);
        put_points(&mut bytes, frame, &soup.positions);
        put_rows(&mut bytes, triangles.as_flattened());
        put_rows(&mut bytes, edges.as_flattened());
        Self {
            bytes: bytes.into(),
            n_vertices: soup.positions.len(),
            n_faces: soup.faces.len(),
        }
    }

    /// Points with normals.
    pub(crate) fn of_cloud(frame: &UnitFrame, points: &[Point3], normals: &[Vector3]) -> Self {
        let mut bytes = header(points.len(), 0, 0, 1);
        put_points(&mut bytes, frame, points);
        for n in normals {
            n.iter()
                .for_each(|&c| bytes.extend((c as f32).to_le_bytes()));
        }
        Self {
            bytes: bytes.into(),
            n_vertices: points.len(),
            n_faces: 0,
        }
    }
}

/// Positions as the page takes them, in the frame of the target.
pub(crate) fn position_bytes(frame: &UnitFrame, x: &Positions) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(12 * x.len());
    put_points(&mut bytes, frame, x.as_slice());
    bytes
}

fn header(n_vertices: usize, n_triangles: usize, n_edges: usize, has_normals: u32) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(16 + 24 * n_vertices + 12 * n_triangles + 8 * n_edges);
    for n in [
        n_vertices as u32,
        n_triangles as u32,
        n_edges as u32,
        has_normals,
    ] {
        bytes.extend(n.to_le_bytes());
    }
    bytes
}

fn put_points(bytes: &mut Vec<u8>, frame: &UnitFrame, points: &[Point3]) {
    for p in points {
        let unit = frame.to_unit(p);
        unit.iter()
            .for_each(|&c| bytes.extend((c as f32).to_le_bytes()));
    }
}

fn put_rows(bytes: &mut Vec<u8>, rows: &[u32]) {
    rows.iter().for_each(|row| bytes.extend(row.to_le_bytes()));
}

/// Every side of every polygon once.
fn edges(faces: &[Vec<u32>]) -> Vec<[u32; 2]> {
    let sides = faces.iter().flat_map(|f| {
        let next = f.iter().cycle().skip(1);
        f.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)])
    });
    let mut edges: Vec<[u32; 2]> = sides.filter(|[a, b]| a != b).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quad_has_four_edges_and_no_diagonal() {
        let faces = vec![vec![0, 1, 2, 3], vec![3, 2, 4]];
        assert_eq!(
            edges(&faces),
            [[0, 1], [0, 3], [1, 2], [2, 3], [2, 4], [3, 4]]
        );
    }
}
