#!/usr/bin/env python3
"""Measures strand linking beside the other anti-aliasing methods with one command, and says which of its goals are met.

  tools/quality_table.py --out out/quality                                    # 1920 × 1080, references of 1024 samples: an hour
  tools/quality_table.py --out out/quality --reference-spp 64 --only straight # minutes

Grows straight50k, curly50k and ponytail, takes Sintel's hair from PELAGE_DATA where it is there, renders each over a dark and a bright
background by every method, and compares with supersampling. At the end stand OUT/quality.md and OUT/quality.json. What the same
program has made before is kept, so a run that was stopped goes on where it was.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys

from demo_report import ROOT, Failure, Workshop

METHODS = {  # name: (label, options of `pelage render`)
    "one": ("one sample", ["--spp", "1"]),
    "smaa": ("SMAA", ["--method", "smaa"]),
    "fxaa": ("FXAA", ["--method", "fxaa"]),
    "taa": ("TAA, 8 frames", ["--method", "taa", "--frames", "8"]),
    "msaa4": ("MSAA 4", ["--spp", "4"]),
    "msaa8": ("MSAA 8", ["--spp", "8"]),
    "link": ("link, count", ["--method", "link", "--spp", "1", "--alpha", "count"]),
    "link-coverage": ("link, coverage", ["--method", "link", "--spp", "1", "--alpha", "coverage"]),
    "link-taa": ("link-taa, 8 frames", ["--method", "link-taa", "--spp", "1", "--frames", "8"]),
    "oidn": ("OIDN", ["--method", "oidn"]),
}
LINKED = ("link", "link-coverage", "link-taa")
RIVALS = ("one", "smaa", "fxaa", "taa", "msaa4")
BACKGROUNDS = {"dark": "0.18,0.19,0.21", "bright": "1,1,1"}
COLUMNS = {  # key: (head, format)
    "mse": ("MSE, 1e-4", lambda v: f"{1e4 * v:.2f}"), "flip": ("FLIP", lambda v: f"{v:.4f}"),
    "psnr": ("PSNR, dB", lambda v: f"{v:.2f}"), "psnr_flyaway": ("PSNR flyaway, dB", lambda v: f"{v:.2f}"),
    "continuity": ("continuity", lambda v: f"{100 * v:.1f} %"), "gap": ("mean gap, px", lambda v: f"{v:.2f}"),
    "energy_dark": ("light, dark", lambda v: f"{100 * v - 100:+.2f} %"), "energy_bright": ("light, bright", lambda v: f"{100 * v - 100:+.2f} %")}


class Subject:
    """A groom: how it is grown, or `inputs` of `pelage render` that are there already."""

    def __init__(self, name, grow=None, inputs=None):
        self.name, self.grow = name, grow
        self.inputs = inputs or [f"{name}.pelage"]


def subjects(options):
    grown = [("straight50k", "straight"), ("curly50k", "curly"), ("ponytail", "ponytail")]
    found = [Subject(name, ["grow", style, "--strands", str(options.strands), "--points", "64"]) for name, style in grown]
    data = pathlib.Path(os.environ.get("PELAGE_DATA", ROOT.parent / "shared/data")).resolve()
    sintel = [data / "grooms/SintelHairOriginal-sintel_hair.16points.tfx", data / "meshes/sintel.obj", data / "meshes/sintel-eyes.obj"]
    if all(f.exists() for f in sintel):
        groom, *meshes = map(str, sintel)
        found.append(Subject("sintel", inputs=[groom] + [word for mesh in meshes for word in ("--mesh", mesh)]))
    elif not options.quick:
        print(f"Sintel is left out: no {sintel[0]}; set PELAGE_DATA", file=sys.stderr)
    return [s for s in found if re.search(options.only, s.name)]


class Bench:
    """Renders and compares the pictures of one subject."""

    def __init__(self, shop, subject, options):
        self.shop, self.subject, self.options = shop, subject, options
        self.size = ["--size", options.size]
        self.files = [f for f in subject.inputs if not f.startswith("--")]

    def render(self, name, arguments):
        output = f"{self.subject.name}-{name}.exr"
        self.shop.make(["render", *self.subject.inputs, *self.size, "--float", *arguments], self.files, output)
        return output

    def reference(self):
        """Transparent, so that it serves for every background."""
        if self.options.references:
            file = str((pathlib.Path(self.options.references) / f"{self.subject.name}.exr").resolve())
            self.compare(file, file, "--mask", "hair", "--metrics", "mse")  # says what is wrong with an opaque one
            return file
        return self.render("reference", ["--method", "ssaa", "--spp", str(self.options.reference_spp), "--background", "transparent"])

    def compare(self, test, reference, *arguments):
        done = subprocess.run([self.shop.pelage, "compare", test, reference, "--json", *arguments], cwd=self.shop.folder,
                              capture_output=True, text=True)
        if done.returncode != 0:
            raise Failure(done.stderr.strip().splitlines()[0] if done.stderr.strip() else f"exit status {done.returncode}")
        return json.loads(done.stdout)

    def measure(self, name, arguments, reference, hair):
        """{column: value} of one method."""
        pictures = {b: self.render(f"{name}-{b}", [*arguments, "--background", color]) for b, color in BACKGROUNDS.items()}

        def against(background, *more):
            return self.compare(pictures[background], reference, "--background", BACKGROUNDS[background], *more)

        groom, *meshes = self.subject.inputs
        shown = against("dark", "--mask", hair, "--tone-map", "aces", "--metrics", "psnr,flip")
        linear = against("dark", "--mask", hair, "--metrics", "mse,energy")
        bright = against("bright", "--mask", hair, "--metrics", "energy")
        flyaway = against("dark", "--strands", groom, *meshes, "--mask", "flyaway", "--tone-map", "aces", "--metrics", "psnr")
        return {"mse": linear["mse"], "flip": shown["flip"], "psnr": shown["psnr"], "psnr_flyaway": flyaway["psnr"],
                "continuity": flyaway["continuity"], "gap": flyaway["continuity_gap"], "energy_dark": linear["energy"],
                "energy_bright": bright["energy"], "flyaway_length": flyaway["continuity_length"]}


def measure_subject(shop, subject, chosen, options):
    """{method: {column: value}}; a method that this build lacks is told and left out."""
    bench = Bench(shop, subject, options)
    if subject.grow:
        print(f"{subject.name}: growing", flush=True)
        shop.make(subject.grow, [], subject.inputs[0])
    print(f"{subject.name}: reference", flush=True)
    reference = bench.reference()
    hair = bench.render("hair", ["--view", "coverage", "--spp", "1"])
    rows = {}
    for i, name in enumerate(chosen):
        print(f"{subject.name}: {METHODS[name][0]} [{i + 1}/{len(chosen)}]", flush=True)
        try:
            rows[name] = bench.measure(name, METHODS[name][1], reference, hair)
        except Failure as failure:
            if name != "oidn":
                raise
            print(f"{METHODS[name][0]} is left out: {failure}", file=sys.stderr, flush=True)
    return rows


# ---- Goals --------------------------------------------------------------------------------------------------------------------


def goals(rows, name):
    """[(goal, met or None where it cannot be said, what was measured)] of method `name`."""
    row, found = rows[name], []
    rivals = [r for r in RIVALS if r in rows]
    for key, label in (("mse", "MSE"), ("flip", "FLIP")):
        lost = [METHODS[r][0] for r in rivals if rows[r][key] <= row[key]]
        found.append((f"{label} below {', '.join(METHODS[r][0] for r in rivals)}", not lost if rivals else None,
                      f"not below {', '.join(lost)}" if lost else ""))
    if "one" in rows:
        gain = row["psnr_flyaway"] - rows["one"]["psnr_flyaway"]
        found.append(("flyaway PSNR 6 dB over one sample", gain >= 6, f"{gain:+.2f} dB"))
    if "msaa8" in rows:
        gain = row["psnr_flyaway"] - rows["msaa8"]["psnr_flyaway"]
        found.append(("flyaway PSNR no less than MSAA 8", gain >= 0, f"{gain:+.2f} dB"))
    if "one" in rows and row["continuity"] is not None:
        one = rows["one"]["continuity"]
        found.append(("continuity 90 % where one sample has below 50 %", row["continuity"] >= 0.9 if one < 0.5 else None,
                      f"{100 * row['continuity']:.1f} % from {100 * one:.1f} %"))
    for background in BACKGROUNDS:
        off = row[f"energy_{background}"] - 1
        found.append((f"light on hair within 1 %, {background}", abs(off) <= 0.01, f"{100 * off:+.2f} %"))
    return found


def markdown_row(cells):
    return "| " + " | ".join(cells) + " |"


def table_of(rows):
    lines = [markdown_row(["", *(head for head, _ in COLUMNS.values())]), markdown_row(["---"] * (len(COLUMNS) + 1))]
    for name, row in rows.items():
        cells = ["–" if row[key] is None else text(row[key]) for key, (_, text) in COLUMNS.items()]
        lines.append(markdown_row([METHODS[name][0], *cells]))
    return "\n".join(lines)


def verdicts_of(rows):
    linked = [name for name in LINKED if name in rows]
    if not linked:
        return ""
    told = {name: goals(rows, name) for name in linked}
    lines = [markdown_row(["goal", *(METHODS[name][0] for name in linked)]), markdown_row(["---"] * (len(linked) + 1))]
    for i, (goal, _, _) in enumerate(told[linked[0]]):
        words = {True: "met", False: "missed", None: "–"}
        lines.append(markdown_row([goal, *(f"{words[told[n][i][1]]} {told[n][i][2]}".strip() for n in linked)]))
    return "\n".join(lines)


def write_results(folder, results, options):
    samples = "references as given" if options.references else f"references of {options.reference_spp} samples"
    text = [f"# Strand linking beside other methods\n\n{options.size.replace('x', ' × ')} pixels, {samples}; hair pixels; MSE scene-linear, PSNR and FLIP "
            "as displayed, over the dark background; light: mean on hair pixels against the reference's."]
    for name, rows in results.items():
        text += [f"## {name}", table_of(rows), verdicts_of(rows)]
    (folder / "quality.md").write_text("\n\n".join(t for t in text if t) + "\n")
    told = {name: {"methods": rows, "goals": {m: [{"goal": g, "met": met, "measured": what} for g, met, what in goals(rows, m)]
                                              for m in LINKED if m in rows}} for name, rows in results.items()}
    settings = {"size": options.size, "strands": options.strands, "reference_spp": None if options.references else options.reference_spp}
    (folder / "quality.json").write_text(json.dumps({"settings": settings, "subjects": told}, indent=1) + "\n")


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default="out/quality", help="folder of everything (%(default)s)")
    parser.add_argument("--quick", action="store_true", help="few strands and pixels, to see that everything works")
    parser.add_argument("--size", metavar="WxH", help="of the pictures (1920x1080; 160x90 with --quick)")
    parser.add_argument("--strands", type=int, help="of the grown grooms (50000; 400 with --quick)")
    parser.add_argument("--reference-spp", type=int, help="samples of the references, each shaded (1024; 16 with --quick)")
    parser.add_argument("--references", metavar="FOLDER", help="take FOLDER/NAME.exr instead, rendered with --background transparent")
    parser.add_argument("--only", default="", metavar="REGEX", help="grooms whose names match: straight50k, curly50k, ponytail, sintel")
    parser.add_argument("--methods", default=",".join(METHODS), metavar="A,B", help="which to measure (%(default)s)")
    parser.add_argument("--pelage", default=os.environ.get("PELAGE", str(ROOT / "build/release/bin/pelage")), help="program (%(default)s)")
    options = parser.parse_args()
    options.size = options.size or ("160x90" if options.quick else "1920x1080")
    options.strands = options.strands or (400 if options.quick else 50000)
    options.reference_spp = options.reference_spp or (16 if options.quick else 1024)
    options.methods = options.methods.split(",")
    for name in options.methods:
        if name not in METHODS:
            parser.error(f"no method {name}; there are {', '.join(METHODS)}")
    return options


def main():
    options = parse_options()
    pelage = str(pathlib.Path(options.pelage).resolve())
    if not os.access(pelage, os.X_OK):
        raise SystemExit(f"{pelage} is no program; build it first, or name it with --pelage")
    chosen = subjects(options)
    if not chosen:
        raise SystemExit(f"no groom matches {options.only}")
    folder = pathlib.Path(options.out).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    shop, results = Workshop(pelage, folder), {}
    for subject in chosen:
        try:
            results[subject.name] = measure_subject(shop, subject, options.methods, options)
        except Failure as failure:
            raise SystemExit(f"{subject.name}: pelage failed: {failure}")
        write_results(folder, results, options)
    print(f"\n{(folder / 'quality.md').read_text()}\nThe same stands in {folder / 'quality.md'}; for machines: {folder / 'quality.json'}")


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit("stopped; the same command goes on from here")
