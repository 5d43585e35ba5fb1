//! Floating point arithmetic of the device, and what must hold whatever it does.

mod driver;
mod faults;
mod scale;
mod trigonometry;
