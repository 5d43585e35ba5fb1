//! Geometry over several bindings, where one cannot hold it.
//!
//! A table of n bindings has its 32-bit numbers dealt out in turns: number i is in binding i mod n, at
//! i / n. A thread that reads n numbers in a row then reads one of each binding at one index, as many
//! loads as from one binding and no choice between them.

use super::DeviceInfo;
use super::limits::mebibytes;
use crate::shader::{Feature, Features};
use crate::{Error, Result};
use rayon::prelude::*;

/// Storage buffers that a kernel binds besides those that only split tables have.
pub(super) const OTHER_BUFFERS: u32 = 9;

/// A table that can lie in several bindings.
pub(super) struct Split {
    /// The variables. Where one binding holds all, only the first is used.
    pub(super) bindings: &'static [&'static str],
    /// The kernels then have this feature.
    pub(super) feature: Feature,
}

/// The tables, each by the name of its first variable.
static SPLITS: [Split; 3] = [
    Split {
        bindings: &["primitives", "primitives_1", "primitives_2", "primitives_3"],
        feature: Feature::SplitPrimitives,
    },
    Split {
        bindings: &["attributes", "attributes_1", "attributes_2", "attributes_3"],
        feature: Feature::SplitAttributes,
    },
    Split { bindings: &["nodes", "nodes_1"], feature: Feature::SplitNodes },
];

impl Split {
    /// The table of that name, if it can be split.
    pub(super) fn named(name: &str) -> Option<&'static Split> {
        SPLITS.iter().find(|split| split.bindings[0] == name)
    }

    /// What binding `k` holds of `bytes`.
    pub(super) fn part(&self, bytes: &[u8], k: usize) -> Vec<u32> {
        let numbers: &[u32] = bytemuck::cast_slice(bytes);
        let groups = numbers.par_chunks_exact(self.bindings.len());
        groups.map(|group| group[k]).collect()
    }
}

/// Which tables are split on a device.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Splits {
    pub(super) features: Features,
    /// Bindings more than without.
    pub(super) extra: u32,
}

impl Splits {
    /// For tables of these names and bytes, in bindings of at most `limit` bytes; or what the first
    /// that does not fit is told. Names that cannot be split are left out.
    pub(super) fn of<'a>(
        tables: impl IntoIterator<Item = (&'a str, usize)>,
        limit: u64,
        device: &DeviceInfo,
    ) -> Result<Self> {
        let mut splits = Self::default();
        for (name, bytes) in tables {
            let Some(split) = Split::named(name).filter(|_| bytes as u64 > limit) else {
                continue;
            };
            let wanted = split.bindings.len() as u32 - 1;
            let left = device.max_storage_buffers.saturating_sub(OTHER_BUFFERS + splits.extra);
            let bindings = if wanted <= left { wanted + 1 } else { 1 };
            if bytes as u64 > u64::from(bindings) * limit || bindings == 1 {
                let plural = if bindings == 1 { "" } else { "s" };
                return Err(Error::Limit(format!(
                    "the scene's {name} need {:.1} MiB, {} offers {bindings} binding{plural} of \
                     {:.1} MiB: use fewer or instanced triangles",
                    mebibytes(bytes as u64),
                    device.name,
                    mebibytes(limit),
                )));
            }
            splits.features = splits.features.with(split.feature);
            splits.extra += wanted;
        }
        Ok(splits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::DeviceKind;

    fn device(max_storage_buffers: u32) -> DeviceInfo {
        DeviceInfo {
            index: 0,
            name: "device".into(),
            driver: String::new(),
            kind: DeviceKind::Cpu,
            subgroup_size: (8, 8),
            max_binding_size: 0,
            max_storage_buffers,
        }
    }

    #[test]
    fn tables_are_split_where_one_binding_is_too_small() {
        let tables = |nodes, primitives, attributes| {
            [("nodes", nodes), ("primitives", primitives), ("attributes", attributes)]
        };
        let of = |tables: [_; 3], buffers| Splits::of(tables, 64, &device(buffers));
        assert_eq!(of(tables(64, 64, 64), 0).unwrap(), Splits::default());
        let splits = of(tables(64, 80, 256), 15).unwrap();
        let both =
            Features::default().with(Feature::SplitPrimitives).with(Feature::SplitAttributes);
        assert_eq!(splits, Splits { features: both, extra: 6 });
        // Three bindings more for each of the two.
        assert!(of(tables(64, 80, 256), 14).is_err());
        assert!(of(tables(128, 64, 64), 10).is_ok());
        for (tables, need) in [
            (tables(144, 64, 64), "2 bindings"),
            (tables(64, 272, 64), "4 bindings"),
            (tables(64, 64, 272), "4 bindings"),
        ] {
            let message = of(tables, 32).unwrap_err().to_string();
            assert!(message.contains(need) && message.contains("instanced"), "{message}");
        }
    }

    #[test]
    fn numbers_are_dealt_out_in_turns() {
        let numbers: Vec<u32> = (0..8).collect();
        let bytes = bytemuck::cast_slice(&numbers);
        let part = |name, k| Split::named(name).unwrap().part(bytes, k);
        assert_eq!(part("primitives", 1), [1, 5]);
        assert_eq!(part("nodes", 1), [1, 3, 5, 7]);
    }
}
