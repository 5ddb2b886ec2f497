//! Scalar properties of the vertices, by name.

use super::body::Body;
use super::header::{Header, Kind};
use crate::io::fault::Fault;

/// The value of a scalar property at each vertex; none if the first element `vertex` has no such property.
pub(super) fn vertex_scalars(
    bytes: &[u8],
    header: &Header,
    name: &str,
) -> Result<Option<Vec<f64>>, Fault> {
    let mut body = Body::new(bytes, header);
    for element in &header.elements {
        if element.name != "vertex" {
            body.skip_element(element)?;
            continue;
        }
        let wanted = element
            .properties
            .iter()
            .position(|p| p.name == name && matches!(p.kind, Kind::Scalar(_)));
        let Some(wanted) = wanted else {
            return Ok(None);
        };
        let mut values = Vec::with_capacity(body.promised(element)?);
        body.each_row(element, |body, _| {
            for (k, property) in element.properties.iter().enumerate() {
                match property.kind {
                    Kind::Scalar(scalar) if k == wanted => {
                        values.push(body.coordinate(scalar)?.value);
                    }
                    kind => body.skip(kind)?,
                }
            }
            Ok(())
        })?;
        return Ok(Some(values));
    }
    Ok(None)
}
