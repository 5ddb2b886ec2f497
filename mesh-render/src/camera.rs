//! Where a picture is taken from: a direction, an up axis, and a frame that fits the shape.

use std::fmt;
use std::str::FromStr;

use mesh_core::{Point3, Vector3};
use nalgebra::{Matrix3, Rotation3};

/// Which direction points up, and with it where the front is.
///
/// Fronts by convention: +Z for ±Y up (Blender's OBJ export, Maya, glTF), −Y for +Z up (Blender's own axes, scanners), +Y
/// for −Z up, +Z for ±X up. A direction between the axes has the front of the nearest one, turned along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Up {
    direction: Vector3,
}

impl Up {
    /// +X up.
    pub const X: Self = Self::of([1.0, 0.0, 0.0]);
    /// +Y up.
    pub const Y: Self = Self::of([0.0, 1.0, 0.0]);
    /// +Z up.
    pub const Z: Self = Self::of([0.0, 0.0, 1.0]);
    /// −X up.
    pub const MINUS_X: Self = Self::of([-1.0, 0.0, 0.0]);
    /// −Y up.
    pub const MINUS_Y: Self = Self::of([0.0, -1.0, 0.0]);
    /// −Z up.
    pub const MINUS_Z: Self = Self::of([0.0, 0.0, -1.0]);
    /// The directions of the axes, and their names.
    pub(crate) const AXES: [(Self, &'static str); 6] = [
        (Self::X, "x"),
        (Self::MINUS_X, "-x"),
        (Self::Y, "y"),
        (Self::MINUS_Y, "-y"),
        (Self::Z, "z"),
        (Self::MINUS_Z, "-z"),
    ];

    const fn of([x, y, z]: [f64; 3]) -> Self {
        Self {
            direction: Vector3::new(x, y, z),
        }
    }

    /// Up along `direction`, of any length; none where that is zero or not finite.
    pub fn along(direction: &Vector3) -> Option<Self> {
        let direction = direction.try_normalize(0.0)?;
        let is_finite = direction.iter().all(|x| x.is_finite());
        is_finite.then_some(Self { direction })
    }

    /// The unit direction that points up.
    pub fn direction(&self) -> Vector3 {
        self.direction
    }

    /// The axis that is nearest.
    pub(crate) fn nearest_axis(&self) -> Self {
        let nearer = |a: Self, b: Self| {
            let is_nearer = b.direction.dot(&self.direction) > a.direction.dot(&self.direction);
            if is_nearer {
                b
            } else {
                a
            }
        };
        Self::AXES
            .iter()
            .map(|(axis, _)| *axis)
            .fold(Self::Y, nearer)
    }

    /// The shape's directions that are seen to the right, upwards and towards the viewer from the front: its columns.
    fn frame(&self) -> Matrix3<f64> {
        let axis = self.nearest_axis();
        let front = if axis == Self::Z {
            -Vector3::y()
        } else if axis == Self::MINUS_Z {
            Vector3::y()
        } else {
            Vector3::z()
        };
        let up = axis.direction;
        let upright = Matrix3::from_columns(&[up.cross(&front), up, front]);
        // The nearest axis is less than 55° away, so that there is one smallest turn.
        let turn = Rotation3::rotation_between(&up, &self.direction);
        turn.map_or(upright, |turn| turn * upright)
    }
}

/// A text that names no axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("use x, y, z, -x, -y or -z")]
pub struct UpError;

/// `x`, `y`, `z`, `-x`, `-y` or `-z`.
impl FromStr for Up {
    type Err = UpError;

    fn from_str(text: &str) -> Result<Self, UpError> {
        let lower = text.to_ascii_lowercase();
        let named = Self::AXES.iter().find(|(_, name)| *name == lower);
        named.map(|(up, _)| *up).ok_or(UpError)
    }
}

/// The name of the axis, or the three components of a direction between the axes.
impl fmt::Display for Up {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = Self::AXES.iter().find(|(up, _)| up == self);
        if let Some((_, name)) = named {
            return f.write_str(name);
        }
        let [x, y, z] = self.direction.into();
        write!(f, "({x:.2}, {y:.2}, {z:.2})")
    }
}

/// A direction to look from: degrees around the up axis (0 = front, 90 = the side at +X) and above the horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Around the up axis.
    pub azimuth: f64,
    /// Above the horizon.
    pub elevation: f64,
}

impl View {
    /// Three quarters from the front.
    pub const FRONT_QUARTER: Self = Self {
        azimuth: 35.0,
        elevation: 15.0,
    };
    /// Three quarters from behind.
    pub const BACK_QUARTER: Self = Self {
        azimuth: 215.0,
        elevation: 15.0,
    };
}

/// A text that names no direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("use quarter, front, side, back, top or AZIMUTH,ELEVATION in degrees")]
pub struct ViewError;

/// `quarter`, `front`, `side`, `back`, `top`, or azimuth and elevation with a comma between them.
impl FromStr for View {
    type Err = ViewError;

    fn from_str(text: &str) -> Result<Self, ViewError> {
        let view = |azimuth, elevation| Ok(Self { azimuth, elevation });
        match text {
            "quarter" => Ok(Self::FRONT_QUARTER),
            "front" => view(0.0, 0.0),
            "side" => view(90.0, 0.0),
            "back" => view(180.0, 0.0),
            "top" => view(0.0, 90.0),
            _ => text
                .split_once(',')
                .and_then(|(a, e)| Some((a.trim().parse().ok()?, e.trim().parse().ok()?)))
                .filter(|(a, e): &(f64, f64)| a.is_finite() && e.is_finite())
                .map(|(azimuth, elevation)| Self { azimuth, elevation })
                .ok_or(ViewError),
        }
    }
}

/// Three perpendicular unit directions of a picture.
#[derive(Clone, Copy, Debug)]
pub struct Axes {
    /// To the right.
    pub right: Vector3,
    /// Upwards.
    pub up: Vector3,
    /// Out of the picture.
    pub towards_viewer: Vector3,
}

impl Axes {
    /// The directions of `view`.
    pub fn new(view: View, up: Up) -> Self {
        let (sin_a, cos_a) = view.azimuth.to_radians().sin_cos();
        let (sin_e, cos_e) = view.elevation.to_radians().sin_cos();
        let frame = up.frame();
        let to_world = |x, y, z| frame * Vector3::new(x, y, z);
        Self {
            right: to_world(cos_a, 0.0, -sin_a),
            up: to_world(-sin_a * sin_e, cos_e, -cos_a * sin_e),
            towards_viewer: to_world(sin_a * cos_e, sin_e, cos_a * cos_e),
        }
    }
}

/// An orthographic camera: the rectangle of the picture plane that is seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    pub(crate) axes: Axes,
    center: [f64; 2],
    /// Pixels for each unit of length.
    pub(crate) scale: f64,
    size: [f64; 2],
}

/// Part of the picture left free on each side.
const MARGIN: f64 = 0.04;

impl Camera {
    /// The camera that shows all `points` in a picture of `width` × `height` pixels.
    pub(crate) fn fit<'a>(
        axes: Axes,
        points: impl IntoIterator<Item = &'a Point3>,
        [width, height]: [usize; 2],
    ) -> Self {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for p in points {
            let at = [p.coords.dot(&axes.right), p.coords.dot(&axes.up)];
            for k in 0..2 {
                low[k] = low[k].min(at[k]);
                high[k] = high[k].max(at[k]);
            }
        }
        if low[0] > high[0] {
            (low, high) = ([0.0; 2], [0.0; 2]);
        }
        let size = [width as f64, height as f64];
        let fits = [0, 1].map(|k| size[k] * (1.0 - 2.0 * MARGIN) / (high[k] - low[k]));
        let scale = fits[0].min(fits[1]);
        Self {
            axes,
            center: [0, 1].map(|k| 0.5 * (low[k] + high[k])),
            scale: if scale.is_finite() { scale } else { 1.0 },
            size,
        }
    }

    /// Pixel column, pixel row (from the top) and height towards the viewer, all in pixels.
    pub(crate) fn project(&self, p: &Point3) -> [f64; 3] {
        let Axes {
            right,
            up,
            towards_viewer,
        } = self.axes;
        [
            0.5 * self.size[0] + (p.coords.dot(&right) - self.center[0]) * self.scale,
            0.5 * self.size[1] - (p.coords.dot(&up) - self.center[1]) * self.scale,
            p.coords.dot(&towards_viewer) * self.scale,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_right_handed_and_perpendicular() {
        let oblique = Up::along(&Vector3::new(0.3, -2.0, 0.7)).unwrap();
        for up in Up::AXES.map(|(up, _)| up).into_iter().chain([oblique]) {
            for azimuth in [0.0, 35.0, 200.0] {
                let elevation = 20.0;
                let a = Axes::new(View { azimuth, elevation }, up);
                assert!((a.right.cross(&a.up) - a.towards_viewer).norm() < 1e-12);
                assert!((a.right.norm() - 1.0).abs() < 1e-12);
                // cos 20° of what points up is seen upwards.
                assert!((a.up.dot(&up.direction()) - 0.939_692_620_785_908_4).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn fronts_are_those_of_the_programs_that_write_the_files() {
        let front = |up| Axes::new("front".parse().unwrap(), up).towards_viewer;
        assert!((front(Up::Y) - Vector3::z()).norm() < 1e-12);
        assert!((front(Up::Z) + Vector3::y()).norm() < 1e-12);
    }

    #[test]
    fn an_up_is_read_as_it_is_shown() {
        for (up, name) in Up::AXES {
            assert_eq!(
                (name.parse::<Up>().unwrap(), up.to_string()),
                (up, name.to_owned())
            );
        }
        assert!("w".parse::<Up>().is_err() && Up::along(&Vector3::zeros()).is_none());
    }

    #[test]
    fn fitted_points_are_inside_and_touch_the_margin() {
        let points = [
            Point3::new(-3.0, 1.0, 2.0),
            Point3::new(5.0, 4.0, -7.0),
            Point3::new(0.0, 0.0, 0.0),
        ];
        let camera = Camera::fit(Axes::new(View::FRONT_QUARTER, Up::Y), &points, [200, 100]);
        let seen = points.map(|p| camera.project(&p));
        assert!(seen
            .iter()
            .all(|s| (0.0..=200.0).contains(&s[0]) && (0.0..=100.0).contains(&s[1])));
        let touches = seen
            .iter()
            .any(|s| (s[1] - 4.0).abs() < 1e-9 || (s[0] - 8.0).abs() < 1e-9);
        assert!(touches);
    }

    #[test]
    fn views_parse() {
        assert_eq!("side".parse::<View>().unwrap().azimuth, 90.0);
        assert_eq!(
            "10, -5".parse::<View>().unwrap(),
            View {
                azimuth: 10.0,
                elevation: -5.0
            }
        );
        assert!("left".parse::<View>().is_err());
    }
}
