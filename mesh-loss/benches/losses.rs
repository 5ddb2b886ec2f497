//! Value and gradient of every term, by the number of vertices, and the pairs that the distance terms look at.
#![allow(missing_docs, reason = "criterion's macros make items without docs")]

use std::sync::Arc;

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use mesh_core::sampling::SeededRng;
use mesh_core::{
    shapes, Point3, Positions, Profile, TargetSurface, TriangleSoup, Triangulation, UnitFrame,
    Vector3, VertexData,
};
use mesh_loss::{
    AreaKl, Chamfer, Conformal, CornerAngle, Drift, Flip, FoldBarrier, LocalShape, Loss,
    NormalAgreement, Overlap, SamplingConfig, SmoothChange, SurfaceMatcher, TriangleQuality,
    WorstDistance,
};

const SAMPLING: SamplingConfig = SamplingConfig {
    n_samples: 4000,
    face_uniform: 0.5,
    normal_bias: Some(0.3),
    n_hard: 100,
    mutual: 0.7,
    overlap: Overlap {
        target_exceeds: false,
        mesh_exceeds: false,
    },
};

fn sphere(n: usize) -> (Arc<Triangulation>, Positions) {
    let (mesh, rest) = shapes::quad_sphere(n)
        .into_halfedge()
        .expect("a sphere is a mesh");
    (Arc::new(Triangulation::new(&mesh, &rest)), rest)
}

fn wavy(x: &Positions) -> Positions {
    x.map(|p| p * (1.0 + 0.1 * (5.0 * p.x).sin()))
}

fn losses(c: &mut Criterion) {
    for n in [13, 41, 129] {
        let (t, rest) = sphere(n);
        let x = wavy(&rest);
        let target = TriangleSoup::new(shapes::icosphere(5)).expect("a sphere is a target");
        let target: Arc<dyn TargetSurface> = Arc::new(target);
        let frame = UnitFrame {
            center: Point3::origin(),
            scale: 1.0,
        };
        let mut matcher = SurfaceMatcher::new(&t, &x, &target, frame);
        let mut rng = SeededRng::new(0);
        let mut profile = Profile::off();
        let mut group = c.benchmark_group("resample");
        group.bench_function(BenchmarkId::from_parameter(x.len()), |b| {
            b.iter(|| matcher.resample(&x, &SAMPLING, &mut rng, &mut profile));
        });
        group.finish();

        let matches = matcher.resample(&x, &SAMPLING, &mut rng, &mut profile);
        let worst = WorstDistance {
            matches: &matches,
            share: 0.003,
            tolerance: 0.006,
        };
        let terms: [(&str, &dyn Loss); 12] = [
            ("chamfer", &Chamfer(&matches)),
            ("worst_distance", &worst),
            ("normal_agreement", &NormalAgreement(&matches)),
            ("corner_angle", &CornerAngle::new(&t, &rest)),
            ("area_kl", &AreaKl::new(&t, &rest)),
            ("triangle_quality", &TriangleQuality::new(&t, 0.2)),
            ("flip", &Flip::new(&t, &rest)),
            ("fold_barrier", &FoldBarrier::new(&t, &rest, 0.3)),
            ("conformal", &Conformal::new(&t, &rest)),
            ("local_shape", &LocalShape::new(&t, &rest)),
            ("drift", &Drift::new(&t, &rest)),
            ("smooth_change", &SmoothChange::new(&t, &rest)),
        ];
        let mut group = c.benchmark_group("loss");
        group.throughput(Throughput::Elements(x.len() as u64));
        let mut gradient = VertexData::new(x.len(), Vector3::zeros());
        for (name, loss) in terms {
            group.bench_function(BenchmarkId::new(name, x.len()), |b| {
                b.iter(|| loss.accumulate(&x, 1.0, &mut gradient));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, losses);
criterion_main!(benches);
