#!/usr/bin/env python3
"""Renders a glTF scene with Mitsuba 3, as an independent reference.

    tools/mitsuba_scene.py SCENE -o out.exr --resolution 256x256 --spp 1024 \\
        [--variance out_var.exr]

Needs the Python packages mitsuba and numpy, and an LLVM library. Materials are
mapped as far as Mitsuba has the model; each approximation is said on stderr,
and what cannot be mapped ends the program.
"""

import argparse
import glob
import os
import sys
import tempfile
from pathlib import Path

import numpy as np

from gltf_reader import Gltf

VARIANT = "llvm_ad_rgb"
# Renders whose spread gives the variance of the mean.
VARIANCE_PASSES = 16


def import_mitsuba(variant=VARIANT):
    """Mitsuba with `variant` chosen. Dr.Jit finds an unversioned libLLVM.so
    only; distributions install versioned ones, of which the newest is taken."""
    if "DRJIT_LIBLLVM_PATH" not in os.environ:
        folders = ["/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib64", "/usr/lib",
                   "/usr/lib/llvm-*/lib", "/usr/local/lib", "/opt/homebrew/opt/llvm/lib"]
        names = ["libLLVM.so.*", "libLLVM-[0-9]*.so*", "libLLVM.dylib"]
        found = [path for folder in folders for name in names for path in glob.glob(f"{folder}/{name}")]

        def version(path):
            digits = "".join(c if c.isdigit() else " " for c in Path(path).name).split()
            return [int(d) for d in digits]

        if found:
            os.environ["DRJIT_LIBLLVM_PATH"] = max(found, key=version)
    import mitsuba

    mitsuba.set_variant(variant)
    return mitsuba


def approximated(message):
    print(f"approximated: {message}", file=sys.stderr)


def unmapped(message):
    raise SystemExit(f"mitsuba_scene: {message}, which has no equal in Mitsuba")


def rgb(value):
    return {"type": "rgb", "value": [float(v) for v in value]}


def bsdf_of(material):
    """The Mitsuba BSDF of a glTF material."""
    name = material.get("name", "unnamed")
    pbr = material.get("pbrMetallicRoughness", {})
    extensions = material.get("extensions", {})
    for owner, texture in [(pbr, "baseColorTexture"), (pbr, "metallicRoughnessTexture"),
                           (material, "normalTexture"), (material, "emissiveTexture")]:
        if texture in owner:
            unmapped(f"material {name} has a {texture}")
    if material.get("alphaMode", "OPAQUE") != "OPAQUE":
        unmapped(f"material {name} has alpha mode {material['alphaMode']}")
    color = pbr.get("baseColorFactor", [1, 1, 1, 1])[:3]
    metallic, roughness = pbr.get("metallicFactor", 1.0), pbr.get("roughnessFactor", 1.0)
    specular = extensions.get("KHR_materials_specular", {})
    specular_weight = specular.get("specularFactor", 1.0) * max(specular.get("specularColorFactor", [1.0]))
    ior = extensions.get("KHR_materials_ior", {}).get("ior", 1.5)
    transmission = extensions.get("KHR_materials_transmission", {}).get("transmissionFactor", 0.0)
    alpha = roughness * roughness

    if transmission > 0 and metallic == 0:
        if transmission < 1:
            unmapped(f"material {name} transmits in part")
        is_solid = extensions.get("KHR_materials_volume", {}).get("thicknessFactor", 0) > 0
        glass = {"int_ior": ior, "ext_ior": 1.0, "specular_transmittance": rgb(color)}
        if not is_solid:
            approximated(f"material {name}: thin glass has light bounce between its sides in Mitsuba")
            if alpha > 0:
                unmapped(f"material {name} is thin rough glass")
            return {"type": "thindielectric", **glass}
        if alpha > 0:
            return {"type": "roughdielectric", "distribution": "ggx", "alpha": alpha, **glass}
        return {"type": "dielectric", **glass}
    if metallic == 0 and (specular_weight == 0 or ior == 1):
        return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(color)}}
    if metallic == 1 and roughness == 0:
        if min(color) < 1:
            approximated(f"material {name}: a smooth metal does not whiten at grazing angles in Mitsuba")
        return {"type": "twosided",
                "bsdf": {"type": "conductor", "material": "none", "specular_reflectance": rgb(color)}}
    approximated(f"material {name}: principled has a separable masking term"
                 + ("" if metallic == 1 else " and Disney's diffuse lobe"))
    if specular_weight != 1 and metallic < 1:
        unmapped(f"material {name} has a weakened dielectric layer")
    principled = {"type": "principled", "base_color": rgb(color), "metallic": metallic, "roughness": roughness}
    if metallic < 1:
        principled["eta"] = ior
    return {"type": "twosided", "bsdf": principled}


def emission_of(material):
    """Emitted radiance of a glTF material."""
    strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
    return np.array(material.get("emissiveFactor", [0, 0, 0]), dtype=np.float64) * strength


def write_ply(path, positions, normals, indices):
    """A binary PLY file."""
    columns = positions if normals is None else np.hstack([positions, normals])
    names = ["x", "y", "z"] + ([] if normals is None else ["nx", "ny", "nz"])
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(positions)}"]
    header += [f"property float {name}" for name in names]
    header += [f"element face {len(indices)}", "property list uchar int vertex_indices", "end_header"]
    faces = np.zeros(len(indices), dtype=[("count", "u1"), ("index", "<i4", 3)])
    faces["count"], faces["index"] = 3, indices
    with open(path, "wb") as file:
        file.write(("\n".join(header) + "\n").encode())
        file.write(columns.astype("<f4").tobytes())
        file.write(faces.tobytes())


class Converter:
    """Builds the dictionary of a Mitsuba scene from a glTF file."""

    def __init__(self, mitsuba, path, folder):
        self.mitsuba = mitsuba
        self.gltf = Gltf(path)
        self.folder = folder
        self.scene = {"type": "scene"}

    def add(self, prefix, value):
        self.scene[f"{prefix}_{len(self.scene)}"] = value

    def convert(self, width, height, environment, environment_radiance):
        self.scene["integrator"] = {"type": "path", "max_depth": -1, "rr_depth": 5}
        has_camera = False
        for node in self.gltf.nodes():
            if "mesh" in node.data:
                self.add_mesh(node)
            if "camera" in node.data and not has_camera:
                self.add_camera(node, width, height)
                has_camera = True
            light = node.data.get("extensions", {}).get("KHR_lights_punctual")
            if light:
                self.add_light(node, self.gltf.root["extensions"]["KHR_lights_punctual"]["lights"][light["light"]])
        if not has_camera:
            raise SystemExit(f"mitsuba_scene: {self.gltf.path} has no camera")
        self.add_environment(environment, environment_radiance)
        return self.scene

    def add_mesh(self, node):
        mesh = self.gltf.root["meshes"][node.data["mesh"]]
        sphere = mesh.get("extras", {}).get("steradian", {}).get("sphere")
        for primitive in mesh["primitives"]:
            materials = self.gltf.root.get("materials", [])
            material = materials[primitive["material"]] if "material" in primitive else {}
            look = {"bsdf": bsdf_of(material)}
            emission = emission_of(material)
            if emission.max() > 0:
                look["emitter"] = {"type": "area", "radiance": rgb(emission)}
            if sphere:
                self.add_sphere(node, sphere["radius"], look)
                return
            triangles = self.gltf.triangles(primitive)
            if triangles is not None:
                self.add_triangles(node, triangles, look, material)

    def add_sphere(self, node, radius, look):
        linear = node.world_from_object[:3, :3]
        scale = np.cbrt(abs(np.linalg.det(linear)))
        if not np.allclose(linear.T @ linear, scale * scale * np.eye(3), rtol=1e-5, atol=1e-5 * scale * scale):
            raise SystemExit("mitsuba_scene: a sphere is scaled unevenly")
        center = [float(v) for v in node.world_from_object[:3, 3]]
        self.add("sphere", {"type": "sphere", "center": center, "radius": float(radius * scale), **look})

    def add_triangles(self, node, triangles, look, material):
        linear = node.world_from_object[:3, :3]
        positions = triangles.positions @ linear.T + node.world_from_object[:3, 3]
        normals = triangles.normals
        if normals is not None:
            normals = normals @ np.linalg.inv(linear)
            normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        indices = triangles.indices
        if np.linalg.det(linear) < 0:
            indices = indices[:, ::-1]
        self.add_ply(positions, normals, indices, look)
        if "emitter" in look and material.get("doubleSided"):
            # Mitsuba's area light has one side: another one lies against its back.
            p, q, r = (positions[indices[:, i]] for i in range(3))
            faces = np.cross(q - p, r - p)
            faces /= np.linalg.norm(faces, axis=1, keepdims=True)
            if not np.allclose(faces, faces[0], atol=1e-4):
                unmapped(f"material {material.get('name')} emits from both sides of a surface that is not flat")
            approximated(f"material {material.get('name')}: its two sides lie 1e-5 of its size apart")
            gap = 1e-5 * np.ptp(positions, axis=0).max()
            back = None if normals is None else -normals
            self.add_ply(positions - gap * faces[0], back, indices[:, ::-1], look)

    def add_ply(self, positions, normals, indices, look):
        path = str(Path(self.folder) / f"{len(self.scene)}.ply")
        write_ply(path, positions, normals, indices)
        self.add("mesh", {"type": "ply", "filename": path, "face_normals": normals is None, **look})

    def add_camera(self, node, width, height):
        camera = self.gltf.root["cameras"][node.data["camera"]]
        if camera["type"] != "perspective":
            unmapped("the camera is orthographic")
        world_from_camera = node.world_from_object.copy()
        world_from_camera[:3, :3] /= np.linalg.norm(world_from_camera[:3, :3], axis=0)
        # Mitsuba looks along +Z and has +X to the left.
        to_world = world_from_camera @ np.diag([-1.0, 1.0, -1.0, 1.0])
        sensor = {
            "type": "perspective", "fov_axis": "y",
            "fov": float(np.degrees(camera["perspective"]["yfov"])),
            "near_clip": 1e-3, "far_clip": 1e6,
            "to_world": self.mitsuba.ScalarTransform4f(to_world),
            "film": {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb",
                     "component_format": "float32", "rfilter": {"type": "box"}},
            "sampler": {"type": "independent"},
        }
        lens = camera.get("extras", {}).get("steradian", {})
        if lens.get("apertureRadius", 0) > 0:
            sensor.update(type="thinlens", aperture_radius=lens["apertureRadius"],
                          focus_distance=lens["focusDistance"])
        self.scene["sensor"] = sensor

    def add_light(self, node, light):
        intensity = np.array(light.get("color", [1, 1, 1])) * light.get("intensity", 1.0)
        if light["type"] == "point" and "range" not in light:
            position = [float(v) for v in node.world_from_object[:3, 3]]
            self.add("light", {"type": "point", "position": position, "intensity": rgb(intensity)})
        elif light["type"] == "directional":
            direction = [float(v) for v in -node.world_from_object[:3, 2]]
            self.add("light", {"type": "directional", "direction": direction, "irradiance": rgb(intensity)})
        else:
            unmapped(f"light {light.get('name', 'unnamed')} is a spot or has a range")

    def add_environment(self, file, radiance):
        own = self.gltf.scene().get("extras", {}).get("steradian", {}).get("environment", {})
        rotation, intensity = 0.0, 1.0
        if file is None and radiance is None:
            radiance = own.get("radiance")
            file = self.gltf.path.parent / own["uri"] if "uri" in own else None
            rotation, intensity = own.get("rotation", 0.0), own.get("intensity", 1.0)
        if radiance is not None:
            values = np.broadcast_to(radiance, 3) * intensity
            self.scene["environment"] = {"type": "constant", "radiance": rgb(values)}
        elif file is not None:
            # Our map's middle is +X and its columns go towards +Z; Mitsuba's
            # middle is +Z, going towards -X.
            turn = self.mitsuba.ScalarTransform4f().rotate([0, 1, 0], 90.0 + rotation)
            self.scene["environment"] = {"type": "envmap", "filename": str(file), "scale": intensity,
                                         "to_world": turn}


def load(mitsuba, path, width, height, environment=None, environment_radiance=None):
    """The scene in `path` as a Mitsuba scene."""
    with tempfile.TemporaryDirectory() as folder:
        converter = Converter(mitsuba, path, folder)
        return mitsuba.load_dict(converter.convert(width, height, environment, environment_radiance))


def render_with_variance(mitsuba, scene, spp, seed):
    """Mean and variance of the mean from independent passes, as arrays."""
    passes = min(VARIANCE_PASSES, spp)
    per_pass = -(-spp // passes)
    total = squares = 0.0
    for i in range(passes):
        image = np.array(mitsuba.render(scene, spp=per_pass, seed=seed * VARIANCE_PASSES + i), dtype=np.float64)
        total, squares = total + image, squares + image * image
    mean = total / passes
    variance = np.maximum(squares / passes - mean * mean, 0.0) / max(passes - 1, 1)
    return mean, variance


def resolution(text):
    width, _, height = text.partition("x")
    return int(width), int(height)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("-o", "--output", required=True, help="EXR file of the mean")
    parser.add_argument("--variance", help="EXR file of the variance of the mean")
    parser.add_argument("--resolution", type=resolution, default=(256, 256))
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--environment", help="equirectangular .hdr or .exr")
    parser.add_argument("--environment-radiance", type=float, nargs="+", help="one value, or red green blue")
    arguments = parser.parse_args()

    mitsuba = import_mitsuba()
    scene = load(mitsuba, arguments.scene, *arguments.resolution, arguments.environment,
                 arguments.environment_radiance)
    mean, variance = render_with_variance(mitsuba, scene, arguments.spp, arguments.seed)
    mitsuba.Bitmap(mean.astype(np.float32)).write(arguments.output)
    if arguments.variance:
        mitsuba.Bitmap(variance.astype(np.float32)).write(arguments.variance)


if __name__ == "__main__":
    main()
