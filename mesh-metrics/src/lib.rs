//! Judges a draped mesh: Chamfer, Hausdorff, Dirichlet, Q_transfer, folds and skinny faces.
