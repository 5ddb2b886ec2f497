//! An animal with four legs, ears and a tail: at its template's proportions a dog.

use mesh_core::{Point3, Vector3};

use super::builder::{joint, point, ring, vector, Builder, Side, Trunk};
use crate::proportions::{slimmed, Proportions};
use crate::skeleton::about;
use crate::skin::Skin;

/// Height of hips and shoulders.
const HEIGHT: f64 = 0.60;

/// Measures that several parts share.
struct Frame {
    p: Proportions,
    /// Height of hips and shoulders.
    height: f64,
    /// Half the length of the trunk.
    half: f64,
    girth: f64,
    hips: usize,
    chest: usize,
}

pub(super) fn build(b: &mut Builder, p: &Proportions) {
    let height = HEIGHT * p.limb_length;
    let hips = b.root(point(0.0, height, 0.0));
    let spine = [
        about(Vector3::y(), -35.0, 35.0),
        about(Vector3::x(), -25.0, 25.0),
    ];
    let chest = b.bone(hips, point(0.0, height + 0.08, 0.0), &spine);
    let half = 0.42 * p.trunk_length;
    let f = Frame {
        p: *p,
        height,
        half,
        girth: p.trunk_girth,
        hips,
        chest,
    };

    let trunk = trunk(b, &f);
    tail(b, &f, &trunk);
    for side in b.sides(&trunk.rings[2], vector(0.5, -1.0, 0.0)) {
        fore_leg(b, &f, side);
    }
    for side in b.sides(&trunk.rings[0], vector(0.5, -1.0, 0.0)) {
        hind_leg(b, &f, side);
    }
    head(b, &f, &trunk);
    b.cage = b.cage.refined();
}

fn trunk(b: &mut Builder, f: &Frame) -> Trunk {
    let (g, l) = (f.girth, f.half);
    let belly = f.p.belly;
    let at = |z: f64, dy: f64, radii: [f64; 2], skin: Skin| {
        ring(
            point(0.0, f.height + dy, z),
            Vector3::z(),
            radii.map(|r| r * g),
            &skin,
        )
    };
    let middle = Skin::between(f.hips, f.chest, 0.5);
    let sections = [
        at(-0.96 * l, 0.09, [0.105, 0.12], Skin::of(f.hips)),
        at(-0.42 * l, 0.08, [0.15, 0.165], Skin::of(f.hips)),
        at(
            0.10 * l,
            0.08 - 0.10 * g * (belly - 1.0),
            [0.15 * belly, 0.165 * belly],
            middle,
        ),
        at(0.72 * l, 0.06, [0.15, 0.20], Skin::of(f.chest)),
        at(1.02 * l, 0.11, [0.095, 0.125], Skin::of(f.chest)),
    ];
    let trunk = b.trunk(&sections, "trunk");
    for (name, ring, direction) in [
        ("withers", 2, Vector3::y()),
        ("breast", 2, -Vector3::y()),
        ("back", 1, Vector3::y()),
        ("belly", 1, -Vector3::y()),
    ] {
        let pair = b.cage.ranked(&trunk.rings[ring], direction);
        b.mark(name, &pair[..2]);
    }
    trunk
}

fn tail(b: &mut Builder, f: &Frame, trunk: &Trunk) {
    let patch = b.cage.ranked(&trunk.start, Vector3::y())[..2].to_vec();
    let base = point(0.0, f.height + 0.15 * f.girth, -0.97 * f.half);
    let along = vector(0.0, -0.35, -0.94);
    let length = 0.48 * f.p.tail_length;
    let free = [
        about(Vector3::x(), -50.0, 60.0),
        about(Vector3::y(), -50.0, 50.0),
    ];
    let at = |t: f64| base + along * (length * t);
    let first = b.bone(f.hips, at(0.02), &free);
    let second = b.bone(first, at(0.36), &free);
    let third = b.bone(second, at(0.68), &free);
    let section = |t: f64, r: f64, skin: Skin| {
        ring(
            at(t),
            along,
            [r * f.girth * slimmed(f.p.tail_length); 2],
            &skin,
        )
    };
    let sections = [
        section(0.08, 0.042, joint(f.hips, first)),
        section(0.36, 0.034, joint(first, second)),
        section(0.68, 0.028, joint(second, third)),
        section(0.97, 0.019, Skin::of(third)),
    ];
    let rings = b.tube(&patch, &sections, "tail");
    b.tip("tail tip", &patch);
    let top = b.cage.ranked(&rings[1], Vector3::y());
    b.mark("middle of the tail", &top[..2]);
}

fn fore_leg(b: &mut Builder, f: &Frame, side: Side) {
    let s = side.sign;
    let z = 0.44 * f.half;
    let x = 0.10 * s * f.girth;
    let h = f.height;
    let spread = about(Vector3::z() * s, -8.0, 30.0);
    let upper = b.bone(
        f.chest,
        point(x, 0.98 * h, z),
        &[about(Vector3::x(), -75.0, 50.0), spread],
    );
    let lower = b.bone(
        upper,
        point(x, 0.52 * h, z - 0.01),
        &[about(Vector3::x(), -120.0, 5.0)],
    );
    let foot = b.bone(
        lower,
        point(x, 0.15 * h, z),
        &[about(Vector3::x(), -20.0, 50.0)],
    );
    let leg = Leg {
        side,
        name: "fore",
        girth: f.p.limb_stoutness(),
        foot_length: f.p.foot_length,
    };
    let rows = [
        ([x, 0.80 * h, z], 0.4, [0.062, 0.085], joint(f.chest, upper)),
        (
            [x, 0.52 * h, z - 0.015],
            0.0,
            [0.047, 0.052],
            joint(upper, lower),
        ),
        ([x, 0.16 * h, z], -0.1, [0.036, 0.038], joint(lower, foot)),
    ];
    leg.draw(b, &rows, foot);
}

fn hind_leg(b: &mut Builder, f: &Frame, side: Side) {
    let s = side.sign;
    let z = -0.66 * f.half;
    let x = 0.10 * s * f.girth;
    let h = f.height;
    let spread = about(Vector3::z() * s, -8.0, 30.0);
    let knee = z + 0.05;
    let hock = z - 0.075;
    let upper = b.bone(
        f.hips,
        point(x, 0.98 * h, z),
        &[about(Vector3::x(), -75.0, 45.0), spread],
    );
    let lower = b.bone(
        upper,
        point(x, 0.55 * h, knee),
        &[about(Vector3::x(), -15.0, 80.0)],
    );
    let foot = b.bone(
        lower,
        point(x, 0.24 * h, hock),
        &[about(Vector3::x(), -60.0, 20.0)],
    );
    let leg = Leg {
        side,
        name: "hind",
        girth: f.p.limb_stoutness(),
        foot_length: f.p.foot_length,
    };
    let rows = [
        (
            [x, 0.80 * h, z + 0.01],
            -0.4,
            [0.064, 0.105],
            joint(f.hips, upper),
        ),
        (
            [x, 0.53 * h, knee],
            0.3,
            [0.050, 0.062],
            joint(upper, lower),
        ),
        ([x, 0.24 * h, hock], 0.4, [0.034, 0.040], joint(lower, foot)),
    ];
    leg.draw(b, &rows, foot);
}

/// What the sections of a leg need.
struct Leg<'a> {
    side: Side,
    name: &'a str,
    girth: f64,
    foot_length: f64,
}

/// Middle, slant, radii and skin of a section.
type Row = ([f64; 3], f64, [f64; 2], Skin);

impl Leg<'_> {
    fn draw(&self, b: &mut Builder, rows: &[Row], foot: usize) {
        let section = |(c, slant, radii, skin): &Row| {
            let down = vector(0.0, -1.0, -slant);
            ring(Point3::from(*c), down, radii.map(|r| r * self.girth), skin)
        };
        let mut sections: Vec<_> = rows.iter().map(section).collect();
        let [x, _, z] = rows[rows.len() - 1].0;
        let n = 0.045 * self.foot_length;
        for (y, a) in [(0.055, 0.046), (0.0, 0.044)] {
            let center = point(x, y, z + 0.6 * n);
            let radii = [a * self.girth, a * self.girth + 0.7 * n];
            sections.push(ring(center, -Vector3::y(), radii, &Skin::of(foot)));
        }
        let Side { name, sign, face } = self.side;
        let part = format!("{name} {} leg", self.name);
        let rings = b.tube(&[face], &sections, &part);
        b.tip(&format!("{name} {} paw", self.name), &[face]);
        let outer = b.cage.facing(&rings[1], Vector3::x() * sign);
        let joint = if self.name == "fore" { "elbow" } else { "knee" };
        b.mark(&format!("{name} {joint}"), &[outer]);
        let root = b.cage.facing(&rings[0], Vector3::x() * sign);
        let root_name = if self.name == "fore" {
            "shoulder"
        } else {
            "hip"
        };
        b.mark(&format!("{name} {root_name}"), &[root]);
    }
}

fn head(b: &mut Builder, f: &Frame, trunk: &Trunk) {
    let along = vector(0.0, 0.76, 0.65);
    let base = point(0.0, f.height + 0.13, 0.98 * f.half);
    let at = |t: f64| base + along * (0.30 * t * f.p.neck_length);
    let turn = |down: f64| {
        [
            about(Vector3::x(), -25.0, down),
            about(Vector3::y(), -40.0, 40.0),
        ]
    };
    let first = b.bone(f.chest, at(0.0), &turn(45.0));
    let second = b.bone(first, at(0.5), &turn(45.0));
    let head = b.bone(second, at(1.0), &turn(35.0));
    let (g, k) = (f.girth, f.p.head_size);
    let width = 0.4 + 0.6 * k.min(g);
    let end = [0.066 * width, 0.078 * width];
    let neck = [
        ring(
            at(0.45),
            along,
            [0.072 * g, 0.088 * g],
            &joint(first, second),
        ),
        ring(at(0.95), vector(0.0, 0.5, 0.85), end, &joint(second, head)),
    ];
    let rings = b.tube(&trunk.end, &neck, "neck");
    b.mark_top("middle of the neck", &rings[0], vector(0.0, 1.0, -1.0));
    b.mark_top("nape", &rings[1], vector(0.0, 1.0, -1.0));
    skull(b, f, trunk, (head, at(1.0)));
}

fn skull(b: &mut Builder, f: &Frame, trunk: &Trunk, (head, top): (usize, Point3)) {
    let (k, muzzle) = (f.p.head_size, f.p.face_length);
    let forward = vector(0.0, -0.22, 0.97);
    let rows = [
        (0.10, 0.060, [0.100, 0.096]),
        (0.19, 0.052, [0.088, 0.080]),
        (0.23 + 0.04 * muzzle, 0.008, [0.047, 0.046]),
        (0.24 + 0.15 * muzzle, 0.004, [0.040, 0.036]),
    ];
    let sections = rows.map(|(z, y, radii)| {
        let center = top + (forward * z + Vector3::y() * y) * k;
        ring(center, forward, radii.map(|r| r * k), &Skin::of(head))
    });
    let rings = b.tube(&trunk.end, &sections, "head");
    b.tip("nose", &trunk.end);
    b.mark_top("throat", &rings[1], -Vector3::y());
    let root = top + (forward * 0.06 + Vector3::y() * 0.12) * k;
    for side in b.sides(&rings[0], vector(0.6, 1.0, 0.0)) {
        ear(b, f, head, side, root);
    }
}

fn ear(b: &mut Builder, f: &Frame, head: usize, side: Side, base: Point3) {
    let Side {
        name,
        sign: s,
        face,
    } = side;
    let k = f.p.head_size;
    let up = vector(0.45 * s, 0.88, -0.15);
    let root = base + vector(0.055 * s, 0.0, 0.0) * k;
    let free = [
        about(Vector3::z() * s, -70.0, 10.0),
        about(Vector3::x(), -40.0, 30.0),
    ];
    let bone = b.bone(head, root, &free);
    let section = |t: f64, radii: [f64; 2], skin: Skin| {
        ring(
            root + up * (0.13 * t * f.p.ear_length * k),
            up,
            radii.map(|r| r * k * slimmed(f.p.ear_length)),
            &skin,
        )
    };
    let sections = [
        section(0.25, [0.036, 0.020], joint(head, bone)),
        section(1.0, [0.018, 0.011], Skin::of(bone)),
    ];
    b.tube(&[face], &sections, &format!("{name} ear"));
    b.tip(&format!("{name} ear tip"), &[face]);
}
