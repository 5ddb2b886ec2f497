//! A bird that stands with its wings spread.

use mesh_core::{Point3, Vector3};

use super::builder::{along, joint, point, ring, vector, Builder, Side, Trunk};
use crate::cage::{children, unit};
use crate::proportions::{slimmed, Proportions};
use crate::skeleton::about;
use crate::skin::Skin;

/// Height of the middle of the body.
const HEIGHT: f64 = 0.30;

/// Measures that several parts share.
struct Frame {
    p: Proportions,
    height: f64,
    /// Half the length of the body.
    half: f64,
    girth: f64,
    body: usize,
}

/// What toes are drawn out of when the quads have been split.
struct Foot {
    side: Side,
    bone: usize,
    cap: usize,
}

pub(super) fn build(b: &mut Builder, p: &Proportions) {
    let height = HEIGHT * p.limb_length;
    let body = b.root(point(0.0, height, 0.0));
    let f = Frame {
        p: *p,
        height,
        half: 0.25 * p.trunk_length,
        girth: p.trunk_girth,
        body,
    };
    let trunk = trunk(b, &f);
    tail(b, &f, &trunk);
    let feet = b
        .sides(&trunk.rings[1], vector(0.5, -1.0, 0.0))
        .map(|side| leg(b, &f, side));
    for side in b.sides(&trunk.rings[2], Vector3::x()) {
        let pair = b.cage.ranked(&trunk.rings[2], Vector3::x() * side.sign)[..2].to_vec();
        wing(b, &f, &pair, side);
    }
    head(b, &f, &trunk);
    b.cage = b.cage.refined();
    for foot in &feet {
        toes(b, &f, foot);
    }
}

fn trunk(b: &mut Builder, f: &Frame) -> Trunk {
    let (g, l, belly) = (f.girth, f.half, f.p.belly);
    let at = |z: f64, y: f64, radii: [f64; 2]| {
        let center = point(0.0, f.height + y, z * l);
        ring(
            center,
            vector(0.0, 0.25, 1.0),
            radii.map(|r| r * g),
            &Skin::of(f.body),
        )
    };
    let sections = [
        at(-1.00, -0.03, [0.055, 0.040]),
        at(-0.55, -0.02, [0.100, 0.092]),
        at(-0.05, 0.0, [0.118 * belly, 0.125 * belly]),
        at(0.60, 0.03, [0.105, 0.115]),
        at(1.00, 0.08, [0.064, 0.068]),
    ];
    let trunk = b.trunk(&sections, "body");
    b.mark_top("belly", &trunk.rings[1], -Vector3::y());
    b.mark_top("back", &trunk.rings[1], Vector3::y());
    b.mark_top("breast", &trunk.rings[3], vector(0.0, -1.0, 0.3));
    b.mark_top("between the wings", &trunk.rings[2], Vector3::y());
    trunk
}

fn tail(b: &mut Builder, f: &Frame, trunk: &Trunk) {
    let base = point(0.0, f.height - 0.035, -0.98 * f.half);
    let free = [
        about(Vector3::x(), -45.0, 45.0),
        about(Vector3::y(), -35.0, 35.0),
    ];
    let bone = b.bone(f.body, base, &free);
    let out = vector(0.0, -0.08, -1.0);
    let at = |t: f64| base + out * (0.28 * t * f.p.tail_length);
    let g = f.girth;
    let stops = [
        (at(0.18), [0.055 * g, 0.022 * g], joint(f.body, bone)),
        (at(0.60), [0.075 * g, 0.014 * g], Skin::of(bone)),
        (at(1.0), [0.095 * g, 0.010 * g], Skin::of(bone)),
    ];
    let rings = b.tube(&trunk.start, &along(base, &stops, Vector3::x()), "tail");
    b.tip("tail tip", &trunk.start);
    b.mark_top("root of the tail", &rings[0], Vector3::y());
    for (name, s) in [("right", -1.0), ("left", 1.0)] {
        let outer = b.cage.ranked(&rings[2], Vector3::x() * s)[..2].to_vec();
        b.mark(&format!("{name} tail feather"), &outer);
    }
}

fn wing(b: &mut Builder, f: &Frame, patch: &[usize], side: Side) {
    let s = side.sign;
    let root = point(0.09 * s * f.girth, f.height + 0.035, 0.28 * f.half);
    let span = 0.62 * f.p.wing_span;
    let at = |t: f64, z: f64| root + vector(s * t, 0.06 * t, z * f.p.wing_span.min(1.0)) * span;
    let (flap, sweep) = (Vector3::z() * s, Vector3::y() * s);
    let inner = b.bone(
        f.body,
        at(0.03, 0.0),
        &[about(flap, -55.0, 60.0), about(sweep, -20.0, 40.0)],
    );
    let middle = b.bone(
        inner,
        at(0.36, 0.0),
        &[about(flap, -45.0, 45.0), about(sweep, -30.0, 20.0)],
    );
    let outer = b.bone(
        middle,
        at(0.70, 0.0),
        &[about(flap, -40.0, 40.0), about(sweep, -10.0, 35.0)],
    );
    let chord = f.girth * slimmed(f.p.wing_span);
    let stops = [
        (at(0.10, 0.0), [0.026, 0.095 * chord], joint(f.body, inner)),
        (at(0.38, 0.03), [0.020, 0.120 * chord], joint(inner, middle)),
        (
            at(0.72, -0.04),
            [0.015, 0.105 * chord],
            joint(middle, outer),
        ),
        (at(1.0, -0.18), [0.010, 0.050 * chord], Skin::of(outer)),
    ];
    let rings = b.tube(
        patch,
        &along(root, &stops, Vector3::y()),
        &format!("{} wing", side.name),
    );
    b.tip(&format!("{} wing tip", side.name), patch);
    for (ring, name) in [(1, "inner"), (2, "outer")] {
        for (edge, z) in [("leading", 1.0), ("trailing", -1.0)] {
            let name = format!("{} {name} {edge} edge", side.name);
            b.mark_top(&name, &rings[ring], vector(0.0, 0.0, z));
        }
    }
}

fn leg(b: &mut Builder, f: &Frame, side: Side) -> Foot {
    let s = side.sign;
    let (h, r) = (f.height, f.p.limb_stoutness());
    let x = 0.075 * s * f.girth;
    let z = -0.16 * f.half;
    let spread = about(Vector3::z() * s, -8.0, 25.0);
    let thigh = b.bone(
        f.body,
        point(x, 0.75 * h, z),
        &[about(Vector3::x(), -60.0, 45.0), spread],
    );
    let shank = b.bone(
        thigh,
        point(x, 0.38 * h, z - 0.035),
        &[about(Vector3::x(), -50.0, 50.0)],
    );
    let bone = b.bone(
        shank,
        point(x, 0.05 * h, z),
        &[about(Vector3::x(), -40.0, 40.0)],
    );
    let stops = [
        (
            point(x, 0.52 * h, z - 0.005),
            [0.036 * r, 0.040 * r],
            joint(f.body, thigh),
        ),
        (
            point(x, 0.36 * h, z - 0.035),
            [0.017 * r, 0.018 * r],
            joint(thigh, shank),
        ),
        (
            point(x, 0.06 * h + 0.01, z),
            [0.015 * r, 0.015 * r],
            joint(shank, bone),
        ),
        (
            point(x, 0.012, z + 0.005),
            [0.020 * r, 0.020 * r],
            Skin::of(bone),
        ),
    ];
    let start = point(x, 0.8 * h, z);
    let rings = b.tube(
        &[side.face],
        &along(start, &stops, Vector3::x()),
        &format!("{} leg", side.name),
    );
    let knee = b.cage.facing(&rings[1], Vector3::z());
    b.mark(&format!("{} shin", side.name), &[knee]);
    Foot {
        side,
        bone,
        cap: side.face,
    }
}

fn toes(b: &mut Builder, f: &Frame, foot: &Foot) {
    let skin = Skin::of(foot.bone);
    let around = children(&[foot.cap]);
    let center = b.cage.patch_center(&around);
    let front = b.cage.ranked(&around, Vector3::z());
    for (names, pair) in [
        (["inner", "outer"], &front[..2]),
        (["inner hind", "outer hind"], &front[2..]),
    ] {
        let outward = b.cage.ranked(pair, Vector3::x() * foot.side.sign);
        for (name, face) in names.iter().zip([outward[1], outward[0]]) {
            let start = b.cage.face_center(face);
            let aside = start - center;
            let level = unit(vector(aside.x, 0.0, aside.z));
            let at =
                |t: f64| start + level * (0.06 * t * f.p.foot_length) - Vector3::y() * (0.006 * t);
            let r = 0.011 * f.p.limb_stoutness();
            let stops = [
                (at(0.35), [r, r], skin.clone()),
                (at(1.0), [0.6 * r, 0.6 * r], skin.clone()),
            ];
            let side = foot.side.name;
            b.tube(
                &[face],
                &along(start - level * 0.01, &stops, Vector3::y()),
                &format!("{side} foot"),
            );
            b.tip(&format!("{side} {name} toe"), &[face]);
        }
    }
}

fn head(b: &mut Builder, f: &Frame, trunk: &Trunk) {
    let (g, k) = (f.girth, f.p.head_size);
    let up = vector(0.0, 0.87, 0.49);
    let base: Point3 = point(0.0, f.height + 0.10, 1.0 * f.half);
    let top = base + up * (0.13 * f.p.neck_length);
    let turn = [
        about(Vector3::x(), -25.0, 40.0),
        about(Vector3::y(), -45.0, 45.0),
    ];
    let neck = b.bone(f.body, base, &turn);
    let head = b.bone(neck, top, &turn);
    let forward = vector(0.0, -0.10, 1.0);
    let at = |y: f64, z: f64| top + (forward * z + Vector3::y() * y) * k;
    let skin = Skin::of(head);
    let long = 0.12 * f.p.face_length;
    let stops = [
        (
            base + up * (0.055 * f.p.neck_length),
            [0.046 * g, 0.050 * g],
            joint(f.body, neck),
        ),
        (top, [0.040 * k.min(g), 0.044 * k.min(g)], joint(neck, head)),
        (at(0.040, 0.045), [0.060 * k, 0.058 * k], skin.clone()),
        (at(0.036, 0.100), [0.034 * k, 0.034 * k], skin.clone()),
        (at(0.030, 0.125), [0.020 * k, 0.019 * k], skin.clone()),
        (at(0.016, 0.125 + long), [0.006 * k, 0.006 * k], skin),
    ];
    let rings = b.tube(&trunk.end, &along(base, &stops, Vector3::x()), "head");
    b.rename(&rings[..2].concat(), "neck");
    b.rename(&[trunk.end.clone(), rings[4..].concat()].concat(), "beak");
    b.tip("beak", &trunk.end);
    b.mark_top("crown", &rings[2], Vector3::y());
    b.mark_top("throat", &rings[2], -Vector3::y());
}
