//! Landmark-guided initial deformation of polygon meshes: affine, biharmonic, as rigid as possible.
