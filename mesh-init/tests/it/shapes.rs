//! Triangle and polygon shapes, closed and open.

use mesh_core::{shapes, HalfedgeMesh, PolygonSoup, Positions, Triangulation, VertexId};

pub(crate) struct Shape {
    pub(crate) name: &'static str,
    pub(crate) mesh: HalfedgeMesh,
    pub(crate) rest: Positions,
    pub(crate) triangulation: Triangulation,
}

pub(crate) fn all() -> Vec<Shape> {
    let soups: [(&str, PolygonSoup); 6] = [
        ("tetrahedron", shapes::tetrahedron()),
        ("icosphere", shapes::icosphere(2)),
        ("quad sphere", shapes::quad_sphere(5)),
        ("open grid", shapes::open_grid(7, 4)),
        ("cone", shapes::cone(9)),
        ("prism", shapes::prism(7)),
    ];
    soups.map(|(name, soup)| shape(name, soup)).into()
}

pub(crate) fn shape(name: &'static str, soup: PolygonSoup) -> Shape {
    let (mesh, rest) = soup.into_halfedge().expect("shapes are meshes");
    let triangulation = Triangulation::new(&mesh, &rest);
    Shape {
        name,
        mesh,
        rest,
        triangulation,
    }
}

/// Four vertices spread over a shape, not in one plane unless the shape is flat.
pub(crate) fn handles(shape: &Shape) -> [VertexId; 4] {
    let n = shape.rest.len();
    [0, n / 3, n / 2, n - 1].map(VertexId::new)
}

pub(crate) fn largest_distance(x: &Positions, y: &Positions) -> f64 {
    x.iter()
        .zip(y)
        .map(|(p, q)| (p - q).norm())
        .fold(0.0, f64::max)
}
