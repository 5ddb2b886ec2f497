//! What follows a drape: the target's colours, normals and relief in the source's texture coordinates.

mod atlas;
mod corners;
mod error;
mod finding;
mod maps;
mod paint;
mod picture;
mod sheet;
mod texture;

pub use error::{BakeError, PictureError};
pub use finding::BakeFinding;
pub use maps::Maps;
pub use paint::Paint;
pub use texture::{Depth, Texture};

use mesh_core::io::Rgb;
use mesh_core::measure::vertex_normals;
use mesh_core::{Point3, Positions, Vector3, VertexData};
use mesh_draping::{Source, Target};
use rayon::prelude::*;

use atlas::{Atlas, Texel};
use sheet::Sheet;

/// The least and the most texels along the side of a map.
const SIZES: [usize; 2] = [4, 16384];

/// The places of a target that belong to the texels of a draped source.
///
/// A texel stands for the place on the source's surface under its centre. To it belongs what the smooth normal meets of the
/// target, outwards or inwards, the nearer of both, within a fiftieth of the longest side; of several sheets the one that
/// looks the same way. Where nothing is met, the closest point counts. Every texel is looked at once, at its centre.
///
/// ```no_run
/// use mesh_draping::{Source, Target};
/// use mesh_render::bake::{Bake, Depth, Paint};
/// let (draped, target) = (Source::read("draped.obj")?, Target::read("scan.obj")?);
/// let bake = Bake::new(&draped, draped.rest(), &target, 2048)?;
/// let (texture, _unpainted) = bake.colors(&Paint::read("scan.obj")?)?;
/// texture.save("texture.png", Depth::Eight)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Bake {
    size: usize,
    n_target_vertices: usize,
    sheet: Sheet,
    places: Vec<Baked>,
    findings: Vec<BakeFinding>,
}

/// A texel with its place on the target.
struct Baked {
    at: u32,
    hit: sheet::Hit,
    /// How far out it lies along the source's normal.
    height: f64,
    normal: Vector3,
}

impl Bake {
    /// Lays the source out in a picture of `size` texels along its side, and finds the place of each on the target.
    ///
    /// # Errors
    /// A source without texture coordinates or with none that cover a texel, or a size beyond 4..=16384.
    pub fn new(
        source: &Source,
        draped: &Positions,
        target: &Target,
        size: usize,
    ) -> Result<Self, BakeError> {
        check_size(size)?;
        let Atlas {
            texels,
            mut findings,
        } = Atlas::new(source, size)?;
        let normals = vertex_normals(source.triangulation(), draped);
        let sheet = Sheet::new(target, draped, normals.as_slice())?;
        let surface = Draped {
            source,
            draped,
            normals: &normals,
        };
        let find = |texel: &Texel| {
            let (point, normal) = surface.at(texel);
            let hit = sheet.hit(&point, &normal);
            Baked {
                at: texel.at,
                height: (hit.point - point).dot(&normal),
                hit,
                normal,
            }
        };
        let places: Vec<Baked> = texels.par_iter().with_min_len(256).map(find).collect();
        let n_far = places.iter().filter(|place| !place.hit.is_near).count();
        if n_far > 0 {
            findings.push(BakeFinding::Far {
                share: n_far as f64 / places.len() as f64,
            });
        }
        Ok(Self {
            size,
            n_target_vertices: target.vertices().len(),
            sheet,
            places,
            findings,
        })
    }

    /// What is worth knowing about all its maps.
    pub fn findings(&self) -> &[BakeFinding] {
        &self.findings
    }

    /// The colours of the target, as its file has them, and the share of the texels whose place on the target has none, 0..=1.
    ///
    /// # Errors
    /// Colours of another shape than the target, or none at all the places that are met.
    pub fn colors(&self, paint: &Paint) -> Result<(Texture<3>, f64), BakeError> {
        paint.check(self.n_target_vertices)?;
        let color = |place: &Baked| paint.at(&self.sheet.place(&place.hit));
        let colors: Vec<Option<Rgb>> = self.places.par_iter().map(color).collect();
        let n_unpainted = colors.iter().filter(|c| c.is_none()).count();
        if n_unpainted == colors.len() {
            return Err(paint.no_colors());
        }
        let unpainted = n_unpainted as f64 / colors.len() as f64;
        let places = self.places.iter().zip(colors);
        let given = places.filter_map(|(place, color)| Some((place.at, color?)));
        Ok((Texture::padded(self.size, given), unpainted))
    }

    /// The smooth normals of the target in the coordinates of the result (object space): (n + 1) / 2.
    ///
    /// They turn to the side that the source's faces turn to; where the target has none, the source's own counts.
    pub fn normals(&self) -> Texture<3> {
        let encoded = |place: &Baked| {
            let normal = self.sheet.normal(&place.hit).unwrap_or(place.normal);
            (place.at, [0, 1, 2].map(|k| (0.5 * normal[k] + 0.5) as f32))
        };
        Texture::padded(self.size, self.places.iter().map(encoded))
    }

    /// How far the target lies out along the smooth normals of the draped source: 0.5 + h / (2 scale), and the scale, which
    /// is the largest |h|, in units of the target; 0 where all lies on the target.
    pub fn displacement(&self) -> (Texture<1>, f64) {
        let heights = self.places.iter().map(|place| place.height.abs());
        let scale = heights.fold(0.0, f64::max);
        let unit = if scale > 0.0 { 0.5 / scale } else { 0.0 };
        let encoded = |place: &Baked| (place.at, [(0.5 + unit * place.height) as f32]);
        let texture = Texture::padded(self.size, self.places.iter().map(encoded));
        (texture, scale)
    }
}

/// Refuses a side that no map can have.
fn check_size(size: usize) -> Result<(), BakeError> {
    let [least, most] = SIZES;
    match (least..=most).contains(&size) {
        true => Ok(()),
        false => Err(BakeError::Size { size, least, most }),
    }
}

/// A draped source.
struct Draped<'a> {
    source: &'a Source,
    draped: &'a Positions,
    normals: &'a VertexData<Vector3>,
}

impl Draped<'_> {
    /// The place of a texel and the unit normal there; zero where it is not known.
    fn at(&self, texel: &Texel) -> (Point3, Vector3) {
        let corners = self.source.triangulation().triangles()[texel.triangle as usize];
        let [a, b] = texel.weights.map(f64::from);
        let weighted = corners.into_iter().zip([a, b, 1.0 - a - b]);
        let (mut point, mut normal) = (Vector3::zeros(), Vector3::zeros());
        for (v, weight) in weighted {
            point += self.draped[v].coords * weight;
            normal += self.normals[v] * weight;
        }
        let normal = normal.try_normalize(f64::MIN_POSITIVE);
        (Point3::from(point), normal.unwrap_or_default())
    }
}

#[cfg(test)]
mod tests;
