//! The integrator.

mod counters;
mod roulette;
mod stack;
mod weights;
