#!/usr/bin/env python3
"""Rays per second of Embree beside the renderer's traversal, on the same triangles and rays.

    cargo build --release --example bvh_study
    tools/bvh_embree.py SCENE [--side 256] [--rounds 5] [--no-device]

Needs the packages numpy and embreex. `bvh_study --dump` gives the rays: through pixels, scattered
from what those meet (`bounce`) and from what these meet (`second`), and towards lights (`shadow`,
any hit). Embree traces one ray at a time through embreex on one thread, which includes that wrapper's
cost; the device uses all its threads. Both are counted in rays per second of processor time, so that
the ratio is for the same number of cores, and measured in turns.
"""

import argparse
import re
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

SETS = ["camera", "bounce", "shadow", "second"]
PROGRAM = Path(__file__).parent.parent / "target/release/examples/bvh_study"
SECONDS = 1.0


def read(path):
    """Triangles, and by set the origins, directions and ends of rays."""
    words = np.fromfile(path, dtype="<u4")
    counts, numbers = words[:5].astype(int), words[5:].view("<f4")
    triangles = numbers[: 9 * counts[0]].reshape(-1, 3, 3)
    rays, at = {}, 9 * counts[0]
    for name, count in zip(SETS, counts[1:]):
        block = numbers[at : at + 7 * count].reshape(-1, 7)
        rays[name] = [np.ascontiguousarray(part) for part in (block[:, :3], block[:, 3:6], block[:, 6])]
        at += 7 * count
    return triangles, rays


def embree_speed(scene, rays, name):
    """Rays per second of processor time, and how many hit."""
    origins, directions, ends = rays
    query = "OCCLUDED" if name == "shadow" else "INTERSECT"
    scene.run(origins, directions, ends.copy(), query=query)
    begin, runs = time.process_time(), 0
    while time.process_time() - begin < SECONDS:
        found = scene.run(origins, directions, ends.copy(), query=query)
        runs += 1
    return runs * len(origins) / (time.process_time() - begin), int(np.count_nonzero(found >= 0))


def device_speeds(arguments):
    """By way and set: rays per second of processor time."""
    command = [PROGRAM, arguments.scene, "--side", str(arguments.side), "--device"]
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    lines = re.findall(r"^(packets|lanes) (\w+) (\S+) rays a CPU second", out, re.M)
    return {(way, name): float(speed) for way, name, speed in lines}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene")
    parser.add_argument("--side", type=int, default=256)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--no-device", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        dump = Path(folder) / "rays"
        command = [PROGRAM, arguments.scene, "--side", str(arguments.side), "--dump", dump]
        subprocess.run(command, check=True, capture_output=True)
        triangles, rays = read(dump)
    begin = time.process_time()
    scene = rtcore_scene.EmbreeScene()
    TriangleMesh(scene, triangles)
    scene.run(*[part[:1] for part in rays["camera"][:2]])
    build = time.process_time() - begin
    print(f"{len(triangles)} triangles, Embree builds {len(triangles) / build / 1e6:.2f} million a CPU second")
    embree = {name: [] for name in SETS}
    device = {}
    for _ in range(arguments.rounds):
        for name in SETS:
            speed, hits = embree_speed(scene, rays[name], name)
            embree[name].append((speed, hits))
        if not arguments.no_device:
            for key, speed in device_speeds(arguments).items():
                device.setdefault(key, []).append(speed)
    for name in SETS:
        speeds = [speed for speed, _ in embree[name]]
        median = statistics.median(speeds)
        count, hits = len(rays[name][0]), embree[name][0][1]
        print(f"{name:7} {count} rays, {hits} hit; Embree {median / 1e6:.2f} million a CPU second"
              f" ({min(speeds) / 1e6:.2f} to {max(speeds) / 1e6:.2f})")
        for (way, of), speeds in device.items():
            if of == name:
                ratios = sorted(s / e for s, (e, _) in zip(speeds, embree[name]))
                print(f"    {way:7} {statistics.median(speeds) / 1e6:.2f} million, ratio"
                      f" {statistics.median(ratios):.2f} ({ratios[0]:.2f} to {ratios[-1]:.2f})")


if __name__ == "__main__":
    main()
