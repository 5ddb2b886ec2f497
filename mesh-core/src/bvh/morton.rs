//! An order of points in which neighbours are close.

use rayon::prelude::*;

use crate::{Aabb, Point3, UnitFrame};

/// Cells along each axis.
const N_CELLS: f64 = 1024.0;

/// The rows of `points` along Morton's curve through the box, which is twice as large as `bounds`; points outside count
/// as on its side, points that are no number as first. At most 2³² points.
pub(super) fn order(points: &[Point3], bounds: &Aabb) -> Vec<u32> {
    let frame = UnitFrame::of(*bounds);
    let mut keys: Vec<u64> = points
        .par_iter()
        .enumerate()
        .map(|(row, p)| {
            let unit = frame.to_unit(p);
            let cell =
                |c: f64| spread(((0.5 * c + 0.5) * N_CELLS).clamp(0.0, N_CELLS - 1.0) as u64);
            let code = cell(unit.x) | cell(unit.y) << 1 | cell(unit.z) << 2;
            code << 32 | row as u64
        })
        .collect();
    keys.par_sort_unstable();
    keys.into_iter().map(|key| key as u32).collect()
}

/// Puts two zeros before each of the ten lowest bits.
fn spread(x: u64) -> u64 {
    let x = (x | x << 16) & 0x0300_00ff;
    let x = (x | x << 8) & 0x0300_f00f;
    let x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_comes_once_and_cells_follow_the_curve() {
        assert_eq!(
            spread(0b11_0000_0001),
            0b1_001_000_000_000_000_000_000_000_001
        );
        let points = [
            [9.0, 9.0, 9.0],
            [f64::NAN, 0.0, 0.0],
            [-9.0; 3],
            [0.4, 0.4, 0.4],
        ];
        let points = points.map(Point3::from);
        let bounds = Aabb {
            min: Point3::new(-0.5, -0.5, -0.5),
            max: Point3::new(0.5, 0.5, 0.5),
        };
        let rows = order(&points, &bounds);
        assert_eq!((rows[0], rows[3]), (2, 0));
        let mut sorted = rows.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, [0, 1, 2, 3]);
    }
}
