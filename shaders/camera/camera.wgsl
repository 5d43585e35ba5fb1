// Camera rays.
#import frame/frame
#import geometry/ray
#import sample/warp

// The ray through `film` (x right, y up, each in [-1, 1] over the picture) and
// the lens point given by the uniform pair `lens`. Direction of unit length.
fn camera_ray(film: vec2<f32>, lens: vec2<f32>) -> Ray {
    let camera = frame.camera;
    // On the plane at distance 1 before the camera (perspective), or on the
    // camera's own plane in metres (orthographic).
    let plane = film * vec2<f32>(camera.half_width, camera.half_height);
    let offset = camera.right * plane.x + camera.up * plane.y;
    var origin = vec3<f32>(0.0);
    var direction = offset - camera.back;
#if ORTHOGRAPHIC
    if camera.orthographic != 0u {
        origin = offset;
        direction = -camera.back;
    }
#endif
#if LENS
    // Thin lens: all rays of a film point meet in the plane of focus.
    if camera.aperture_radius > 0.0 {
        let disk = camera.aperture_radius * warp_disk(lens);
        let shift = camera.right * disk.x + camera.up * disk.y;
        origin += shift;
        direction = direction * camera.focus_distance - shift;
    }
#endif
    return ray_new(camera.position + origin, normalize(direction));
}
