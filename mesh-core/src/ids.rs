//! Typed element indices: raw integers never cross a public boundary except in soup and files.

/// An element index that knows which kind of element it names.
pub trait Id: Copy + Eq + std::fmt::Debug {
    /// The id of the element in row `index`.
    ///
    /// # Panics
    /// If `index` does not fit in 32 bits; [`crate::HalfedgeMesh`] checks sizes before it makes ids.
    fn new(index: usize) -> Self;

    /// The row of the element.
    fn index(self) -> usize;
}

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
        pub struct $name(u32);

        impl $name {
            /// The id of the element in row `index` (see [`Id::new`]).
            pub fn new(index: usize) -> Self {
                <Self as Id>::new(index)
            }

            /// The row of the element.
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl Id for $name {
            fn new(index: usize) -> Self {
                Self(u32::try_from(index).expect("element indices fit in 32 bits"))
            }

            fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.0.fmt(f)
            }
        }
    };
}

id!(
    /// A vertex: the row of a position, the same row as in the file it came from.
    VertexId
);
id!(
    /// A directed edge of a face, or of a boundary loop.
    HalfedgeId
);
id!(
    /// An undirected edge: the pair of halfedges `2e` and `2e + 1`.
    EdgeId
);
id!(
    /// A face: the row of a polygon, the same row as in the file it came from.
    FaceId
);
