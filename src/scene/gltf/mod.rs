//! glTF 2.0 and GLB to [`Scene`](super::Scene).
