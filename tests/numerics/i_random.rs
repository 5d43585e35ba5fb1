//! Random numbers and sequences.
