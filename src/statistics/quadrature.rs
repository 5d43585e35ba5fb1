//! Integrals over rectangles, to the accuracy that a chi-square test needs.

/// Positive abscissae and weights of the Gauss-Legendre rule of six points on [-1, 1]
/// (Abramowitz and Stegun, table 25.4).
const NODES: [(f64, f64); 3] = [
    (0.238_619_186_083_196_9, 0.467_913_934_572_691_04),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_36),
];

/// Halvings of each side at most: a jump across the rectangle leaves an error near 1e-5
/// of what it jumps over.
const DEEPEST: u32 = 8;

/// Integral of `f` over `x` times `y` in f64, by Gauss rules on quarters that are cut
/// until their sum moves by less than `relative` of it or `absolute`. Jumps of `f` cost
/// time, not accuracy beyond about 1e-5. A peak much narrower than a tenth of the
/// rectangle may be missed: choose rectangles of its size.
pub fn integrate_rectangle(
    f: &impl Fn(f64, f64) -> f64,
    x: (f64, f64),
    y: (f64, f64),
    relative: f64,
    absolute: f64,
) -> f64 {
    refine(f, (x, y), gauss(f, (x, y)), &Tolerance { relative, absolute }, 0)
}

type Rectangle = ((f64, f64), (f64, f64));

struct Tolerance {
    relative: f64,
    absolute: f64,
}

fn refine(
    f: &impl Fn(f64, f64) -> f64,
    whole: Rectangle,
    estimate: f64,
    tolerance: &Tolerance,
    depth: u32,
) -> f64 {
    let quarters = quarters(whole);
    let parts = quarters.map(|quarter| gauss(f, quarter));
    let sum: f64 = parts.iter().sum();
    // The absolute share of a part shrinks with its area.
    let allowed = tolerance.absolute * 0.25_f64.powi(depth as i32) + tolerance.relative * sum.abs();
    if depth + 1 == DEEPEST || (sum - estimate).abs() <= allowed {
        return sum;
    }
    let parts = quarters.iter().zip(parts);
    parts.map(|(&quarter, part)| refine(f, quarter, part, tolerance, depth + 1)).sum()
}

fn quarters(((x0, x2), (y0, y2)): Rectangle) -> [Rectangle; 4] {
    let (x1, y1) = (0.5 * (x0 + x2), 0.5 * (y0 + y2));
    let (left, right, low, high) = ((x0, x1), (x1, x2), (y0, y1), (y1, y2));
    [(left, low), (right, low), (left, high), (right, high)]
}

fn gauss(f: &impl Fn(f64, f64) -> f64, (x, y): Rectangle) -> f64 {
    let points = |(a, b): (f64, f64)| {
        let (center, half) = (0.5 * (a + b), 0.5 * (b - a));
        let both = move |&(node, weight): &(f64, f64)| {
            [(center - half * node, weight * half), (center + half * node, weight * half)]
        };
        NODES.iter().flat_map(both)
    };
    let row = |(x, wx): (f64, f64)| points(y).map(|(y, wy)| wx * wy * f(x, y)).sum::<f64>();
    points(x).map(row).sum()
}
