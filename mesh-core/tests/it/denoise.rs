//! Clouds whose points scatter about a surface.

use mesh_core::{shapes, Point3, PointCloud, TargetSurface};

fn cloud(points: Vec<Point3>) -> PointCloud {
    PointCloud::new(points, None).expect("points make a cloud")
}

/// A ball of 2 562 points, 0.07 apart, off by up to `noise`.
fn ball(noise: f64) -> Vec<Point3> {
    let mut points = shapes::icosphere(4).positions;
    for (k, p) in points.iter_mut().enumerate() {
        *p *= 1.0 + 2.0 * noise * ((k as f64 * 0.618_034).fract() - 0.5);
    }
    points
}

fn off(points: &[Point3]) -> f64 {
    let off = points.iter().map(|p| (p.coords.norm() - 1.0).abs());
    off.sum::<f64>() / points.len() as f64
}

#[test]
fn exact_points_stay() {
    assert!(cloud(ball(0.0)).denoised().is_none());
    assert!(cloud(shapes::open_grid(12, 12).positions)
        .denoised()
        .is_none());
    assert!(cloud(vec![Point3::origin(); 40]).denoised().is_none());
}

#[test]
fn points_that_scatter_are_moved_back() {
    let noisy = cloud(ball(0.05));
    let denoised = noisy.denoised().unwrap();
    assert!(off(&noisy.vertices()) > 0.024);
    // The mean over 25 points, and the arc that they span, leave 0.01.
    assert!(off(&denoised.cloud.vertices()) < 0.013);
    assert!(denoised.n_left_out < 60, "{}", denoised.n_left_out);
    assert!(denoised.scatter > 0.015 && denoised.scatter < 0.05);
}

#[test]
fn points_beside_the_surface_are_left_out() {
    let mut points = ball(0.05);
    let n = points.len();
    let beside: Vec<Point3> = (0..8).map(|k| points[k * 300] * 1.25).collect();
    points.extend(beside);
    let denoised = cloud(points).denoised().unwrap();
    assert!(denoised.n_left_out >= 8);
    let out = denoised.cloud.vertices();
    assert!(out.len() > n - 60);
    assert!(out.iter().all(|p| p.coords.norm() < 1.2));
}
