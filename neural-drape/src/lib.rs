//! Drapes a mesh over a target: progressive-encoding network or preconditioned vertices, one stepper.
