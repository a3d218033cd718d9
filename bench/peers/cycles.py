#!/usr/bin/env python3
"""Path tracing beside Blender Cycles: the same strands, camera, size, environment, threads and bounces.

  bench/peers/cycles.py [--pelage build/release/bin/pelage] [--size 1024] [--samples 4] [--runs 3] [--strands 10000 50000]

Needs `apt-get install blender python3-numpy`. A picture of N and one of 2 N samples a pixel are made in turn; their difference is
the time of N samples without start, scene and acceleration structure. Prints millions of samples per second (one sample: a
camera ray and all that follows from it), medians, and the ratio. Both draw flat ribbons with a physical hair
BCSDF (Principled Hair here, Marschner there) and follow 12 bounces.
"""
import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
BOUNCES = 12


def run(*command):
    # Blender looks for its own Python's packages; another Python earlier in the path would be asked instead.
    environment = {**os.environ, "PATH": "/usr/bin:/bin"}
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, env=environment)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


def cycles_seconds(groom, scene, samples, threads, out):
    text = run("blender", "-b", "--python-exit-code", 1, "--python", os.path.join(HERE, "cycles_scene.py"), "--", groom, scene,
               samples, BOUNCES, threads, out)
    return float(re.search(r"^seconds (\S+)", text, re.M).group(1))


def pelage_seconds(pelage, scene, samples, threads, out):
    text = run(pelage, "trace", scene, "-o", out, "--spp", samples, "--bounces", BOUNCES, "--threads", threads,
               "--no-checkpoint", "--json")
    return json.loads(text)["seconds"]


def write_scene(folder, groom, size):
    path = os.path.join(folder, "scene.json")
    with open(path, "w") as f:
        json.dump({"camera": {"eye": [-0.35, 0.05, 0.98], "target": [0, -0.16, 0], "fov": 31},
                   "environment": {"radiance": [1, 1, 1]},
                   "grooms": [{"name": "straight", "file": os.path.basename(groom)}],
                   "settings": {"width": size, "height": size}}, f)
    return path


def compare(options, strands, folder):
    groom = os.path.join(folder, "straight.hair")
    run(options.pelage, "grow", "straight", "--strands", strands, "--points", 32, "--width", 1e-4, "--width-variation", 0,
        "--taper", 0, "-o", groom)
    scene = write_scene(folder, groom, options.size)
    out = os.path.join(folder, "out.exr")
    n, threads = options.samples, options.threads
    rates = {"cycles": [], "pelage": []}
    for _ in range(options.runs):
        work = n * options.size ** 2 * 1e-6
        seconds = {s: cycles_seconds(groom, scene, s, threads, os.path.join(folder, "cycles.png")) for s in (n, 2 * n)}
        rates["cycles"].append(work / (seconds[2 * n] - seconds[n]))
        seconds = {s: pelage_seconds(options.pelage, scene, s, threads, out) for s in (n, 2 * n)}
        rates["pelage"].append(work / (seconds[2 * n] - seconds[n]))
    median = {name: statistics.median(values) for name, values in rates.items()}
    ratio = statistics.median(p / c for p, c in zip(rates["pelage"], rates["cycles"]))
    print(f"{strands:>8} strands x 32: cycles {median['cycles']:.3f}, pelage {median['pelage']:.3f} M samples/s, ratio {ratio:.2f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pelage", type=os.path.abspath, default=os.path.join(HERE, "../../build/release/bin/pelage"))
    parser.add_argument("--size", type=int, default=1024)
    parser.add_argument("--samples", type=int, default=4)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--strands", type=int, nargs="+", default=[10000, 50000])
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for strands in options.strands:
            compare(options, strands, folder)


if __name__ == "__main__":
    main()
