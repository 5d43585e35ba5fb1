// How threads are laid over the picture.
#import frame/frame

// Pixel of the window that thread `local` of a tile works on: a tile is 8 by 8
// pixels, eight neighbouring threads are a block of 4 by 2.
fn tile_pixel(tile: u32, local: u32) -> vec2<u32> {
    let x = (local & 3u) | ((local >> 1u) & 4u);
    let y = ((local >> 2u) & 1u) | ((local >> 3u) & 6u);
    return vec2<u32>(tile % frame.tiles_across, tile / frame.tiles_across) * 8u + vec2<u32>(x, y);
}

// The inverse: the place of a pixel in the order of tiles.
fn tile_index(pixel: vec2<u32>) -> u32 {
    let x = pixel.x & 7u;
    let y = pixel.y & 7u;
    let local = (x & 3u) | ((x & 4u) << 1u) | ((y & 1u) << 2u) | ((y & 6u) << 3u);
    let tile = pixel.y / 8u * frame.tiles_across + pixel.x / 8u;
    return tile * TILE_PIXELS + local;
}
