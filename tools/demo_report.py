#!/usr/bin/env python3
"""Makes the report of the demo scenes with one command: hairstyles × colors × lights, and some from farther away, by every
method that `pelage` has, against path tracing.

  tools/demo_report.py [--quick] [--dual] [--out out/report] [--only REGEX] [--readme]

Pictures that the same command of the same program has made are kept, so a run that was stopped goes on where it was. At the
end stand OUT/cases.json, OUT/page/index.html and the tables of OUT/tables.md. --dual does another set of cases, every
hairstyle in every color near, middle and far in front light, and adds OUT/dual.md: the error of dual scattering in each.
"""
import argparse
import hashlib
import json
import math
import os
import pathlib
import platform
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
HAIRSTYLES = ("straight", "wavy", "curly", "afro", "ponytail")
COLORS = {"black": {"eumelanin": 8, "pheomelanin": 0}, "brown": {"eumelanin": 1.3, "pheomelanin": 0.2},
          "blond": {"eumelanin": 0.1, "pheomelanin": 0.1}}
LIGHTS = {"front": (25, -25), "side": (90, -20), "back": (160, -30)}  # degrees: where it turns from the view, and falls
DISTANCES = {"near": 1, "middle": 3, "far": 9}  # times the distance of the demo scene
DUAL = {"raster64": "opacity maps", "dual": "counted by rays"}  # methods that scatter so, and how they know the strands on the way


class Method:
    """What is typed after `pelage VERB SCENE`; `samples` is what a pixel gets."""

    def __init__(self, name, label, series, verb, arguments, samples, about):
        self.name, self.label, self.series, self.verb = name, label, series, verb
        self.arguments, self.samples, self.about = arguments, samples, about


def methods(options):
    def render(name, label, series, samples, *arguments, about=""):
        return Method(name, label, series, "render", [*arguments, "--spp", str(samples)], samples, about)

    def trace(name, label, samples, *arguments, about=""):
        return Method(name, label, label, "trace", [*arguments, "--spp", str(samples)], samples, about)

    return [
        render("raster1", "Raster, 1 sample", "Raster", 1, about="Nearest strand at the center of a pixel"),
        render("raster8", "Raster, 8 samples", "Raster", 8, about="Eight sample positions, shared shading"),
        render("raster64", "Raster, 64 samples", "Raster", 64, "--method", "ssaa", about="64 jittered frames, each shaded"),
        render("taa", "TAA", "TAA", 1, "--method", "taa", about="Temporal anti-aliasing: jitter, history, clamp"),
        render("smaa", "SMAA", "SMAA", 1, "--method", "smaa", about="Morphological anti-aliasing of one sample"),
        render("fxaa", "FXAA", "FXAA", 1, "--method", "fxaa", about="Fast approximate anti-aliasing of one sample"),
        trace("dual", "Dual scattering, traced", options.dual_samples, "--integrator", "dual",
              about="Dual scattering with every strand on the shadow ray counted"),
        trace("path", "Path traced", options.samples, about="All light paths: the reference"),
    ]


# ---- Scenes -------------------------------------------------------------------------------------------------------------


def unit(v):
    size = math.sqrt(sum(x * x for x in v))
    return [x / size for x in v]


def light_direction(camera, turn, fall):
    """Where light travels that comes from behind the camera (turn 0), from its side (90), or towards it (180)."""
    view = unit([t - e for t, e in zip(camera["target"], camera["eye"])])
    turn, fall = math.radians(turn), math.radians(fall)
    c, s = math.cos(turn), math.sin(turn)
    flat = unit([c * view[0] + s * view[2], 0, -s * view[0] + c * view[2]])
    return [round(x, 4) for x in (flat[0] * math.cos(fall), math.sin(fall), flat[2] * math.cos(fall))]


class Case:
    def __init__(self, style, color, light, distance):
        self.axes = {"hairstyle": style, "color": color, "light": light, "distance": distance}
        self.name = f"{style}-{color}-{light}" + (f"-{distance}" if distance != 1 else "")
        self.title = f"{style.capitalize()}, {color}, {light} light" + (f", from {distance} times as far" if distance != 1 else "")

    def scene(self, groom, size):
        style = self.axes["hairstyle"]
        scene = json.loads((ROOT / f"assets/scenes/{style}.json").read_text())
        scene.pop("$schema")
        camera = scene["camera"]
        camera["eye"] = [round(t + self.axes["distance"] * (e - t), 4) for e, t in zip(camera["eye"], camera["target"])]
        direction = light_direction(camera, *LIGHTS[self.axes["light"]])
        scene["lights"] = [{"name": self.axes["light"], "type": "directional", "direction": direction, "intensity": [6, 6, 6]}]
        scene.pop("environment", None)
        material = COLORS[self.axes["color"]]
        scene["grooms"] = [{"name": style, "file": groom, "scale": 1, "material": material}]
        scene["settings"] = {"width": size, "height": size, "background": [0.12, 0.13, 0.15]}
        return scene


def all_cases(quick, dual):
    if dual:
        return [Case(s, c, "front", d) for s in HAIRSTYLES for c in COLORS for d in DISTANCES.values()]
    if quick:
        return [Case(style, "brown", light, 1) for style in ("straight", "curly") for light in ("front", "back")]
    near = [Case(s, c, l, 1) for s in HAIRSTYLES for c in COLORS for l in LIGHTS]
    return near + [Case(s, "brown", "front", d) for s in HAIRSTYLES for d in DISTANCES.values() if d > 1]


# ---- Work that is done once ------------------------------------------------------------------------------------------------


class Failure(Exception):
    pass


class Workshop:
    """Runs `pelage`; what a command has made is kept with a stamp of the command, its inputs and the program."""

    def __init__(self, pelage, folder):
        self.pelage, self.folder = pelage, folder
        self.program = hashlib.sha256(pathlib.Path(pelage).read_bytes()).hexdigest()

    def stamp(self, arguments, inputs):
        told = hashlib.sha256(self.program.encode())
        told.update(json.dumps(arguments).encode())
        for name in inputs:
            told.update((self.folder / name).read_bytes())
        return told.hexdigest()

    def known(self, arguments, inputs, output):
        """What the stamp beside `output` tells, None where it has to be made."""
        try:
            stamp = json.loads((self.folder / f"{output}.stamp").read_text())
        except (OSError, ValueError):
            return None
        return stamp if stamp["stamp"] == self.stamp(arguments, inputs) and (self.folder / output).exists() else None

    def make(self, arguments, inputs, output, json_output=False):
        """Runs `pelage ARGUMENTS -o OUTPUT` in the folder, and returns the stamp: `seconds` of the work, and `told`, with json_output, what
        it printed."""
        stamp = self.known(arguments, inputs, output)
        if stamp:
            return stamp
        (self.folder / output).parent.mkdir(parents=True, exist_ok=True)
        command = [self.pelage, *arguments, "-o", output, *(["--json"] if json_output else [])]
        start = time.monotonic()
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
        if done.returncode != 0:
            raise Failure(done.stderr.strip().splitlines()[0] if done.stderr.strip() else f"exit status {done.returncode}")
        seconds, told = time.monotonic() - start, json.loads(done.stdout) if json_output else {}
        stamp = {"stamp": self.stamp(arguments, inputs), "seconds": round(self.work_seconds(told, seconds), 4), "told": told}
        (self.folder / f"{output}.stamp").write_text(json.dumps(stamp))
        return stamp

    @staticmethod
    def work_seconds(told, wall):
        """Of all stages, without reading and writing files."""
        stages = told.get("stages")
        return sum(s["seconds"] for s in stages if not s["stage"].startswith("io.")) if stages else wall


class Clock:
    """Tells how far the work is and how long the rest takes, from what each method took so far."""

    def __init__(self, jobs):
        self.left, self.total, self.took = list(jobs), len(jobs), {}

    def line(self, what):
        known = [sum(t) / len(t) for t in self.took.values()]
        guess = sum(known) / len(known) if known else 0
        seconds = sum(sum(self.took[m]) / len(self.took[m]) if m in self.took else guess for m in self.left)
        rest = f", about {seconds / 60:.0f} min left" if known and seconds > 45 else ""
        print(f"[{self.total - len(self.left) + 1}/{self.total}] {what}{rest}", flush=True)

    def done(self, method, seconds):
        self.left.remove(method)
        if seconds is not None:
            self.took.setdefault(method, []).append(seconds)


# ---- The whole --------------------------------------------------------------------------------------------------------------


def make_grooms(shop, cases, strands):
    for style in dict.fromkeys(case.axes["hairstyle"] for case in cases):
        grow = json.loads((ROOT / f"assets/scenes/{style}.json").read_text())["grooms"][0]["grow"]
        count = strands or grow["strands"]
        print(f"growing {style}, {count} strands", flush=True)
        shop.make(["grow", style, "--strands", str(count), "--seed", str(grow.get("seed", 1))], [], f"grooms/{style}.pelage")


def picture(shop, case, method):
    """(arguments, inputs, output) of one picture."""
    scene = f"scenes/{case.name}.json"
    return [method.verb, scene, *method.arguments], [scene, f"grooms/{case.axes['hairstyle']}.pelage"], f"pictures/{case.name}-{method.name}.exr"


def make_pictures(shop, cases, chosen):
    """{(case, method): seconds} of what could be made, {method: message} of what could not."""
    seconds, failures = {}, {}
    jobs = [(case, m) for case in cases for m in chosen]
    for job in jobs:
        stamp = shop.known(*picture(shop, *job))
        if stamp:
            seconds[job[0].name, job[1].name] = stamp["seconds"]
    missing = [job for job in jobs if (job[0].name, job[1].name) not in seconds]
    print(f"{len(jobs)} pictures, {len(jobs) - len(missing)} of them are there", flush=True)
    clock = Clock([m.name for _, m in missing])
    for case, method in missing:
        if method.name in failures:
            clock.done(method.name, None)
            continue
        clock.line(f"{case.title}: {method.label}")
        start = time.monotonic()
        try:
            seconds[case.name, method.name] = shop.make(*picture(shop, case, method), json_output=True)["seconds"]
            clock.done(method.name, time.monotonic() - start)
        except Failure as failure:
            failures[method.name] = str(failure)
            clock.done(method.name, None)
            print(f"{method.label} is left out: {failure}", file=sys.stderr, flush=True)
    return seconds, failures


def machine():
    names = re.findall(r"model name\s*:\s*(.+)", pathlib.Path("/proc/cpuinfo").read_text()) if os.path.exists("/proc/cpuinfo") else []
    return f"Times of {names[0] if names else platform.machine()}, {os.cpu_count()} threads; reading and writing files not counted."


def write_cases(folder, cases, chosen, seconds, size):
    def entry(case, method):
        arguments, _, output = picture(None, case, method)
        return {"method": method.name, "file": output, "samples": method.samples, "time": seconds[case.name, method.name],
                "command": " ".join(["pelage", *arguments, "-o", output])}

    told = {
        "title": "Hair by every method",
        "about": "Five hairstyles in three colors and three lights, and from farther away: what each method of Pelage makes of "
                 "them, measured against path tracing of the same strands, fibers, camera and light.",
        "machine": machine(), "axes": ["hairstyle", "color", "light", "distance"], "reference": "path",
        "methods": [{"name": m.name, "label": m.label, "series": m.series, "about": m.about} for m in chosen], "cases": []}
    for case in cases:
        images = [entry(case, m) for m in chosen if (case.name, m.name) in seconds]
        if len(images) < 2 or not any(image["method"] == "path" for image in images):
            continue
        told["cases"].append({
            "title": case.title, "axes": case.axes, "mask": f"masks/{case.name}.exr", "images": images,
            "settings": {"scene": f"scenes/{case.name}.json", "material": json.dumps(COLORS[case.axes["color"]]), "size": f"{size} × {size}"}})
    (folder / "cases.json").write_text(json.dumps(told, indent=1) + "\n")
    return len(told["cases"])


def write_page(pelage, folder):
    """The page and tables.md, from one measurement of every picture. Returns the table of means."""
    axes = ("hairstyle", "color", "light", "distance")
    found = json.loads((folder / "cases.json").read_text())["cases"]
    several = [a for a in axes if len({c["axes"][a] for c in found}) > 1]
    arguments = [pelage, "report", "cases.json", "-o", "page", "--markdown", *(word for a in several for word in ("--by", a))]
    tables = subprocess.run(arguments, cwd=folder, check=True, stdout=subprocess.PIPE, text=True).stdout
    (folder / "tables.md").write_text(tables)
    return tables.split("\n\n")[0] + "\n"


def write_dual(pelage, folder, cases):
    """Errors of dual scattering by hairstyle, color and distance, on hair pixels. Returns the table, which is dual.md too."""
    def errors(case, method):
        pictures = [f"pictures/{case.name}-{name}.exr" for name in (method, "path")]
        told = subprocess.run([pelage, "compare", *pictures, "--mask", f"masks/{case.name}.exr", "--tone-map", "aces", "--metrics", "flip,psnr",
                               "--json"], cwd=folder, check=True, stdout=subprocess.PIPE, text=True).stdout
        return json.loads(told)

    by_place = {(c.axes["hairstyle"], c.axes["color"], c.axes["distance"]): c for c in cases}
    heads = [f"{label}, {distance}" for label in DUAL.values() for distance in DISTANCES]
    lines = ["| FLIP (PSNR) of | " + " | ".join(heads) + " |", "|---" * (1 + len(heads)) + "|"]
    for style, color in dict.fromkeys(place[:2] for place in by_place):
        cells = []
        for method in DUAL:
            for distance in DISTANCES.values():
                case = by_place.get((style, color, distance))
                found = errors(case, method) if case else None
                cells.append(f"{found['flip']:.3f} ({found['psnr']:.1f})" if found else "")
        lines.append(f"| {style}, {color} | " + " | ".join(cells) + " |")
    table = "\n".join(lines) + "\n"
    (folder / "dual.md").write_text(table)
    return table


def program(path):
    """The absolute path of a program that is there."""
    found = str(pathlib.Path(path).resolve())
    if not os.access(found, os.X_OK):
        raise SystemExit(f"{found} is no program; build it first, or name it with --pelage")
    return found


def run(main):
    """main(), of a tool that keeps what it has made."""
    try:
        main()
    except KeyboardInterrupt:
        sys.exit("stopped; the same command goes on from here")


def put_into_readme(mark, told):
    """Puts `told` between <!-- mark --> and <!-- /mark --> of README.md."""
    readme = ROOT / "README.md"
    text, count = re.subn(rf"(<!-- {mark} -->\n).*?(<!-- /{mark} -->)", lambda m: m[1] + told + m[2], readme.read_text(), flags=re.S)
    if count != 1:
        raise SystemExit(f"README.md lacks the marks <!-- {mark} --> and <!-- /{mark} -->")
    readme.write_text(text)


def write_readme(table, cases, options):
    """The table, and what it was made of."""
    styles = ", ".join(dict.fromkeys(case.axes["hairstyle"] for case in cases))
    strands = f"{options.strands} strands" if options.strands else "the strands of assets/scenes"
    told = (f"Means over {len(cases)} cases ({styles}) on hair pixels, {options.size}×{options.size} pixels, {strands}, against "
            f"{options.samples} paths a pixel:\n\n{table}\n")
    put_into_readme("demo report", told)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="four cases of few strands and pixels, to see that everything works")
    parser.add_argument("--dual", action="store_true", help="dual scattering alone, by hairstyle, color and distance")
    parser.add_argument("--out", default="out/report", help="folder of everything (%(default)s)")
    parser.add_argument("--only", default="", metavar="REGEX", help="cases whose names match, e.g. 'curly-.*-back'")
    parser.add_argument("--pelage", default=os.environ.get("PELAGE", str(ROOT / "build/release/bin/pelage")), help="program (%(default)s)")
    parser.add_argument("--size", type=int, help="pixels of a side (320; 96 with --quick)")
    parser.add_argument("--strands", type=int, help="of each groom (as in assets/scenes; 1500 with --quick)")
    parser.add_argument("--samples", type=int, help="of path tracing, a pixel (256; 16 with --quick)")
    parser.add_argument("--readme", action="store_true", help="put the table of means into README.md")
    options = parser.parse_args()
    if options.dual and options.readme:
        parser.error("the README's table is that of the demo scenes, not of --dual")
    options.size = options.size or (96 if options.quick else 320)
    options.strands = options.strands or (1500 if options.quick else 0)
    options.samples = options.samples or (16 if options.quick else 256)
    options.dual_samples = max(1, options.samples // 4)
    folder = pathlib.Path(options.out).resolve()
    pelage = program(options.pelage)
    cases = [c for c in all_cases(options.quick, options.dual) if re.search(options.only, c.name)]
    if not cases:
        raise SystemExit(f"no case matches {options.only}")
    (folder / "scenes").mkdir(parents=True, exist_ok=True)
    shop, chosen = Workshop(pelage, folder), [m for m in methods(options) if not options.dual or m.name in (*DUAL, "path")]
    try:
        make_grooms(shop, cases, options.strands)
        for case in cases:
            scene = f"scenes/{case.name}.json"
            (folder / scene).write_text(json.dumps(case.scene(f"../grooms/{case.axes['hairstyle']}.pelage", options.size), indent=1) + "\n")
            shop.make(["render", scene, "--view", "coverage", "--spp", "16", "--float"], [scene, f"grooms/{case.axes['hairstyle']}.pelage"],
                      f"masks/{case.name}.exr")
    except Failure as failure:
        raise SystemExit(f"pelage failed: {failure}")
    seconds, failures = make_pictures(shop, cases, chosen)
    if not write_cases(folder, cases, chosen, seconds, options.size):
        raise SystemExit("no case has both a reference and a picture to compare with it:\n" +
                         "\n".join(f"  {name}: {message}" for name, message in failures.items()))
    table = write_page(pelage, folder)
    if options.readme:
        write_readme(table, cases, options)
    if options.dual and not failures:
        print(f"\n{write_dual(pelage, folder, cases)}")
    print(f"\n{table}\nOpen {folder / 'page/index.html'}; all tables: {folder / 'tables.md'}")
    if failures:
        print("left out: " + ", ".join(failures), file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("stopped; the same command goes on from here")
