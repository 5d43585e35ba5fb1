//! A number for what was asked for.

use super::RenderSettings;
use crate::scene::Fnv;
#[cfg(doc)]
use crate::scene::Scene;
use std::fmt::Write;

impl RenderSettings {
    /// Hash of everything here that the bits of a finished picture depend on; with
    /// [`Scene::content_hash`], which knows the camera, it names the picture of a device and driver.
    /// The limit of time is not part of it: what it cuts off is no finished picture. To tell whether
    /// two renders are parts of one, hash both with the same `spp` and `crop`. It may change with the
    /// version of this program.
    pub fn content_hash(&self) -> u64 {
        // Every field by name, so that the compiler asks about a new one.
        let Self {
            resolution,
            crop: _,
            spp,
            time: _,
            stopping: _,
            seed,
            strategy,
            light_samples,
            light_selection,
            light_candidates,
            max_bounces,
            only_bounce,
            roulette,
            path_reuse: _,
            sampler,
            camera: _,
            block_size,
            accel,
            energy_compensation,
            all_features,
        } = self;
        let mut hash = Fnv::default();
        // Writing to a hash cannot fail. `{:?}` tells any two numbers apart.
        let _ = write!(hash, "{:?}", (resolution, self.window(), spp, seed, block_size, sampler));
        let _ = write!(hash, "{:?}", (strategy, light_samples, light_selection, light_candidates));
        let _ = write!(hash, "{:?}", (max_bounces, only_bounce, roulette, self.shares_paths()));
        let _ = write!(hash, "{:?}", (accel, energy_compensation, all_features));
        let _ = write!(hash, "{:?}", self.stopping_rule());
        hash.value()
    }
}

#[cfg(test)]
mod tests {
    use crate::settings::*;
    use crate::stopping::{CalibratedRule, Preset, SeedRule};
    use std::time::Duration;

    #[test]
    fn the_hash_knows_every_field_that_changes_bits() {
        let hash = |change: fn(&mut RenderSettings)| {
            let mut settings = RenderSettings::default();
            change(&mut settings);
            settings.content_hash()
        };
        let rule = |tolerance, confidence, preset| {
            let rule = CalibratedRule::new(tolerance, confidence, preset);
            let stopping = Some(StoppingRule::Calibrated(rule));
            RenderSettings { stopping, ..RenderSettings::default() }.content_hash()
        };
        let all = [
            hash(|_| {}),
            hash(|s| s.resolution.0 = 511),
            hash(|s| s.crop = Some(Crop { x: 1, y: 0, width: 511, height: 512 })),
            hash(|s| s.spp = 65),
            hash(|s| s.seed = 1),
            hash(|s| s.strategy = Strategy::Light),
            hash(|s| s.light_samples = 2),
            hash(|s| s.light_selection = LightSelection::Power),
            hash(|s| s.light_candidates = 1),
            hash(|s| s.max_bounces = Some(4)),
            hash(|s| s.only_bounce = Some(4)),
            hash(|s| s.roulette = false),
            hash(|s| s.path_reuse = true),
            hash(|s| s.sampler = Sampler::Independent),
            hash(|s| s.block_size = 8),
            hash(|s| s.accel = Accel::Median),
            hash(|s| s.energy_compensation = true),
            hash(|s| s.all_features = true),
            hash(|s| s.stopping = Some(StoppingRule::Seed(SeedRule { batch: 8, tolerance: 0.05 }))),
            rule(0.05, 0.95, Preset::Default),
            rule(0.05, 0.95, Preset::Strict),
            rule(0.05, 0.9, Preset::Strict),
            rule(0.01, 0.95, Preset::Strict),
        ];
        for (i, a) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|b| a != b), "change {i} does not count");
        }
    }

    #[test]
    fn the_hash_is_of_what_settings_mean() {
        let first = RenderSettings::default();
        let same = [
            RenderSettings { time: Some(Duration::from_secs(9)), ..first.clone() },
            RenderSettings { camera: 3, ..first.clone() },
            RenderSettings { crop: Some(first.window()), ..first.clone() },
        ];
        assert_eq!(same.map(|s| s.content_hash()), [first.content_hash(); 3]);
        let short = RenderSettings { max_bounces: Some(1), ..first };
        let alone = RenderSettings { path_reuse: true, ..short.clone() };
        assert_eq!(alone.content_hash(), short.content_hash());
    }
}
