//! Every struct shared with WGSL. Fields are documented there.

use crate::layout::{StructLayout, gpu_struct};

gpu_struct! {
    /// `frame/frame.wgsl`.
    "Camera" GpuCamera {
        position: [f32; 3],
        aperture_radius: f32,
        right: [f32; 3],
        focus_distance: f32,
        up: [f32; 3],
        half_height: f32,
        back: [f32; 3],
        half_width: f32,
        orthographic: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }
}

gpu_struct! {
    /// `frame/frame.wgsl`.
    "Frame" GpuFrame {
        camera: GpuCamera,
        environment_x: [f32; 4],
        environment_y: [f32; 4],
        environment_z: [f32; 4],
        environment_size: [u32; 2],
        environment_pmf: f32,
        light_count: u32,
        resolution: [u32; 2],
        window_origin: [u32; 2],
        window_size: [u32; 2],
        tiles_across: u32,
        region_first_tile: u32,
        dispatch_first_tile: u32,
        sample_first: u32,
        sample_count: u32,
        seed: u32,
        max_bounces: u32,
        only_bounce: u32,
        light_samples: u32,
        triangle_count: u32,
        sphere_count: u32,
        attribute_base: u32,
        attribute_stride: u32,
        dispatch_tile_count: u32,
        block_unit: u32,
        largest_block: u32,
        sample_limit: u32,
        environment_block: u32,
        finite_light_count: u32,
        finite_light_share: f32,
        light_tree_trails: u32,
        light_candidates: u32,
    }
}

gpu_struct! {
    /// `film/film.wgsl`.
    "FilmPixel" GpuFilmPixel {
        first: [f32; 3],
        sample_count: u32,
        difference: [f32; 3],
        closest_ray_count: u32,
        shadow_ray_count: u32,
        fault_counts: u32,
        fault_sample: u32,
        fault_bounce: u32,
        fault_material: u32,
        pixel: u32,
        sample_first: u32,
        squares: f32,
    }
}

gpu_struct! {
    /// `first_hit.wgsl`.
    "FirstHit" GpuFirstHit {
        shading_normal: [f32; 3],
        depth: f32,
        geometric_normal: [f32; 3],
        hit_count: u32,
        albedo: [f32; 3],
        ray_count: u32,
        position: [f32; 3],
        axial_depth: f32,
        uv: [f32; 2],
        material: u32,
        node_visits: u32,
        primitive_visits: u32,
        faults: u32,
        source: u32,
        instance: u32,
        weights: [f32; 2],
        centre_depth: f32,
        padding_0: u32,
    }
}

gpu_struct! {
    /// `stopping/tally.wgsl`.
    "Tally" GpuTally {
        mean: f32,
        variance: f32,
        largest: f32,
        sample_count: u32,
        half_width: f32,
        reason: u32,
        is_lightable: u32,
        is_estimated: u32,
        first: f32,
        pending: f32,
    }
}

gpu_struct! {
    /// `stopping/tally.wgsl`.
    "Stopping" GpuStopping {
        tolerance: f32,
        floor: f32,
        least_samples: u32,
        black_samples: u32,
        factor: f32,
        consistency: f32,
        outlier_weight: f32,
        batch: u32,
        tile_count: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }
}

gpu_struct! {
    /// `stopping/dispatch.wgsl`.
    "Dispatch" GpuDispatch {
        x: u32,
        y: u32,
        z: u32,
        active_count: u32,
        block_samples: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }
}

gpu_struct! {
    /// `material/material.wgsl`.
    "Material" GpuMaterial {
        base_color: [f32; 3],
        alpha: f32,
        emission: [f32; 3],
        alpha_cutoff: f32,
        specular_color: [f32; 3],
        specular: f32,
        metallic: f32,
        roughness: f32,
        ior: f32,
        transmission: f32,
        normal_scale: f32,
        flags: u32,
        base_color_texture: u32,
        metallic_roughness_texture: u32,
        normal_texture: u32,
        emission_texture: u32,
        specular_texture: u32,
        specular_color_texture: u32,
        absorption: [f32; 3],
        dispersion: f32,
        diffuse_transmission_color: [f32; 3],
        diffuse_transmission: f32,
        sheen_color: [f32; 3],
        sheen_roughness: f32,
        anisotropy: f32,
        anisotropy_cos: f32,
        anisotropy_sin: f32,
        iridescence: f32,
        film_ior: f32,
        film_minimum: f32,
        film_maximum: f32,
        clearcoat: f32,
        clearcoat_roughness: f32,
        clearcoat_normal_scale: f32,
        transmission_texture: u32,
        diffuse_transmission_texture: u32,
        diffuse_transmission_color_texture: u32,
        anisotropy_texture: u32,
        iridescence_texture: u32,
        film_texture: u32,
        sheen_color_texture: u32,
        sheen_roughness_texture: u32,
        clearcoat_texture: u32,
        clearcoat_roughness_texture: u32,
        clearcoat_normal_texture: u32,
        specular_glossiness_texture: u32,
        padding_0: u32,
        padding_1: u32,
    }
}

gpu_struct! {
    /// `light/light.wgsl`.
    "Light" GpuLight {
        kind: u32,
        cdf: f32,
        pmf: f32,
        material: u32,
        a: [f32; 3],
        red: f32,
        b: [f32; 3],
        green: f32,
        c: [f32; 3],
        blue: f32,
        source: u32,
        is_double_sided: u32,
        cell: u32,
        cell_side: u32,
    }
}

/// The layouts of all of them.
pub fn layouts() -> Vec<StructLayout> {
    vec![
        GpuCamera::layout(),
        GpuFrame::layout(),
        GpuFilmPixel::layout(),
        GpuFirstHit::layout(),
        GpuTally::layout(),
        GpuStopping::layout(),
        GpuDispatch::layout(),
        GpuMaterial::layout(),
        GpuLight::layout(),
    ]
}
