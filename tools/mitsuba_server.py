#!/usr/bin/env python3
"""Renders with Mitsuba 3 what it is asked for; the child of `steradian bench --against mitsuba`.

One JSON object a line on stdin, one a line back on stdout; all else goes to stderr. First it says
{"version": ...} by itself. Then:

    {"load": SCENE, "width": W, "height": H, "sampler": NAME, "max_depth": N, "rr_depth": N}
        -> {"seconds": ...}
    {"spp": N, "seed": N, "path": FILE}
        -> {"wall": ..., "cpu": ..., "spp": ...}

FILE gets the picture as 32-bit little-endian floats, red, green, blue, row by row. `wall` and `cpu` are
the seconds of the render call up to its pixels being in memory, on all cores; kernels are compiled
after the first call. `spp` is what was taken: samplers round up. What cannot be done is {"error": ...}.
"""

import json
import os
import sys
import time


def main():
    # Mitsuba and Dr.Jit may write to stdout: answers keep a channel of their own.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)

    def answer(value):
        answers.write(json.dumps(value) + "\n")
        answers.flush()

    try:
        from mitsuba_scene import Converter, import_mitsuba
        import numpy
        mitsuba = import_mitsuba()
    except (ImportError, RuntimeError) as error:
        answer({"error": f"--against mitsuba: {error}; python3 -m pip install mitsuba"})
        return 1
    answer({"version": f"Mitsuba {mitsuba.__version__} {mitsuba.variant()}"})

    import tempfile
    scene = None
    for line in sys.stdin:
        request = json.loads(line)
        try:
            if "load" in request:
                start = time.perf_counter()
                with tempfile.TemporaryDirectory() as folder:
                    converter = Converter(mitsuba, request["load"], folder)
                    described = converter.convert(request["width"], request["height"], None, None)
                    described["integrator"].update(max_depth=request["max_depth"], rr_depth=request["rr_depth"])
                    described["sensor"]["sampler"] = {"type": request["sampler"]}
                    scene = mitsuba.load_dict(described)
                answer({"seconds": time.perf_counter() - start})
                continue
            sampler = scene.sensors()[0].sampler()
            sampler.set_sample_count(request["spp"])
            taken = sampler.sample_count()
            wall, cpu = time.perf_counter(), time.process_time()
            image = numpy.array(mitsuba.render(scene, spp=taken, seed=request["seed"]))
            cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
            image[..., :3].astype("<f4").tofile(request["path"])
            answer({"wall": wall, "cpu": cpu, "spp": taken})
        except (Exception, SystemExit) as error:  # whatever it is, the other side must hear of it
            answer({"error": f"Mitsuba: {error}"})
    return 0


if __name__ == "__main__":
    sys.exit(main())
