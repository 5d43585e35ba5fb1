//! Accumulation.
