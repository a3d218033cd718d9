#!/usr/bin/env python3
"""Makes the report of method swr (deferred software rasterization of hair meshes) with one command, as Lipp 2026 shows it: table 1 with
the paper's own ratios beside ours, figures 1, 4, 5, 6 and 7, how level of detail changes the look from 2000 to 20 pixels, and what
moves between the frames of a dolly.

  tools/swr_report.py [--quick] [--out out/swr] [--only REGEX]

Parts: table1, look, dolly, figure1, figure4, figure5, figure6, figure7. What the same command of the same program has made is kept, so
a run that was stopped goes on where it was. At the end stand OUT/index.html, OUT/swr.md and OUT/swr.json. Times are medians of
`pelage bench`: let nothing else run.
"""
import argparse
import json
import math
import os
import pathlib
import re
import subprocess

from demo_report import ROOT, Failure, Workshop, program, run
from link_report import ENVIRONMENT, write_environment
from png_sheet import read_png, sheet, write_png
from report_page import Report, bench, curve_picture

GROOMS = {"long-wavy": "", "curls": "curls."}  # and what their bench cases are called by
DISTANCES = {"close": 1000, "mid": 350, "far": 70}  # pixels of height at 1080 rows
KINDS = {"center": "1 sample", "filter": "1 + filter", "msaa2": "MSAA 2", "msaa4": "MSAA 4", "msaa8": "MSAA 8"}
STYLES = ("bob", "long-wavy", "curls", "afro", "ponytail", "braid")
PARTS = ("table1", "look", "dolly", "figure1", "figure4", "figure5", "figure6", "figure7")

# Milliseconds of Lipp 2026, table 1, software rasterizer: close, mid, far.
PAPER = {
    "long-wavy": {"full": {"center": (3.08, 2.35, 1.81), "filter": (3.72, 2.70, 4.50), "msaa2": (4.10, 2.84, 2.03),
                           "msaa4": (5.97, 3.68, 2.37), "msaa8": (8.27, 4.71, 2.77)},
                  "lod": {"center": (2.73, 1.69, 0.25), "filter": (3.35, 1.94, 0.36), "msaa2": (3.73, 2.15, 0.29),
                          "msaa4": (5.54, 2.87, 0.42), "msaa8": (7.71, 3.69, 0.62)}},
    "curls": {"full": {"center": (3.40, 2.74, 2.40), "filter": (4.23, 3.00, 4.23), "msaa2": (4.37, 3.12, 2.58),
                       "msaa4": (6.24, 3.96, 2.87), "msaa8": (9.10, 4.95, 3.18)},
              "lod": {"center": (3.07, 2.24, 0.35), "filter": (3.79, 2.40, 0.45), "msaa2": (4.08, 2.55, 0.49),
                      "msaa4": (5.95, 3.27, 0.52), "msaa8": (8.56, 4.17, 0.76)}}}

ABOUT = "Deferred software rasterization of hair meshes beside Lipp 2026."
LIGHTS = [{"name": "key", "type": "directional", "direction": [0.55, -0.75, -0.75], "intensity": [3.4, 3.2, 3.0]},
          {"name": "fill", "type": "directional", "direction": [-0.9, -0.25, -0.6], "intensity": [0.9, 1.0, 1.15]},
          {"name": "rim", "type": "directional", "direction": [-0.45, -0.6, 0.85], "intensity": [3.2, 3.3, 3.6]}]


# ---- Measurements of `pelage bench` -------------------------------------------------------------------------------------------


def table1(shop, report, options):
    found = {}
    if options.quick:
        found.update(bench(shop, r"^swr\.far\.(filter\.lod|strands|prepass)$"))
    else:
        for prefix in GROOMS.values():
            for distance in DISTANCES:
                found.update(bench(shop, rf"^swr\.{prefix.replace('.', chr(92) + '.')}{distance}\."))
    report.numbers["table1"] = [{"case": c, "metric": m, "value": v} for (c, m), v in found.items()]
    report.text("Table 1: a frame, by kind of picture, distance and level of detail", heading=True)
    report.text("Milliseconds at 1920 × 1080, 127,000 strands; times over those of one sample without filter at full detail, and in parentheses "
                "the paper's; FLIP and squared error on hair against 64 samples, over gray.")
    for groom, prefix in GROOMS.items():
        rows = table1_rows(found, groom, prefix)
        if rows:
            heads = [f"{what} {distance}" for what in ("ms", "ratio", "FLIP", "MSE 1e-4") for distance in DISTANCES]
            report.table([groom, *heads], rows)
        shares = [found.get((f"swr.{prefix}{d}.strands", "share")) for d in DISTANCES]
        if any(s is not None for s in shares):
            report.text(f"Strands drawn of {groom} with level of detail: " +
                        ", ".join(f"{d} {100 * s:.1f} %" for d, s in zip(DISTANCES, shares) if s is not None) + ".")
    table1_verdicts(found, report)


def table1_rows(found, groom, prefix):
    rows = []
    for detail in ("full", "lod"):
        for kind, label in KINDS.items():
            cells = {"ms": [], "ratio": [], "flip": [], "mse": []}
            for i, distance in enumerate(DISTANCES):
                at = f"swr.{prefix}{distance}."
                seconds = found.get((f"{at}{kind}.{detail}", "seconds_per_frame"))
                plain = found.get((f"{at}center.full", "seconds_per_frame"))
                paper = PAPER[groom][detail][kind][i] / PAPER[groom]["full"]["center"][i]
                cells["ms"].append(f"{1e3 * seconds:.1f}" if seconds else "")
                cells["ratio"].append(f"{seconds / plain:.2f} ({paper:.2f})" if seconds and plain else "")
                for metric, text in (("flip", "{:.3f}"), ("mse", "{:.2f}")):
                    value = found.get((f"{at}quality.{kind}.{detail}", metric))
                    cells[metric].append("" if value is None else text.format(value * (1e4 if metric == "mse" else 1)))
            if any(cells["ms"]):
                rows.append([label + (", LoD" if detail == "lod" else ""), *cells["ms"], *cells["ratio"], *cells["flip"], *cells["mse"]])
    return rows


def table1_verdicts(found, report):
    for groom, prefix in GROOMS.items():
        def value(distance, name, metric="ratio", prefix=prefix):
            return found.get((f"swr.{prefix}{distance}.{name}", metric))

        def row(what, values, good, text="{:.2f}", groom=groom):
            known = {d: v for d, v in values.items() if v is not None}
            if known:
                report.verdict(f"{groom}: {what}", all(good(d, v) for d, v in known.items()),
                               ", ".join(f"{d} {text.format(v)}" for d, v in known.items()))

        row("filter costs ≤ MSAA 2", {d: value(d, "filter_over_msaa2") for d in DISTANCES}, lambda d, v: v <= 1)
        row("filter costs ≤ MSAA 2, with LoD", {d: value(d, "filter_over_msaa2.lod") for d in DISTANCES}, lambda d, v: v <= 1)
        flips = {d: (value(d, "quality.filter.full", "flip"), value(d, "quality.msaa4.full", "flip")) for d in DISTANCES}
        row("FLIP of the filter over MSAA 4's ≤ 1", {d: a / b if a and b else None for d, (a, b) in flips.items()}, lambda d, v: v <= 1)
        least = {"close": 1, "mid": 1.25, "far": 12}
        row("LoD, times as fast with filter: ≥ 1, 1.25, 12", {d: value(d, "lod_gain") for d in DISTANCES}, lambda d, v: v >= least[d])
        row("strands drawn far ≤ 20 %", {"far": value("far", "strands", "share")}, lambda d, v: v <= 0.2, "{:.3f}")
        row("LoD pre-pass ≤ 3 %", {d: value(d, "prepass_share") for d in DISTANCES}, lambda d, v: v <= 0.03, "{:.4f}")
        row("filter far ≤ 1.3 × without", {"far": value("far", "conservative_share")}, lambda d, v: v <= 1.3)
        row("stereo: the second view ≤ 60 % of a frame", {d: None if value(d, "stereo_over_single") is None else value(d, "stereo_over_single") - 1
                                                          for d in DISTANCES}, lambda d, v: v <= 0.6)


# ---- How level of detail looks --------------------------------------------------------------------------------------------------


def look(shop, report, options):
    found = {}
    for style in ("bob",) if options.quick else STYLES:
        found.update(bench(shop, rf"^swr\.look\.{style}\." + ("20$" if options.quick else "")))
    curves = {metric: {} for metric in ("coverage", "radiance")}
    for (case, metric), value in found.items():
        _, _, style, height = case.split(".")
        curves[metric].setdefault(style, {})[int(height)] = value
    report.numbers["look"] = curves
    report.text("Look: level of detail over full detail", heading=True)
    report.text("Without the filter, at the same places of thousands of samples: standard errors are below 0.4 %. Coverage is opacity in sum "
                "over the picture, radiance the mean luminance of what is covered.")
    for metric, curve in curves.items():
        heights = sorted({h for points in curve.values() for h in points}, reverse=True)
        report.table([f"{metric}, by height in pixels", *map(str, heights)],
                     [[style, *(f"{points[h]:.3f}" if h in points else "" for h in heights)] for style, points in curve.items()])
        file = f"look-{metric}.svg"
        (report.folder / file).write_text(curve_picture(curve, heights, metric))
        report.picture(file, f"{metric.capitalize()} with level of detail over that of full detail, by the groom's height in pixels; gray: within 3 %.")
        worst = max(((abs(v - 1), v, style, h) for style, points in curve.items() for h, v in points.items()), default=None)
        if worst:
            report.verdict(f"LoD look: {metric} within 3 % from 2000 to 20 pixels", worst[0] <= 0.03,
                           f"worst {worst[1]:.3f}, {worst[2]} at {worst[3]} pixels")


def dolly(shop, report, options):
    names = ("psnr_full", "psnr_lod", "least_gain")
    found = {} if options.quick else bench(shop, r"^swr\.(slow_)?dolly\.")
    if not found:
        return
    report.numbers["dolly"] = [{"case": c, "metric": m, "value": v} for (c, m), v in found.items()]
    report.text("No pop: PSNR between neighboring frames of a dolly", heading=True)
    report.text("From 600 to 60 pixels of height in 60 frames, and from 120 to 105 (slow), with the filter; means over the frames, and the least "
                "that level of detail has over full detail in any of them. What pops lowers it, most of all in the slow one, where all "
                "else hardly moves.")
    cases = dict.fromkeys(c for c, _ in found)
    report.table(["", "full detail, dB", "LoD, dB", "least gain, dB"],
                 [[c.removeprefix("swr."), *(f"{found[c, n]:.2f}" for n in names)] for c in cases])
    for c in cases:
        gain = found[c, "least_gain"]
        report.verdict(f"{c.removeprefix('swr.')}: PSNR between frames of a dolly never below full detail's", gain >= 0, f"least {gain:+.2f} dB")


# ---- Figures ----------------------------------------------------------------------------------------------------------------------


def grown(shop, style, strands):
    """The file of a hair mesh, and its box."""
    file = f"grooms/{style}-{strands}.hairmesh"
    shop.make(["grow", "--hair-mesh", style, "--strands", str(strands)], [], file)
    told = subprocess.run([shop.pelage, "info", file, "--json"], cwd=shop.folder, check=True, capture_output=True, text=True).stdout
    return file, json.loads(told)["bounds"]


def before(shop, style, strands, pixels, size, **keys):
    """A scene of one groom on the mannequin, `pixels` of 1080 tall."""
    file, box = grown(shop, style, strands)
    center = [(a + b) / 2 for a, b in zip(box["lower"], box["upper"])]
    fov = 26
    away = (box["upper"][1] - box["lower"][1]) * 1080 / pixels / (2 * math.tan(math.radians(fov) / 2)) + 0.1
    azimuth, elevation = math.radians(-28), math.radians(6)
    back = (math.sin(azimuth) * math.cos(elevation), math.sin(elevation), math.cos(azimuth) * math.cos(elevation))
    width, height = (int(n) for n in size.split("x"))
    return {"camera": {"eye": [c + away * b for c, b in zip(center, back)], "target": center, "fov": fov}, "lights": LIGHTS,
            "environment": {"radiance": [0.32, 0.34, 0.38]}, "meshes": [{"shape": "mannequin"}],
            "grooms": [{"file": f"../{file}", **keys}],
            "settings": {"width": width, "height": height, "method": "swr", "opacity_map_size": 1024 if strands > 1000 else 64, "exposure": 0.5, "background": [0.12, 0.13, 0.15]}}, file


def shoot(shop, name, scene, groom, *arguments, suffix=".png"):
    """Renders, and returns the file."""
    file = f"scenes/{name}.json"
    (shop.folder / file).write_text(json.dumps(scene, indent=1) + "\n")
    output = f"pictures/{name}{suffix}"
    print(f"rendering {name}", flush=True)
    shop.make(["render", file, *arguments], [file, *([groom] if isinstance(groom, str) else groom)], output)
    return output


def cropped(shop, file, place, size, times):
    """`size` pixels a side around `place`, shares of the picture, magnified."""
    whole = read_png(shop.folder / file)
    return whole.crop(int(place[0] * whole.width - size / 2), int(place[1] * whole.height - size / 2), size, size).magnified(times)


def save(shop, report, name, lines, about):
    write_png(shop.folder / name, sheet(lines))
    report.picture(name, about)


FIGURE1 = (  # style, strands, λ, where its head stands (metres), by how much it turns away (degrees), color
    ("bob", 90000, 4, (-0.47, 0.0, 0.55), 18, {"eumelanin": 3, "pheomelanin": 0}),
    ("long-wavy", 127000, 5.5, (-0.22, 0.0, 0.16), -14, {"eumelanin": 0.3, "pheomelanin": 0.2}),
    ("curls", 127000, 2, (0.20, 0.0, -0.40), 12, {"eumelanin": 0.25, "pheomelanin": 1.4}),
    ("afro", 80000, 2.8, (0.62, 0.0, -1.00), -20, {"eumelanin": 5, "pheomelanin": 0}),
    ("ponytail", 59000, 3, (1.30, 0.0, -1.90), -75, {"eumelanin": 0.12, "pheomelanin": 0.1}))


def figure1(shop, report, options):
    size, thin = ((192, 108), 20) if options.quick else ((3840, 2160), 1)
    grooms, heads, files, eye = [], [], [ENVIRONMENT], [-0.35, 0.10, 2.3]
    write_environment(shop.folder / ENVIRONMENT, 128 if options.quick else 1024)
    for style, strands, density, place, aside, color in FIGURE1:
        file, _ = grown(shop, style, max(1000, strands // thin))
        turn = math.degrees(math.atan2(eye[0] - place[0], eye[2] - place[2])) + aside
        transform = {"translate": list(place), "rotate": [0, turn, 0]}
        grooms.append({"name": style, "file": f"../{file}", "lod_lambda": density, "transform": transform, "material": color})
        heads.append({"name": f"{style} head", "shape": "mannequin", "transform": transform, "color": [0.45, 0.31, 0.25], "roughness": 0.45})
        files.append(file)
    scene = {"camera": {"eye": eye, "target": [0.04, -0.15, -0.6], "fov": 20.5},
             "lights": [{**light, "intensity": [0.55 * x for x in light["intensity"]]} for light in LIGHTS],
             "environment": {"map": f"../{ENVIRONMENT}", "radiance": [0.5, 0.5, 0.5], "rotation": 60}, "meshes": heads, "grooms": grooms,
             "settings": {"width": size[0], "height": size[1], "method": "swr", "environment_lighting": "probe", "opacity_map_size": 64 if options.quick else 1024, "exposure": 0.6,
                          "background": [0.05, 0.055, 0.065]}}
    file = "scenes/figure1.json"
    (shop.folder / file).write_text(json.dumps(scene, indent=1) + "\n")
    output = "pictures/figure1.png"
    print("rendering figure 1", flush=True)
    stats = shop.make(["render", file], [file, *files], output, json_output=True)["told"]
    strands = next(s["items"] for s in stats["stages"] if s["stage"] == "lod")
    seconds = {s["stage"]: s["seconds"] for s in stats["stages"]}
    mib, hair = stats["peak_bytes"] / 2**20, sum(seconds[s] for s in ("lod", "raster", "shade", "filter.reconnect"))
    report.numbers["figure1"] = stats
    report.text("Figure 1: five grooms, one command", heading=True)
    told_size = f"{size[0]} × {size[1]}"
    report.picture(output, f"{sum(f[1] // thin for f in FIGURE1):,} strands in five grooms, {strands:,} of them drawn, {told_size}: level of detail "
                   f"(λ {', '.join(str(f[2]) for f in FIGURE1)}), filter, probe lighting with baked occlusion; {hair:.2f} s of hair, peak memory {mib:.0f} MiB. "
                   f"Again: `pelage render {file} -o figure1.png`.")
    report.verdict("figure 1: 483k strands, 4K, peak memory ≤ 1.5 GiB", None if options.quick else mib <= 1536, f"{mib:.0f} MiB")
    report.verdict("shading ≤ 20 % of a frame's hair (figure 1)", None if options.quick else seconds["shade"] <= 0.2 * hair,
                   f"{100 * seconds['shade'] / hair:.1f} %")


def figure4(shop, report, options):
    variants = {"full detail": {"lod": False}, "naive": {"thicken": False, "depth_correction": False}, "eq. 8": {"thicken": False}, "thickened": {}}
    tiles, told, first = [], [], None
    for name, swr in variants.items():
        scene, groom = before(shop, "long-wavy", options.strands, 200, options.size)
        scene["grooms"][0]["lod_lambda"] = 1
        hair = {**scene, "meshes": [], "settings": {**scene["settings"], "transparent_background": True, "swr": {**swr, "filter": False}}}
        linear = shoot(shop, f"figure4-{name.replace(' ', '-').replace('.', '')}", hair, groom, "--float", suffix=".exr")
        first = first or linear
        done = subprocess.run([shop.pelage, "compare", linear, first, "--mask", "hair", "--metrics", "energy", "--json"], cwd=shop.folder,
                              check=True, capture_output=True, text=True)
        told.append(f"{name} {json.loads(done.stdout)['energy']:.3f}")
        scene["settings"]["swr"] = swr
        picture = shoot(shop, f"figure4-{name.replace(' ', '-').replace('.', '')}", scene, groom)
        tiles.append(cropped(shop, picture, (0.5, 0.5), options.tile // 3, 3))
    report.text("Figure 4: shadows where strands are left out", heading=True)
    save(shop, report, "figure4.png", [tiles], f"Long waves, 200 pixels tall, λ 1, maps of light of all strands: {', '.join(variants)}. Naive: fewer "
         "strands are seen too deep in the hair, where the maps hold little light. Thickened, the default here, they hide what is behind as all did. "
         f"Light of the hair alone over that of full detail, without filter: {', '.join(told)}.")


def figure5(shop, report, options):
    scene, groom = before(shop, "curls", options.strands, 1000, options.size)
    jobs = {"1 sample": ["--no-filter"], "touched": ["--method", "msaa", "--view", "coverage", "--spp", "16"], "1 + filter": [], "MSAA 8": ["--spp", "8"],
            f"{options.reference_spp} samples": ["--method", "ssaa", "--spp", str(options.reference_spp)]}
    pictures = {name: shoot(shop, f"figure5-{name.replace(' ', '-').replace('+', 'and')}", scene, groom, *arguments)
                for name, arguments in jobs.items()}
    size = options.tile // 10
    places = (loneliest(read_png(shop.folder / pictures["touched"]), size), LOCK_END)
    lines = [[] for _ in places]
    for name, picture in pictures.items():
        for line, place in zip(lines, places):
            tile = cropped(shop, picture, place, size, 6)
            line.append(tile.threshold() if name == "touched" else tile)
    report.text("Figure 5: lone strands", heading=True)
    save(shop, report, "figure5.png", lines, f"Curls, {options.tile // 10} pixels magnified six times: {', '.join(jobs)}. Touched: pixels of which any of "
         "16 samples hits hair, all that the conservative layer can tell.")


LOCK_END = (0.604, 0.745)  # where locks thin out; shares of the picture


def loneliest(picture, size):
    """Middle of the square of `size` pixels with the most lone ones: not black, with at most three neighbors that are not."""
    touched = [[any(row[i:i + 3]) for i in range(0, len(row), 3)] for row in picture.rows]
    lone, step = {}, size // 2
    for y in range(1, picture.height - 1):
        above, row, below = touched[y - 1:y + 2]
        for x in range(1, picture.width - 1):
            if row[x] and sum(above[x - 1:x + 2]) + row[x - 1] + row[x + 1] + sum(below[x - 1:x + 2]) <= 3:
                cell = x // step, y // step
                lone[cell] = lone.get(cell, 0) + 1
    corner = max(sorted(lone), key=lambda c: sum(lone.get((c[0] + i, c[1] + j), 0) for i in (0, 1) for j in (0, 1)), default=(0, 0))
    return (corner[0] + 1) * step / picture.width, (corner[1] + 1) * step / picture.height


def figure6(shop, report, options):
    tiles = []
    for name, arguments in (("without", ["--no-occlusion"]), ("with", [])):
        scene, groom = before(shop, "long-wavy", options.strands, 1000, options.size)
        del scene["lights"][:]
        scene["environment"] = {"map": f"../{ENVIRONMENT}", "radiance": [1.6, 1.6, 1.6], "rotation": 60}
        scene["settings"]["environment_lighting"] = "probe"
        write_environment(shop.folder / ENVIRONMENT, 128 if options.quick else 1024)
        picture = shoot(shop, f"figure6-{name}-occlusion", scene, [groom, ENVIRONMENT], *arguments)
        tiles.append(cropped(shop, picture, (0.5, 0.5), options.tile * 10 // 7, 1))
    report.text("Figure 6: baked occlusion", heading=True)
    save(shop, report, "figure6.png", [tiles], "Lit by an environment alone, as a probe: without and with the occlusion that is baked into the hair mesh.")


def figure7(shop, report, options):
    kinds = {"1 sample": ["--no-filter", "--no-lod"], "1 + filter": ["--no-lod"], "1 + filter + LoD": [], "MSAA 8": ["--spp", "8", "--no-lod"]}
    report.text("Figure 7: close, mid and far", heading=True)
    for style in GROOMS if not options.quick else ["curls"]:
        lines = []
        for name, arguments in kinds.items():
            line = []
            for distance, pixels in DISTANCES.items():
                scene, groom = before(shop, style, options.strands, pixels, options.size)
                picture = shoot(shop, f"figure7-{style}-{distance}-{name.replace(' ', '')}", scene, groom, *arguments)
                times = {"close": 1, "mid": 2, "far": 10}[distance]
                line.append(cropped(shop, picture, (0.5, 0.5), options.tile // times, times))
            lines.append(line)
        save(shop, report, f"figure7-{style}.png", lines, f"{style}, {', '.join(f'{d} ({p} pixels tall)' for d, p in DISTANCES.items())}; magnified 1, 2 and 10 "
             f"times. From above: {', '.join(kinds)}.")


# ---- The whole ----------------------------------------------------------------------------------------------------------------------


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="few strands, pixels and cases, to see that everything works")
    parser.add_argument("-o", "--out", default="out/swr", help="folder of everything (%(default)s)")
    parser.add_argument("--only", default="", metavar="REGEX", help=f"parts whose names match: {', '.join(PARTS)}")
    parser.add_argument("--pelage", default=os.environ.get("PELAGE", str(ROOT / "build/release/bin/pelage")), help="program (%(default)s)")
    parser.add_argument("--reference-spp", type=int, help="samples of figure 5's reference (64; 4 with --quick)")
    options = parser.parse_args()
    options.size, options.tile, options.strands = ("160x90", 60, 1000) if options.quick else ("1920x1080", 700, 127000)
    options.reference_spp = options.reference_spp or (4 if options.quick else 64)
    return options


def main():
    options = parse_options()
    folder, pelage = pathlib.Path(options.out).resolve(), program(options.pelage)
    chosen = [p for p in PARTS if re.search(options.only, p)]
    if not chosen:
        raise SystemExit(f"no part matches {options.only}")
    (folder / "scenes").mkdir(parents=True, exist_ok=True)
    shop, report = Workshop(pelage, folder), Report(folder, "Method swr", "swr", ABOUT)
    for i, part in enumerate(chosen):
        print(f"[{i + 1}/{len(chosen)}] {part}", flush=True)
        try:
            globals()[part](shop, report, options)
        except Failure as failure:
            raise SystemExit(f"{part}: pelage failed: {failure}")
        report.write()
    print(f"\nOpen {folder / 'index.html'}; the same as Markdown: {folder / 'swr.md'}")


if __name__ == "__main__":
    run(main)
