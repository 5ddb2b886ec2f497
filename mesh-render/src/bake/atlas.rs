//! The texels of a source's texture, each with its place on the source's surface.

use mesh_core::FaceId;
use mesh_draping::Source;

use super::corners::corners_in_face;
use super::error::BakeError;
use super::finding::BakeFinding;

/// A face may reach over this many unit squares of texture coordinates along an axis.
const MOST_SQUARES: f64 = 16.0;
/// A texel is inside a triangle where no corner has a smaller weight: on a side it may belong to two neighbours.
const INSIDE: f64 = 1e-6;

/// A texel that a face covers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Texel {
    /// Where in the picture it is, counted row by row from the top left.
    pub(super) at: u32,
    /// Row of the triangle of the source.
    pub(super) triangle: u32,
    /// Weights of the triangle's first and second corner.
    pub(super) weights: [f32; 2],
}

/// The texels that a source's faces cover in a square picture.
pub(super) struct Atlas {
    /// In the order of the picture.
    pub(super) texels: Vec<Texel>,
    pub(super) findings: Vec<BakeFinding>,
}

/// A triangle in the picture: texel centres lie at whole numbers.
type Flat = [[f64; 2]; 3];

impl Atlas {
    /// Lays the source out in a picture of `size` texels along each side.
    ///
    /// A texel is covered where its centre is: by the first of several faces. Beyond the unit square, coordinates wrap.
    pub(super) fn new(source: &Source, size: usize) -> Result<Self, BakeError> {
        let mut layout = Layout {
            size,
            owner: vec![None; size * size],
            n_doubled: 0,
        };
        let (mut n_without, mut is_wrapped) = (0, false);
        for (t, corners) in uvs(source)?.into_iter().enumerate() {
            let Some(uvs) = corners else {
                n_without += 1;
                continue;
            };
            is_wrapped |= uvs.as_flattened().iter().any(|c| !(0.0..=1.0).contains(c));
            let face = source.triangulation().parent(t).index();
            check_extent(face, &uvs)?;
            layout.draw(t as u32, &uvs);
        }
        layout.finish(n_without, is_wrapped)
    }
}

/// The texture coordinates of each triangle's corners; none where a corner has none.
fn uvs(source: &Source) -> Result<Vec<Option<Flat>>, BakeError> {
    let file = source.file().ok_or(BakeError::NoUvs)?;
    let of_corners = file.looks().corner_uvs.ok_or(BakeError::NoUvs)?;
    let faces = &file.soup().faces;
    let triangulation = source.triangulation();
    let vertex = |row: &u32| {
        source
            .vertex_at(*row as usize)
            .map_or(u32::MAX, |v| v.index() as u32)
    };
    let of_face = |f: usize| {
        let welded: Vec<u32> = faces[f].iter().map(vertex).collect();
        let triangles = triangulation.face_triangles(FaceId::new(f));
        let uvs = &of_corners[f];
        triangles
            .map(|t| {
                let vertices = triangulation.triangles()[t].map(|v| v.index() as u32);
                let [a, b, c] = corners_in_face(&welded, vertices)?;
                let at = |k: u32| uvs.get(k as usize).copied().flatten();
                let flat = [at(a)?, at(b)?, at(c)?];
                flat.as_flattened()
                    .iter()
                    .all(|c| c.is_finite())
                    .then_some(flat)
            })
            .collect::<Vec<_>>()
    };
    Ok((0..triangulation.n_faces()).flat_map(of_face).collect())
}

fn check_extent(face: usize, uvs: &Flat) -> Result<(), BakeError> {
    let extent = |axis: usize| {
        let along = uvs.map(|uv| uv[axis]);
        let most = along.into_iter().fold(f64::NEG_INFINITY, f64::max);
        most - along.into_iter().fold(f64::INFINITY, f64::min)
    };
    let squares = extent(0).max(extent(1));
    if squares > MOST_SQUARES {
        return Err(BakeError::TooWide {
            face,
            squares,
            most: MOST_SQUARES,
        });
    }
    Ok(())
}

struct Layout {
    size: usize,
    owner: Vec<Option<(u32, [f32; 2])>>,
    /// Texels that lie inside a second triangle.
    n_doubled: usize,
}

impl Layout {
    /// Gives the triangle the texels that it covers and that none before it has.
    fn draw(&mut self, triangle: u32, uvs: &Flat) {
        let n = self.size as f64;
        // Whole squares do not matter where coordinates wrap, but cost digits.
        let square = [0, 1].map(|axis| uvs[0][axis].floor());
        let flat = uvs.map(|[u, v]| {
            let (u, v) = (u - square[0], v - square[1]);
            [u * n - 0.5, (1.0 - v) * n - 0.5]
        });
        let Some(weights) = Weights::of(&flat) else {
            return;
        };
        let range = |axis: usize| {
            let along = flat.map(|p| p[axis]);
            let low = along.into_iter().fold(f64::INFINITY, f64::min).ceil();
            let high = along.into_iter().fold(f64::NEG_INFINITY, f64::max).floor();
            low as i64..=high as i64
        };
        for y in range(1) {
            for x in range(0) {
                let w = weights.at([x as f64, y as f64]);
                let least = w.into_iter().fold(f64::INFINITY, f64::min);
                if least >= -INSIDE {
                    let wrap = |k: i64| k.rem_euclid(self.size as i64) as usize;
                    let at = wrap(y) * self.size + wrap(x);
                    self.cover(at, triangle, w, least > INSIDE);
                }
            }
        }
    }

    fn cover(&mut self, at: usize, triangle: u32, weights: [f64; 3], is_inside: bool) {
        match &mut self.owner[at] {
            Some((owner, _)) => {
                self.n_doubled += usize::from(is_inside && *owner != triangle);
            }
            free => *free = Some((triangle, [weights[0] as f32, weights[1] as f32])),
        }
    }

    fn finish(self, n_without: usize, is_wrapped: bool) -> Result<Atlas, BakeError> {
        let owners = self.owner.iter().enumerate();
        let texels: Vec<Texel> = owners
            .filter_map(|(at, owner)| {
                let (triangle, weights) = (*owner)?;
                Some(Texel {
                    at: at as u32,
                    triangle,
                    weights,
                })
            })
            .collect();
        if texels.is_empty() {
            return Err(BakeError::NoTexel);
        }
        let mut findings = Vec::new();
        if n_without > 0 {
            findings.push(BakeFinding::WithoutUvs {
                n_triangles: n_without,
            });
        }
        if is_wrapped {
            findings.push(BakeFinding::Wrapped);
        }
        if self.n_doubled > 0 {
            findings.push(BakeFinding::Overlapping {
                share: self.n_doubled as f64 / texels.len() as f64,
            });
        }
        Ok(Atlas { texels, findings })
    }
}

/// Barycentric coordinates in a triangle of the plane.
struct Weights {
    origin: [f64; 2],
    rows: [[f64; 2]; 2],
}

impl Weights {
    /// None for a triangle without area.
    fn of([a, b, c]: &Flat) -> Option<Self> {
        let ([ux, uy], [vx, vy]) = (minus(a, c), minus(b, c));
        let area = ux * vy - uy * vx;
        (area != 0.0).then(|| Self {
            origin: *c,
            rows: [[vy / area, -vx / area], [-uy / area, ux / area]],
        })
    }

    fn at(&self, p: [f64; 2]) -> [f64; 3] {
        let [x, y] = minus(&p, &self.origin);
        let [a, b] = self.rows.map(|[rx, ry]| rx * x + ry * y);
        [a, b, 1.0 - a - b]
    }
}

fn minus(a: &[f64; 2], b: &[f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}
