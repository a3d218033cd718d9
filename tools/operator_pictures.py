#!/usr/bin/env python3
"""Makes docs/images/operator_*.png: for each styling operator of hair meshes a strip of the same lock without it, with a little of
it, and with much. What is drawn stands in OPERATORS; docs/hair_meshes.md shows the strips.

  tools/operator_pictures.py [--pelage build/release/bin/pelage] [--only curl] [--folder docs/images]

A strip is one hair mesh, three locks side by side with a style each, drawn by one `pelage render`.
"""
import argparse
import json
import math
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent

# Kind: a little and much of it, as (amount, frequency, start, variation).
OPERATORS = {
    "length": [(0.8, 0, 0, 0.15), (1.15, 0, 0, 0.9)],
    "clump": [(0.5, 2, 0, 0.2), (1, 3, 0, 0.2)],
    "braid": [(0.25, 2, 0.1, 0.3), (0.45, 5, 0.05, 0)],
    "wave": [(0.004, 3, 0.1, 0.1), (0.012, 5, 0.1, 0.1)],
    "curl": [(0.004, 5, 0.1, 0.1), (0.010, 8, 0.1, 0.1)],
    "noise": [(0.006, 1, 0, 0), (0.016, 2, 0, 0)],
    "frizz": [(0.004, 3, 0.1, 0.5), (0.012, 6, 0.1, 0)],
    "taper": [(0.5, 0, 0.4, 0), (0.03, 0, 0, 0)],
}
WIDE = {"clump": 2, "curl": 2}  # bundles across a lock; 1
STRANDS = {"taper": 5, "frizz": 2000}  # of a lock; 5000
WIDTH = {"taper": 5e-3}  # meters; 1.2e-4

LENGTH, LAYERS, APART = 0.20, 12, 0.115  # meters


def column(x, z, u, v):
    """A column that hangs, and swings out a little as it does."""
    steps = [k / (LAYERS - 1) for k in range(LAYERS)]
    return {
        "positions": [[x, -LENGTH * w, z + 0.02 * math.sin(0.5 * math.pi * w)] for w in steps],
        "uvw": [[u, v, w] for w in steps],
    }


def strip(kind):
    """Three locks: off, a little, much."""
    wide, half = WIDE.get(kind, 1), 0.022
    mesh = {"hair_mesh": 1, "width": WIDTH.get(kind, 1.2e-4), "styles": [[]], "columns": [], "bundles": []}
    for amount, frequency, start, variation in OPERATORS[kind]:
        mesh["styles"].append(
            [{"kind": kind, "amount": amount, "frequency": frequency, "start": start, "variation": variation}])
    for lock in range(3):
        for i in range(wide):
            first = len(mesh["columns"])
            for u, v in ((i, 0), (i + 1, 0), (i + 1, 1), (i, 1)):
                u /= wide
                mesh["columns"].append(column((lock - 1) * APART + half * (2 * u - 1), half * (1 - 2 * v) * 0.7, u, v))
            mesh["bundles"].append({"columns": [first + k for k in range(4)], "strands": STRANDS.get(kind, 5000) // wide,
                                    "style": lock, "seed": 1 + i})
    return mesh


def scene(mesh_file):
    return {
        "camera": {"eye": [0, -0.105, 1.0], "target": [0, -0.105, 0], "projection": "orthographic", "height": 0.25},
        "lights": [
            {"type": "directional", "direction": [0.5, -0.6, -0.8], "intensity": [3.4, 3.3, 3.2]},
            {"type": "directional", "direction": [-0.8, -0.2, -0.5], "intensity": [1.2, 1.3, 1.5]},
        ],
        "grooms": [{"file": mesh_file, "material": {"color": [0.55, 0.33, 0.16]}}],
        "settings": {"width": 376, "height": 244, "samples": 16, "background": [0.8, 0.8, 0.8]},
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pelage", default=ROOT / "build/release/bin/pelage", type=pathlib.Path)
    parser.add_argument("--only", choices=OPERATORS)
    parser.add_argument("--folder", default=ROOT / "docs/images", type=pathlib.Path)
    options = parser.parse_args()
    for kind in [options.only] if options.only else OPERATORS:
        with tempfile.TemporaryDirectory() as folder:
            mesh, scene_file = pathlib.Path(folder, "lock.json"), pathlib.Path(folder, "scene.json")
            mesh.write_text(json.dumps(strip(kind)))
            scene_file.write_text(json.dumps(scene(mesh.name)))
            picture = options.folder / f"operator_{kind}.png"
            subprocess.run([options.pelage, "render", scene_file, "-o", picture], check=True)
            print(f"{picture}: {picture.stat().st_size} bytes")


if __name__ == "__main__":
    main()
