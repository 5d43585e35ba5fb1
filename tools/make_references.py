#!/usr/bin/env python3
"""Renders the committed references of tests/references with Mitsuba 3.

    tools/make_references.py [NAME ...] [--runs 64] [--spp 2048]

Each scene of tests/references/scenes.json is rendered in independent runs with
different seeds. NAME.exr holds their mean in R, G and B, and the variance of
that mean in variance.R and so on; its attributes say how it was made. Where
Mitsuba has no equal of a material, scenes.json replaces it on both sides: `matte`
materials lose their specular layer, metalness and transmission, `white` ones
their colour.
Needs what tools/mitsuba_scene.py needs.
"""

import argparse
import hashlib
import json
import sys
import tempfile
import time
from datetime import date
from pathlib import Path

import numpy as np

import mitsuba_scene
from mitsuba_scene import Converter

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "tests" / "references"


def change_materials(root, entry):
    """Replaces what Mitsuba has no equal of, as scenes.json says."""
    materials = root["materials"]
    for name in entry.get("matte", []) + entry.get("white", []):
        if not any(m.get("name") == name for m in materials):
            raise SystemExit(f"make_references: {entry['name']} has no material {name}")
    for material in materials:
        pbr = material.setdefault("pbrMetallicRoughness", {})
        if material.get("name") in entry.get("matte", []):
            pbr["metallicFactor"] = 0.0
            material.setdefault("extensions", {})["KHR_materials_specular"] = {"specularFactor": 0.0}
            material["extensions"].pop("KHR_materials_transmission", None)
        if material.get("name") in entry.get("white", []):
            pbr["baseColorFactor"] = [1.0, 1.0, 1.0, 1.0]


def scene_files(path):
    """The glTF file and what it refers to, in a fixed order."""
    root = json.loads(path.read_text())
    uris = [buffer["uri"] for buffer in root.get("buffers", [])]
    environment = root["scenes"][root.get("scene", 0)].get("extras", {}).get("steradian", {}).get("environment", {})
    uris += [environment["uri"]] if "uri" in environment else []
    return [path] + [path.parent / uri for uri in uris]


def fnv1a(data):
    """64-bit FNV-1a."""
    value = 0xCBF29CE484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return value


def scene_hash(path, entry):
    """Of the scene's files and its entry in scenes.json, as the test computes it."""
    text = json.dumps(entry, sort_keys=True, separators=(",", ":"))
    return f"{fnv1a(b''.join(file.read_bytes() for file in scene_files(path)) + text.encode()):016x}"


def sha256(path):
    """Of the scene's files in a row: the glTF file, its buffers, its environment map."""
    return hashlib.sha256(b"".join(file.read_bytes() for file in scene_files(path))).hexdigest()


class ReferenceConverter(Converter):
    """Exact where the usual converter approximates."""

    def add_environment(self, file, radiance):
        """Mitsuba's first and last rows of texels lie at the poles, ours half a texel away.
        Twice the rows and one hold the same piecewise linear function."""
        super().add_environment(file, radiance)
        environment = self.scene.get("environment", {})
        if environment.get("type") == "envmap":
            rows = np.array(self.mitsuba.Bitmap(environment.pop("filename")).convert(
                self.mitsuba.Bitmap.PixelFormat.RGB, self.mitsuba.Struct.Type.Float32, srgb_gamma=False))
            padded = np.concatenate([rows[:1], rows, rows[-1:]])
            fine = np.empty((2 * len(rows) + 1, *rows.shape[1:]), dtype=np.float32)
            fine[0::2], fine[1::2] = 0.5 * (padded[:-1] + padded[1:]), rows
            environment["bitmap"] = self.mitsuba.Bitmap(fine)


def load(mitsuba, path, entry):
    with tempfile.TemporaryDirectory() as folder:
        converter = ReferenceConverter(mitsuba, path, folder)
        change_materials(converter.gltf.root, entry)
        return mitsuba.load_dict(converter.convert(*entry["resolution"], None, None))


def render_runs(mitsuba, scene, runs, spp, first_seed):
    """Mean over `runs` pictures of `spp` samples, and the variance of that mean."""
    pictures = [np.array(mitsuba.render(scene, spp=spp, seed=first_seed + i), dtype=np.float64) for i in range(runs)]
    return np.mean(pictures, axis=0), np.var(pictures, axis=0, ddof=1) / runs


def write(mitsuba, path, mean, variance, attributes):
    names = ["R", "G", "B", "variance.R", "variance.G", "variance.B"]
    channels = np.concatenate([mean, variance], axis=2).astype(np.float32)
    bitmap = mitsuba.Bitmap(channels, mitsuba.Bitmap.PixelFormat.MultiChannel, names)
    for key, value in attributes.items():
        bitmap.metadata()[key] = str(value)
    bitmap.write(str(path))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="scenes to render; all without")
    parser.add_argument("--runs", type=int, default=64)
    parser.add_argument("--spp", type=int, default=2048, help="samples per pixel of a run")
    parser.add_argument("--seed", type=int, default=1, help="seed of the first run; the others follow")
    arguments = parser.parse_args()

    entries = json.loads((FOLDER / "scenes.json").read_text())["scenes"]
    unknown = set(arguments.names) - {entry["name"] for entry in entries}
    if unknown:
        raise SystemExit(f"make_references: {', '.join(sorted(unknown))} not in scenes.json")
    mitsuba = mitsuba_scene.import_mitsuba()
    for entry in entries:
        name = entry["name"]
        if arguments.names and name not in arguments.names:
            continue
        start = time.monotonic()
        path = ROOT / "scenes" / name / f"{name}.gltf"
        mean, variance = render_runs(mitsuba, load(mitsuba, path, entry), arguments.runs, arguments.spp, arguments.seed)
        attributes = {
            "renderer": f"Mitsuba {mitsuba.__version__}, {mitsuba.variant()}, path integrator",
            "runs": arguments.runs, "spp": arguments.spp, "first_seed": arguments.seed,
            "date": date.today().isoformat(), "scene_hash": scene_hash(path, entry),
            "scene_sha256": sha256(path),
        }
        write(mitsuba, FOLDER / f"{name}.exr", mean, variance, attributes)
        error = np.sqrt(variance.sum(axis=(0, 1))) / mean.sum(axis=(0, 1))
        print(f"{name}: {time.monotonic() - start:.0f} s, mean {mean.mean(axis=(0, 1))}, "
              f"relative error of it {error}", file=sys.stderr)


if __name__ == "__main__":
    main()
