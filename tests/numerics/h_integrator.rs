//! The integrator.
