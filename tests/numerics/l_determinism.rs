//! The same bytes.
