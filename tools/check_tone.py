#!/usr/bin/env python3
"""Tone curves as others publish them: the numbers of src/image/tone/published.rs.

    pip install numpy opencolorio bpy
    tools/check_tone.py            # prints the tables

Khronos PBR Neutral: entries of Khronos's own table pbrNeutral.cube, which Blender ships, without
interpolation. AgX: Blender's view "AgX" of the display sRGB, by OpenColorIO. ACES: the view
"ACES 1.0 - SDR Video" of OpenColorIO's built-in config. bpy is only needed for its data files.
"""

import importlib.util
import pathlib

import numpy
import PyOpenColorIO as ocio

COLOURS = [(0.18, 0.18, 0.18), (1, 1, 1), (0.02, 0.5, 0.9), (4, 0.25, 0.05), (0, 0, 2), (0.05, 0.1, 0.02), (30, 20, 10), (0.7, 0.05, 0.3)]
# Places in the table: its axes are logarithms of base 2 from -9 to 10.
ENTRIES = [(19, 19, 19), (26, 26, 26), (30, 10, 5), (24, 25, 20), (35, 28, 22), (56, 40, 0), (8, 22, 27), (27, 26, 25)]
SIZE, LOW, HIGH = 57, -9, 10


def rows(values):
    for value in values:
        print("        [" + ", ".join(f"{float(v):.7f}" for v in value) + "],")


def linear(srgb):
    return numpy.where(srgb <= 0.04045, srgb / 12.92, ((numpy.maximum(srgb, 0) + 0.055) / 1.055) ** 2.4)


def displayed(config, source, display, view):
    transform = ocio.DisplayViewTransform(src=source, display=display, view=view)
    pixels = numpy.array(COLOURS, dtype=numpy.float32)
    config.getProcessor(transform).getDefaultCPUProcessor().applyRGB(pixels)
    return linear(pixels.astype(float))


def main():
    package = pathlib.Path(importlib.util.find_spec("bpy").origin).parent
    data = next(package.glob("*/datafiles/colormanagement"))
    lines = (data / "luts/pbrNeutral.cube").read_text().splitlines()
    table = [line.split() for line in lines if line[:1].isdigit()]
    assert len(table) == SIZE**3
    print("PBR Neutral: colours, then what is published")
    rows([[2 ** (k / (SIZE - 1) * (HIGH - LOW) + LOW) for k in entry] for entry in ENTRIES])
    rows([table[r + SIZE * (g + SIZE * b)] for r, g, b in ENTRIES])
    print("Colours for AgX and ACES")
    rows(COLOURS)
    print("AgX of Blender")
    rows(displayed(ocio.Config.CreateFromFile(str(data / "config.ocio")), "Linear Rec.709", "sRGB", "AgX"))
    print("ACES 1.0, SDR video")
    config = ocio.Config.CreateFromBuiltinConfig("cg-config-v1.0.0_aces-v1.3_ocio-v2.1")
    rows(displayed(config, "Linear Rec.709 (sRGB)", "sRGB - Display", "ACES 1.0 - SDR Video"))


if __name__ == "__main__":
    main()
