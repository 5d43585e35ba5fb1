// The width of GGX's lobe: alpha, or alpha along x and along y, of which x's is the larger.

// Below this GGX is a mirror: in f32 the half vector would be the larger error.
const LEAST_ALPHA: f32 = 1e-3;

#if ANISOTROPY
alias GgxWidth = vec2<f32>;
#else
alias GgxWidth = f32;
#endif

fn width_of(alpha: f32) -> GgxWidth {
    return GgxWidth(alpha);
}

fn width_is_rough(alpha: GgxWidth) -> bool {
#if ANISOTROPY
    return alpha.x > 0.0;
#else
    return alpha > 0.0;
#endif
}
