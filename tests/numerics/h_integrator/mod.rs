//! The integrator.

mod stack;
