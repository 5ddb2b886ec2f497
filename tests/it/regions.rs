//! A head with eyeballs, teeth and the lining of a mouth, draped over a head without any.

use mesh_core::{io, shapes, Point3, PolygonSoup, Vector3};

use crate::support::Workplace;

/// Where the eyes are in the source, and their radius.
const EYES: [[f64; 3]; 2] = [[0.35, 0.25, 0.72], [-0.35, 0.25, 0.72]];
const EYE: f64 = 0.16;

/// One part of the head, by name.
struct Part {
    name: &'static str,
    soup: PolygonSoup,
}

fn moved(mut soup: PolygonSoup, scale: [f64; 3], to: [f64; 3]) -> PolygonSoup {
    for p in &mut soup.positions {
        *p = Point3::new(p.x * scale[0], p.y * scale[1], p.z * scale[2]) + Vector3::from(to);
    }
    soup
}

/// Skin with a mouth that is sunk into it, eyeballs, a row of teeth, and a bag behind them.
fn parts() -> Vec<Part> {
    let teeth = shapes::prism(6);
    let mut bag = shapes::quad_sphere(6);
    bag.faces
        .retain(|f| f.iter().any(|&v| bag.positions[v as usize].z < 0.6));
    vec![
        Part {
            name: "skin",
            soup: shapes::quad_sphere(16),
        },
        Part {
            name: "left_eye",
            soup: moved(shapes::quad_sphere(4), [EYE; 3], EYES[0]),
        },
        Part {
            name: "right_eye",
            soup: moved(shapes::icosphere(2), [EYE; 3], EYES[1]),
        },
        Part {
            name: "teeth",
            soup: moved(teeth, [0.14, 0.05, 0.1], [0.0, -0.35, 0.62]),
        },
        Part {
            name: "bag",
            soup: moved(bag, [0.22, 0.16, 0.2], [0.0, -0.35, 0.55]),
        },
    ]
}

fn head_obj(parts: &[Part]) -> String {
    let (mut text, mut n) = (String::new(), 1);
    for part in parts {
        text += &format!("g {}\n", part.name);
        for p in &part.soup.positions {
            text += &format!("v {} {} {}\n", p.x, p.y, p.z);
        }
        for face in &part.soup.faces {
            let corners: Vec<String> = face.iter().map(|v| (v + n).to_string()).collect();
            text += &format!("f {}\n", corners.join(" "));
        }
        n += part.soup.positions.len() as u32;
    }
    text
}

/// The skin of another head: larger units, longer, narrower above, with a chin.
fn target() -> PolygonSoup {
    let mut soup = shapes::icosphere(4);
    for p in &mut soup.positions {
        *p = there(p);
    }
    soup
}

/// What turns the source's skin into the target's.
fn there(p: &Point3) -> Point3 {
    let narrow = 1.0 - 0.15 * p.y;
    Point3::new(
        80.0 * p.x * narrow + 300.0,
        110.0 * p.y,
        95.0 * p.z * (1.0 + 0.1 * p.y * p.y),
    )
}

fn landmarks() -> String {
    let places = [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let entries = places.map(|p| {
        let to = there(&Point3::from(p));
        serde_json::json!({"source": {"point": p}, "target": {"point": [to.x, to.y, to.z]}})
    });
    serde_json::json!({ "landmarks": entries }).to_string()
}

/// Names of the files in [`head_on_skin`].
pub(crate) const HEAD: &str = "head.obj";
pub(crate) const SKIN: &str = "skin.ply";

/// A folder with the head, the skin and their landmarks.
pub(crate) fn head_on_skin() -> Workplace {
    let place = Workplace::new();
    place.write(HEAD, &head_obj(&parts()));
    place.write("head.json", &landmarks());
    io::write_soup(place.path(SKIN), &target()).expect("the target is written");
    place
}

/// The vertices of each part in the result.
fn draped(options: &str) -> Vec<(Part, Vec<Point3>)> {
    let place = head_on_skin();
    place.write(
        "half.toml",
        "[[stages]]\nn_iterations = 60\n[[stages]]\nn_iterations = 60\n",
    );
    place
        .drape(&format!(
            "transfer head.obj skin.ply -l head.json --config half.toml -o out.obj {options}"
        ))
        .well();
    let result = io::read_soup(place.path("out.obj")).expect("a result");
    let mut rest = result.positions.as_slice();
    parts()
        .into_iter()
        .map(|part| {
            let (own, others) = rest.split_at(part.soup.positions.len());
            rest = others;
            (part, own.to_vec())
        })
        .collect()
}

/// Smallest and largest distance of points from their mean.
fn radii(points: &[Point3]) -> (f64, f64) {
    let mean = points.iter().map(|p| p.coords).sum::<Vector3>() / points.len() as f64;
    let radii = points.iter().map(|p| (p.coords - mean).norm());
    radii.fold((f64::INFINITY, 0.0), |(low, high), r| {
        (low.min(r), high.max(r))
    })
}

/// The largest change of a side of a face against the mean change, in shares of it.
fn worst_stretch(soup: &PolygonSoup, moved: &[Point3]) -> f64 {
    let ratios: Vec<f64> = soup
        .faces
        .iter()
        .flat_map(|f| (0..f.len()).map(|k| (f[k] as usize, f[(k + 1) % f.len()] as usize)))
        .map(|(a, b)| (moved[a] - moved[b]).norm() / (soup.positions[a] - soup.positions[b]).norm())
        .collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    ratios
        .iter()
        .map(|r| (r / mean - 1.0).abs())
        .fold(0.0, f64::max)
}

/// How deep a point lies inside the target's skin, as a share of the way to the middle.
fn depth(p: &Point3) -> f64 {
    let y = p.y / 110.0;
    let x = (p.x - 300.0) / 80.0 / (1.0 - 0.15 * y);
    let z = p.z / 95.0 / (1.0 + 0.1 * y * y);
    1.0 - Vector3::new(x, y, z).norm()
}

#[test]
fn eyes_stay_round_and_the_mouth_inside_with_and_without_names() {
    let named = "--rigid left_eye --rigid right_eye --rigid teeth --free bag";
    for options in ["", named] {
        for (part, points) in draped(options) {
            match part.name {
                "skin" => {
                    let off = points.iter().map(|p| depth(p).abs()).fold(0.0, f64::max);
                    assert!(off < 0.03, "{options}: the skin is off by {off}");
                    continue;
                }
                "left_eye" | "right_eye" => {
                    let (low, high) = radii(&points);
                    assert!(
                        high / low < 1.0 + 1e-6,
                        "{options}: {} {low} {high}",
                        part.name
                    );
                }
                "teeth" => {
                    let stretch = worst_stretch(&part.soup, &points);
                    assert!(stretch < 1e-6, "{options}: {stretch}");
                }
                _ => {
                    // The head itself becomes 80 wide and 110 high: a bag that follows changes by as much.
                    let stretch = worst_stretch(&part.soup, &points);
                    assert!(stretch < 0.45, "{options}: {stretch}");
                }
            }
            let least = points.iter().map(depth).fold(f64::INFINITY, f64::min);
            let eye = part.name.ends_with("eye");
            assert!(
                least > if eye { -0.03 } else { 0.1 },
                "{options}: {} {least}",
                part.name
            );
        }
    }
}

#[test]
fn inspect_proposes_the_inner_pieces() {
    let place = head_on_skin();
    let seen = place.drape("inspect head.obj --hidden inner.txt").well();
    assert_eq!(
        seen.stdout.matches("closed piece inside").count(),
        3,
        "{}",
        seen.stdout
    );
    assert!(seen.stdout.contains("open piece inside"), "{}", seen.stdout);
    let alone = place.drape("inspect head.obj --hidden").well();
    assert_eq!(alone.stdout, seen.stdout);
    let mesh = std::fs::read(place.path("skin.ply")).unwrap();
    let confused = place.drape("inspect head.obj --hidden skin.ply");
    assert!(
        confused.stderr.contains("would replace a mesh"),
        "{}",
        confused.stderr
    );
    assert_eq!(std::fs::read(place.path("skin.ply")).unwrap(), mesh);
    for part in ["--free inner.txt", "--free hidden:1 --draped hidden:4"] {
        let line = "transfer head.obj skin.ply -l head.json --config short.toml -o out.obj";
        place.drape(&format!("{line} {part}")).well();
    }
    assert!(
        seen.stdout.contains("propose --rigid hidden:2"),
        "{}",
        seen.stdout
    );
    let line = "transfer head.obj skin.ply -l head.json -o out.obj --free hidden:5";
    let wrong = place.drape(line);
    assert!(
        wrong.stderr.contains("there is no inner surface '5'"),
        "{}",
        wrong.stderr
    );
}

#[test]
fn parts_that_are_not_there_are_named() {
    let place = Workplace::new();
    let wrong = place.transfer("--free nose");
    assert_eq!(wrong.code, Some(2));
    assert!(
        wrong.stderr.contains("--free nose: is neither a name") && wrong.stderr.contains("side0"),
        "{}",
        wrong.stderr
    );
    place.write("w.txt", "0 1\n3 2.5\n");
    let wrong = place.transfer("--weights w.txt");
    assert!(
        wrong.stderr.contains("vertex 3 has the weight 2.5"),
        "{}",
        wrong.stderr
    );
    place.write("w.txt", "0 0.5\n");
    place
        .transfer("--weights w.txt --free side1 --rigid skin")
        .well();
}
