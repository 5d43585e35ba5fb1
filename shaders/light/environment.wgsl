// Light from infinity: an equirectangular map with bilinear filtering, sampled
// by rows of cells, then columns, then uniformly in solid angle within the cell. A cell is a
// square of frame.environment_block texels a side, or what of it lies on the map; its probability
// is the integral of the filtered map over it.
#import light/light
#import sample/warp

// All f32. width * height texels of radiance, three words each; then cumulative probabilities of
// the rows of cells (one more than rows), then of each row's columns (one more than columns);
// then of each row the cosine of theta at its upper edge, and by how much it falls to the lower.
@group(0) @binding(8) var<storage, read> environment: array<u32>;

fn environment_texel(x: i32, y: i32) -> vec3<f32> {
    let size = vec2<i32>(frame.environment_size);
    let column = (x + size.x) % size.x;
    let row = clamp(y, 0, size.y - 1);
    let i = 3 * (row * size.x + column);
    return bitcast<vec3<f32>>(vec3<u32>(environment[i], environment[i + 1], environment[i + 2]));
}

fn environment_table(index: u32) -> f32 {
    let base = 3u * frame.environment_size.x * frame.environment_size.y;
    return bitcast<f32>(environment[base + index]);
}

// Columns and rows of cells.
fn environment_cells() -> vec2<u32> {
    return (frame.environment_size + frame.environment_block - 1u) / frame.environment_block;
}

// Texels across a cell of the column.
fn environment_cell_width(column: u32) -> f32 {
    let left = frame.environment_size.x - column * frame.environment_block;
    return f32(min(left, frame.environment_block));
}

fn environment_row_start(row: u32) -> u32 {
    let cells = environment_cells();
    return cells.y + 1u + row * (cells.x + 1u);
}

// Position on the map, in texels, of a world direction.
fn environment_position(direction: vec3<f32>) -> vec2<f32> {
    let e = vec3<f32>(
        dot(frame.environment_x.xyz, direction),
        dot(frame.environment_y.xyz, direction),
        dot(frame.environment_z.xyz, direction),
    );
    let u = atan2_accurate(e.z, e.x) * (0.5 * INV_PI) + 0.5;
    let v = atan2_accurate(length(e.xz), e.y) * INV_PI;
    return vec2<f32>(u, v) * vec2<f32>(frame.environment_size);
}

fn environment_direction(cos_theta: f32, sin_theta: f32, phi: f32) -> vec3<f32> {
    let around = sin_theta * warp_circle(phi);
    let e = vec3<f32>(around.x, cos_theta, around.y);
    return e.x * frame.environment_x.xyz + e.y * frame.environment_y.xyz + e.z * frame.environment_z.xyz;
}

// Radiance arriving against `direction` (which points away from the scene).
fn environment_emitted(direction: vec3<f32>) -> vec3<f32> {
    let position = environment_position(direction) - 0.5;
    let corner = floor(position);
    let w = position - corner;
    let i = vec2<i32>(corner);
    let top = mix(environment_texel(i.x, i.y), environment_texel(i.x + 1, i.y), w.x);
    let bottom = mix(environment_texel(i.x, i.y + 1), environment_texel(i.x + 1, i.y + 1), w.x);
    return mix(top, bottom, w.y);
}

// Density per solid angle within a cell: its probability over its solid angle.
fn environment_density(row: u32, column: u32) -> f32 {
    let start = environment_row_start(row) + column;
    let row_pmf = environment_table(row + 1u) - environment_table(row);
    let pmf = row_pmf * (environment_table(start + 1u) - environment_table(start));
    let turn = (2.0 * PI / f32(frame.environment_size.x)) * environment_cell_width(column);
    let solid_angle = turn * environment_row_shape(row).y;
    return frame.environment_pmf * pmf / solid_angle;
}

// From a table: a texel's solid angle is less than the error of some devices' sines.
fn environment_row_shape(row: u32) -> vec2<f32> {
    let first = environment_row_start(environment_cells().y) + 2u * row;
    return vec2<f32>(environment_table(first), environment_table(first + 1u));
}

fn environment_pdf(direction: vec3<f32>) -> f32 {
    if frame.environment_pmf <= 0.0 {
        return 0.0;
    }
    let position = vec2<u32>(environment_position(direction));
    let cell = min(position, frame.environment_size - 1u) / frame.environment_block;
    return environment_density(cell.y, cell.x);
}

// The last of `count` entries from `start` whose cumulative probability is at most u.
fn environment_search(start: u32, count: u32, u: f32) -> u32 {
    var low = 0u;
    var high = count;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if environment_table(start + middle) <= u {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

// Where u lies between the entry's cumulative probability and the next.
fn environment_rest(index: u32, u: f32) -> f32 {
    let low = environment_table(index);
    return clamp((u - low) / (environment_table(index + 1u) - low), 0.0, 1.0);
}

fn light_environment_sample(u: vec2<f32>) -> LightSample {
    let cells = environment_cells();
    let row = environment_search(0u, cells.y, u.y);
    let start = environment_row_start(row);
    let column = environment_search(start, cells.x, u.x);
    let pdf = environment_density(row, column);
    if !(pdf > 0.0) {
        return light_none();
    }
    let shape = environment_row_shape(row);
    let cos_theta = shape.x - environment_rest(row, u.y) * shape.y;
    let sin_theta = sqrt(max(0.0, (1.0 - cos_theta) * (1.0 + cos_theta)));
    let across = environment_rest(start + column, u.x) * environment_cell_width(column);
    let x = f32(column * frame.environment_block) + across;
    let phi = x * (2.0 * PI / f32(frame.environment_size.x)) - PI;
    let wi = normalize(environment_direction(cos_theta, sin_theta, phi));
    return LightSample(wi, pdf, environment_emitted(wi) / pdf, vec3<f32>(0.0), true);
}
