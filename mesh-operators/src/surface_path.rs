//! The shortest way between two places of a surface.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use mesh_core::{MeshPoint, Point3, Positions, Triangulation, VertexId};

/// A way may turn at this many places inside every edge, beside its ends.
const PLACES_PER_EDGE: usize = 3;

/// The shortest way along the surface from one place to another: places one after the other, any two of them in one triangle.
///
/// Dijkstra's search, led by the straight distance to the end (A*), over the vertices and three evenly spaced places on
/// every edge, joined straight through triangles. Ways are too long by 1 or 2 %, where triangles are thin by more. None where
/// no triangles join the places, or a place is in none.
///
/// # Panics
/// If a place names a vertex that is not a row of `x`, or `x` has not one position for each vertex of the mesh.
///
/// ```
/// use mesh_core::{shapes, MeshPoint, Triangulation, VertexId};
/// use mesh_operators::surface_path;
/// let (mesh, x) = shapes::open_grid(4, 4).into_halfedge()?;
/// let triangulation = Triangulation::new(&mesh, &x);
/// let [from, to] = [0, 24].map(|v| MeshPoint::vertex(VertexId::new(v)));
/// let way = surface_path(&triangulation, &x, &from, &to).expect("the grid is one piece");
/// let length: f64 = way.windows(2).map(|p| (p[0].position(&x) - p[1].position(&x)).norm()).sum();
/// assert!((length - 32f64.sqrt()).abs() < 1e-9);
/// # Ok::<(), mesh_core::TopologyError>(())
/// ```
pub fn surface_path(
    triangulation: &Triangulation,
    x: &Positions,
    from: &MeshPoint,
    to: &MeshPoint,
) -> Option<Vec<MeshPoint>> {
    let graph = Graph { triangulation, x };
    let (starts, ends) = (graph.around(from), graph.around(to));
    if starts.iter().any(|t| ends.contains(t)) {
        return Some(vec![*from, *to]);
    }
    let mut search = Search::new(&graph, to.position(x));
    let start = from.position(x);
    for node in starts.iter().flat_map(|&t| graph.nodes(t)) {
        search.reach(node, (graph.at(node) - start).norm(), None);
    }
    while let Some((node, length)) = search.nearest() {
        if node == search.goal {
            break;
        }
        let here = graph.at(node);
        for t in graph.touching(node) {
            if ends.contains(&t) {
                let left = (search.end - here).norm();
                search.reach(search.goal, length + left, Some(node));
            }
            for next in graph.nodes(t) {
                search.reach(next, length + (graph.at(next) - here).norm(), Some(node));
            }
        }
    }
    let mut way = vec![*from];
    way.extend(search.way()?.into_iter().map(|node| graph.place(node)));
    way.push(*to);
    way.dedup_by(|b, a| a.position(x) == b.position(x));
    Some(way)
}

/// How far the nodes are from the start, as far as is known.
struct Search<'a> {
    graph: &'a Graph<'a>,
    /// The place to come to, as a node after all others.
    goal: usize,
    end: Point3,
    /// Length of the shortest known way to a node, and the node before it; looked up, never gone through.
    known: HashMap<usize, (f64, Option<usize>)>,
    /// Length of the way by a node if it went straight on, length to the node, node. Lengths are ≥ 0, and the bits of such
    /// numbers are ordered as the numbers are.
    queue: BinaryHeap<Reverse<(u64, u64, usize)>>,
}

impl<'a> Search<'a> {
    fn new(graph: &'a Graph<'a>, end: Point3) -> Self {
        let goal = graph.n_nodes();
        Self {
            graph,
            goal,
            end,
            known: HashMap::new(),
            queue: BinaryHeap::new(),
        }
    }

    /// A way of this length leads to a node, from the node before.
    fn reach(&mut self, node: usize, length: f64, before: Option<usize>) {
        if self.known.get(&node).is_some_and(|known| known.0 <= length) {
            return;
        }
        self.known.insert(node, (length, before));
        let left = match node == self.goal {
            true => 0.0,
            false => (self.graph.at(node) - self.end).norm(),
        };
        let straight_on = (length + left).to_bits();
        self.queue
            .push(Reverse((straight_on, length.to_bits(), node)));
    }

    /// The next node to go on from, and the length of the way to it.
    fn nearest(&mut self) -> Option<(usize, f64)> {
        while let Some(Reverse((_, bits, node))) = self.queue.pop() {
            let length = self.known.get(&node).map(|known| known.0);
            if length.is_some_and(|length| length.to_bits() == bits) {
                return length.map(|length| (node, length));
            }
        }
        None
    }

    /// The nodes on the way to the goal; none where it was not reached.
    fn way(&self) -> Option<Vec<usize>> {
        let before = |node: &usize| self.known.get(node)?.1;
        // The goal always has a node before it.
        let last = before(&self.goal)?;
        let mut way: Vec<usize> = std::iter::successors(Some(last), before).collect();
        way.reverse();
        Some(way)
    }
}

/// The vertices, and after them the places on every edge.
struct Graph<'a> {
    triangulation: &'a Triangulation,
    x: &'a Positions,
}

impl Graph<'_> {
    fn n_nodes(&self) -> usize {
        self.x.len() + PLACES_PER_EDGE * self.triangulation.edges().len()
    }

    /// The edge of a node and where on it; none for a vertex.
    fn on_edge(&self, node: usize) -> Option<(usize, f64)> {
        let row = node.checked_sub(self.x.len())?;
        let share = (row % PLACES_PER_EDGE + 1) as f64 / (PLACES_PER_EDGE + 1) as f64;
        Some((row / PLACES_PER_EDGE, share))
    }

    fn place(&self, node: usize) -> MeshPoint {
        match self.on_edge(node) {
            None => MeshPoint::vertex(VertexId::new(node)),
            Some((edge, share)) => {
                let [a, b] = self.triangulation.edges()[edge];
                MeshPoint::barycentric([a, b, b], [1.0 - share, share, 0.0])
            }
        }
    }

    fn at(&self, node: usize) -> Point3 {
        self.place(node).position(self.x)
    }

    /// The triangles that a node is a corner or on a side of.
    fn touching(&self, node: usize) -> Vec<usize> {
        let rows = match self.on_edge(node) {
            None => self.triangulation.vertex_triangles(VertexId::new(node)),
            Some((edge, _)) => self.triangulation.edge_triangles(edge),
        };
        rows.iter().map(|&t| t as usize).collect()
    }

    /// The nodes on the sides of a triangle.
    fn nodes(&self, t: usize) -> impl Iterator<Item = usize> + '_ {
        let corners = self.triangulation.triangles()[t];
        let sides = self.triangulation.triangle_edges(t);
        let n_vertices = self.x.len();
        let on_sides = sides.into_iter().flat_map(move |edge| {
            (0..PLACES_PER_EDGE).map(move |k| n_vertices + PLACES_PER_EDGE * edge + k)
        });
        corners.into_iter().map(VertexId::index).chain(on_sides)
    }

    /// The triangles that hold a place: those that have all vertices that count there.
    fn around(&self, place: &MeshPoint) -> Vec<usize> {
        let counts = place.vertices.iter().zip(place.weights);
        let counts: Vec<VertexId> = counts.filter(|(_, w)| *w != 0.0).map(|(&v, _)| v).collect();
        let Some(&first) = counts.first() else {
            return Vec::new();
        };
        let rows = self.triangulation.vertex_triangles(first);
        let holds = |&t: &usize| {
            let corners = self.triangulation.triangles()[t];
            counts.iter().all(|v| corners.contains(v))
        };
        rows.iter().map(|&t| t as usize).filter(holds).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::shapes;

    #[test]
    fn ways_around_a_ball_are_near_to_great_circles() {
        let (mesh, x) = shapes::icosphere(3).into_halfedge().unwrap();
        let triangulation = Triangulation::new(&mesh, &x);
        for (a, b) in [(0, 3), (5, 11), (20, 300)] {
            let [from, to] = [a, b].map(|v| MeshPoint::vertex(VertexId::new(v)));
            let way = surface_path(&triangulation, &x, &from, &to).unwrap();
            let places: Vec<Point3> = way.iter().map(|p| p.position(&x)).collect();
            let length: f64 = places.windows(2).map(|p| (p[0] - p[1]).norm()).sum();
            let ends = [from.position(&x).coords, to.position(&x).coords];
            let arc = ends[0].cross(&ends[1]).norm().atan2(ends[0].dot(&ends[1]));
            assert!(
                (0.99 * arc..1.03 * arc).contains(&length),
                "{length} of {arc}"
            );
        }
    }

    #[test]
    fn pieces_are_not_joined() {
        let mut soup = shapes::tetrahedron();
        let n = soup.positions.len() as u32;
        let second = shapes::tetrahedron();
        soup.positions.extend(second.positions);
        let moved = second
            .faces
            .iter()
            .map(|f| f.iter().map(|v| v + n).collect());
        soup.faces.extend(moved);
        let (mesh, x) = soup.into_halfedge().unwrap();
        let triangulation = Triangulation::new(&mesh, &x);
        let [from, to] = [0, 5].map(|v| MeshPoint::vertex(VertexId::new(v)));
        assert!(surface_path(&triangulation, &x, &from, &to).is_none());
    }
}
