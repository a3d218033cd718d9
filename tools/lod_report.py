#!/usr/bin/env python3
"""Makes the report of level of detail with thick hairs (Huang 2025) with one command: its table of goals, figures 4, 6, 7, 9, 11, 12 and 13, every
hairstyle in every color and light near, middle and far beside path tracing, and which kind of level of detail wins where.

  tools/lod_report.py [--quick] [-o out/lod] [--only REGEX] [--styles …] [--colors …] [--lights …] [--shots …]

Parts: construction, look, traced, worlds, speed, dolly, still, motion, aggregate, knit. What the same command of the same program has made is kept, so a
run that was stopped goes on where it was; path-traced pictures stay good for any program that traces the same, in the folder --cache
(tools/reference_cache.py). Of the look, 192 pictures are path traced: --styles and the like choose a part. At the end stand
OUT/index.html, which holds its pictures, OUT/lod.md and OUT/lod.json. For `speed`, let nothing else run.
"""
import argparse
import json
import math
import os
import pathlib
import re
import statistics
import subprocess

from demo_report import ROOT, Failure, Workshop, program, run
from lod_stage import COLORS, FALL, SHOTS, Shot, Stage, TraceCache, compare, groom, stage_items, stage_seconds, tell, work
from png_sheet import sheet, write_png
from report_page import Report, bench, curve_picture, scatter_picture

ABOUT = "Level of detail with thick hairs beside Huang 2025: 100,000 strands of 64 points where nothing else is said."
STYLES = ("straight", "wavy", "curly", "afro")
LIGHTS = (0, 45, 90, 180)  # degrees from where the eye is
SHARES = (0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.003)
FIBER = ["--lod-scattering", "fiber"]
METHODS = {  # name: (label, options of `pelage render`)
    "full": ("all strands", ["--no-lod"]),
    "thick": ("thick hairs", []),
    "fiber": ("thick, one fiber's", FIBER),
    "strands": ("thinned strands", ["--lod-as", "strands", *FIBER]),
    "bundles": ("thinned, as bundles", ["--lod-as", "strands"]),
    "cards": ("cards", ["--lod-as", "cards", *FIBER])}
SHAPES = ("thick", "strands", "cards")
DOLLY = {name: METHODS[name] for name in ("full", *SHAPES)}
DOLLY["blend"] = ("thick hairs that blend", ["--lod-pixels", "2.3", "--lod-blend", "0.25"])
PARTS = ("construction", "look", "traced", "worlds", "speed", "dolly", "still", "motion", "aggregate", "knit")


# ---- Construction ---------------------------------------------------------------------------------------------------------------------------


def construction(shop, report, options):
    rows, seconds, shares = [], {}, {}
    for style in options.styles:
        _, file, built = groom(shop, style, options)
        lod = tell(shop, "info", file)["lod"]
        seconds[style], shares[style] = built["told"]["seconds"], lod["bytes"] / lod["groom_bytes"]
        rows.append([style, f"{seconds[style]:.1f}", f"{100 * shares[style]:.1f} %", ", ".join(f"{level['hairs']:,}" for level in lod["levels"])])
    report.text("Construction and memory", heading=True)
    report.table(["", "seconds", "memory over the strands'", "thick hairs by level"], rows)
    report.numbers["construction"] = {"seconds": seconds, "memory": shares}
    report.verdict("construction ≤ 30 s", max(seconds.values()) <= 30 if options.whole else None, f"{max(seconds.values()):.1f} s at most")
    report.verdict("extra memory ≤ 78 %", max(shares.values()) <= 0.78, f"{100 * max(shares.values()):.1f} % at most")


# ---- Look: beside path tracing ------------------------------------------------------------------------------------------------------------


def look(shop, report, options):
    cache = TraceCache(shop, options.cache)
    report.text("Look: near, middle and far beside path tracing", heading=True)
    report.text(f"FLIP over the pixels of hair, {options.size}² pixels near, twice as many a side in the middle, four times far away, against {options.samples} paths a pixel through all strands; the noise of these paths is in "
                f"every number. Hair takes 60, 20 and 2 % of the picture. Light falls by {-FALL}° and is turned away from the eye by 0°, 45°, 90° and 180°.")
    found = {}
    for style in options.styles:
        stage = Stage(shop, style, options)
        for shot in options.shots:
            lines = []
            for color in options.colors:
                for light in options.lights:
                    lines.append(look_at(Shot(stage, shot, color, light), cache, found, options))
                    print(f"look: {len(found)} of {len(options.styles) * len(options.shots) * len(options.colors) * len(options.lights)}", flush=True)
            write_png(shop.folder / f"look-{style}-{shot}.png", sheet(lines, gap=4))
            report.picture(f"look-{style}-{shot}.png", f"{style}, {shot}. From the left: path traced, {', '.join(l for l, _ in METHODS.values())}. From above: "
                           f"{', '.join(options.colors)}, each with light at {', '.join(f'{a}°' for a in options.lights)}.")
    look_tables(report, found)


def look_at(shot, cache, found, options):
    """Measures all methods, and returns the tiles of truth and methods."""
    truth = shot.truth(cache)
    tiles, flips = [shot.tile(pathlib.Path(truth).with_suffix(".png"), options.tile)], {}
    for name, (_, arguments) in METHODS.items():
        picture, shown, _ = shot.picture(name, arguments)
        flips[name] = shot.flip(picture, truth)
        tiles.append(shot.tile(shown, options.tile))
    found[shot.stage.style, shot.shot, shot.color, shot.light] = flips
    return tiles


def look_tables(report, found):
    report.numbers["look"] = [{"case": "-".join(map(str, case)), **flips} for case, flips in found.items()]
    groups = {"shot": 1, "hairstyle": 0, "color": 2, "light": 3}
    for what, axis in groups.items():
        rows = []
        for value in dict.fromkeys(case[axis] for case in found):
            some = [flips for case, flips in found.items() if case[axis] == value]
            rows.append([f"{value}{'°' if what == 'light' else ''}", *(f"{statistics.mean(f[m] for f in some):.4f}" for m in METHODS)])
        report.table([f"FLIP, mean by {what}", *(label for label, _ in METHODS.values())], rows)
    limits = {"near": 1, "middle": 1, "far": 1.1}
    for shot in dict.fromkeys(case[1] for case in found):
        ratios = {case: f["thick"] / f["full"] for case, f in found.items() if case[1] == shot}
        worst = max(ratios, key=ratios.get)
        good = sum(r < limits[shot] or r <= 1 for r in ratios.values())
        goal = "below full geometry's with dual scattering" if limits[shot] == 1 else "within 10 % of full geometry's"
        report.verdict(f"FLIP {shot}, thick hairs: {goal}, in every case", good == len(ratios),
                       f"{good} of {len(ratios)} cases; mean ratio {statistics.mean(ratios.values()):.3f}, worst {ratios[worst]:.3f} ({'-'.join(map(str, worst))})")


def second(values):
    """The one that parts take which show one of them."""
    return values[min(1, len(values) - 1)]


def traced(shop, report, options):
    report.text("Thick hairs in the path tracer (figure 4)", heading=True)
    if not offers(shop, "trace", "--lod"):
        report.text("Left out: this program traces no thick hairs.")
        report.verdict("thick hairs in the path tracer too", None, "left out: no `pelage trace --lod`")
        return
    cache, lines, rows, flips = TraceCache(shop, options.cache), [], [], []
    for style in options.styles:
        stage = Stage(shop, style, options)
        for name in options.shots:
            shot = Shot(stage, name, second(options.colors), second(options.lights))
            file, truth = stage.write(shot.name, shot.scene), shot.truth(cache)
            thick, _ = cache.picture([file, "--lod"], [file, stage.file], options.samples, f"{shot.name}-thick")
            energy = shot.energy(thick, truth)
            flips.append(shot.flip(thick, truth))
            rows.append([f"{style}, {name}", f"{flips[-1]:.4f}", f"{energy:.3f}"])
            lines.append([shot.tile(pathlib.Path(f).with_suffix(".png"), options.tile) for f in (truth, thick)])
    write_png(shop.folder / "traced.png", sheet(lines, gap=4))
    report.picture("traced.png", f"Path traced: all strands, thick hairs. From above: {', '.join(r[0] for r in rows)}.")
    report.table(["path traced", "FLIP, with the noise of both", "light over that of all strands"], rows)
    report.verdict("thick hairs in the path tracer too", None, f"no goal is set; FLIP {statistics.mean(flips):.4f} beside all strands, noise of both included")


# ---- Which world wins where --------------------------------------------------------------------------------------------------------------------


def kinds_of_detail(options):
    """{label: [(name, options of `pelage render`)]}, of each kind fewer and fewer segments."""
    by_width = {**{k: METHODS[k] for k in ("thick", "fiber", "strands", "bundles", "cards")}, "card-bundles": ("cards, as bundles", ["--lod-as", "cards"])}
    kinds = {label: [(f"{name}-{w}", [*arguments, "--lod-pixels", str(w)]) for w in options.widths] for name, (label, arguments) in by_width.items()}
    return {**kinds, "thick, by error": [(f"error-{e}", ["--lod-error", str(e)]) for e in options.errors]}


def worlds(shop, report, options):
    cache = TraceCache(shop, options.cache)
    color, light = second(options.colors), second(options.lights)
    report.text("Which world wins where", heading=True)
    report.text("FLIP against path tracing over the number of segments that are drawn and over the time of the frame, as widths on the screen "
                f"({', '.join(map(str, options.widths))} pixels) or predicted errors ({', '.join(map(str, options.errors))}) allow fewer and fewer; all strands for "
                f"comparison. {color}, light at {light}°. "
                "Segments of cards are runs of texels, which on a GPU would be a texture (docs/lod.md).")
    told = []
    for style in options.styles:
        stage = Stage(shop, style, options)
        for name in options.shots[:1] if options.quick else options.shots:
            shot, curves = Shot(stage, name, color, light), {}
            truth = shot.truth(cache)
            picture, _, stamp = shot.picture("full", METHODS["full"][1])
            curves["all strands"] = [(stage_items(stamp["told"], "groom") - options.strands, work(stamp), shot.flip(picture, truth))]
            for label, steps in kinds_of_detail(options).items():
                for step, arguments in steps:
                    picture, _, stamp = shot.picture(step, arguments)
                    curves.setdefault(label, []).append((stage_items(stamp["told"], "lod"), work(stamp), shot.flip(picture, truth)))
            told += [{"style": style, "shot": name, "kind": k, "segments": a, "seconds": b, "flip": c} for k, points in curves.items() for a, b, c in points]
            for axis, what in ((0, "segments"), (1, "seconds")):
                file = f"worlds-{style}-{name}-{what}.svg"
                (shop.folder / file).write_text(scatter_picture({k: [(p[axis], p[2]) for p in points] for k, points in curves.items()}, what, "FLIP"))
                report.picture(file, f"{style}, {name}: FLIP over {what}.")
    report.numbers["worlds"] = told
    worlds_plot(shop, report, told)
    worlds_table(report, told)


def worlds_plot(shop, report, told):
    """All pictures in one plot: steps of each kind, means over hairstyles and distances."""
    whole = {(t["style"], t["shot"]): t for t in told if t["kind"] == "all strands"}
    seen = {}  # by kind and case, in order of the steps
    for t in told:
        seen.setdefault(t["kind"], {}).setdefault((t["style"], t["shot"]), []).append(t)
    curves = {}
    for kind, cases in seen.items():
        for steps in zip(*([(t["segments"] / whole[case]["segments"], t["flip"] / whole[case]["flip"]) for t in some] for case, some in cases.items())):
            curves.setdefault(kind, []).append((statistics.geometric_mean(s[0] for s in steps), statistics.mean(s[1] for s in steps)))
    (shop.folder / "worlds.svg").write_text(scatter_picture(curves, "segments over those of all strands", "FLIP over all strands'"))
    report.picture("worlds.svg", f"All of {len(whole)} pictures: mean of FLIP over that of all strands, over segments drawn (geometric mean).")
    report.table(["kind", "segments: FLIP over all strands', means of all pictures"], [[kind, ", ".join(f"{100 * x:.3g} %: {y:.3f}" for x, y in curve)] for kind, curve in curves.items()])


def worlds_table(report, told):
    """Of each picture, who errs least with the segments of thick hairs at the default width or fewer."""
    rows = []
    for style, shot in dict.fromkeys((t["style"], t["shot"]) for t in told):
        here = [t for t in told if (t["style"], t["shot"]) == (style, shot) and t["kind"] != "all strands"]
        budget = sorted(t["segments"] for t in here if t["kind"] == METHODS["thick"][0])[-2:][0]
        best = {}
        for t in here:
            if t["segments"] <= 1.05 * budget:
                best[t["kind"]] = min(best.get(t["kind"], math.inf), t["flip"])
        ranked = sorted(best, key=best.get)
        rows.append([f"{style}, {shot}", f"{budget:,.0f}", ", ".join(f"{k} {best[k]:.4f}" for k in ranked)])
    report.table(["within as many segments", "segments", "least FLIP, best first"], rows)


# ---- Speed ---------------------------------------------------------------------------------------------------------------------------------------


def timed(shop, file, arguments):
    """What one run tells. Never kept."""
    return tell(shop, "render", file, *arguments, "-o", "pictures/timed.png")


def paired(shop, stage, share, options):
    """[(told with all strands, told with thick hairs)], one after the other; kept for the program that was timed."""
    name = f"speed-{stage.style}-{share}"
    file = stage.write(name, stage.scene(stage.distance(share), options.speed_size, head=False))
    note, stamp = shop.folder / f"{name}.json", shop.stamp([options.speed_size, options.runs], [file, stage.file])
    if note.exists() and (kept := json.loads(note.read_text()))["stamp"] == stamp:
        return kept["runs"]
    print(f"timing {stage.style} at {100 * share:g} %", flush=True)
    runs = [[timed(shop, file, ["--no-lod"]), timed(shop, file, [])] for _ in range(options.runs)]
    note.write_text(json.dumps({"stamp": stamp, "runs": runs}))
    return runs


def speed(shop, report, options):
    goals = {0.5: 0.99, 0.1: 2, 0.003: 13}
    report.text("Speed against the share of the screen (figure 7)", heading=True)
    report.text(f"Hair alone, {options.speed_size}² pixels, 8 samples, one light; medians of {options.runs} paired runs, all strands and thick hairs in turn, maps of light made anew in each "
                "frame, reading and writing files not counted. `lod.choose` chooses levels, `lod` makes what is drawn of them.")
    stage = Stage(shop, options.styles[0], options)
    found = {share: paired(shop, stage, share, options) for share in options.shares}
    stages = [s["stage"] for s in next(iter(found.values()))[0][1]["stages"] if not s["stage"].startswith("io.")]
    rows, ratios, selection = [], {}, {}
    for share, runs in found.items():
        def total(told):
            return sum(s["seconds"] for s in told["stages"] if not s["stage"].startswith("io."))
        ratios[share] = statistics.median(total(a) / total(b) for a, b in runs)
        thick = statistics.median(total(b) for _, b in runs)
        selection[share] = statistics.median(stage_seconds(b, "lod.choose") / total(b) for _, b in runs)
        rows.append([f"{100 * share:g} %", f"{1e3 * statistics.median(total(a) for a, _ in runs):.1f}", f"{1e3 * thick:.1f}", f"{ratios[share]:.2f}",
                     *(f"{1e3 * statistics.median(stage_seconds(a, s) for a, _ in runs):.1f} / {1e3 * statistics.median(stage_seconds(b, s) for _, b in runs):.1f}" for s in stages)])
        if share in goals:
            report.verdict(f"speed ≥ {goals[share]}× at {100 * share:g} % of the screen", ratios[share] >= goals[share] if options.whole else None,
                           f"{ratios[share]:.2f}×, {stage.style}")
    report.table(["hair takes", "all strands, ms", "thick hairs, ms", "times as fast", *(f"{s}, ms" for s in stages)], rows)
    report.numbers["speed"] = {"ratio": ratios, "selection": selection}
    worst = max(selection, key=selection.get)
    report.verdict("selection ≤ 2 % of the frame", all(v <= 0.02 for v in selection.values()) if options.whole else None,
                   f"stage lod.choose: {100 * selection[worst]:.1f} % at {100 * worst:g} %, {100 * min(selection.values()):.1f} % at least")


# ---- Smoothness -----------------------------------------------------------------------------------------------------------------------------------


def dolly(shop, report, options):
    report.text("A dolly, from 30 % of the screen to 1 % (figure 6)", heading=True)
    report.text(f"{options.frames} frames of {options.dolly_size}² pixels, hair alone on black, each made by itself. PSNR is between neighboring frames as a display shows them; "
                "light and coverage are those of thick hairs over those of all strands, in sum over the picture, radiance is light over coverage.")
    for style in options.dolly_styles:
        stage, ratios, psnr = Stage(shop, style, options), {}, {name: [] for name in DOLLY}
        first, last = (stage.distance(s) for s in (0.3, 0.01))
        away = [first * (last / first) ** (i / (options.frames - 1)) for i in range(options.frames)]
        before = {}
        for i, distance in enumerate(away):
            light, cover = dolly_frame(shop, stage, f"dolly-{style}-{i}", distance, options)
            for name in DOLLY:
                if i:
                    psnr[name].append(compare(shop, light[name], before[name], "--tone-map", "aces", "--metrics", "psnr")["psnr"])
            for name in [name for name in DOLLY if name != "full"]:
                energy = compare(shop, light[name], light["full"], "--metrics", "energy")["energy"]
                covered = compare(shop, cover[name], cover["full"], "--metrics", "energy")["energy"]
                ratios.setdefault(name, []).append((covered, energy / covered))
            before = light
            print(f"dolly: {style}, {i + 1} of {options.frames}", flush=True)
        dolly_tables(shop, report, style, away, psnr, ratios)


def dolly_frame(shop, stage, name, distance, options):
    """({method: picture}, {method: its coverage})."""
    scene, light, cover = stage.scene(distance, options.dolly_size, head=False, background=(0, 0, 0)), {}, {}
    for method, (_, arguments) in DOLLY.items():
        light[method], _ = stage.render(name, scene, *arguments, "--float", output=f"pictures/{name}-{method}.exr")
        cover[method], _ = stage.render(name, scene, *arguments, "--float", "--view", "coverage", output=f"pictures/{name}-{method}-coverage.exr")
    return light, cover


def dolly_tables(shop, report, style, away, psnr, ratios):
    labels = {name: label for name, (label, _) in DOLLY.items()}
    gains = [a - b for a, b in zip(psnr["thick"], psnr["full"])]
    report.table([f"PSNR between frames, {style}", "mean, dB", "least, dB", "least over all strands, dB"],
                 [[labels[n], f"{statistics.mean(v):.2f}", f"{min(v):.2f}", f"{min(a - b for a, b in zip(v, psnr['full'])):+.2f}"] for n, v in psnr.items()])
    report.verdict(f"dolly, {style}: adjacent-frame PSNR never below full geometry's", min(gains) >= 0,
                   f"least {min(gains):+.2f} dB, {sum(g >= 0 for g in gains)} of {len(gains)} steps, mean {statistics.mean(gains):+.2f} dB")
    for at, what in enumerate(("coverage", "radiance")):
        near = [round(1 / d, 3) for d in away]
        curves = {labels[n]: {x: v[at] for x, v in zip(near, values)} for n, values in ratios.items()}
        file = f"dolly-{style}-{what}.svg"
        (shop.folder / file).write_text(curve_picture(curves, near, what, 0.02, near[::max(1, len(near) // 6)]))
        report.picture(file, f"{style}: {what} over that of all strands, by 1 / meters of distance; gray: within 2 %.")
        values = [v[at] for v in ratios["thick"]]
        steps = [abs(b / a - 1) for a, b in zip(values, values[1:])]
        report.verdict(f"dolly, {style}: mean hair {what} within 2 % across every level change", max(abs(v - 1) for v in values) <= 0.02,
                       f"{min(values):.3f} to {max(values):.3f} of all strands'; largest step between frames {100 * max(steps):.2f} %")
    report.numbers[f"dolly {style}"] = {"psnr": psnr, "ratios": ratios, "metres": away}


def still(shop, report, options):
    stage = Stage(shop, options.styles[0], options)
    scene = stage.write("still", stage.scene(stage.distance(SHOTS["middle"]), options.dolly_size, head=False))
    (shop.folder / "still").mkdir(exist_ok=True)
    tell(shop, "render", scene, "--view", "lod", "--frames", "60", "--orbit", "0", "-o", "still/still.####.png")
    frames = [f.read_bytes() for f in sorted((shop.folder / "still").glob("still.*.png"))]
    flips = sum(a != b for a, b in zip(frames, frames[1:]))
    report.text("A still camera", heading=True)
    report.text(f"{len(frames)} frames in which nothing moves: {flips} of them show other levels than the one before.")
    report.verdict("zero flips in 60 still frames", flips == 0 and len(frames) == 60, f"{flips} in {len(frames)} frames")
    picture, _ = stage.render("still", stage.scene(stage.distance(SHOTS["middle"]), options.dolly_size, head=False), "--view", "lod",
                              output="pictures/levels.png")
    report.picture(picture, "Levels in one of them: strands gray, thick hairs from the coarsest in red, orange, yellow, green, cyan.")


def offers(shop, *words):
    """Whether the program's help knows a verb or a word of it."""
    done = subprocess.run([shop.pelage, *words[:-1], "--help"], capture_output=True, text=True)
    return done.returncode == 0 and re.search(rf"(?<![\w-]){re.escape(words[-1])}(?![\w-])", done.stdout) is not None


def motion(shop, report, options):
    report.text("Hair that moves (figure 9)", heading=True)
    if not offers(shop, "simulate"):
        report.text("Left out: this program cannot simulate.")
        report.verdict("a simulated sequence: adjacent-frame PSNR never below full geometry's", None, "left out: no `pelage simulate`")
        return
    moved_sequence(shop, report, options)


def moved_sequence(shop, report, options):
    stage, count = Stage(shop, options.styles[0], options), options.moving_frames
    moving = f"grooms/{stage.style}-{options.strands}-moving.pelage"
    shop.make(["simulate", stage.file, "--frames", f"1-{count}", "--motion", "turn", "--wind", "3,0,1"], [stage.file], moving)
    scene = stage.scene(stage.distance(SHOTS["middle"]), options.dolly_size, head=False, background=(0, 0, 0))
    scene["grooms"][0]["file"] = f"../{moving}"
    file, psnr = stage.write("moving", scene), {}
    for name in ("full", *SHAPES):
        tell(shop, "render", file, *METHODS[name][1], "--frames", f"1-{count}", "-o", f"pictures/moving-{name}.####.png")
        frames = sorted((shop.folder / "pictures").glob(f"moving-{name}.*.png"))
        psnr[name] = [compare(shop, str(b), str(a), "--metrics", "psnr")["psnr"] for a, b in zip(frames, frames[1:])]
    gains = [a - b for a, b in zip(psnr["thick"], psnr["full"])]
    report.table(["PSNR between frames", "mean, dB", "least, dB"],
                 [[METHODS[n][0], f"{statistics.mean(v):.2f}", f"{min(v):.2f}"] for n, v in psnr.items()])
    report.numbers["motion"] = psnr
    report.verdict("a simulated sequence: adjacent-frame PSNR never below full geometry's", min(gains) >= 0,
                   f"least {min(gains):+.2f} dB, {sum(g >= 0 for g in gains)} of {len(gains)} steps, mean {statistics.mean(gains):+.2f} dB")


# ---- Scattering of bundles ---------------------------------------------------------------------------------------------------------------------------


def aggregate(shop, report, options):
    models = {"ours": "ours", "huang": "Huang 2025", "huang-no-a1plus": "without A_1+ (figure 11)", "huang-no-s": "without S (figure 12)",
              "huang-buffon": "Buffon's n", "huang-fitted": "fitted constants", "zhu2023": "Zhu 2023"}
    found = bench(shop, r"^aggregate\.error\." + (r"zhu\.blond\.circle\." if options.quick else ""))
    errors = {}
    for (case, _), value in found.items():
        *panel, model = case.split(".")[2:]
        errors.setdefault(model, {})[".".join(panel)] = value
    report.text("Scattering of bundles (figures 10, 11 and 12)", heading=True)
    report.text("Mean of the relative errors of three profiles, over azimuth and over inclination on both sides, against path-traced bundles of 100 random fibers "
                "(docs/derivations/aggregated_scattering.md).")
    report.table(["", "mean over panels", "best", "worst"],
                 [[label, f"{statistics.mean(errors[m].values()):.3f}", f"{min(errors[m].values()):.3f}", f"{max(errors[m].values()):.3f}"]
                  for m, label in models.items() if m in errors])
    report.numbers["aggregate"] = errors
    closer = [p for p, e in errors["ours"].items() if e < errors["zhu2023"][p]]
    worst = max(e / errors["zhu2023"][p] for p, e in errors["ours"].items())
    report.verdict("aggregate closer to traced bundles than Zhu 2023 in every panel", len(closer) == len(errors["ours"]),
                   f"{len(closer)} of {len(errors['ours'])} panels, at most {worst:.2f} of its error")


class Cloth(Stage):
    """A knit patch, seen from before it."""
    azimuth, mannequin = 15, []

    def grown(self):
        plain, file = f"grooms/{self.style}.pelage", f"grooms/{self.style}-lod.pelage"
        few = ["--strands", str(self.options.strands), "--wales", "6", "--courses", "7"] if not self.options.whole else []
        self.shop.make(["grow", self.style, *few], [], plain)
        self.shop.make(["lod", "build", plain, "--guides", "0"], [plain], file, json_output=True)
        return plain, file


def knit(shop, report, options):
    report.text("Knit patches (figure 13)", heading=True)
    grow = subprocess.run([shop.pelage, "grow", "--help"], capture_output=True, text=True).stdout
    kinds = sorted(set(re.findall(r"\bknit-[a-z]+", grow)))[:2]
    if not kinds:
        report.text("Left out: this program grows no knit.")
        report.verdict("two knit patches", None, "left out: no `pelage grow knit-…`")
        return
    cache, lines, rows, better = TraceCache(shop, options.cache), [], [], []
    for kind in kinds:
        stage = Cloth(shop, kind, options)
        for name in ("near", "far"):
            shot = Shot(stage, name, options.colors[0], second(options.lights))
            truth, pictures = shot.truth(cache), {METHODS[m][0]: shot.picture(m, METHODS[m][1])[0] for m in ("full", "thick", "fiber")}
            pictures["thick hairs, path traced"], _ = cache.picture([stage.write(shot.name, shot.scene), "--lod"], [f"scenes/{shot.name}.json", stage.file],
                                                                    options.samples, f"{shot.name}-thick")
            flips = {label: shot.flip(file, truth) for label, file in pictures.items()}
            rows.append([f"{kind}, {name}", *(f"{flips[l]:.4f}, {shot.energy(f, truth):.3f}" for l, f in pictures.items())])
            better.append(flips[METHODS["thick"][0]] / flips[METHODS["full"][0]])
            lines.append([shot.tile(pathlib.Path(f).with_suffix(".png"), 2 * options.tile) for f in (truth, *pictures.values())])
    write_png(shop.folder / "knit.png", sheet(lines, gap=4))
    report.picture("knit.png", f"From the left: path traced, {', '.join(pictures)}. From above: {', '.join(row[0] for row in rows)}.")
    report.table(["FLIP; light over that path traced", *pictures], rows)
    report.verdict("two knit patches", len(kinds) == 2, f"{', '.join(kinds)}: FLIP of thick hairs {min(better):.2f} to {max(better):.2f} of all fibers'")


# ---- The whole -----------------------------------------------------------------------------------------------------------------------------------------


def chosen(text, known):
    """Those of `known` that are named in `text`, A,B,…; all without it."""
    names = {str(k): k for k in known}
    wrong = [w for w in (text or "").split(",") if w and w not in names]
    if wrong:
        raise SystemExit(f"{', '.join(wrong)}: choose from {', '.join(names)}")
    return [k for name, k in names.items() if not text or name in text.split(",")]


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="few strands, pixels and cases, to see that everything works")
    parser.add_argument("-o", "--out", default="out/lod", help="folder of everything (%(default)s)")
    parser.add_argument("--only", default="", metavar="REGEX", help=f"parts whose names match: {', '.join(PARTS)}")
    parser.add_argument("--pelage", default=os.environ.get("PELAGE", str(ROOT / "build/release/bin/pelage")), help="program (%(default)s)")
    parser.add_argument("--cache", help="folder of path-traced pictures (OUT/references)")
    for axis, known in (("styles", STYLES), ("colors", COLORS), ("lights", LIGHTS), ("shots", SHOTS)):
        parser.add_argument(f"--{axis}", metavar="A,B", help=f"only these: {', '.join(map(str, known))}")
    parser.add_argument("--size", type=int, help="pixels of a side, of the look near; twice as many in the middle, four times far away (256; 32 with --quick)")
    parser.add_argument("--samples", type=int, help="paths a pixel of the look's references (64; 4 with --quick)")
    parser.add_argument("--strands", type=int, help="of each groom (100000; 1000 with --quick)")
    parser.add_argument("--frames", type=int, help="of the dolly (60; 3 with --quick)")
    parser.add_argument("--runs", type=int, help="paired runs of each time (5; 1 with --quick)")
    options = parser.parse_args()
    quick = options.quick
    options.styles, options.shots = chosen(options.styles, STYLES[:1] if quick else STYLES), chosen(options.shots, ("middle", "far") if quick else SHOTS)
    options.colors, options.lights = chosen(options.colors, ("light-brown",) if quick else COLORS), chosen(options.lights, LIGHTS[:1] if quick else LIGHTS)
    options.size, options.samples = options.size or (32 if quick else 256), options.samples or (4 if quick else 64)
    options.strands, options.runs = options.strands or (1000 if quick else 100000), options.runs or (1 if quick else 5)
    options.whole = options.strands == 100000
    options.tile, options.render_samples = (64, 4) if quick else (128, 16)
    options.widths, options.shares = ((2, 8), (0.5, 0.003)) if quick else ((1, 2, 4, 8), SHARES)
    options.errors = (0.05, 0.1) if quick else (0.02, 0.04, 0.08, 0.16)
    options.speed_size, options.dolly_size = (64, 48) if quick else (1024, 256)
    options.frames, options.moving_frames = options.frames or (3 if quick else 60), 3 if quick else 48
    options.dolly_styles = options.styles[:1] + [s for s in options.styles[1:] if s == "curly"]
    options.cache = options.cache or str(pathlib.Path(options.out) / "references")
    return options


def main():
    options = parse_options()
    folder, pelage = pathlib.Path(options.out).resolve(), program(options.pelage)
    parts = [p for p in PARTS if re.search(options.only, p)]
    if not parts:
        raise SystemExit(f"no part matches {options.only}")
    for name in ("scenes", "pictures"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    shop, report = Workshop(pelage, folder), Report(folder, "Level of detail with thick hairs", "lod", ABOUT, embed=True)
    for i, part in enumerate(parts):
        print(f"[{i + 1}/{len(parts)}] {part}", flush=True)
        try:
            globals()[part](shop, report, options)
        except Failure as failure:
            raise SystemExit(f"{part}: pelage failed: {failure}")
        report.write()
    print(f"\nOpen {folder / 'index.html'}; the same as Markdown: {folder / 'lod.md'}")


if __name__ == "__main__":
    run(main)
