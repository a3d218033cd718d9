#!/usr/bin/env python3
"""Makes the report of strand linking with one command, as Huang 2025 shows it: under an environment with a busy background (their
figure 8), from 1 to 16 samples a pixel (9), part by part (11), and where hair crosses densely, which they name as a limit.

  tools/link_report.py [--quick] [--out out/link] [--only REGEX] [--cache FOLDER]

Pictures that the same command of the same program has made are kept, so a run that was stopped goes on where it was; references
stay good for any program that renders the same (tools/reference_cache.py). At the end stand OUT/cases.json, OUT/page/index.html
and the tables of OUT/tables.md.
"""
import argparse
import json
import math
import os
import pathlib
import random
import re
import struct
import subprocess

from demo_report import ROOT, Failure, Method, Workshop, machine, program, run
from reference_cache import ReferenceCache

SAMPLES = (1, 4, 9, 16)
DEPTHS = (0.01, 0.03, 0.1)  # σ of depth continuity, as a share of the distance to the camera
STYLES = {"straight": "blond", "curly": "black", "ponytail": "red"}  # hairstyles and colors of figure 11


def many(samples):
    return f"{samples} sample" + ("s" if samples > 1 else "")


def method(name, label, series, *arguments, samples=1, about=""):
    return Method(name, label, series, "render", ["--method", "link", *arguments, "--spp", str(samples)], samples, about)


def all_methods():
    found = [method(f"input{n}", f"Input, {many(n)}", "Input", "--no-linking", "--no-filter", samples=n,
                    about=f"What linking starts from: {many(n)} a pixel") for n in SAMPLES]
    found += [
        method("linked", "+ linking", "Parts", "--alpha", "none", "--no-filter", about="Missed pixels of strands are filled, all opaque"),
        method("alpha", "+ alpha fix", "Parts", "--no-filter", about="Linked strands are thinned to the energy of their samples"),
        method("filter", "Filter alone", "Parts", "--no-linking", about="The input, smoothed along its strands, nothing linked")]
    found += [method(f"link{n}", f"Link, {many(n)}", "Link, count", samples=n, about="Linking, alpha fix and filter: all of it") for n in SAMPLES]
    found += [method(f"coverage{n}", f"Link by coverage, {many(n)}", "Link, coverage", "--alpha", "coverage", samples=n,
                     about="Opacity from the exact area of all strands") for n in SAMPLES]
    found += [method(f"depth{d}", f"Link, depth σ {d}", "Link, depth", "--depth-sigma", str(d),
                     about=f"Of strands that fit, those {d} of its distance behind the nearest count less") for d in DEPTHS]
    found.append(Method("msaa8", "MSAA 8", "MSAA", "render", ["--spp", "8"], 8, "Eight samples that share shading"))
    return found


class Case:
    """A scene, by the groom's file and the options of `pelage render`, and the names of the methods that it is shown by."""

    def __init__(self, figure, groom, methods, options=(), files=()):
        self.name, self.figure, self.groom, self.methods = f"{figure}-{groom}", figure, groom, methods
        self.file, self.options, self.files = f"grooms/{groom}.pelage", list(options), list(files)
        self.scene = "-".join([groom, *(["environment"] if ENVIRONMENT in files else [])])  # whose reference serves several cases
        if groom == "sheets":
            self.file = "grooms/sheets.hair"

    def inputs(self, size):
        return [self.file, "--size", size, *self.options]


ENVIRONMENT = "environment.hdr"


def all_cases():
    colored = {style: ["--hair", hair] for style, hair in STYLES.items()}
    environment = ["--env", ENVIRONMENT, "--env-visible"]
    samples = [f"{kind}{n}" for kind in ("input", "link", "coverage") for n in SAMPLES]
    depths = ["input1", "link1", *(f"depth{d}" for d in DEPTHS)]
    return ([Case("parts", s, ["input1", "linked", "alpha", "link1", "filter", "coverage1"], colored[s]) for s in STYLES] +
            [Case("environment", s, ["input1", "linked", "alpha", "link1", "coverage1", "msaa8"], colored[s] + environment, [ENVIRONMENT])
             for s in STYLES] +
            [Case("samples", s, samples, colored[s]) for s in ("straight", "curly")] +
            [Case("crossing", s, depths, colored.get(s, ())) for s in ("sheets", "curly")])


TITLES = {"parts": "Part by part", "environment": "Environment light, busy background", "samples": "1 to 16 samples",
          "crossing": "Dense crossings"}


# ---- What is made here and not by `pelage` ----------------------------------------------------------------------------------


def write_sheets(file, strands, seed=1):
    """Two sheets of wavy strands that cross, the dark one 4 cm behind the bright one: a cyHAIR file."""
    rng, points = random.Random(seed), 16
    positions, colors = [], []
    for sheet, (turn, depth, color) in enumerate(((0.6, 0.02, (0.55, 0.4, 0.2)), (-0.6, -0.02, (0.03, 0.02, 0.015)))):
        for _ in range(strands // 2):
            across, phase = 0.24 * (rng.random() - 0.5), 2 * math.pi * rng.random()
            for i in range(points):
                along = 0.24 * (i / (points - 1) - 0.5)
                sideways = across + 0.003 * math.sin(phase + 40 * along)
                positions.append((sideways * math.cos(turn) + along * math.sin(turn), -depth + 0.004 * math.sin(phase) + 0.01 * sheet,
                                  along * math.cos(turn) - sideways * math.sin(turn)))  # Z up, seen from −Y
                colors.append(color)
    count = strands // 2 * 2
    header = struct.pack("<4sIIIIff3f88s", b"HAIR", count, len(positions), 2 | 16, points - 1, 8e-5, 0, 1, 1, 1, b"unit=m up=z")
    floats = [x for p in positions for x in p] + [x for c in colors for x in c]
    file.write_bytes(header + struct.pack(f"<{len(floats)}f", *floats))


def environment_color(x, y, trunk):
    """Radiance towards azimuth x, 0…1, and height y, 1 above … 0 below: sky, sun, leaves and trunks before it, ground."""
    if y < 0.45:
        grain = 0.6 + 0.4 * math.sin(1900 * x) * math.sin(1300 * y)
        return 0.16 * grain, 0.13 * grain, 0.05 * grain
    sun = 80 * math.exp(-((x - 0.62) ** 2 * 4 + (y - 0.78) ** 2) / 0.0006)
    sky = 0.8 + 1.2 * (1 - y)
    red, green, blue = 0.55 * sky + sun, 0.75 * sky + 0.9 * sun, sky + 0.7 * sun
    leaves = math.sin(401 * x + 9 * math.sin(93 * y)) * math.sin(283 * y + 7 * math.sin(237 * x))
    if leaves > 0.25 and y < 0.8:
        red, green, blue = 0.05 + 0.3 * leaves * (1 - y), 0.1 + 0.5 * leaves * (1 - y), 0.03
    if trunk and y < 0.75:
        red, green, blue = 0.06, 0.045, 0.03
    return red, green, blue


def write_environment(file, width):
    """A clearing in a wood with the sun above it, as a Radiance picture without compression."""
    rng, height = random.Random(7), width // 2
    trunks = [(rng.random(), 0.0005 + 0.002 * rng.random()) for _ in range(150)]
    columns = [((i + 0.5) / width, any(abs((i + 0.5) / width - at) < half for at, half in trunks)) for i in range(width)]
    pixels = bytearray()
    for row in range(height):
        for x, trunk in columns:
            color = environment_color(x, 1 - (row + 0.5) / height, trunk)
            fraction, exponent = math.frexp(max(color))
            pixels += bytes(min(255, int(c * 256 / 2 ** exponent)) for c in color) + bytes([exponent + 128])
    file.write_bytes(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode() + pixels)


def make_inputs(shop, cases, options):
    (shop.folder / "grooms").mkdir(exist_ok=True)
    for groom in dict.fromkeys(case.groom for case in cases):
        if groom == "sheets":
            write_sheets(shop.folder / "grooms/sheets.hair", max(20, options.strands // 20))
        else:
            print(f"growing {groom}, {options.strands} strands", flush=True)
            shop.make(["grow", groom, "--strands", str(options.strands), "--points", "64"], [], f"grooms/{groom}.pelage")
    if any(ENVIRONMENT in case.files for case in cases):
        write_environment(shop.folder / ENVIRONMENT, 128 if options.quick else 2048)


# ---- Pictures, and the page of them -------------------------------------------------------------------------------------------


def make_case(shop, cache, case, methods, options):
    """The entry of cases.json."""
    inputs, files = case.inputs(options.size), [case.file, *case.files]
    mask = f"masks/{case.name}.exr"
    shop.make(["render", *inputs, "--view", "coverage", "--spp", "1", "--float"], files, mask)
    reference, took = cache.picture(inputs, files, options.reference_spp, case.scene)
    images = [{"method": "reference", "file": reference, "samples": options.reference_spp, "time": took,
               "command": " ".join(["pelage", *cache.command(inputs, options.reference_spp), "-o", "reference.exr"])}]
    for m in (methods[name] for name in case.methods):
        output, arguments = f"pictures/{case.name}-{m.name}.exr", ["render", *inputs, "--float", *m.arguments]
        stamp = shop.make(arguments, files, output, json_output=True)
        images.append({"method": m.name, "file": output, "samples": m.samples, "time": stamp["seconds"],
                       "command": " ".join(["pelage", *arguments, "-o", output])})
    return {"title": f"{TITLES[case.figure]}: {case.groom}", "axes": {"figure": case.figure, "groom": case.groom, "case": case.name},
            "mask": mask, "images": images, "settings": {"size": options.size.replace("x", " × ")}}


def write_cases(folder, entries, methods):
    used = {image["method"] for entry in entries for image in entry["images"]}
    told = [{"name": m.name, "label": m.label, "series": m.series, "about": m.about} for m in methods.values() if m.name in used]
    told.append({"name": "reference", "label": "Reference", "about": "Supersampling, every sample shaded"})
    (folder / "cases.json").write_text(json.dumps({
        "title": "Strand linking",
        "about": "One sample a pixel made whole by strand linking, alpha fix and the orientation-aware filter: part by part, before a busy "
                 "background, from more samples, and where hair crosses.",
        "machine": machine(), "axes": ["figure", "groom", "case"], "reference": "reference", "methods": told, "cases": entries}, indent=1) + "\n")


def write_page(pelage, folder):
    """The page, and tables of PSNR and FLIP of every method over the cases."""
    tables = []
    for metric, output in (("psnr", ["-o", "page"]), ("flip", [])):
        done = subprocess.run([pelage, "report", "cases.json", *output, "--by", "case", "--metric", metric], cwd=folder, check=True,
                              stdout=subprocess.PIPE, text=True)
        tables.append(done.stdout.strip())
    text = "\n\n".join(tables) + "\n"
    (folder / "tables.md").write_text(text)
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="few strands and pixels, to see that everything works")
    parser.add_argument("-o", "--out", default="out/link", help="folder of everything (%(default)s)")
    parser.add_argument("--cache", metavar="FOLDER", help="where references are kept (OUT/references)")
    parser.add_argument("--only", default="", metavar="REGEX", help="cases whose names match, e.g. parts-curly, environment, samples, crossing")
    parser.add_argument("--pelage", default=os.environ.get("PELAGE", str(ROOT / "build/release/bin/pelage")), help="program (%(default)s)")
    parser.add_argument("--size", metavar="WxH", help="of the pictures (960x540; 96x54 with --quick)")
    parser.add_argument("--strands", type=int, help="of each groom (50000; 400 with --quick)")
    parser.add_argument("--reference-spp", type=int, help="samples of the references, each shaded (256; 4 with --quick)")
    options = parser.parse_args()
    options.size = options.size or ("96x54" if options.quick else "960x540")
    options.strands = options.strands or (400 if options.quick else 50000)
    options.reference_spp = options.reference_spp or (4 if options.quick else 256)
    folder, pelage = pathlib.Path(options.out).resolve(), program(options.pelage)
    cases = [c for c in all_cases() if re.search(options.only, c.name)]
    if not cases:
        raise SystemExit(f"no case matches {options.only}")
    folder.mkdir(parents=True, exist_ok=True)
    shop, methods, entries = Workshop(pelage, folder), {m.name: m for m in all_methods()}, []
    cache = ReferenceCache(shop, options.cache or folder / "references")
    try:
        make_inputs(shop, cases, options)
        for i, case in enumerate(cases):
            print(f"[{i + 1}/{len(cases)}] {case.name}", flush=True)
            entries.append(make_case(shop, cache, case, methods, options))
            write_cases(folder, entries, methods)
    except Failure as failure:
        raise SystemExit(f"pelage failed: {failure}")
    print(f"\n{write_page(pelage, folder)}\nOpen {folder / 'page/index.html'}; tables: {folder / 'tables.md'}")


if __name__ == "__main__":
    run(main)
