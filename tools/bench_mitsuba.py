#!/usr/bin/env python3
"""Samples per second of Steradian against Mitsuba 3 (llvm_ad_rgb) on this machine.

    tools/bench_mitsuba.py SCENE... [--resolution 512x512] [--spp 64] [--rounds 5]

Both render the same scene, resolution and samples per pixel, without a depth
limit and with Russian roulette, in turns, so that a slow spell of the machine
hits both. Ours is the time of tracing alone (`render_seconds` of --stats);
Mitsuba's is that of a render whose kernels are compiled and whose scene is
loaded. Whole runs of our program, with loading and compiling, are shown beside.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from mitsuba_scene import import_mitsuba, load, resolution


def time_ours(program, scene, size, spp, seed, folder):
    """Seconds of tracing and of the whole run, and the statistics."""
    stats = Path(folder) / "stats.json"
    command = [program, "render", scene, "-o", str(Path(folder) / "ours.exr"), "--resolution",
               f"{size[0]}x{size[1]}", "--spp", str(spp), "--seed", str(seed), "--stats", str(stats)]
    start = time.perf_counter()
    run = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    wall = time.perf_counter() - start
    if run.returncode != 0:
        raise SystemExit(f"bench_mitsuba: {' '.join(command)} failed ({run.returncode}):\n{run.stderr}")
    values = json.loads(stats.read_text())
    expected = size[0] * size[1] * spp
    if values["samples"] != expected:
        raise SystemExit(f"bench_mitsuba: {values['samples']} samples were traced, {expected} asked for")
    return values["render_seconds"], wall, values


def time_mitsuba(mitsuba, scene, spp, seed):
    """Seconds of one render, up to its pixels being in memory."""
    start = time.perf_counter()
    image = np.array(mitsuba.render(scene, spp=spp, seed=seed))
    seconds = time.perf_counter() - start
    if not np.isfinite(image).all():
        raise SystemExit("bench_mitsuba: Mitsuba's picture is not finite")
    return seconds


def compare(mitsuba, program, path, size, spp, rounds):
    scene = load(mitsuba, path, *size)
    time_mitsuba(mitsuba, scene, spp, 0)
    samples = size[0] * size[1] * spp
    ours, walls, theirs = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        # Fills the driver's shader cache, as Mitsuba's warm-up did its own.
        stats = time_ours(program, path, size, spp, 0, folder)[2]
        for seed in range(1, rounds + 1):
            seconds, wall, stats = time_ours(program, path, size, spp, seed, folder)
            ours.append(seconds)
            walls.append(wall)
            theirs.append(time_mitsuba(mitsuba, scene, spp, seed))
    ratios = [b / a for a, b in zip(ours, theirs, strict=True)]

    def line(name, seconds):
        middle = statistics.median(seconds)
        print(f"  {name:<28} {middle:8.3f} s  ({min(seconds):.3f} to {max(seconds):.3f})"
              f"  {samples / middle / 1e6:8.3f} million samples/s")

    print(f"{path}: {size[0]}x{size[1]}, {spp} spp, {rounds} rounds on {stats['device']} ({stats['driver']})")
    line("Steradian, tracing", ours)
    line("Steradian, whole program", walls)
    line(f"Mitsuba {mitsuba.__version__} {mitsuba.variant()}", theirs)
    print(f"  Steradian / Mitsuba, samples per second: {statistics.median(ratios):.3f}"
          f"  ({min(ratios):.3f} to {max(ratios):.3f})")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="+", metavar="SCENE")
    parser.add_argument("--resolution", type=resolution, default=(512, 512))
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--rounds", type=int, default=5)
    root = Path(__file__).resolve().parent.parent
    parser.add_argument("--steradian", default=str(root / "target/release/steradian"), help="the program")
    arguments = parser.parse_args()
    if not Path(arguments.steradian).exists():
        raise SystemExit(f"bench_mitsuba: no {arguments.steradian}: run 'cargo build --release'")
    mitsuba = import_mitsuba()
    for scene in arguments.scenes:
        compare(mitsuba, arguments.steradian, scene, arguments.resolution, arguments.spp, arguments.rounds)


if __name__ == "__main__":
    sys.exit(main())
