//! Floating point arithmetic of the device.
