#!/usr/bin/env python3
"""Measures strand linking beside the other anti-aliasing methods with one command, and says which of its goals are met.

  tools/quality_table.py --out out/quality                                    # 1920 × 1080, references of 1024 samples: an hour
  tools/quality_table.py --out out/quality --reference-spp 64 --only straight # minutes

Grows straight50k, curly50k and ponytail, takes Sintel's hair from PELAGE_DATA where it is there, renders each over a dark and a bright
background by every method, and compares with supersampling. OUT/quality.md and OUT/quality.json have all that was measured so far. What
the same program has made before is kept, so a run that was stopped goes on where it was; references stay good for any program that
renders the same (tools/reference_cache.py) in the folder --cache. --readme puts the sum of it into the README.
"""
import argparse
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import time

from demo_report import ROOT, Failure, Workshop, program, put_into_readme, run
from reference_cache import ReferenceCache

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
    "link-taa-coverage": ("link-taa, coverage", ["--method", "link-taa", "--spp", "1", "--frames", "8", "--alpha", "coverage"]),
    "oidn": ("OIDN", ["--method", "oidn"]),
}
LINKED = ("link", "link-coverage", "link-taa", "link-taa-coverage")
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
        self.cache = ReferenceCache(shop, options.cache)
        self.size = ["--size", options.size]
        self.files = [f for f in subject.inputs if not f.startswith("--")]

    def render(self, name, arguments):
        output = f"{self.subject.name}-{name}.exr"
        self.shop.make(["render", *self.subject.inputs, *self.size, "--float", *arguments], self.files, output)
        return output

    def reference(self):
        """(file, seconds it took or None); transparent, so that it serves for every background."""
        if self.options.references:
            file = str((pathlib.Path(self.options.references) / f"{self.subject.name}.exr").resolve())
            self.compare(file, file, "--mask", "hair", "--metrics", "mse")  # says what is wrong with an opaque one
            return file, None
        arguments = [*self.subject.inputs, *self.size, "--background", "transparent"]
        return self.cache.picture(arguments, self.files, self.options.reference_spp, self.subject.name)

    def compare(self, test, reference, *arguments):
        done = subprocess.run([self.shop.pelage, "compare", test, reference, "--json", *arguments], cwd=self.shop.folder,
                              capture_output=True, text=True)
        if done.returncode != 0:
            raise Failure(done.stderr.strip().splitlines()[0] if done.stderr.strip() else f"exit status {done.returncode}")
        return json.loads(done.stdout)

    def known_or_measured(self, name, reference):
        """{column: value} of one method, and the seconds it took; kept like pictures are."""
        note = self.shop.folder / "rows" / f"{self.subject.name}-{name}.json"
        stamp = hashlib.sha256(json.dumps([self.shop.program, METHODS[name][1], self.size, str(reference)]).encode())
        for file in [*self.files, reference]:
            stamp.update((self.shop.folder / file).read_bytes())
        try:
            told = json.loads(note.read_text())
            if told["stamp"] == stamp.hexdigest():
                return told["row"], told["seconds"]
        except (OSError, ValueError, KeyError):
            pass
        start = time.monotonic()
        row = self.measure(name, METHODS[name][1], reference)
        seconds = round(time.monotonic() - start, 1)
        note.parent.mkdir(exist_ok=True)
        note.write_text(json.dumps({"stamp": stamp.hexdigest(), "seconds": seconds, "row": row}) + "\n")
        return row, seconds

    def measure(self, name, arguments, reference):
        hair = self.render("hair", ["--view", "coverage", "--spp", "1"])
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


class Results:
    """All that was measured so far: {subject: {method: {column: value}}} and {subject: {what: seconds}}."""

    def __init__(self, folder, options):
        self.folder, self.options = folder, options
        self.rows, self.seconds = {}, {}

    def add(self, subject, name, row, seconds):
        self.rows.setdefault(subject, {})[name] = row
        self.seconds.setdefault(subject, {})[name] = seconds
        write_results(self.folder, self.rows, self.seconds, self.options)


def measure_subject(shop, subject, options, results):
    """Adds the methods one by one; one that this build lacks is told and left out."""
    bench = Bench(shop, subject, options)
    if subject.grow:
        print(f"{subject.name}: growing", flush=True)
        shop.make(subject.grow, [], subject.inputs[0])
    reference, took = bench.reference()
    results.seconds[subject.name] = {} if took is None else {"reference": took}
    for i, name in enumerate(options.methods):
        print(f"{subject.name}: {METHODS[name][0]} [{i + 1}/{len(options.methods)}]", end="", flush=True)
        try:
            row, seconds = bench.known_or_measured(name, reference)
            print(f", {seconds:.0f} s", flush=True)
            results.add(subject.name, name, row, seconds)
        except Failure as failure:
            if name != "oidn":
                raise
            print(f" is left out: {failure}", flush=True)


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


def times_of(seconds):
    told = [f"{METHODS[name][0] if name in METHODS else name} {took:.0f}" for name, took in seconds.items()]
    return "Seconds to render and measure: " + ", ".join(told) + "."


def readme_table(results):
    """The sum of it: what linking has beside one sample, MSAA 8 and TAA, in few columns."""
    shown = [m for m in ("one", "taa", "msaa8", "link", "link-coverage", "link-taa", "link-taa-coverage") if any(m in rows for rows in results.values())]
    lines = [markdown_row(["hair pixels", *(METHODS[m][0] for m in shown)]), markdown_row(["---"] * (len(shown) + 1))]
    for subject, rows in results.items():
        for key in ("mse", "flip", "psnr_flyaway", "continuity"):
            head, text = COLUMNS[key]
            cells = [text(rows[m][key]) if m in rows and rows[m][key] is not None else "–" for m in shown]
            if any(cell != "–" for cell in cells):
                lines.append(markdown_row([f"{subject}: {head}", *cells]))
    met = {m: [g[1] for rows in results.values() if m in rows for g in goals(rows, m) if g[1] is not None] for m in shown if m in LINKED}
    told = "; ".join(f"{METHODS[m][0]} {sum(found)} of {len(found)}" for m, found in met.items())
    return "\n".join(lines) + f"\n\nGoals that are met: {told}.\n"


def references_of(options):
    return "references as given" if options.references else f"references of {options.reference_spp} samples"


def write_readme(results, options):
    """The sum of the tables, and what it was made of."""
    told = (f"One sample a pixel made whole beside other methods (`tools/quality_table.py --readme`), {options.size.replace('x', '×')}, grown grooms of "
            f"{options.strands:,} strands, {references_of(options)}:\n\n{readme_table(results)}")
    put_into_readme("link quality", told)


def write_results(folder, results, seconds, options):
    text = [f"# Strand linking beside other methods\n\n{options.size.replace('x', ' × ')} pixels, {references_of(options)}; hair pixels; MSE scene-linear, PSNR and FLIP "
            "as displayed, over the dark background; light: mean on hair pixels against the reference's."]
    for name, rows in results.items():
        text += [f"## {name}", table_of(rows), verdicts_of(rows), times_of(seconds[name])]
    (folder / "quality.md").write_text("\n\n".join(t for t in text if t) + "\n")
    told = {name: {"seconds": seconds[name], "methods": rows, "goals": {m: [{"goal": g, "met": met, "measured": what} for g, met, what in goals(rows, m)]
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
    parser.add_argument("--cache", metavar="FOLDER", help="where references are kept (OUT/references)")
    parser.add_argument("--readme", action="store_true", help="put the sum of it into README.md")
    parser.add_argument("--references", metavar="FOLDER", help="take FOLDER/NAME.exr instead, rendered with --background transparent")
    parser.add_argument("--only", default="", metavar="REGEX", help="grooms whose names match: straight50k, curly50k, ponytail, sintel")
    parser.add_argument("--methods", default=",".join(METHODS), metavar="A,B", help="which to measure (%(default)s)")
    parser.add_argument("--pelage", default=os.environ.get("PELAGE", str(ROOT / "build/release/bin/pelage")), help="program (%(default)s)")
    options = parser.parse_args()
    options.size = options.size or ("160x90" if options.quick else "1920x1080")
    options.strands = options.strands or (400 if options.quick else 50000)
    options.reference_spp = options.reference_spp or (16 if options.quick else 1024)
    options.methods = options.methods.split(",")
    options.cache = options.cache or str(pathlib.Path(options.out) / "references")
    for name in options.methods:
        if name not in METHODS:
            parser.error(f"no method {name}; there are {', '.join(METHODS)}")
    return options


def main():
    options = parse_options()
    pelage = program(options.pelage)
    chosen = subjects(options)
    if not chosen:
        raise SystemExit(f"no groom matches {options.only}")
    folder = pathlib.Path(options.out).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    shop, results = Workshop(pelage, folder), Results(folder, options)
    for subject in chosen:
        try:
            measure_subject(shop, subject, options, results)
        except Failure as failure:
            raise SystemExit(f"{subject.name}: pelage failed: {failure}")
    if options.readme:
        write_readme(results.rows, options)
    print(f"\n{(folder / 'quality.md').read_text()}\nThe same stands in {folder / 'quality.md'}; for machines: {folder / 'quality.json'}")


if __name__ == "__main__":
    run(main)
