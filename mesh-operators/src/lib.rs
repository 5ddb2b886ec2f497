//! Sparse operators of polygon meshes (Laplacians, mass), sparse Cholesky, and displacement fields extended into space.
