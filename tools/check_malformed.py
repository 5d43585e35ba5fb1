#!/usr/bin/env python3
"""Runs `steradian info` on a folder of malformed glTF files and judges each end.

    tools/check_malformed.py FOLDER [--program target/release/steradian] [--verbose]

Every .gltf and .glb below FOLDER must end with exit code 0 or 3, within 10 seconds
and 1 GiB of resident memory. Where a report of the glTF validator (FILE.report.json)
stands beside a file, a table says for each of the validator's error codes how many files
with it are refused, and how many are loaded with and without a line about something
approximated or ignored.

Most files of such a collection have nothing to draw, or do not use what is wrong in them.
Each is therefore run twice more, in a copy of its folder: with nodes for what can stand
in a scene, and with everything in it put to use. The table counts a file as refused where one
of the runs is, for another reason than that nothing is drawn. No device is used.

Exit code 1 if a file did not end as it must. Linux only.
"""

import argparse
import base64
import collections
import json
import os
import resource
import shutil
import signal
import struct
import sys
import tempfile
import time
from pathlib import Path

TIME_LIMIT = 10.0
MEMORY_LIMIT = 1 << 30
# A backstop far above the limit, so that a runaway cannot take the machine with it.
ADDRESS_LIMIT = 16 << 30


def run(program, arguments):
    """Exit code (None for a hang), seconds, bytes resident at most, output."""
    with tempfile.TemporaryFile() as output:
        start = time.monotonic()
        child = os.fork()
        if child == 0:
            os.dup2(output.fileno(), 1)
            os.dup2(output.fileno(), 2)
            resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_LIMIT, ADDRESS_LIMIT))
            # Without a Vulkan driver: loading is looked at, not the device.
            os.environ["VK_DRIVER_FILES"] = "/nonexistent.json"
            try:
                os.execv(program, [program, *arguments])
            finally:
                os._exit(127)
        hung = False
        while True:
            done, status, usage = os.wait4(child, os.WNOHANG)
            if done:
                break
            if not hung and time.monotonic() - start > TIME_LIMIT:
                hung = True
                os.kill(child, signal.SIGKILL)
            time.sleep(0.002)
        seconds = time.monotonic() - start
        output.seek(0)
        text = output.read().decode(errors="replace")
    code = None if hung else os.waitstatus_to_exitcode(status)
    return code, seconds, usage.ru_maxrss * 1024, text


def split(data):
    """JSON bytes, and what follows them in a GLB."""
    if data[:4] != b"glTF":
        return data, None
    length, = struct.unpack_from("<I", data, 12)
    return data[20:20 + length], data[20 + length:]


def join(text, rest):
    if rest is None:
        return text
    text += b" " * (-len(text) % 4)
    size = 20 + len(text) + len(rest)
    return struct.pack("<4sIIII", b"glTF", 2, size, len(text), 0x4E4F534A) + text + rest


class PutToUse:
    """Adds to a glTF's JSON what it takes for everything in it to have an effect."""

    def __init__(self, root):
        self.root = root
        text = json.dumps(root)
        self.unused = lambda name, index: f'"{name}": {index}' not in text
        self.new_nodes = []

    def add_corners(self):
        self.corners = self.accessor(3, "VEC3", struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))

    def list(self, name):
        return [item for item in self.root.get(name, []) if isinstance(item, dict)]

    def append(self, name, value):
        self.root.setdefault(name, []).append(value)
        return len(self.root[name]) - 1

    def accessor(self, count, kind, data=None):
        """Of floats; zeros where there is no data."""
        accessor = {"componentType": 5126, "type": kind, "count": count}
        if data:
            uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
            buffer = self.append("buffers", {"uri": uri, "byteLength": len(data)})
            accessor["bufferView"] = self.append("bufferViews", {"buffer": buffer, "byteLength": len(data)})
        return self.append("accessors", accessor)

    def draw(self, attributes, node=None, **primitive):
        mesh = self.append("meshes", {"primitives": [{"attributes": attributes, **primitive}]})
        self.new_nodes.append(self.append("nodes", {"mesh": mesh, **(node or {})}))

    def accessors(self, given):
        """Each as an attribute, as far as its type tells one."""
        for index, accessor in enumerate(given):
            kind, count = accessor.get("type"), accessor.get("count")
            if not self.unused("POSITION", index) or not isinstance(count, int) or count > 1 << 20:
                continue
            zeros = self.accessor(max(count, 1), "VEC3")
            if kind == "VEC3":
                self.draw({"POSITION": index})
            elif kind == "VEC2":
                self.draw({"POSITION": zeros, "TEXCOORD_0": index})
            elif kind == "VEC4":
                self.draw({"POSITION": zeros, "NORMAL": zeros, "TANGENT": index})
            elif kind == "SCALAR" and accessor.get("componentType") in (5121, 5123, 5125):
                self.draw({"POSITION": self.corners}, indices=index)

    def materials(self):
        uvs = self.accessor(3, "VEC2", struct.pack("<6f", 0, 0, 1, 0, 0, 1))
        for index in range(len(self.list("images"))):
            if self.unused("source", index):
                self.append("textures", {"source": index})
        if self.list("samplers") and not self.list("images"):
            dot = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNoAAAAggCBd81ytgAAAABJRU5ErkJggg=="
            self.append("images", {"uri": f"data:image/png;base64,{dot}"})
        for index in range(len(self.list("samplers"))):
            if self.unused("sampler", index):
                self.append("textures", {"sampler": index, "source": 0})
        for index in range(len(self.list("textures"))):
            if self.unused("index", index):
                texture = {"baseColorTexture": {"index": index}}
                self.append("materials", {"pbrMetallicRoughness": texture})
        for index in range(len(self.list("materials"))):
            if self.unused("material", index):
                attributes = {"POSITION": self.corners, "TEXCOORD_0": uvs, "TEXCOORD_1": uvs}
                self.draw(attributes, material=index)

    def nodes(self):
        for index in range(len(self.list("meshes"))):
            if self.unused("mesh", index):
                self.new_nodes.append(self.append("nodes", {"mesh": index}))
        for index in range(len(self.list("cameras"))):
            if self.unused("camera", index):
                self.new_nodes.append(self.append("nodes", {"camera": index}))
        punctual = self.root.get("extensions", {}).get("KHR_lights_punctual", {})
        for index in range(len(punctual.get("lights", []))):
            if self.unused("light", index):
                extensions = {"KHR_lights_punctual": {"light": index}}
                self.new_nodes.append(self.append("nodes", {"extensions": extensions}))

    def skins(self):
        for index in range(len(self.list("skins"))):
            if self.unused("skin", index):
                joints = self.accessor(3, "VEC4")
                weights = self.accessor(3, "VEC4", struct.pack("<12f", *[1, 0, 0, 0] * 3))
                self.root["accessors"][joints]["componentType"] = 5121
                attributes = {"POSITION": self.corners, "JOINTS_0": joints, "WEIGHTS_0": weights}
                self.draw(attributes, node={"skin": index})

    def scene(self, given):
        """The nodes that nothing refers to, and the new ones, in the scene that is drawn."""
        referred = {c for node in given for c in node.get("children", []) if isinstance(c, int)}
        for scene in self.list("scenes"):
            referred |= {n for n in scene.get("nodes", []) if isinstance(n, int)}
        roots = [i for i in range(len(given)) if i not in referred] + self.new_nodes
        if not self.root.get("scenes"):
            self.root["scenes"] = [{"nodes": []}]
        scene = self.root["scenes"][self.root.get("scene", 0)]
        scene.setdefault("nodes", []).extend(roots)


def put_to_use(data, with_new_data):
    """The file with everything in it drawn; None where the JSON is too broken for that.

    Without new data only nodes are added: an index one beyond a list stays without an object.
    """
    try:
        text, rest = split(data)
        root = json.loads(text.decode("utf-8-sig"))
        accessors, nodes = list(root.get("accessors", [])), list(root.get("nodes", []))
        use = PutToUse(root)
        if with_new_data:
            use.add_corners()
            use.draw({"POSITION": use.corners})
            use.accessors(accessors)
            use.materials()
            use.skins()
        use.nodes()
        use.scene(nodes)
        return join(json.dumps(root).encode(), rest)
    except (ValueError, KeyError, TypeError, AttributeError, IndexError, struct.error):
        return None


class Case:
    """One file, and how the program ended on it."""

    def __init__(self, path, folder, program, scratch):
        self.name = str(path.relative_to(folder))
        report = Path(f"{path}.report.json")
        messages = json.loads(report.read_text())["issues"]["messages"] if report.exists() else []
        self.errors = sorted({m["code"] for m in messages if m["severity"] == 0})
        self.runs = [run(program, ["info", str(path)])]
        for with_new_data in (False, True):
            changed = put_to_use(path.read_bytes(), with_new_data)
            if changed is None:
                continue
            copy = Path(scratch) / path.parent.relative_to(folder)
            if not copy.exists():
                shutil.copytree(path.parent, copy)
            target = copy / f"used-{path.name}"
            target.write_bytes(changed)
            self.runs.append(run(program, ["info", str(target)]))

    @property
    def refusal(self):
        """The message of the last run that was refused for what is wrong in the file."""
        texts = [text for code, _, _, text in self.runs if code == 3 and "nothing to render" not in text]
        return texts[-1] if texts else None

    def lines(self, *kinds):
        text = self.runs[-1][3].splitlines()
        return [line for line in text if line.split(" ")[0] in kinds]

    def faults(self):
        for code, seconds, memory, text in self.runs:
            if code is None:
                yield f"ran longer than {TIME_LIMIT:g} s"
            elif code not in (0, 3):
                yield f"exit code {code}: {text.strip()[-300:]}"
            elif code == 3 and not text.startswith("error: "):
                yield f"refused without a message: {text[:200]}"
            if memory > MEMORY_LIMIT:
                yield f"{memory / 2**20:.0f} MiB"


def table(cases):
    """For each error code: files, refused, loaded with a line, loaded without."""
    rows = collections.defaultdict(lambda: [0, 0, 0, []])
    for case in cases:
        for error in case.errors:
            row = rows[error]
            row[0] += 1
            if case.refusal:
                row[1] += 1
            elif case.lines("approximated", "ignored"):
                row[2] += 1
            else:
                row[3].append(case.name)
    print(f"{'error code':46} files refused noticed silent")
    for error, (files, refused, noticed, silent) in sorted(rows.items()):
        print(f"{error:46} {files:5} {refused:7} {noticed:7} {len(silent):6}")
        for name in silent:
            print(f"    {name}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--program", default="target/release/steradian")
    parser.add_argument("--verbose", action="store_true", help="what was said about each file")
    flags = parser.parse_args()
    paths = sorted(p for p in flags.folder.rglob("*") if p.suffix in (".gltf", ".glb"))
    program = os.path.abspath(flags.program)
    with tempfile.TemporaryDirectory() as scratch:
        cases = [Case(path, flags.folder, program, scratch) for path in paths]
    if flags.verbose:
        for case in cases:
            print(f"{case.name}: {' '.join(case.errors) or 'valid'}: exit {[r[0] for r in case.runs]}")
            for line in case.lines("error:", "approximated", "ignored"):
                print(f"    {line}")
    table(cases)
    runs = [result for case in cases for result in case.runs]
    codes = collections.Counter(result[0] for result in runs)
    print(f"{len(cases)} files, {len(runs)} runs; exit codes {dict(codes)}")
    print(f"longest {max(r[1] for r in runs):.2f} s, largest {max(r[2] for r in runs) / 2**20:.0f} MiB")
    faults = [(case.name, fault) for case in cases for fault in case.faults()]
    for name, fault in faults:
        print(f"FAULT {name}: {fault}")
    return 1 if faults or not cases else 0


if __name__ == "__main__":
    sys.exit(main())
