//! Parts of a source that are treated in their own way.

use mesh_draping::mesh_core::{io::MeshFile, shapes, Point3, PolygonSoup};
use mesh_draping::parts::{HiddenSurfaces, InnerKind, PartError, PartProblem};
use mesh_draping::{Note, Pair, Parts, Seams, Source, Target, Treatment};

/// A ball with a smaller one inside, as an object of its own.
fn ball_with_an_eye() -> Pair {
    let (outer, inner) = (shapes::quad_sphere(4), shapes::quad_sphere(3));
    let mut text = String::from("o ball\n");
    add(&mut text, &outer, 1.0, 0);
    text += "o eye\n";
    add(&mut text, &inner, 0.3, outer.positions.len());
    let file = MeshFile::from_bytes("eye.obj", text.into_bytes());
    let file = file.expect("the text is an OBJ file");
    Pair {
        source: Source::of_file(file, Seams::EXACT).expect("balls are a mesh"),
        target: Target::of_soup(shapes::icosphere(3)).expect("a ball is a surface"),
        landmarks: Vec::new(),
    }
}

fn add(text: &mut String, soup: &PolygonSoup, size: f64, first: usize) {
    for p in &soup.positions {
        let Point3 { coords: p } = p * size;
        *text += &format!("v {} {} {}\n", p.x, p.y, p.z);
    }
    for face in &soup.faces {
        let corners = face.iter().map(|v| (*v as usize + first + 1).to_string());
        *text += &format!("f {}\n", corners.collect::<Vec<_>>().join(" "));
    }
}

#[test]
fn an_inner_piece_that_nobody_names_becomes_a_rigid_body() {
    let pair = ball_with_an_eye();
    let hidden = HiddenSurfaces::of(&pair);
    assert_eq!(hidden.inner[0].kind, InnerKind::ClosedPiece);
    assert_eq!(hidden.unasked(&hidden.inner[0]), Treatment::Rigid);

    let resolved = Parts::default().resolve(&pair).unwrap();
    let is_rigid = |v| resolved.regions.rigid[v] && resolved.regions.attraction[v] == 0.0;
    assert!(hidden.inner[0].vertices.iter().all(|&v| is_rigid(v)));
    let is_told = |n: &Note| {
        matches!(
            n,
            Note::InnerPartsFreed {
                n_rigid: 1,
                n_free: 0,
                ..
            }
        )
    };
    assert!(resolved.notes.iter().any(is_told));
}

#[test]
fn it_stays_attracted_where_that_is_asked_for() {
    let pair = ball_with_an_eye();
    let asked = [
        Parts {
            draped: vec!["eye".to_owned()],
            ..Parts::default()
        },
        Parts {
            draped: vec!["hidden:1".to_owned()],
            ..Parts::default()
        },
        Parts {
            is_hidden_draped: true,
            ..Parts::default()
        },
    ];
    for parts in asked {
        let resolved = parts.resolve(&pair).unwrap();
        assert!(resolved.regions.is_none() && resolved.notes.is_empty());
    }
}

#[test]
fn parts_that_are_not_there_are_named() {
    let pair = ball_with_an_eye();
    let free = |name: &str| Parts {
        free: vec![name.to_owned()],
        ..Parts::default()
    };
    let error = free("nose").resolve(&pair).unwrap_err();
    assert!(error.to_string().contains("ball") && error.to_string().contains("eye"));
    let error = free("hidden:7").resolve(&pair).unwrap_err();
    let is_counted = |p: &PartProblem| matches!(p, PartProblem::NoInnerSurface { n: 1, .. });
    assert!(matches!(&error, PartError::Part { problem, .. } if is_counted(problem)));
    let everything = Parts {
        free: vec!["ball".to_owned(), "eye".to_owned()],
        ..Parts::default()
    };
    assert!(matches!(everything.resolve(&pair), Err(PartError::AllFree)));
}
