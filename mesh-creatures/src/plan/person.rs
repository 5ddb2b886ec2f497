//! A person who stands with the arms held out a little below the horizontal and the palms downwards.

use mesh_core::{Point3, Vector3};

use super::builder::{along, joint, point, ring, vector, Builder, Side, Trunk};
use crate::cage::{children, Section};
use crate::proportions::Proportions;
use crate::skeleton::about;
use crate::skin::Skin;

/// Height of the crotch.
const HEIGHT: f64 = 0.80;

/// Measures that several parts share.
struct Frame {
    p: Proportions,
    /// Height of the crotch.
    height: f64,
    girth: f64,
    /// Girth of arms and legs.
    limb: f64,
    pelvis: usize,
    chest: usize,
}

/// What is drawn out of a hand when its quads have been split.
struct Hand {
    side: Side,
    bone: usize,
    cap: Vec<usize>,
    /// The face at the side of the thumb.
    thumb: usize,
    /// From the wrist to the fingers.
    along: Vector3,
}

pub(super) fn build(b: &mut Builder, p: &Proportions) {
    let height = HEIGHT * p.limb_length;
    let pelvis = b.root(point(0.0, height, 0.0));
    let spine = [
        about(Vector3::x(), -15.0, 40.0),
        about(Vector3::y(), -40.0, 40.0),
        about(Vector3::z(), -25.0, 25.0),
    ];
    let chest = b.bone(
        pelvis,
        point(0.0, height + 0.18 * p.trunk_length, 0.0),
        &spine,
    );
    let girth = p.trunk_girth;
    let limb = p.limb_stoutness();
    let f = Frame {
        p: *p,
        height,
        girth,
        limb,
        pelvis,
        chest,
    };
    let trunk = trunk(b, &f);
    for (name, sign) in [("right", -1.0), ("left", 1.0)] {
        let half = b.cage.ranked(&trunk.start, Vector3::x() * sign)[..2].to_vec();
        leg(b, &f, &half, (name, sign));
    }
    let hands = b.sides(&trunk.rings[3], Vector3::x()).map(|side| {
        let pair = b.cage.ranked(&trunk.rings[3], Vector3::x() * side.sign)[..2].to_vec();
        arm(b, &f, &pair, side)
    });
    let (faces, top) = head(b, &f, &trunk);

    b.cage = b.cage.refined();
    for hand in &hands {
        fingers(b, &f, hand);
    }
    face(b, &f, &children(&faces), top);
}

fn trunk(b: &mut Builder, f: &Frame) -> Trunk {
    let (t, g, belly) = (f.p.trunk_length, f.girth, f.p.belly);
    let at = |y: f64, z: f64, radii: [f64; 2], skin: Skin| {
        let center = point(0.0, f.height + y * t, z * g);
        ring(center, Vector3::y(), radii.map(|r| r * g), &skin)
    };
    let waist = joint(f.pelvis, f.chest);
    let sections = [
        at(0.00, 0.0, [0.135, 0.085], Skin::of(f.pelvis)),
        at(0.12, -0.005, [0.150, 0.098], Skin::of(f.pelvis)),
        at(
            0.26,
            0.03 * (belly - 1.0),
            [0.122 * belly, 0.086 * belly],
            waist,
        ),
        at(0.41, 0.0, [0.165, 0.105], Skin::of(f.chest)),
        at(0.53, -0.01, [0.145, 0.080], Skin::of(f.chest)),
    ];
    let trunk = b.trunk(&sections, "trunk");
    b.mark_top("navel", &trunk.rings[1], Vector3::z());
    b.mark_top("small of the back", &trunk.rings[1], -Vector3::z());
    b.mark_top("breastbone", &trunk.rings[2], Vector3::z());
    b.mark_top(
        "between the shoulder blades",
        &trunk.rings[2],
        -Vector3::z(),
    );
    trunk
}

fn leg(b: &mut Builder, f: &Frame, patch: &[usize], (side, s): (&str, f64)) {
    let (x, h, r) = (0.100 * s * f.girth, f.height, f.limb);
    let spread = about(Vector3::z() * s, -6.0, 45.0);
    let upper = b.bone(
        f.pelvis,
        point(x, h + 0.06, 0.0),
        &[about(Vector3::x(), -100.0, 35.0), spread],
    );
    let lower = b.bone(
        upper,
        point(x, 0.53 * h, -0.01),
        &[about(Vector3::x(), 0.0, 120.0)],
    );
    let foot = b.bone(
        lower,
        point(x, 0.09 * h, 0.0),
        &[about(Vector3::x(), -20.0, 40.0)],
    );
    let n = f.p.foot_length;
    let across = |c: [f64; 3], d: Vector3, side: Vector3, radii: [f64; 2], skin: Skin| {
        Section::across(Point3::from(c), d, side, radii.map(|k| k * r), &skin)
    };
    let (down, z, y) = (-Vector3::y(), Vector3::z(), Vector3::y());
    let sections = [
        across(
            [x, 0.89 * h, 0.0],
            down,
            z,
            [0.078, 0.070],
            joint(f.pelvis, upper),
        ),
        across(
            [x, 0.53 * h, 0.005],
            down,
            z,
            [0.056, 0.053],
            joint(upper, lower),
        ),
        across(
            [x, 0.11 * h, -0.012],
            down,
            z,
            [0.037, 0.034],
            joint(lower, foot),
        ),
        across(
            [x, 0.045, 0.02 * n],
            vector(0.0, -0.75, 0.65),
            vector(0.0, 0.65, 0.75),
            [0.052, 0.040],
            Skin::of(foot),
        ),
        across([x, 0.026, 0.14 * n], z, y, [0.022, 0.042], Skin::of(foot)),
    ];
    let rings = b.tube(patch, &sections, &format!("{side} leg"));
    b.tip(&format!("{side} toes"), patch);
    b.mark_top(&format!("{side} knee"), &rings[1], vector(0.0, 0.0, 1.0));
    b.mark_top(&format!("{side} heel"), &rings[3], vector(0.0, -0.6, -0.8));
    b.mark_top(&format!("{side} hip"), &rings[0], vector(s, 0.0, 0.0));
}

fn arm(b: &mut Builder, f: &Frame, patch: &[usize], side: Side) -> Hand {
    let s = side.sign;
    let out = vector(0.91 * s, -0.41, 0.0);
    let shoulder = point(
        0.125 * s * f.girth,
        f.height + 0.485 * f.p.trunk_length,
        -0.01,
    );
    let at = |t: f64| shoulder + out * (t * f.p.limb_length);
    let swing = [
        about(Vector3::z() * s, -50.0, 85.0),
        about(-Vector3::y() * s, -30.0, 90.0),
    ];
    let upper = b.bone(f.chest, at(0.02), &swing);
    let lower = b.bone(upper, at(0.28), &[about(-Vector3::y() * s, 0.0, 120.0)]);
    let bone = b.bone(lower, at(0.52), &[about(Vector3::z() * s, -60.0, 50.0)]);
    let n = f.p.foot_length;
    let r = f.limb;
    let palm = |t: f64| at(0.52) + out * (t * n);
    let stops = [
        (at(0.07), [0.060 * r, 0.058 * r], joint(f.chest, upper)),
        (at(0.28), [0.045 * r, 0.045 * r], joint(upper, lower)),
        (at(0.51), [0.034 * r, 0.028 * r], joint(lower, bone)),
        (palm(0.05), [0.050 * n, 0.021 * r], Skin::of(bone)),
        (palm(0.10), [0.058 * n, 0.017 * r], Skin::of(bone)),
    ];
    let rings = b.tube(
        patch,
        &along(shoulder, &stops, Vector3::z()),
        &format!("{} arm", side.name),
    );
    let hand = b.cage.part(&format!("{} hand", side.name));
    rings[3..]
        .concat()
        .iter()
        .chain(patch)
        .for_each(|&face| b.cage.parts[face] = hand);
    b.mark_top(&format!("{} elbow", side.name), &rings[1], -Vector3::z());
    b.mark_top(&format!("{} wrist", side.name), &rings[2], Vector3::y());
    b.mark_top(&format!("{} shoulder", side.name), &rings[0], Vector3::y());
    let thumb = b.cage.facing(&rings[4], Vector3::z());
    Hand {
        side,
        bone,
        cap: patch.to_vec(),
        thumb,
        along: out,
    }
}

/// Lengths of the fingers from the one beside the thumb.
const FINGERS: [(&str, f64); 4] = [
    ("index", 0.078),
    ("middle", 0.086),
    ("ring", 0.078),
    ("little", 0.060),
];

fn fingers(b: &mut Builder, f: &Frame, hand: &Hand) {
    let by_thumb = b.cage.ranked(&children(&hand.cap), Vector3::z());
    let out = hand.along;
    for (k, (name, length)) in FINGERS.into_iter().enumerate() {
        let spread = vector(0.0, 0.0, 0.27 - 0.18 * k as f64);
        let curl = about(Vector3::z() * hand.side.sign, -70.0, 15.0);
        finger(
            b,
            f,
            hand,
            &by_thumb[2 * k..2 * k + 2],
            (name, length, out + spread, curl),
        );
    }
    let near_wrist = b.cage.ranked(&children(&[hand.thumb]), -out)[..2].to_vec();
    let bend = about(Vector3::y() * hand.side.sign, -40.0, 40.0);
    let aside = out * 0.55 + Vector3::z() * 0.85;
    finger(b, f, hand, &near_wrist, ("thumb", 0.060, aside, bend));
}

fn finger(
    b: &mut Builder,
    f: &Frame,
    hand: &Hand,
    patch: &[usize],
    (name, length, direction, free): (&str, f64, Vector3, crate::skeleton::Freedom),
) {
    let start = b.cage.patch_center(patch);
    let n = f.p.foot_length;
    let at = |t: f64| start + direction * (t * length * n);
    let bone = b.bone(hand.bone, at(0.05), &[free]);
    let r = 0.0092 * n.min(f.limb);
    let stops = [
        (at(0.16), [r, r], joint(hand.bone, bone)),
        (at(1.0), [1.05 * r, 1.05 * r], Skin::of(bone)),
    ];
    let side = hand.side.name;
    b.tube(
        patch,
        &along(start, &stops, Vector3::y()),
        &format!("{side} {name}"),
    );
    b.tip(&format!("{side} {name} tip"), patch);
}

/// The faces around the middle of the face, and the place where the head turns.
fn head(b: &mut Builder, f: &Frame, trunk: &Trunk) -> (Vec<usize>, Point3) {
    let (k, g) = (f.p.head_size, f.girth);
    let base = point(0.0, f.height + 0.55 * f.p.trunk_length, -0.01);
    let top = base + vector(0.0, 0.07 * f.p.neck_length, 0.01);
    let turn = [
        about(Vector3::x(), -25.0, 30.0),
        about(Vector3::y(), -40.0, 40.0),
        about(Vector3::z(), -20.0, 20.0),
    ];
    let neck = b.bone(f.chest, base, &turn);
    let head = b.bone(neck, top, &turn);
    let up = Vector3::y();
    let mut sections = vec![
        ring(
            base + up * 0.01,
            up,
            [0.058 * g, 0.056 * g],
            &joint(f.chest, neck),
        ),
        ring(
            top,
            up,
            [0.048 * k.min(g), 0.052 * k.min(g)],
            &joint(neck, head),
        ),
    ];
    for (y, z, radii) in [
        (0.045, 0.030, [0.062, 0.076]),
        (0.125, 0.016, [0.080, 0.096]),
        (0.195, 0.004, [0.075, 0.092]),
        (0.240, -0.004, [0.042, 0.055]),
    ] {
        let center = top + vector(0.0, y, z) * k;
        sections.push(ring(center, up, radii.map(|r| r * k), &Skin::of(head)));
    }
    let rings = b.tube(&trunk.end, &sections, "head");
    let neck = b.cage.part("neck");
    rings[..2]
        .concat()
        .iter()
        .for_each(|&face| b.cage.parts[face] = neck);
    b.tip("crown", &trunk.end);
    b.mark_top("chin", &rings[2], Vector3::z());
    b.mark_top("nape", &rings[2], -Vector3::z());
    (rings[3].clone(), top)
}

fn face(b: &mut Builder, f: &Frame, faces: &[usize], top: Point3) {
    let k = f.p.head_size;
    let nose = top + vector(0.0, 0.075, 0.115) * k;
    let patch = b.cage.nearest(faces, &nose, 2);
    let skin = b.cage.skins[b.cage.faces[patch[0]][0] as usize].clone();
    let length = 0.03 * f.p.face_length;
    let section = |t: f64, r: [f64; 2]| {
        let center = top + (vector(0.0, 0.078 - 0.3 * t, 0.100) + Vector3::z() * t) * k;
        Section::across(
            center,
            vector(0.0, -0.25, 1.0),
            Vector3::x(),
            r.map(|r| r * k),
            &skin,
        )
    };
    b.tube(
        &patch,
        &[
            section(0.4 * length, [0.016, 0.022]),
            section(length, [0.010, 0.012]),
        ],
        "nose",
    );
    b.tip("nose", &patch);
    for (name, s) in [("right", -1.0), ("left", 1.0)] {
        let patch = b
            .cage
            .nearest(faces, &(top + vector(0.08 * s, 0.085, 0.005) * k), 2);
        let skin = b.cage.skins[b.cage.faces[patch[0]][0] as usize].clone();
        let out = vector(s, 0.1, -0.6);
        let at = |t: f64| top + (vector(0.070 * s, 0.09, 0.0) + out * (t * f.p.ear_length)) * k;
        let stops = [
            (at(0.012), [0.022 * k, 0.010 * k], skin.clone()),
            (at(0.030), [0.026 * k, 0.007 * k], skin),
        ];
        b.tube(
            &patch,
            &along(at(0.0), &stops, Vector3::y()),
            &format!("{name} ear"),
        );
        b.tip(&format!("{name} ear"), &patch);
    }
}
