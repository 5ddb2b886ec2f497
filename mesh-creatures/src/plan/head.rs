//! A head on its neck, with eyes, ears, a nose and an open mouth.

use mesh_core::{Point3, Vector3};

use super::builder::{along, joint, point, ring, vector, Builder};
use crate::cage::{children, Section};
use crate::proportions::Proportions;
use crate::skeleton::about;
use crate::skin::Skin;

/// Bones and measures that several parts share.
struct Frame {
    p: Proportions,
    head: usize,
    jaw: usize,
}

impl Frame {
    /// A place of the skull, by its height over the neck as a share of the template's.
    fn at(&self, x: f64, y: f64, z: f64) -> Point3 {
        let g = self.p.trunk_girth;
        point(x * g, self.base() + y * self.p.trunk_length, z * g)
    }

    /// Size of eyes, nose, mouth and ears.
    fn size(&self) -> f64 {
        self.p.trunk_girth.min(self.p.trunk_length)
    }

    /// Height of the top of the neck.
    fn base(&self) -> f64 {
        0.18 * self.p.neck_length
    }
}

pub(super) fn build(b: &mut Builder, p: &Proportions) {
    let neck = b.root(Point3::origin());
    let turn = [
        about(Vector3::x(), -30.0, 25.0),
        about(Vector3::y(), -60.0, 60.0),
        about(Vector3::z(), -30.0, 25.0),
    ];
    let base = 0.18 * p.neck_length;
    let head = b.bone(neck, point(0.0, base, -0.04), &turn);
    let jaw = b.bone(
        head,
        point(0.0, base + 0.30 * p.trunk_length, 0.0),
        &[about(Vector3::x(), 0.0, 25.0)],
    );
    let f = Frame { p: *p, head, jaw };
    let rings = skull(b, &f, neck);
    b.cage = b.cage.refined();
    let [mouth_faces, nose_faces, eye_faces] = [2, 3, 4].map(|k| children(&rings[k]));
    mouth(b, &f, &mouth_faces);
    nose(b, &f, &nose_faces);
    for (name, s) in [("right", -1.0), ("left", 1.0)] {
        eye(b, &f, &eye_faces, (name, s));
        ear(
            b,
            &f,
            &[nose_faces.clone(), eye_faces.clone()].concat(),
            (name, s),
        );
    }
}

fn skull(b: &mut Builder, f: &Frame, neck: usize) -> Vec<Vec<usize>> {
    let (g, cheeks) = (f.p.trunk_girth, f.p.belly);
    let thick = g * f.p.limb_girth;
    let up = Vector3::y();
    let at = |y: f64, z: f64, radii: [f64; 2]| {
        ring(f.at(0.0, y, z), up, radii.map(|r| r * g), &Skin::of(f.head))
    };
    let front = 0.03 * (f.p.face_length - 1.0);
    let mut sections = vec![
        ring(
            point(0.0, 0.0, -0.06),
            up,
            [0.20 * thick, 0.21 * thick],
            &Skin::of(neck),
        ),
        ring(
            point(0.0, f.base(), -0.04),
            up,
            [0.18 * thick, 0.19 * thick],
            &joint(neck, f.head),
        ),
        at(0.13, 0.075 + front, [0.215 * cheeks, 0.285]),
        at(0.31, 0.05 + front, [0.265 * cheeks, 0.345]),
        at(0.49, 0.03 + 0.5 * front, [0.295, 0.375]),
        at(0.67, 0.01, [0.31, 0.385]),
        at(0.86, -0.02, [0.285, 0.36]),
        at(0.99, -0.03, [0.17, 0.22]),
    ];
    let first = sections.remove(0);
    let trunk = b.trunk(&[first], "neck");
    let mut rings = Vec::new();
    for (k, section) in sections.iter().enumerate() {
        let part = if k == 0 { "neck" } else { "head" };
        rings.extend(b.tube(&trunk.end, std::slice::from_ref(section), part));
        if k == 1 || k == 2 {
            jaw_line(b, f, [0.9, 0.5][k - 1]);
        }
    }
    b.tip("crown", &trunk.end);
    b.tip("root of the neck", &trunk.start);
    b.mark_top("chin", &rings[1], Vector3::z());
    b.mark_top("nape", &rings[1], -Vector3::z());
    b.mark_top("throat", &rings[0], Vector3::z());
    b.mark_top("back of the head", &rings[4], -Vector3::z());
    b.mark_top("forehead", &rings[5], Vector3::z());
    for (name, s) in [("right", -1.0), ("left", 1.0)] {
        b.mark_top(&format!("{name} jaw"), &rings[2], vector(s, 0.0, 0.0));
        b.mark_top(&format!("{name} temple"), &rings[5], vector(s, 0.0, 0.0));
    }
    rings
}

/// Lets the front of the newest ring of the skull follow the jaw.
fn jaw_line(b: &mut Builder, f: &Frame, share: f64) {
    for (k, v) in b
        .cage
        .newest(8, Vector3::z())
        .into_iter()
        .take(3)
        .enumerate()
    {
        let share = share * if k == 0 { 1.0 } else { 0.6 };
        b.cage.skins[v] = Skin::between(f.head, f.jaw, share);
    }
}

/// How much the lips bend backwards, over the square of the distance from their middle.
const CURVE: f64 = 2.4;

/// Shares of the jaw in the eight vertices around the mouth, from below upwards.
const LIPS: [f64; 8] = [0.95, 0.85, 0.85, 0.5, 0.5, 0.2, 0.2, 0.1];

fn mouth(b: &mut Builder, f: &Frame, faces: &[usize]) {
    let front = 0.395 + 0.03 * (f.p.face_length - 1.0);
    let patch = b.cage.nearest(faces, &f.at(0.0, 0.21, front), 4);
    let g = f.size();
    let rows = [
        (0.010, [0.125, 0.050]),
        (0.016, [0.108, 0.030]),
        (-0.020, [0.090, 0.012]),
        (-0.110, [0.075, 0.018]),
    ];
    for (k, (out, radii)) in rows.into_iter().enumerate() {
        let center = f.at(0.0, 0.225, front - 0.06 + out);
        let section = ring(
            center,
            Vector3::z(),
            radii.map(|r| r * g),
            &Skin::of(f.head),
        );
        b.tube(&patch, &[section], if k < 2 { "lips" } else { "mouth" });
        let around = b.cage.newest(8, -Vector3::y());
        for (v, share) in around.into_iter().zip(LIPS) {
            let place = &mut b.cage.positions[v];
            place.z -= CURVE * place.x * place.x / g;
            b.cage.skins[v] = Skin::between(f.head, f.jaw, share);
        }
    }
}

fn nose(b: &mut Builder, f: &Frame, faces: &[usize]) {
    let patch = b.cage.nearest(faces, &f.at(0.0, 0.42, 0.42), 4);
    let (g, n) = (f.size(), f.p.face_length);
    let skin = Skin::of(f.head);
    let at = |y: f64, z: f64| f.at(0.0, y, 0.40 + 0.10 * (z - 1.0) * n + 0.02 * n);
    let stops = [
        (at(0.41, 1.0), [0.062 * g, 0.085 * g], skin.clone()),
        (at(0.385, 1.9), [0.048 * g, 0.045 * g], skin),
    ];
    b.tube(
        &patch,
        &along(f.at(0.0, 0.42, 0.36), &stops, Vector3::x()),
        "nose",
    );
    b.tip("nose", &patch);
}

fn eye(b: &mut Builder, f: &Frame, faces: &[usize], (name, s): (&str, f64)) {
    let patch = b.cage.nearest(faces, &f.at(0.125 * s, 0.58, 0.36), 4);
    let center = b.cage.patch_center(&patch);
    let out = vector(0.30 * s, 0.0, 0.95);
    let g = f.size();
    for (depth, radii, part) in [
        (-0.002, [0.078, 0.052], "lids"),
        (-0.020, [0.062, 0.036], "lids"),
        (-0.014, [0.054, 0.030], "eye"),
        (0.010, [0.032, 0.018], "eye"),
    ] {
        let section = Section::across(
            center + out * (depth * g),
            out,
            Vector3::x(),
            radii.map(|r| r * g),
            &Skin::of(f.head),
        );
        b.tube(&patch, &[section], &format!("{name} {part}"));
    }
    b.mark(&format!("{name} eye"), &patch);
}

fn ear(b: &mut Builder, f: &Frame, faces: &[usize], (name, s): (&str, f64)) {
    let g = f.size();
    let patch = b.cage.nearest(faces, &f.at(0.30 * s, 0.49, -0.03), 2);
    let start = f.at(0.28 * s, 0.49, -0.03);
    let out = vector(0.75 * s, 0.12, -0.60);
    let bone = b.bone(
        f.head,
        start,
        &[
            about(Vector3::y() * s, -30.0, 20.0),
            about(Vector3::z() * s, -25.0, 25.0),
        ],
    );
    let at = |t: f64| start + out * (0.19 * t * f.p.ear_length * g);
    let stops = [
        (at(0.25), [0.085 * g, 0.032 * g], joint(f.head, bone)),
        (at(0.65), [0.120 * g, 0.024 * g], Skin::of(bone)),
        (at(1.0), [0.090 * g, 0.014 * g], Skin::of(bone)),
    ];
    let rings = b.tube(
        &patch,
        &along(start, &stops, Vector3::y()),
        &format!("{name} ear"),
    );
    b.tip(&format!("{name} ear"), &patch);
    b.mark_top(&format!("{name} ear above"), &rings[1], Vector3::y());
    b.mark_top(&format!("{name} ear lobe"), &rings[1], -Vector3::y());
}
