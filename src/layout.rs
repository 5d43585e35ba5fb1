//! Structs that the host fills and WGSL reads.

/// What a struct looks like on the host; a test compares it with WGSL's.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StructLayout {
    /// Name in WGSL.
    pub name: &'static str,
    /// Bytes.
    pub size: usize,
    /// Name and byte offset of each field.
    pub fields: Vec<(&'static str, usize)>,
}

/// Defines a `repr(C)`, `Pod` struct and its [`StructLayout`]. The first word is
/// the struct's name in WGSL.
macro_rules! gpu_struct {
    ($(#[$doc:meta])* $wgsl:literal $name:ident { $($field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[repr(C)]
        #[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        #[allow(missing_docs, reason = "fields are documented in the WGSL struct")]
        pub struct $name { $(pub $field: $type,)* }

        impl $name {
            /// Its layout on the host.
            pub fn layout() -> $crate::layout::StructLayout {
                $crate::layout::StructLayout {
                    name: $wgsl,
                    size: size_of::<Self>(),
                    fields: vec![$((stringify!($field), std::mem::offset_of!(Self, $field)),)*],
                }
            }
        }
    };
}

pub(crate) use gpu_struct;
