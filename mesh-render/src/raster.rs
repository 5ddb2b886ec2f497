//! A small rasteriser: shaded triangles with polygon outlines, discs for points, on a depth buffer.

use mesh_core::Vector3;

use crate::camera::{Axes, Camera};
use crate::color::{self, Rgb};
use crate::image::Image;
use crate::model::{Facet, Model};

/// Canvas pixels along each side of a picture pixel.
const SUPERSAMPLING: usize = 2;
/// Half the width of an outline, in canvas pixels.
const HALF_OUTLINE: f64 = 0.9;
const OUTLINE: Rgb = [0.09, 0.11, 0.15];
/// Mean length of a triangle's outlines, in canvas pixels, at which they are drawn fully: denser nets fade.
const CLEAR_OUTLINE_LENGTH: f64 = 16.0;
const MARKER_RADIUS: f64 = 7.0;

/// A square picture and the direction it is taken from.
#[derive(Clone, Copy, Debug)]
pub struct Shot {
    /// The directions of the picture.
    pub axes: Axes,
    /// Pixels along each side.
    pub size: usize,
}

/// How a shape looks.
#[derive(Clone, Debug)]
pub struct Look {
    /// Colour of the material.
    pub color: Rgb,
    /// One value from 0 to 1 per vertex, drawn as a heat map in place of the material.
    pub heat: Option<Vec<f64>>,
    /// Whether the sides of polygons are drawn.
    pub has_outlines: bool,
}

impl Look {
    /// Of one colour, without the sides of polygons.
    pub fn plain(color: Rgb) -> Self {
        Self {
            color,
            heat: None,
            has_outlines: false,
        }
    }

    /// Of one colour, with the sides of polygons.
    pub fn outlined(color: Rgb) -> Self {
        Self {
            has_outlines: true,
            ..Self::plain(color)
        }
    }

    /// A heat map of one value from 0 to 1 per vertex.
    pub fn heat(values: Vec<f64>) -> Self {
        Self {
            heat: Some(values),
            ..Self::plain(color::TARGET)
        }
    }

    fn color_of(&self, vertex: usize) -> Rgb {
        self.heat
            .as_ref()
            .map_or(self.color, |values| color::heat(values[vertex]))
    }
}

/// Draws `model`, framed so that `frame` and the model itself fit, with a dot at each
/// of `markers`.
pub fn draw(
    model: &Model,
    look: &Look,
    markers: &[mesh_core::Point3],
    frame: &[mesh_core::Point3],
    shot: Shot,
) -> Image {
    let canvas_size = [shot.size * SUPERSAMPLING; 2];
    let seen = model.seen_points();
    let camera = Camera::fit(shot.axes, seen.iter().chain(frame), canvas_size);
    let mut canvas = Canvas::new(canvas_size);
    if model.facets.is_empty() {
        draw_cloud(&mut canvas, model, look, &camera);
    } else {
        draw_facets(&mut canvas, model, look, &camera);
    }
    for marker in markers {
        let [x, y, z] = camera.project(marker);
        canvas.ball([x, y, z + MARKER_RADIUS], MARKER_RADIUS, color::LANDMARK);
    }
    canvas.into_image()
}

fn draw_facets(canvas: &mut Canvas, model: &Model, look: &Look, camera: &Camera) {
    let projected: Vec<[f64; 3]> = model.positions.iter().map(|p| camera.project(p)).collect();
    for facet in &model.facets {
        let Some(shape) = ScreenTriangle::new(facet.corners.map(|c| projected[c])) else {
            continue;
        };
        let flat = mesh_core::measure::triangle_normal(facet.corners.map(|c| model.positions[c]))
            .unwrap_or_default();
        let is_back = flat.dot(&camera.axes.towards_viewer) < 0.0;
        let colors = facet.corners.map(|c| {
            let smooth = model.normals[c];
            let normal = if smooth.dot(&flat) > 0.2 {
                smooth
            } else {
                flat
            };
            shade(look.color_of(c), normal, is_back, &camera.axes)
        });
        let outlines = if look.has_outlines {
            outline_strength(&shape, facet)
        } else {
            0.0
        };
        canvas.fill(&shape, facet, colors, outlines as f32);
    }
}

/// Full strength for clear nets, fading where their lines come closer than they are wide.
fn outline_strength(shape: &ScreenTriangle, facet: &Facet) -> f64 {
    let outlines = (0..3)
        .filter(|&k| facet.is_outline[k])
        .map(|k| shape.side_lengths[k]);
    let (sum, n) = outlines.fold((0.0, 0.0), |(sum, n), length| (sum + length, n + 1.0));
    (sum / f64::max(n, 1.0) / CLEAR_OUTLINE_LENGTH).clamp(0.06, 0.85)
}

fn side_length(a: [f64; 3], b: [f64; 3]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

fn draw_cloud(canvas: &mut Canvas, model: &Model, look: &Look, camera: &Camera) {
    let [width, height] = canvas.size.map(|s| s as f64);
    let spacing = (0.4 * width * height / model.positions.len().max(1) as f64).sqrt();
    let radius = (0.9 * spacing).clamp(1.5, 9.0);
    for (i, p) in model.positions.iter().enumerate() {
        let towards = camera.axes.towards_viewer;
        let normal = Some(model.normals[i])
            .filter(|n| n.norm_squared() > 0.0)
            .unwrap_or(towards);
        let facing = if normal.dot(&towards) < 0.0 {
            -normal
        } else {
            normal
        };
        let color = shade(look.color_of(i), facing, false, &camera.axes);
        canvas.disc(camera.project(p), radius, color);
    }
}

/// Soft light from above left, a little from the viewer and the sky; the inside of a surface is darker.
fn shade(material: Rgb, normal: Vector3, is_back: bool, axes: &Axes) -> Rgb {
    let n = if is_back { -normal } else { normal };
    let key = (axes.towards_viewer * 0.62 + axes.up * 0.66 - axes.right * 0.42)
        .try_normalize(0.0)
        .unwrap_or_default();
    let halfway = (key + axes.towards_viewer)
        .try_normalize(0.0)
        .unwrap_or_default();
    let diffuse = 0.52 * n.dot(&key).max(0.0) + 0.20 * n.dot(&axes.towards_viewer).max(0.0);
    let sky = 0.34 + 0.10 * n.dot(&axes.up);
    let shine = 0.10 * n.dot(&halfway).max(0.0).powi(24);
    let light = if is_back { 0.62 } else { 1.0 } * (diffuse + sky);
    material.map(|m| (m * light as f32 + shine as f32).min(1.0))
}

/// A triangle on the canvas that covers some area.
struct ScreenTriangle {
    corners: [[f64; 3]; 3],
    twice_area: f64,
    side_lengths: [f64; 3],
}

impl ScreenTriangle {
    fn new(corners: [[f64; 3]; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        (twice_area.is_finite() && twice_area.abs() > 1e-9).then(|| Self {
            corners,
            twice_area,
            side_lengths: [side_length(a, b), side_length(b, c), side_length(c, a)],
        })
    }

    /// Barycentric coordinates of a canvas point.
    fn weights(&self, x: f64, y: f64) -> [f64; 3] {
        let [a, b, c] = self.corners;
        let part = |p: [f64; 3], q: [f64; 3]| {
            ((p[0] - x) * (q[1] - y) - (p[1] - y) * (q[0] - x)) / self.twice_area
        };
        [part(b, c), part(c, a), part(a, b)]
    }

    /// The canvas pixels that may be covered, along `axis`.
    fn range(&self, axis: usize, size: usize) -> std::ops::Range<usize> {
        let values = self.corners.map(|c| c[axis]);
        let low = values
            .into_iter()
            .fold(f64::INFINITY, f64::min)
            .floor()
            .max(0.0);
        let high = values
            .into_iter()
            .fold(0.0, f64::max)
            .ceil()
            .min(size as f64);
        low as usize..(high as usize).max(low as usize)
    }
}

/// Colours and depths; depth grows towards the viewer and is −∞ where nothing is.
struct Canvas {
    size: [usize; 2],
    colors: Vec<Rgb>,
    depths: Vec<f32>,
}

impl Canvas {
    fn new(size: [usize; 2]) -> Self {
        Self {
            size,
            colors: vec![[0.0; 3]; size[0] * size[1]],
            depths: vec![f32::NEG_INFINITY; size[0] * size[1]],
        }
    }

    fn set(&mut self, x: usize, y: usize, depth: f64, color: impl FnOnce() -> Rgb) {
        let at = y * self.size[0] + x;
        if depth as f32 > self.depths[at] {
            self.depths[at] = depth as f32;
            self.colors[at] = color();
        }
    }

    fn fill(
        &mut self,
        shape: &ScreenTriangle,
        facet: &Facet,
        colors: [Rgb; 3],
        outline_strength: f32,
    ) {
        for y in shape.range(1, self.size[1]) {
            for x in shape.range(0, self.size[0]) {
                let w = shape.weights(x as f64 + 0.5, y as f64 + 0.5);
                if w.iter().any(|&w| w < 0.0) {
                    continue;
                }
                let depth = (0..3).map(|k| w[k] * shape.corners[k][2]).sum();
                self.set(x, y, depth, || {
                    let inside =
                        [0, 1, 2].map(|c| (0..3).map(|k| w[k] as f32 * colors[k][c]).sum());
                    color::mix(
                        inside,
                        OUTLINE,
                        outline_strength * outline_coverage(shape, facet, w),
                    )
                });
            }
        }
    }

    /// A flat disc that faces the viewer.
    fn disc(&mut self, [cx, cy, depth]: [f64; 3], radius: f64, color: Rgb) {
        self.round([cx, cy], radius, |_, _| (depth, color));
    }

    /// A small shaded ball with a light rim.
    fn ball(&mut self, [cx, cy, depth]: [f64; 3], radius: f64, color: Rgb) {
        self.round([cx, cy], radius, |dx, dy| {
            let height = (1.0 - (dx * dx + dy * dy)).max(0.0).sqrt();
            let light = 0.65 + 0.35 * (0.8 * height - 0.4 * (dx + dy)).max(0.0);
            let rim = [1.0; 3];
            let fill = color.map(|c| c * light as f32);
            (
                depth + height * radius,
                if dx.hypot(dy) > 0.78 { rim } else { fill },
            )
        });
    }

    /// Sets the pixels within `radius` of a point; `paint` gets offsets in units of the radius.
    fn round(&mut self, [cx, cy]: [f64; 2], radius: f64, paint: impl Fn(f64, f64) -> (f64, Rgb)) {
        let range = |c: f64, size: usize| {
            let low = (c - radius).floor().clamp(0.0, size as f64) as usize;
            low..((c + radius).ceil().clamp(low as f64, size as f64) as usize)
        };
        for y in range(cy, self.size[1]) {
            for x in range(cx, self.size[0]) {
                let (dx, dy) = (
                    (x as f64 + 0.5 - cx) / radius,
                    (y as f64 + 0.5 - cy) / radius,
                );
                if dx * dx + dy * dy <= 1.0 {
                    let (depth, color) = paint(dx, dy);
                    self.set(x, y, depth, || color);
                }
            }
        }
    }

    /// Averages the canvas pixels of each picture pixel; uncovered ones become transparency.
    fn into_image(self) -> Image {
        let mut image = Image::new(self.size[0] / SUPERSAMPLING, self.size[1] / SUPERSAMPLING);
        for y in 0..image.height() {
            for x in 0..image.width() {
                image.set_pixel(x, y, self.average(x, y));
            }
        }
        image
    }

    fn average(&self, x: usize, y: usize) -> [u8; 4] {
        let mut sum = [0.0; 3];
        let mut n_covered = 0;
        for j in 0..SUPERSAMPLING {
            for i in 0..SUPERSAMPLING {
                let at = (y * SUPERSAMPLING + j) * self.size[0] + x * SUPERSAMPLING + i;
                if self.depths[at] > f32::NEG_INFINITY {
                    n_covered += 1;
                    sum = [0, 1, 2].map(|k| sum[k] + self.colors[at][k]);
                }
            }
        }
        let [r, g, b] = sum.map(|s| color::byte(s / n_covered.max(1) as f32));
        let alpha = n_covered as f32 / (SUPERSAMPLING * SUPERSAMPLING) as f32;
        [r, g, b, color::byte(alpha)]
    }
}

/// How much of the pixel an outline covers, from its distance to the polygon's sides.
fn outline_coverage(shape: &ScreenTriangle, facet: &Facet, w: [f64; 3]) -> f32 {
    let nearest = (0..3)
        .filter(|&k| facet.is_outline[k])
        .map(|k| w[(k + 2) % 3] * shape.twice_area.abs() / shape.side_lengths[k])
        .fold(f64::INFINITY, f64::min);
    (HALF_OUTLINE + 0.5 - nearest).clamp(0.0, 1.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Up, View};

    fn shot(azimuth: f64) -> Shot {
        let view = View {
            azimuth,
            elevation: 0.0,
        };
        Shot {
            axes: Axes::new(view, Up::Y),
            size: 64,
        }
    }

    #[test]
    fn a_sphere_is_a_disc_of_the_right_size() {
        let model = Model::of_soup(&mesh_core::shapes::icosphere(3)).unwrap();
        let image = draw(&model, &Look::plain(color::RESULT), &[], &[], shot(20.0));
        let covered: f64 = (0..64 * 64)
            .map(|i| f64::from(image.pixel(i % 64, i / 64)[3]) / 255.0)
            .sum();
        let radius = 0.5 * 64.0 * 0.92;
        let disc = std::f64::consts::PI * radius * radius;
        assert!((covered / disc - 1.0).abs() < 0.03, "{covered} of {disc}");
        assert_eq!(image.pixel(0, 0)[3], 0);
    }

    #[test]
    fn what_is_nearer_hides_what_is_behind() {
        let mut soup = mesh_core::shapes::open_grid(1, 1);
        let near = mesh_core::shapes::open_grid(1, 1);
        soup.positions
            .extend(near.positions.iter().map(|p| p + Vector3::z()));
        soup.faces.push(vec![4, 5, 7, 6]);
        let model = Model::of_soup(&soup).unwrap();
        let heat = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
        let image = draw(&model, &Look::heat(heat), &[], &[], shot(0.0));
        let [r, _, b, _] = image.pixel(32, 32);
        assert!(r > b, "the bright sheet in front is seen");
    }

    #[test]
    fn outlines_darken_the_sides_of_a_quad_but_not_its_diagonal() {
        let model = Model::of_soup(&mesh_core::shapes::open_grid(1, 1)).unwrap();
        let image = draw(&model, &Look::outlined([1.0; 3]), &[], &[], shot(0.0));
        let middle = image.pixel(32, 32)[0];
        let on_diagonals = [image.pixel(20, 20)[0], image.pixel(44, 20)[0]];
        assert!(on_diagonals.iter().all(|&p| p.abs_diff(middle) < 12));
        assert!(image.pixel(2, 32)[0] < middle - 60);
    }

    #[test]
    fn clouds_and_empty_models_draw() {
        let cloud = Model::cloud(&mesh_core::shapes::icosphere(2).positions, None);
        assert!(
            draw(&cloud, &Look::plain(color::TARGET), &[], &[], shot(0.0)).pixel(32, 32)[3] > 0
        );
        let nothing = Model::cloud(&[], None);
        assert_eq!(
            draw(&nothing, &Look::plain(color::TARGET), &[], &[], shot(0.0)).pixel(32, 32)[3],
            0
        );
    }
}
