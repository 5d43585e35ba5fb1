#!/usr/bin/env python3
"""Opens an EXR of Steradian with OpenEXR's own library and checks what its layers promise.

    pip install OpenEXR numpy
    tools/check_exr.py picture.exr

Every channel must have the size of the data window. Hashes of Cryptomatte names are computed
again, by an implementation that shares nothing with the renderer's, and every id in the pixels
must be in the manifest. Positions, depths and normals must agree with the camera's matrices.
"""

import json
import struct
import sys

import numpy
import OpenEXR


def murmur3(data: bytes) -> int:
    """MurmurHash3_x86_32 with a seed of 0."""
    mask, h = 0xFFFFFFFF, 0
    mix = lambda k: ((((k * 0xCC9E2D51 & mask) << 15 | (k * 0xCC9E2D51 & mask) >> 17) & mask) * 0x1B873593) & mask
    for (k,) in struct.iter_unpack("<I", data[: len(data) & ~3]):
        h ^= mix(k)
        h = ((h << 13 | h >> 19) * 5 + 0xE6546B64) & mask
    tail = data[len(data) & ~3 :]
    if tail:
        h ^= mix(int.from_bytes(tail, "little"))
    h ^= len(data)
    for shift, factor in ((16, 0x85EBCA6B), (13, 0xC2B2AE35)):
        h = ((h ^ h >> shift) * factor) & mask
    return h ^ h >> 16


def float_bits(h: int) -> int:
    exponent = h >> 23 & 255
    return h ^ 1 << 23 if exponent in (0, 255) else h


def check(holds, what: str):
    if not holds:
        sys.exit(f"FAILED: {what}")
    print(f"ok: {what}")


def cryptomattes(header, channels):
    keys = {name.split("/")[1] for name in header if name.startswith("cryptomatte/")}
    for key in sorted(keys):
        entry = {n: header[f"cryptomatte/{key}/{n}"] for n in ("name", "hash", "conversion", "manifest")}
        name, manifest = entry["name"], json.loads(entry["manifest"])
        check(key == f"{murmur3(name.encode()):08x}"[:7], f"{name}: key {key}")
        check((entry["hash"], entry["conversion"]) == ("MurmurHash3_32", "uint32_to_float32"), f"{name}: hash and conversion")
        wrong = [n for n, h in manifest.items() if int(h, 16) != float_bits(murmur3(n.encode()))]
        check(not wrong, f"{name}: {len(manifest)} hashes of the manifest {wrong or ''}")
        known = {int(h, 16): n for n, h in manifest.items()}
        total, last, cover = 0.0, None, {}
        for level in range(3):
            for id_name, share_name in (("r", "g"), ("b", "a")):
                ids = channels[f"{name}{level:02}.{id_name}"].pixels.view(numpy.uint32)
                share = channels[f"{name}{level:02}.{share_name}"].pixels
                check(((ids == 0) == (share == 0)).all(), f"{name}{level:02}.{id_name}: no id without a share")
                strangers = set(numpy.unique(ids)) - set(known) - {0}
                check(not strangers, f"{name}{level:02}.{id_name}: every id is in the manifest {strangers or ''}")
                check(last is None or (share <= last).all(), f"{name}{level:02}.{share_name}: ranks fall")
                for i in set(numpy.unique(ids)) - {0}:
                    cover[known[i]] = cover.get(known[i], 0.0) + share[ids == i].sum(dtype=float)
                total, last = total + share, share
        check((total <= 1 + 1e-6).all(), f"{name}: shares sum to at most 1")
        if "coverage.A" in channels:
            check(numpy.abs(total - channels["coverage.A"].pixels).max() <= 1e-6 or (last > 0).any(), f"{name}: shares sum to the coverage")
        for thing, pixels in sorted(cover.items(), key=lambda item: -item[1])[:8]:
            print(f"    {pixels:12.2f} pixels  {thing}")


def camera(header, channels, window):
    if "P.X" not in channels:
        return
    matrix = lambda name: numpy.array(header[name], dtype=float).reshape(4, 4)
    p = numpy.stack([channels[f"P.{c}"].pixels.astype(float) for c in "XYZ"] + [numpy.ones(window[3:1:-1])], -1)
    (x0, y0, width, height), display = window, header["displayWindow"]
    resolution = numpy.array(display[1]) - numpy.array(display[0]) + 1
    # Only pixels of one surface: a mean of several is nowhere.
    whole = channels["coverage.A"].pixels == 1 if "coverage.A" in channels else numpy.isfinite(channels["Z"].pixels)
    if "N.X" in channels:
        n = numpy.stack([channels[f"N.{c}"].pixels for c in "XYZ"], -1)
        length = numpy.linalg.norm(n, axis=-1)
        check((length <= 1 + 1e-5).all(), "normals are no longer than 1")
        whole &= length > 0.999
    ndc = p @ matrix("worldToNDC")
    place = ndc[..., :2] / ndc[..., 3:] * resolution
    at = numpy.stack(numpy.meshgrid(x0 + numpy.arange(width) + 0.5, y0 + numpy.arange(height) + 0.5), -1)
    if whole.any():
        error = numpy.abs(place - at)[whole].max()
        check(error < 1, f"positions lie in their pixels: at most {error:.3f} pixels from the centre")
    if "Z" in channels and whole.any():
        z = channels["Z"].pixels[whole]
        difference = numpy.abs((p @ matrix("worldToCamera"))[..., 2][whole] / z - 1).max()
        check(difference < 1e-4, f"Z is the distance along the camera's axis: {difference:.1e} relative")


def main(path):
    part = OpenEXR.File(path, separate_channels=True).parts[0]
    header, channels = part.header, part.channels
    low, high = (numpy.array(corner) for corner in header["dataWindow"])
    width, height = high - low + 1
    for name, channel in sorted(channels.items()):
        pixels = channel.pixels
        check(pixels.shape == (height, width), f"{name}: {pixels.dtype} {width}x{height}")
    first = numpy.array(header["displayWindow"][0]), numpy.array(header["displayWindow"][1])
    check((first[0] == 0).all() and (low >= first[0]).all() and (high <= first[1]).all(), f"data window {low} to {high} in {first[1] + 1}")
    for name in ("chromaticities", "colorInteropID", "generatedBy", "software", "samplesPerPixel", "worldToCamera", "worldToNDC", "steradian.scene_hash", "steradian.settings_hash"):
        check(name in header, f"{name}: {header.get(name)!r}")
    cryptomattes(header, channels)
    camera(header, channels, (low[0], low[1], width, height))


if __name__ == "__main__":
    main(sys.argv[1])
