//! Scattering.
