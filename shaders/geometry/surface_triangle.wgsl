// The surface at a hit on a triangle. The position is interpolated from the
// vertices: it lies in the triangle's plane however far the ray came.
#import geometry/surface
#if INSTANCES
#import geometry/nodes
#endif
#if ATTRIBUTES
#import geometry/attributes
#endif

fn surface_triangle(surface: Surface, p: Primitive, hit: Hit) -> Surface {
    var s = surface;
    let a = primitive_point(p.a);
    let b = primitive_point(p.b);
    let c = primitive_point(p.c);
    s.position = (1.0 - hit.u - hit.v) * a + hit.u * b + hit.v * c;
    let extent = max(max(abs(a), abs(b)), abs(c));
    s.offset = spawn_offset(max_component(extent));
    s.ng = surface_unit(cross(b - a, c - a));
    s.ns = s.ng;
#if ATTRIBUTES
    s = surface_attributes(s, primitive_source(p), hit, b - a, c - a);
#endif
#if INSTANCES
    if hit.instance != INVALID {
        s = surface_to_world(s, extent, hit.instance);
    }
#endif
    return s;
}

#if ATTRIBUTES
fn surface_attributes(surface: Surface, source: u32, hit: Hit, e1: vec3<f32>, e2: vec3<f32>) -> Surface {
    var s = surface;
    let corners = corners_load(source);
    let weights = vec2<f32>(hit.u, hit.v);
    if (corners.flags & ATTRIBUTE_NORMAL) != 0u {
        s.ns = surface_unit(attribute_at(corners, 0u, weights).xyz);
    }
#if VERTEX_DATA
    if (corners.flags & ATTRIBUTE_UV) != 0u {
        s.uv = attribute_at(corners, 1u, weights);
        s.tangent = surface_uv_tangent(corners, e1, e2);
    }
    if (corners.flags & ATTRIBUTE_COLOR) != 0u {
        s.color = attribute_at(corners, 2u, weights);
    }
    if (corners.flags & ATTRIBUTE_TANGENT) != 0u {
        let t = attribute_at(corners, 3u, weights);
        s.tangent = vec4<f32>(surface_unit(t.xyz), select(-1.0, 1.0, t.w >= 0.0));
    }
#endif
    return s;
}
#endif

#if VERTEX_DATA
// Direction in which u of set 0 grows; 0 where the texture coordinates are degenerate.
fn surface_uv_tangent(c: Corners, e1: vec3<f32>, e2: vec3<f32>) -> vec4<f32> {
    let origin = bitcast<vec4<f32>>(attribute_word(c.first + 1u)).xy;
    let d1 = bitcast<vec4<f32>>(attribute_word(c.second + 1u)).xy - origin;
    let d2 = bitcast<vec4<f32>>(attribute_word(c.third + 1u)).xy - origin;
    let area = d1.x * d2.y - d1.y * d2.x;
    if area == 0.0 {
        return vec4<f32>(0.0);
    }
    let side = select(-1.0, 1.0, area > 0.0);
    // v grows downwards in the picture: the bitangent of a normal map points up.
    return vec4<f32>(surface_unit(side * (e1 * d2.y - e2 * d1.y)), -side);
}
#endif

#if INSTANCES
// From the instance's object space to world space.
fn surface_to_world(surface: Surface, extent: vec3<f32>, record: u32) -> Surface {
    var s = surface;
    let ox = bitcast<vec4<f32>>(node_word(record + 2u)).xyz;
    let oy = bitcast<vec4<f32>>(node_word(record + 3u)).xyz;
    let oz = bitcast<vec4<f32>>(node_word(record + 4u)).xyz;
    let x = bitcast<vec4<f32>>(node_word(record + 5u));
    let y = bitcast<vec4<f32>>(node_word(record + 6u));
    let z = bitcast<vec4<f32>>(node_word(record + 7u));
    let p = vec4<f32>(s.position, 1.0);
    s.position = vec3<f32>(dot(x, p), dot(y, p), dot(z, p));
    // Rounding of the sums above, as well as of the object's own coordinates.
    let e = vec4<f32>(extent, 1.0);
    s.offset = spawn_offset(max(dot(abs(x), e), max(dot(abs(y), e), dot(abs(z), e))));
    // Normals go by the inverse transpose, which keeps the front also of a mirrored instance.
    s.ng = surface_unit(ox * s.ng.x + oy * s.ng.y + oz * s.ng.z);
    s.ns = surface_unit(ox * s.ns.x + oy * s.ns.y + oz * s.ns.z);
    let t = s.tangent.xyz;
    if any(t != vec3<f32>(0.0)) {
        let mirrored = dot(cross(x.xyz, y.xyz), z.xyz) < 0.0;
        let side = select(s.tangent.w, -s.tangent.w, mirrored);
        s.tangent = vec4<f32>(surface_unit(vec3<f32>(dot(x.xyz, t), dot(y.xyz, t), dot(z.xyz, t))), side);
    }
    return s;
}
#endif
