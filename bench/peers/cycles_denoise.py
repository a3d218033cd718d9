#!/usr/bin/env python3
"""pelage denoise on a G-buffer of Blender Cycles: one sample a pixel, before and after, against many samples of Cycles.

  bench/peers/cycles_denoise.py [--pelage build/release/bin/pelage] [--size 640] [--samples 64] [--strands 10000] [--style straight]
                                [--keep FOLDER] [-- OPTIONS OF DENOISE]

Needs `apt-get install blender python3-numpy`. Prints what `pelage denoise --reference --stats` prints; --keep leaves the G-buffer, the
reference and the picture there. cycles_scene.py says which passes and outputs make a G-buffer.
"""
import argparse
import os
import sys
import tempfile

from cycles import BOUNCES, HERE, run, write_scene

NAMES = {"color": "Combined", "depth": "Depth", "position": "Position", "tangent": "tangent", "strand": "strand", "u": "u"}


def main():
    own, _, rest = " ".join(sys.argv[1:]).partition(" -- ")
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pelage", type=os.path.abspath, default=os.path.join(HERE, "../../build/release/bin/pelage"))
    parser.add_argument("--size", type=int, default=640)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--strands", type=int, default=10000)
    parser.add_argument("--style", default="straight")
    parser.add_argument("--keep")
    options = parser.parse_args(own.split())
    with tempfile.TemporaryDirectory() as folder:
        folder = os.path.abspath(options.keep or folder)
        os.makedirs(folder, exist_ok=True)
        groom, gbuffer, reference = (os.path.join(folder, name) for name in ("hair.hair", "one.gbuffer.exr", "many.exr"))
        run(options.pelage, "grow", options.style, "--strands", options.strands, "--points", 32, "--width", 1e-4,
            "--width-variation", 0, "--taper", 0, "-o", groom)
        scene = write_scene(folder, groom, options.size, "chiang")
        for samples, seed, out in ((1, 0, gbuffer), (options.samples, 1, reference)):
            run("blender", "-b", "--python-exit-code", 1, "--python", os.path.join(HERE, "cycles_scene.py"), "--", groom, scene,
                samples, BOUNCES, os.cpu_count(), seed, out)
        renamed = [word for own_name, theirs in NAMES.items() for word in ("--channel", f"{own_name}=ViewLayer.{theirs}")]
        print(run(options.pelage, "denoise", "--gbuffer", gbuffer, *renamed, "-o", os.path.join(folder, "clean.exr"), "-o",
                  os.path.join(folder, "clean.png"), "--reference", reference, "--stats", *rest.split()), end="")


if __name__ == "__main__":
    main()
