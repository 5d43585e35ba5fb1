//! The integrator.

mod caught;
mod counters;
mod roulette;
mod stack;
mod weights;
