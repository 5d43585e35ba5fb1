#!/usr/bin/env python3
"""Says whether two renders of one scene differ by more than their noise.

    tools/compare_exr.py ours.exr reference.exr reference_variance.exr \\
        [--own-variance ours_variance.exr] [--tile 8]

The variance files hold the variance of each pixel's mean. Printed are the ratio
of the means per channel, the spread of the pixels' z-scores, and a map of the
z-scores of tiles, in which a difference with structure stands out where single
pixels drown it in noise. Exit code 1 if the largest tile is improbable.
"""

import argparse
import math
import sys

import numpy as np

from mitsuba_scene import import_mitsuba

# Probability that a comparison of equal renders fails.
FALSE_ALARM = 1e-3


def read(mitsuba, path):
    """Colour channels of an EXR, rows from the top."""
    bitmap = mitsuba.Bitmap(path)
    for name, part in bitmap.split():
        if name in ("root", "<root>"):
            bitmap = part
    pixels = np.array(bitmap.convert(mitsuba.Bitmap.PixelFormat.RGB, mitsuba.Struct.Type.Float32, False))
    return pixels.astype(np.float64)


def tile_means(values, tile):
    """Means of square tiles; what is left over at the right and below is left out."""
    rows, columns = values.shape[0] // tile, values.shape[1] // tile
    cut = values[:rows * tile, :columns * tile]
    return cut.reshape(rows, tile, columns, tile, -1).mean(axis=(1, 3))


def z_limit(tests):
    """Largest |z| expected among `tests` normal variables but for FALSE_ALARM (Šidák)."""
    p = -math.expm1(math.log1p(-FALSE_ALARM) / tests)
    low, high = 0.0, 40.0
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if math.erfc(middle / math.sqrt(2)) > p else (low, middle)
    return high


def print_map(z):
    """One character a tile: the rounded z of the channel that differs most."""
    rows, columns = z.shape[:2]
    # A terminal's width; coarser where the map is wider.
    step = -(-columns // 64)
    for y in range(0, rows, step):
        line = ""
        for x in range(0, columns, step):
            block = z[y:y + step, x:x + step].ravel()
            value = block[np.argmax(np.abs(block))]
            size = min(int(abs(value)), 26)
            line += "." if size < 3 else (chr(ord("a") - 3 + size) if value < 0 else chr(ord("A") - 3 + size))
        print(line)
    print("map: . |z| < 3, then A B C ... brighter and a b c ... darker than the reference by 3, 4, 5 ... sigma")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("ours")
    parser.add_argument("reference")
    parser.add_argument("reference_variance")
    parser.add_argument("--own-variance",
                        help="variance of our means; without it ours counts as noisy as the reference")
    parser.add_argument("--tile", type=int, default=8, help="pixels along a tile's side")
    arguments = parser.parse_args()

    mitsuba = import_mitsuba("scalar_rgb")
    ours, reference = read(mitsuba, arguments.ours), read(mitsuba, arguments.reference)
    variance = read(mitsuba, arguments.reference_variance)
    if not ours.shape == reference.shape == variance.shape:
        raise SystemExit(f"compare_exr: sizes differ: {ours.shape}, {reference.shape}, {variance.shape}")
    if not np.isfinite(ours).all():
        count = np.count_nonzero(~np.isfinite(ours))
        raise SystemExit(f"compare_exr: {arguments.ours} has {count} values that are not finite")
    variance = variance + (read(mitsuba, arguments.own_variance) if arguments.own_variance else variance)

    ratio = ours.mean(axis=(0, 1)) / reference.mean(axis=(0, 1))
    error = np.sqrt(variance.sum(axis=(0, 1))) / variance[..., 0].size / reference.mean(axis=(0, 1))
    for channel, r, e in zip("RGB", ratio, error, strict=True):
        print(f"mean {channel}: ours / reference = {r:.5f} +- {e:.5f} ({(r - 1) / e:+.1f} sigma)")

    # Pixels whose variance is 0 are exact, or so dark that no sample met light.
    known = variance > 0
    z = (ours - reference)[known] / np.sqrt(variance[known])
    spread = 1.4826 * np.median(np.abs(z - np.median(z)))
    print(f"pixels: z of {z.size} values, robust spread {spread:.3f} (1 if the variances are right), "
          f"{100 * np.mean(np.abs(z) > 3):.2f} % beyond 3 (0.27 % if normal)")
    if (~known).any():
        print(f"pixels: {np.count_nonzero(~known)} values without variance, "
              f"largest difference {np.abs(ours - reference)[~known].max():.3g}")

    tile = arguments.tile
    difference, tile_variance = tile_means(ours - reference, tile), tile_means(variance, tile) / tile**2
    # Tiles without variance must agree to the rounding of the files.
    rounding = 1e-6 * tile_means(np.abs(reference), tile)
    tile_z = difference / np.sqrt(tile_variance + rounding**2 + np.finfo(np.float64).tiny)
    worst = np.unravel_index(np.argmax(np.abs(tile_z)), tile_z.shape)
    limit = z_limit(tile_z.size)
    print(f"tiles of {tile}x{tile}: robust spread {1.4826 * np.median(np.abs(tile_z)):.3f}, "
          f"max |z| {abs(tile_z[worst]):.2f} in channel {'RGB'[worst[2]]} at pixel "
          f"({worst[1] * tile}, {worst[0] * tile}); limit {limit:.2f} for {tile_z.size} tiles")
    print_map(tile_z[np.arange(tile_z.shape[0])[:, None], np.arange(tile_z.shape[1]), np.abs(tile_z).argmax(axis=2)])
    is_equal = abs(tile_z[worst]) <= limit
    print("no structure in the difference" if is_equal else "the difference has structure")
    return 0 if is_equal else 1


if __name__ == "__main__":
    sys.exit(main())
