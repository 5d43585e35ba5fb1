#!/usr/bin/env python3
"""FLIP of the pictures in tests/compare/fixtures by NVIDIA's own package.

    python3 -m pip install flip-evaluator
    tools/check_flip.py            # compares with flip.json
    tools/check_flip.py --write    # writes it

`cargo test --test compare flip` holds ours to flip.json. The pictures are our own: cornell-spheres as EXR
and statue as PNG, 24x16 pixels, with few and with many samples.
"""

import argparse
import json
import sys
from pathlib import Path

import flip_evaluator

FOLDER = Path(__file__).resolve().parent.parent / "tests/compare/fixtures"

# Pairs of files, and what FLIP takes them for.
PAIRS = {"ldr": ("ldr-actual.png", "ldr-expected.png", "LDR"), "hdr": ("hdr-actual.exr", "hdr-expected.exr", "HDR")}

# Digits of the stored values; the package computes in f32.
DIGITS = 7


def evaluate(actual, expected, dynamic_range):
    errors, mean, parameters = flip_evaluator.evaluate(
        str(FOLDER / expected), str(FOLDER / actual), dynamic_range, applyMagma=False)
    result = {"mean": round(float(mean), DIGITS), "map": [round(float(v), DIGITS) for v in errors.ravel()]}
    if dynamic_range == "HDR":
        result["exposures"] = {
            "start": round(parameters["startExposure"], 5), "stop": round(parameters["stopExposure"], 5),
            "count": parameters["numExposures"]}
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write flip.json")
    arguments = parser.parse_args()
    found = {name: evaluate(*pair) for name, pair in PAIRS.items()}
    path = FOLDER / "flip.json"
    if arguments.write:
        path.write_text(json.dumps(found, separators=(",", ":")) + "\n")
    stored = json.loads(path.read_text())
    for name, values in found.items():
        difference = max(abs(a - b) for a, b in zip(values["map"], stored[name]["map"], strict=True))
        print(f"{name}: mean {values['mean']:.7f}, stored {stored[name]['mean']:.7f}, "
              f"largest difference of a pixel {difference:.1e}")
        if difference > 1e-6:
            sys.exit("flip.json is not what the package says")


if __name__ == "__main__":
    main()
