//! An insect on six legs, with antennae.

use mesh_core::{Point3, Vector3};

use super::builder::{along, joint, point, ring, vector, Builder, Side, Trunk};
use crate::cage::{children, Section};
use crate::proportions::Proportions;
use crate::skeleton::about;
use crate::skin::Skin;

/// Height of the thorax.
const HEIGHT: f64 = 0.24;

/// Measures that several parts share.
struct Frame {
    p: Proportions,
    height: f64,
    girth: f64,
    thorax: usize,
    abdomen: usize,
    head: usize,
}

pub(super) fn build(b: &mut Builder, p: &Proportions) {
    let height = HEIGHT * p.limb_length.max(0.8);
    let thorax = b.root(point(0.0, height, 0.0));
    let turn = [
        about(Vector3::x(), -30.0, 30.0),
        about(Vector3::y(), -30.0, 30.0),
    ];
    let abdomen = b.bone(thorax, point(0.0, height, -0.17), &turn);
    let neck = point(0.0, height + 0.015, 0.17 + 0.02 * p.neck_length);
    let head = b.bone(thorax, neck, &turn);
    let f = Frame {
        p: *p,
        height,
        girth: p.trunk_girth,
        thorax,
        abdomen,
        head,
    };
    let trunk = trunk(b, &f);
    let legs = [("hind", 4, -0.80), ("middle", 5, -0.10), ("fore", 6, 0.70)];
    for (name, ring, yaw) in legs {
        for side in b.sides(&trunk.rings[ring], vector(1.0, -0.5, 0.0)) {
            leg(b, &f, side, (name, yaw));
        }
    }
    let front = trunk.rings[10].clone();
    b.cage = b.cage.refined();
    antennae(b, &f, &children(&front));
}

fn trunk(b: &mut Builder, f: &Frame) -> Trunk {
    let trunk = b.trunk(&sections(f), "thorax");
    b.rename(
        &[trunk.start.clone(), trunk.rings[..3].concat()].concat(),
        "abdomen",
    );
    b.rename(
        &[trunk.end.clone(), trunk.rings[8..].concat()].concat(),
        "head",
    );
    b.tip("end of the abdomen", &trunk.start);
    b.tip("mouth", &trunk.end);
    b.mark_top("abdomen above", &trunk.rings[1], Vector3::y());
    b.mark_top("abdomen below", &trunk.rings[1], -Vector3::y());
    b.mark_top("thorax above", &trunk.rings[5], Vector3::y());
    b.mark_top("head above", &trunk.rings[9], Vector3::y());
    trunk
}

/// From the end of the abdomen to the mouth.
fn sections(f: &Frame) -> [Section; 12] {
    let (g, l, k) = (f.girth, f.p.trunk_length, f.p.head_size);
    let at = |z: f64, y: f64, radii: [f64; 2], skin: Skin| {
        ring(point(0.0, f.height + y, z), Vector3::z(), radii, &skin)
    };
    let waist = -0.16;
    let behind = |z: f64, y: f64, r: f64| {
        let r = r * g * f.p.belly;
        at(waist - z * l, y, [r, 0.9 * r], Skin::of(f.abdomen))
    };
    let chest = |z: f64, r: f64| at(z, 0.0, [r * g, 0.88 * r * g], Skin::of(f.thorax));
    let front = 0.19 + 0.04 * f.p.neck_length;
    let before = |z: f64, y: f64, radii: [f64; 2]| {
        at(
            front + z * k,
            0.015 + y,
            radii.map(|r| r * k),
            Skin::of(f.head),
        )
    };
    let narrow = [0.030 * g.min(k), 0.028 * g.min(k)];
    [
        behind(0.50, -0.035, 0.035),
        behind(0.38, -0.020, 0.110),
        behind(0.20, 0.005, 0.140),
        at(
            waist,
            0.0,
            [0.032 * g, 0.030 * g],
            joint(f.abdomen, f.thorax),
        ),
        chest(-0.12, 0.070),
        chest(-0.03, 0.082),
        chest(0.06, 0.082),
        chest(0.14, 0.066),
        at(
            0.16 + 0.03 * f.p.neck_length,
            0.01,
            narrow,
            joint(f.thorax, f.head),
        ),
        before(0.04, 0.0, [0.074, 0.064]),
        before(0.11, 0.0, [0.080, 0.062]),
        before(0.17, -0.012, [0.042, 0.036]),
    ]
}

fn leg(b: &mut Builder, f: &Frame, side: Side, (name, yaw): (&str, f64)) {
    let l = f.p.limb_length;
    let r = f.p.limb_stoutness();
    let out = vector(side.sign * yaw.cos(), 0.0, yaw.sin());
    let axis = out.cross(&Vector3::y());
    let start = b.cage.face_center(side.face);
    let at = |t: f64, y: f64| Point3::new(start.x + out.x * t * l, y, start.z + out.z * t * l);
    let h = f.height;
    let knee_height = h + 0.10 * l;
    let raise = about(axis, -35.0, 40.0);
    let swing = about(Vector3::y() * side.sign, -40.0, 40.0);
    let femur = b.bone(f.thorax, start, &[swing, raise]);
    let tibia = b.bone(femur, at(0.24, knee_height), &[about(axis, -60.0, 70.0)]);
    let tarsus = b.bone(tibia, at(0.38, 0.035), &[about(axis, -50.0, 60.0)]);
    let stops = [
        (
            at(0.055, h + 0.005),
            [0.022 * r, 0.022 * r],
            joint(f.thorax, femur),
        ),
        (
            at(0.24, knee_height),
            [0.020 * r, 0.020 * r],
            joint(femur, tibia),
        ),
        (at(0.38, 0.04), [0.013 * r, 0.013 * r], joint(tibia, tarsus)),
        (at(0.47, 0.0), [0.011 * r, 0.010 * r], Skin::of(tarsus)),
    ];
    let side_name = side.name;
    let rings = b.tube(
        &[side.face],
        &along(start, &stops, axis),
        &format!("{side_name} {name} leg"),
    );
    b.tip(&format!("{side_name} {name} foot"), &[side.face]);
    let knee = b.cage.facing(&rings[1], Vector3::y());
    b.mark(&format!("{side_name} {name} knee"), &[knee]);
}

fn antennae(b: &mut Builder, f: &Frame, faces: &[usize]) {
    let k = f.p.head_size;
    for side in b.sides(faces, vector(0.5, 1.0, 0.4)) {
        let s = side.sign;
        let start = b.cage.face_center(side.face);
        let length = 0.30 * f.p.ear_length;
        let at = |t: f64, y: f64| start + vector(0.55 * s * t, y, 0.75 * t) * length;
        let free = [
            about(Vector3::y() * s, -40.0, 40.0),
            about(Vector3::x(), -40.0, 40.0),
        ];
        let lower = b.bone(f.head, start, &free);
        let upper = b.bone(lower, at(0.45, 0.42), &free);
        let r = 0.010 * k;
        let stops = [
            (at(0.10, 0.12), [r, r], joint(f.head, lower)),
            (at(0.45, 0.42), [0.9 * r, 0.9 * r], joint(lower, upper)),
            (at(1.0, 0.36), [0.8 * r, 0.8 * r], Skin::of(upper)),
        ];
        let name = side.name;
        b.tube(
            &[side.face],
            &along(start, &stops, Vector3::x()),
            &format!("{name} antenna"),
        );
        b.tip(&format!("{name} antenna tip"), &[side.face]);
    }
}
