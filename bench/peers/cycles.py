#!/usr/bin/env python3
"""Path tracing beside Blender Cycles: the same strands, fibers, camera, size, environment, threads and bounces.

  bench/peers/cycles.py [--pelage build/release/bin/pelage] [--size 512] [--samples 8] [--runs 3] [--strands 10000 50000]
                        [--models chiang marschner] [--cpu-time]

Needs `apt-get install blender python3-numpy`. A picture of N and one of 2 N samples a pixel are made in turn; their difference is
the time of N samples without start, scene and acceleration structure. Both draw flat ribbons, follow 12 bounces, and know
the fiber by the same absorption, roughness, tilt and index of refraction: Principled Hair is Chiang's BCSDF, which is the model
`chiang` here; `marschner`, the default, is its mean over the width of the strand. Prints, as medians,

  rate        millions of samples per second (one sample: a camera ray and all that follows from it), and their ratio; with
              --cpu-time per second of all processors together, which other work on the machine disturbs less
  mean        radiance of both pictures: what both make of the same fibers under a light of 1 from everywhere
  variance    of one sample: squared error of small pictures of 16 samples a pixel against one of 512, times 16
  efficiency  ratio of 1/(variance * time)
"""
import argparse
import json
import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
BOUNCES = 12
FEW, MANY, SMALL = 16, 512, 128  # samples and size of the pictures that variance is measured on
FIBER = {"eumelanin": 0.7, "pheomelanin": 0.2, "eta": 1.55, "beta_longitudinal": 7.5, "beta_azimuthal": 15, "cuticle_tilt": 3}


def run(*command):
    # Blender looks for its own Python's packages; another Python earlier in the path would be asked instead.
    environment = {**os.environ, "PATH": "/usr/bin:/bin"}
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, env=environment)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


def cpu_seconds(work):
    """User time of what `work` starts."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    work()
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def write_scene(folder, groom, size, model):
    path = os.path.join(folder, f"{model}_{size}.json")
    with open(path, "w") as f:
        json.dump({"camera": {"eye": [-0.35, 0.05, 0.98], "target": [0, -0.16, 0], "fov": 31},
                   "environment": {"radiance": [1, 1, 1], "visible": True},
                   "grooms": [{"name": "straight", "file": os.path.basename(groom), "material": {"model": model, **FIBER}}],
                   "settings": {"width": size, "height": size}}, f)
    return path


class Pelage:
    def __init__(self, options, folder, groom, model, size):
        self.name, self.options, self.folder, self.size = model, options, folder, size
        self.scene = write_scene(folder, groom, size, model)

    def picture(self, samples, seed):
        return os.path.join(self.folder, f"{self.name}_{self.size}_{samples}_{seed}.exr")

    def seconds(self, samples, seed):
        if self.options.cpu_time:
            return cpu_seconds(lambda: self.trace(samples, seed))
        return self.trace(samples, seed)

    def variance(self):
        self.trace(MANY, 0), self.trace(FEW, 1)
        compared = run(self.options.pelage, "compare", self.picture(FEW, 1), self.picture(MANY, 0), "--metrics", "mse", "--json")
        return json.loads(compared)["mse"] / (1 / FEW + 1 / MANY)

    def trace(self, samples, seed):
        text = run(self.options.pelage, "trace", self.scene, "-o", self.picture(samples, seed), "--spp", samples, "--bounces",
                   BOUNCES, "--threads", self.options.threads, "--seed", seed, "--no-checkpoint", "--json")
        return json.loads(text)["seconds"]


class Cycles(Pelage):
    def __init__(self, options, folder, groom, model, size):
        super().__init__(options, folder, groom, model, size)
        self.name, self.groom, self.means = "cycles", groom, {}

    def trace(self, samples, seed, *pictures):
        text = run("blender", "-b", "--python-exit-code", 1, "--python", os.path.join(HERE, "cycles_scene.py"), "--", self.groom,
                   self.scene, samples, BOUNCES, self.options.threads, seed, self.picture(samples, seed), *pictures)
        self.means = {path: float(mean) for mean, path in re.findall(r"^mean (\S+) (.*)$", text, re.M)}
        return float(re.search(r"^seconds (\S+)", text, re.M).group(1))


def compare(options, strands, folder):
    groom = os.path.join(folder, "straight.hair")
    run(options.pelage, "grow", "straight", "--strands", strands, "--points", 32, "--width", 1e-4, "--width-variation", 0,
        "--taper", 0, "-o", groom)
    def tracers(size):
        return ([Pelage(options, folder, groom, model, size) for model in options.models],
                Cycles(options, folder, groom, options.models[0], size))

    n, (ours, cycles) = options.samples, tracers(options.size)
    rates = {tracer.name: [] for tracer in (*ours, cycles)}
    for _ in range(options.runs):
        for tracer in (*ours, cycles):
            seconds = tracer.seconds(2 * n, 0) - tracer.seconds(n, 1)
            rates[tracer.name].append(n * options.size**2 * 1e-6 / seconds)
    cycles.trace(2 * n, 0, *(tracer.picture(2 * n, 0) for tracer in ours))
    small = tracers(SMALL)
    variance = {tracer.name: tracer.variance() for tracer in (*small[0], small[1])}
    print(f"{strands} strands x 32, {options.size}^2")
    for tracer in (*ours, cycles):
        ratio = statistics.median(p / c for p, c in zip(rates[tracer.name], rates["cycles"]))
        print(f"  {tracer.name:10} {statistics.median(rates[tracer.name]):.3f} M samples/s, "
              f"mean {cycles.means[tracer.picture(2 * n, 0)]:.4f}, variance {variance[tracer.name]:.5f}; beside cycles: "
              f"rate {ratio:.2f}, efficiency {ratio * variance['cycles'] / variance[tracer.name]:.2f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pelage", type=os.path.abspath, default=os.path.join(HERE, "../../build/release/bin/pelage"))
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--samples", type=int, default=8)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--strands", type=int, nargs="+", default=[10000, 50000])
    parser.add_argument("--models", nargs="+", default=["chiang", "marschner"])
    parser.add_argument("--cpu-time", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for strands in options.strands:
            compare(options, strands, folder)


if __name__ == "__main__":
    main()
