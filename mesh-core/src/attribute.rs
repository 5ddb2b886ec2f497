//! One value per element, indexed only by that element's own id: `x[v]`.

use std::marker::PhantomData;
use std::ops::{Index, IndexMut};

use crate::{EdgeId, FaceId, HalfedgeId, Id, Point3, VertexId};

/// One `T` per element of kind `I`, beside the mesh and never inside it.
///
/// ```
/// use mesh_core::{VertexData, VertexId};
/// let mut weight = VertexData::new(3, 1.0);
/// weight[VertexId::new(2)] = 0.5;
/// assert_eq!(weight.as_slice(), [1.0, 1.0, 0.5]);
/// ```
#[derive(Clone, PartialEq, Debug)]
pub struct Attribute<I, T> {
    values: Vec<T>,
    element: PhantomData<fn(I)>,
}

/// One value per vertex.
pub type VertexData<T> = Attribute<VertexId, T>;
/// One value per halfedge.
pub type HalfedgeData<T> = Attribute<HalfedgeId, T>;
/// One value per edge.
pub type EdgeData<T> = Attribute<EdgeId, T>;
/// One value per face.
pub type FaceData<T> = Attribute<FaceId, T>;
/// One point per vertex: the geometry of a mesh.
pub type Positions = VertexData<Point3>;

impl<I: Id, T> Attribute<I, T> {
    /// `n` copies of `value`.
    pub fn new(n: usize, value: T) -> Self
    where
        T: Clone,
    {
        Self::from(vec![value; n])
    }

    /// How many elements there are.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether there is no element.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// All ids, in order.
    pub fn ids(&self) -> impl ExactSizeIterator<Item = I> + use<I, T> {
        (0..self.values.len()).map(I::new)
    }

    /// All values, in id order.
    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.values.iter()
    }

    /// All values, in id order, to be changed.
    pub fn iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
        self.values.iter_mut()
    }

    /// All values as a plain slice, in id order.
    pub fn as_slice(&self) -> &[T] {
        &self.values
    }

    /// All values as a plain slice to be changed, in id order.
    pub fn as_mut_slice(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// The values as a plain vector, in id order.
    pub fn into_vec(self) -> Vec<T> {
        self.values
    }

    /// The attribute whose values are `f` of these.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> Attribute<I, U> {
        Attribute::from(self.values.iter().map(f).collect::<Vec<_>>())
    }
}

impl<I, T> From<Vec<T>> for Attribute<I, T> {
    fn from(values: Vec<T>) -> Self {
        Self {
            values,
            element: PhantomData,
        }
    }
}

impl<I, T> FromIterator<T> for Attribute<I, T> {
    fn from_iter<It: IntoIterator<Item = T>>(values: It) -> Self {
        Self::from(values.into_iter().collect::<Vec<_>>())
    }
}

impl<'a, I, T> IntoIterator for &'a Attribute<I, T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.values.iter()
    }
}

impl<I: Id, T> Index<I> for Attribute<I, T> {
    type Output = T;

    fn index(&self, id: I) -> &T {
        &self.values[id.index()]
    }
}

impl<I: Id, T> IndexMut<I> for Attribute<I, T> {
    fn index_mut(&mut self, id: I) -> &mut T {
        &mut self.values[id.index()]
    }
}
