#!/usr/bin/env python3
"""A render in parts by Ray (pip install ray).

    render.py SCENE FOLDER PICTURE --parts 8 [--program steradian] [--cpus 1] [-- FLAGS of render]

FOLDER is one that all nodes see. A part whose worker or node dies is begun again and goes on from its
checkpoint; so is one that ends with 75.
"""

import argparse
import os
import subprocess
import sys

import ray


class TryAgain(Exception):
    """The program ended with 75 (EX_TEMPFAIL), or was killed."""


def render(arguments, part):
    stem = os.path.join(arguments.folder, f"part-{part}")
    command = [
        arguments.program, "render", arguments.scene, "-q",
        "--shard", f"{part}/{arguments.parts}", "-o", f"{stem}.film", "--skip-existing",
        "--checkpoint", f"{stem}.checkpoint", "--resume", *arguments.flags,
    ]  # fmt: skip
    environment = {**os.environ, "LP_NUM_THREADS": str(arguments.cpus)}
    ended = subprocess.run(command, env=environment, stderr=subprocess.PIPE, text=True)
    if ended.returncode == 75 or ended.returncode < 0:
        raise TryAgain(f"part {part}: {ended.returncode}: {ended.stderr}")
    if ended.returncode != 0:
        raise RuntimeError(f"part {part}: {ended.returncode}: {ended.stderr}")
    return f"{stem}.film"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=os.path.abspath)
    parser.add_argument("folder", type=os.path.abspath)
    parser.add_argument("picture")
    parser.add_argument("--parts", type=int, default=8)
    parser.add_argument("--program", default="steradian")
    parser.add_argument("--cpus", type=int, default=1)
    given = sys.argv[1:]
    end = given.index("--") if "--" in given else len(given)
    arguments = parser.parse_args(given[:end])
    arguments.flags = given[end + 1 :]
    os.makedirs(arguments.folder, exist_ok=True)

    ray.init(log_to_driver=False)
    task = ray.remote(render).options(
        num_cpus=arguments.cpus, max_retries=3, retry_exceptions=[TryAgain]
    )
    films = ray.get([task.remote(arguments, part) for part in range(arguments.parts)])
    merge = [arguments.program, "merge", *films, "-o", arguments.picture]
    return subprocess.run(merge).returncode


if __name__ == "__main__":
    sys.exit(main())
