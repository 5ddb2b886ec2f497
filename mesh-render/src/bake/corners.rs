//! Which corners of its face a triangle has.

/// The corners of a face that a triangle's vertices are, by their places in the face; none where one of them is not there.
///
/// A vertex that the face names twice counts where it is first.
pub(super) fn corners_in_face(face: &[u32], triangle: [u32; 3]) -> Option<[u32; 3]> {
    let place = |vertex| face.iter().position(|&v| v == vertex);
    let [a, b, c] = triangle.map(place);
    Some([a?, b?, c?].map(|k| k as u32))
}
