//! PLY: ascii and binary in both byte orders, any elements and properties. Written back in the same encoding, only
//! `x y z` and `nx ny nz` of the vertices differ.

mod body;
mod header;
mod looks;
mod scalars;

use std::path::Path;

use self::body::{push_doubles, push_header, Body, Value};
use self::header::{Element, Header, Kind, Property, Scalar};
use super::contents::{CarriedNormals, Contents, Morphs};
use super::document::{Codec, Document, Geometry, Parsed};
use super::error::{Place, ReadProblem};
use super::fault::Fault;
use super::looks::{NamedPicture, PictureAt, Rgb};
use super::printable::printable;
use super::text::{Cursor, Splice};
use super::uvs::CornerUvs;
use crate::{Point3, PolygonSoup, Vector3};

pub(super) const CODEC: Codec = Codec {
    name: "PLY",
    extensions: &["ply"],
    is_text: false,
    geometry: Geometry::Polygons,
    has_uvs: false,
    has_mark,
    is_always_marked: true,
    has_statement: |_| false,
    read,
    write: |soup, _| Ok(write(soup)),
};

/// A PLY file as it was read.
#[derive(Debug)]
struct PlyFile {
    bytes: Vec<u8>,
    header: Header,
}

fn has_mark(bytes: &[u8]) -> bool {
    let mut line = Cursor::new(bytes);
    let keyword = line.field().map(|word| word.text);
    matches!(keyword, Some(b"ply" | b"PLY")) && line.field().is_none() && line.left() > 0
}

const POSITION: [&str; 3] = ["x", "y", "z"];
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];

/// Reads a file: vertices and faces in their order.
fn read(bytes: Vec<u8>, _: &Path) -> Result<Parsed, Fault> {
    let header = Header::read(&bytes)?;
    check_has_positions(&header)?;

    let mut soup = PolygonSoup::default();
    let mut body = Body::new(&bytes, &header);
    for (k, element) in header.elements.iter().enumerate() {
        match element.name.as_str() {
            "vertex" if is_first(&header, k) => read_vertices(&mut body, element, &mut soup)?,
            "face" => read_faces(&mut body, element, &mut soup)?,
            "tristrips" => read_strips(&mut body, element, &mut soup)?,
            _ => body.skip_element(element)?,
        }
    }
    check_indices(&soup)?;
    Ok(Parsed {
        contents: contents(&header, &soup),
        soup,
        findings: Vec::new(),
        document: Box::new(PlyFile { bytes, header }),
    })
}

fn is_first(header: &Header, k: usize) -> bool {
    header.elements[..k].iter().all(|e| e.name != "vertex")
}

fn check_has_positions(header: &Header) -> Result<(), Fault> {
    let vertex = header.elements.iter().find(|e| e.name == "vertex");
    let has_all = vertex.is_some_and(|e| {
        POSITION.iter().all(|name| {
            e.properties
                .iter()
                .any(|p| p.name == *name && matches!(p.kind, Kind::Scalar(_)))
        })
    });
    if has_all {
        return Ok(());
    }
    Err(Fault::whole(ReadProblem::Unsupported {
        feature: "a PLY file without `x`, `y` and `z` in an element `vertex`".to_owned(),
        advice: "rename the properties that hold the position",
    }))
}

fn contents(header: &Header, soup: &PolygonSoup) -> Contents {
    let vertex = header.elements.iter().find(|e| e.name == "vertex");
    let of_vertices = |names: &[&str]| match vertex {
        Some(vertex) if vertex.has_any(names) => soup.positions.len(),
        _ => 0,
    };
    let n_corners = || soup.faces.iter().map(Vec::len).sum();
    let has_corner_uvs = header
        .elements
        .iter()
        .any(|e| e.name == "face" && e.has_any(&["texcoord"]));
    Contents {
        n_uvs: match of_vertices(&["u", "s", "texture_u"]) {
            0 if has_corner_uvs => n_corners(),
            n => n,
        },
        n_normals: of_vertices(&["nx"]),
        n_colors: of_vertices(&["red", "r", "diffuse_red"]),
        n_comments: header.n_comments,
        n_lines_and_points: header
            .elements
            .iter()
            .filter(|e| e.name == "edge")
            .map(|e| e.count as usize)
            .sum(),
        ..Contents::default()
    }
}

/// The scalar property called `names[k]`, as `k` and its type.
fn axis_of(property: &Property, names: [&str; 3]) -> Option<(usize, Scalar)> {
    let axis = names.iter().position(|name| property.name == *name)?;
    match property.kind {
        Kind::Scalar(scalar) => Some((axis, scalar)),
        Kind::List { .. } => None,
    }
}

fn read_vertices<'a>(
    body: &mut Body<'a>,
    element: &'a Element,
    soup: &mut PolygonSoup,
) -> Result<(), Fault> {
    soup.positions.reserve_exact(body.promised(element)?);
    let axes: Vec<_> = element
        .properties
        .iter()
        .map(|p| axis_of(p, POSITION))
        .collect();
    body.each_row(element, |body, _| {
        let mut p = Point3::origin();
        for (property, axis) in element.properties.iter().zip(&axes) {
            match *axis {
                Some((axis, scalar)) => p[axis] = body.coordinate(scalar)?.value,
                None => body.skip(property.kind)?,
            }
        }
        soup.positions.push(p);
        Ok(())
    })
}

/// Which list of `element` holds the corners: the one called so, or else the first of whole numbers.
fn corner_list(element: &Element) -> Result<usize, Fault> {
    let is_list = |p: &Property| matches!(p.kind, Kind::List { .. });
    let is_whole = |p: &Property| matches!(p.kind, Kind::List { item, .. } if !item.is_float());
    let is_named = |p: &Property| matches!(p.name.as_str(), "vertex_indices" | "vertex_index");
    let properties = &element.properties;
    let named = properties.iter().position(|p| is_list(p) && is_named(p));
    let found = named.or_else(|| properties.iter().position(is_whole));
    found.ok_or_else(|| {
        let feature = format!(
            "a PLY file without a list `vertex_indices` in its element `{}`",
            printable(&element.name)
        );
        Fault::unsupported(feature, "name the list that holds the corners so")
    })
}

/// Calls `visit` with the list of whole numbers in each row of `element`.
fn each_corner_list<'a>(
    body: &mut Body<'a>,
    element: &'a Element,
    mut visit: impl FnMut(&Body<'a>, &[i64]) -> Result<(), Fault>,
) -> Result<(), Fault> {
    if element.count == 0 {
        return Ok(());
    }
    let corners_at = corner_list(element)?;
    let mut items = Vec::new();
    body.each_row(element, |body, _| {
        items.clear();
        for (k, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::List { count, item } if corners_at == k => {
                    for _ in 0..body.list_length(count, item)? {
                        items.push(whole(body, item)?);
                    }
                }
                kind => body.skip(kind)?,
            }
        }
        visit(body, &items)
    })
}

fn whole(body: &mut Body<'_>, scalar: Scalar) -> Result<i64, Fault> {
    let Value { value, .. } = body.value(scalar)?;
    if value.fract() == 0.0 {
        return Ok(value as i64);
    }
    let text = value.to_string();
    let expected = "the row of a vertex";
    Err(body.fault(ReadProblem::Unexpected { expected, text }))
}

fn vertex_row(body: &Body<'_>, index: i64, soup: &PolygonSoup) -> Result<u32, Fault> {
    let n_vertices = soup.positions.len();
    // Vertices may follow the faces: then the upper end is checked when both are read.
    u32::try_from(index)
        .ok()
        .filter(|&row| n_vertices == 0 || (row as usize) < n_vertices)
        .ok_or_else(|| {
            let first = 0;
            body.fault(ReadProblem::IndexOutOfRange {
                index,
                n_vertices,
                first,
            })
        })
}

/// Where the faces come before the vertices.
fn check_indices(soup: &PolygonSoup) -> Result<(), Fault> {
    let n_vertices = soup.positions.len();
    let is_outside = |&v: &u32| v as usize >= n_vertices;
    for (row, corners) in soup.faces.iter().enumerate() {
        if let Some(&v) = corners.iter().find(|v| is_outside(v)) {
            let element = "face".to_owned();
            return Err(Fault {
                place: Place::Row { element, row },
                problem: ReadProblem::IndexOutOfRange {
                    index: i64::from(v),
                    n_vertices,
                    first: 0,
                },
            });
        }
    }
    Ok(())
}

fn read_faces<'a>(
    body: &mut Body<'a>,
    element: &'a Element,
    soup: &mut PolygonSoup,
) -> Result<(), Fault> {
    soup.faces.reserve_exact(body.promised(element)?);
    each_corner_list(body, element, |body, items| {
        let corners = items.iter().map(|&index| vertex_row(body, index, soup));
        let corners = corners.collect::<Result<_, _>>()?;
        soup.faces.push(corners);
        Ok(())
    })
}

/// Strips of triangles, each turning against the one before; −1 starts a new strip.
fn read_strips<'a>(
    body: &mut Body<'a>,
    element: &'a Element,
    soup: &mut PolygonSoup,
) -> Result<(), Fault> {
    each_corner_list(body, element, |body, items| {
        for strip in items.split(|&index| index == -1) {
            for (k, corners) in strip.windows(3).enumerate() {
                let mut triangle = Vec::with_capacity(3);
                for &index in corners {
                    triangle.push(vertex_row(body, index, soup)?);
                }
                if k % 2 == 1 {
                    triangle.swap(0, 1);
                }
                soup.faces.push(triangle);
            }
        }
        Ok(())
    })
}

impl Document for PlyFile {
    fn vertex_normals(&self, _: &PolygonSoup) -> Option<Vec<Vector3>> {
        self.normal_rows().ok().flatten()
    }

    fn vertex_scalars(&self, name: &str) -> Option<Vec<f64>> {
        let values = scalars::vertex_scalars(&self.bytes, &self.header, name);
        values.ok().flatten()
    }

    fn vertex_colors(&self, _: usize) -> Option<Vec<Rgb>> {
        let channels = ["red", "green", "blue"].map(|name| self.vertex_scalars(name));
        let [Some(red), Some(green), Some(blue)] = channels else {
            return None;
        };
        let colors = red.into_iter().zip(green).zip(blue);
        let colors: Vec<[f64; 3]> = colors.map(|((r, g), b)| [r, g, b]).collect();
        let are_bytes = colors.iter().flatten().any(|&c| c > 1.0);
        let scale = if are_bytes { 1.0 / 255.0 } else { 1.0 };
        let scaled = colors.into_iter().map(|c| c.map(|x| (x * scale) as f32));
        Some(scaled.collect())
    }

    fn shown_uvs(&self, soup: &PolygonSoup) -> Option<CornerUvs> {
        self.uvs(soup)
    }

    fn pictures(&self, _: &Contents, n_faces: usize, _: &Path) -> Vec<NamedPicture> {
        let all = || std::iter::once(0..n_faces).collect();
        let named = self.picture().map(|name| (all(), PictureAt::File(name)));
        named.into_iter().collect()
    }

    /// Coordinates that did not change keep their bytes. Positions in whole-number columns become `double` columns.
    fn rewrite(&self, rest: &PolygonSoup, moved: &[Point3], _: Morphs) -> Result<Vec<u8>, Fault> {
        let rows = self.normal_rows()?;
        let normals = rows.map(|rows| CarriedNormals::of_vertices(rows, rest, moved));
        let has_moved = rest.positions != moved;
        let mut splice = Splice::new(&self.bytes);
        let mut body = Body::new(&self.bytes, &self.header);
        for element in &self.header.elements {
            if element.name != "vertex" {
                body.skip_element(element)?;
                continue;
            }
            if has_moved {
                widen_positions(&mut splice, element);
            }
            rewrite_vertices(&mut body, element, &mut splice, |property, row| {
                if let Some((axis, _)) = axis_of(property, POSITION) {
                    let (from, to) = (rest.positions[row][axis], moved[row][axis]);
                    let is_kept = from.to_bits() == to.to_bits();
                    return (!is_kept || has_moved && is_widened(property)).then_some(to);
                }
                let (axis, scalar) = axis_of(property, NORMAL)?;
                let n = normals.as_ref()?.changed(row)?;
                scalar.holds_coordinates().then_some(n[axis])
            })?;
            break;
        }
        Ok(splice.finish())
    }
}

fn is_widened(property: &Property) -> bool {
    axis_of(property, POSITION).is_some_and(|(_, scalar)| !scalar.holds_coordinates())
}

fn widen_positions(splice: &mut Splice<'_>, element: &Element) {
    for property in element.properties.iter().filter(|p| is_widened(p)) {
        splice.replace(property.type_name.clone(), b"double");
    }
}

/// Replaces the numbers of the vertices for which `new` has one.
fn rewrite_vertices<'a>(
    body: &mut Body<'a>,
    element: &'a Element,
    splice: &mut Splice<'_>,
    new: impl Fn(&Property, usize) -> Option<f64>,
) -> Result<(), Fault> {
    body.each_row(element, |body, row| {
        for property in &element.properties {
            let (Kind::Scalar(scalar), Some(x)) = (property.kind, new(property, row)) else {
                body.skip(property.kind)?;
                continue;
            };
            let range = body.take(scalar)?;
            body.put(splice, range, scalar, x)?;
        }
        Ok(())
    })
}

impl PlyFile {
    /// The columns `nx ny nz` of the vertices, if there are any.
    fn normal_rows(&self) -> Result<Option<Vec<Vector3>>, Fault> {
        let mut body = Body::new(&self.bytes, &self.header);
        for element in &self.header.elements {
            if element.name != "vertex" {
                body.skip_element(element)?;
            } else if element.has_any(&NORMAL[..1]) {
                return normal_rows(&mut body, element).map(Some);
            } else {
                break;
            }
        }
        Ok(None)
    }
}

fn normal_rows<'a>(body: &mut Body<'a>, element: &'a Element) -> Result<Vec<Vector3>, Fault> {
    let mut rows = Vec::new();
    body.each_row(element, |body, _| {
        let mut n = Vector3::zeros();
        for property in &element.properties {
            match axis_of(property, NORMAL) {
                Some((axis, scalar)) => n[axis] = body.value_or_nan(scalar)?,
                None => body.skip(property.kind)?,
            }
        }
        let is_finite = n.iter().all(|x| x.is_finite());
        rows.push(if is_finite { n } else { Vector3::zeros() });
        Ok(())
    })?;
    Ok(rows)
}

/// A new file of `soup`, binary, in double precision.
fn write(soup: &PolygonSoup) -> Vec<u8> {
    let mut out = Vec::with_capacity(24 * soup.positions.len() + 16 * soup.faces.len() + 256);
    push_header(&mut out, soup.positions.len(), soup.faces.len());
    for p in &soup.positions {
        push_doubles(&mut out, p.coords.iter().copied());
    }
    for face in &soup.faces {
        out.extend_from_slice(&(face.len() as u32).to_le_bytes());
        for v in face {
            out.extend_from_slice(&v.to_le_bytes());
        }
    }
    out
}
