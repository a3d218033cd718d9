"""Pages of the tools that measure: text, tables, pictures, plots and which goals are met; and what `pelage bench` measures."""
import base64
import html
import json
import math
import pathlib
import re
import subprocess

from demo_report import Failure, machine
from quality_table import markdown_row


class Report:
    """What is told, part by part: as Markdown, and as a page. `embed`: the page holds its pictures."""

    def __init__(self, folder, title, stem, about, embed=False):
        self.folder, self.title, self.stem, self.about, self.embed = folder, title, stem, about, embed
        self.markdown, self.body, self.verdicts, self.numbers = [], [], [], {}

    def text(self, words, heading=False):
        self.markdown.append(f"## {words}" if heading else words)
        tag = "h2" if heading else "p"
        self.body.append(f"<{tag}>{html.escape(words)}</{tag}>")

    def table(self, head, rows):
        self.markdown.append("\n".join([markdown_row(head), markdown_row(["---"] * len(head)), *(markdown_row(r) for r in rows)]))
        cells = "".join("<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in r) + "</tr>" for r in rows)
        self.body.append("<table><tr>" + "".join(f"<th>{html.escape(c)}</th>" for c in head) + f"</tr>{cells}</table>")

    def picture(self, file, about):
        self.markdown.append(f"![{about}]({file})\n\n{about}")
        shown = f'<img src="{self.source(file)}" alt="">'
        if not self.embed:
            shown = f'<a href="{file}">{shown}</a>'
        self.body.append(f'<figure>{shown}<figcaption>{html.escape(about)}</figcaption></figure>')

    def source(self, file):
        if not self.embed:
            return file
        kind = {".png": "image/png", ".svg": "image/svg+xml"}[pathlib.Path(file).suffix]
        return f"data:{kind};base64,{base64.b64encode((self.folder / file).read_bytes()).decode()}"

    def verdict(self, row, met, measured):
        """met: None where it cannot be said."""
        self.verdicts.append({"row": row, "met": met, "measured": measured})

    def write(self):
        words = {True: "met", False: "missed", None: "–"}
        rows = [[v["row"], words[v["met"]], v["measured"]] for v in self.verdicts]
        top = Report(self.folder, self.title, self.stem, self.about)
        top.text(f"{self.about} {machine()}")
        if rows:
            top.table(["row", "", "measured"], rows)
        (self.folder / f"{self.stem}.md").write_text("\n\n".join([f"# {self.title}", *top.markdown, *self.markdown]) + "\n")
        (self.folder / f"{self.stem}.json").write_text(json.dumps({"machine": machine(), "rows": self.verdicts, **self.numbers}, indent=1) + "\n")
        (self.folder / "index.html").write_text(PAGE.replace("@TITLE@", html.escape(self.title)).replace("@BODY@", "\n".join(top.body + self.body)))


PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>@TITLE@</title><style>
body { font: 15px/1.5 system-ui, sans-serif; max-width: 1500px; margin: 2em auto; padding: 0 1em; color: #222; background: #fff }
table { border-collapse: collapse; margin: 1em 0; font-variant-numeric: tabular-nums }
td, th { border-bottom: 1px solid #ddd; padding: .2em .7em; text-align: left; white-space: nowrap }
figure { margin: 1em 0 } img { max-width: 100%; image-rendering: auto } figcaption { color: #555 }
</style></head><body><h1>@TITLE@</h1>
@BODY@
</body></html>
"""


def bench(shop, regex):
    """{(case, metric): value} of the cases whose names match."""
    file = f"bench/{re.sub(r'[^a-z0-9]+', '-', regex).strip('-')}.json"
    note, stamp = shop.folder / f"{file}.stamp", shop.stamp(["bench", regex], [])
    if not (note.exists() and note.read_text() == stamp):
        (shop.folder / "bench").mkdir(exist_ok=True)
        print(f"measuring {regex}", flush=True)
        done = subprocess.run([shop.pelage, "bench", regex, "--json", file], cwd=shop.folder, capture_output=True, text=True)
        if done.returncode != 0:
            raise Failure((done.stderr.strip() or done.stdout.strip() or f"exit status {done.returncode}").splitlines()[-1])
        note.write_text(stamp)
    lines = [json.loads(line) for line in (shop.folder / file).read_text().splitlines()]
    return {(line["case"], line["metric"]): line["value"] for line in lines if "value" in line}


INKS = ("#1b6ca8", "#d1495b", "#edae49", "#2e933c", "#6a4c93", "#555555")


def curve_picture(curve, heights, metric, band=0.03, ticks=None):
    """An SVG of all curves {name: {x: ratio}} over the logarithm of x, largest first; gray: within `band` of 1; ticks at `heights`, or fewer."""
    width, height, left, top = 900, 380, 60, 20
    low, high = math.log(min(heights) / 1.1), math.log(max(heights) * 1.1)
    values = [v for points in curve.values() for v in points.values()]
    least, most = min(1 - 2 * band, *values), max(1 + 2 * band, *values)

    def x(h):
        return left + (high - math.log(h)) / (high - low) * (width - left - 120)

    def y(v):
        return top + (most - v) / (most - least) * (height - top - 50)

    parts = [f'<rect x="{left}" y="{y(1 + band):.1f}" width="{width - left - 120}" height="{y(1 - band) - y(1 + band):.1f}" fill="#eee"/>',
             f'<line x1="{left}" x2="{width - 120}" y1="{y(1):.1f}" y2="{y(1):.1f}" stroke="#aaa"/>']
    parts += [f'<text x="{left - 8}" y="{y(v) + 4:.1f}" text-anchor="end">{v:.2f}</text>' for v in (1 - band, 1, 1 + band)]
    parts += [f'<text x="{x(h):.1f}" y="{height - 25}" text-anchor="middle">{h}</text>' for h in ticks or heights]
    for i, (style, points) in enumerate(curve.items()):
        line = " ".join(f"{x(h):.1f},{y(points[h]):.1f}" for h in heights if h in points)
        parts.append(f'<polyline points="{line}" fill="none" stroke="{INKS[i % 6]}" stroke-width="2"/>')
        parts.append(f'<text x="{width - 112}" y="{top + 14 + 18 * i}" fill="{INKS[i % 6]}">{style}</text>')
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">'
            f'<title>{metric}</title><rect width="{width}" height="{height}" fill="#fff"/>{"".join(parts)}</svg>\n')


def scatter_picture(curves, x_label, y_label):
    """An SVG of points {name: [(x, y)]}, joined in order, over the logarithm of x."""
    width, height, left, top, right = 900, 380, 60, 20, 190
    points = [p for curve in curves.values() for p in curve]
    low, high = math.log(min(p[0] for p in points) / 1.2), math.log(max(p[0] for p in points) * 1.2)
    least, most = 0.95 * min(p[1] for p in points), 1.05 * max(p[1] for p in points)

    def at(p):
        across, up = (math.log(p[0]) - low) / (high - low), (p[1] - least) / (most - least)
        return left + across * (width - left - right), top + (1 - up) * (height - top - 50)

    parts = []
    for i in range(5):
        value = least + (most - least) * i / 4
        y = at((points[0][0], value))[1]
        parts.append(f'<line x1="{left}" x2="{width - right}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ddd"/>'
                     f'<text x="{left - 8}" y="{y + 4:.1f}" text-anchor="end">{value:.3f}</text>')
    ticks = [step * 10 ** power for power in range(math.floor(low / math.log(10)), math.ceil(high / math.log(10))) for step in (1, 2, 5)]
    for tick in (t for t in ticks if low <= math.log(t) <= high):
        x = at((tick, most))[0]
        parts.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{top}" y2="{height - 50}" stroke="#ddd"/>'
                     f'<text x="{x:.1f}" y="{height - 32}" text-anchor="middle">{tick:,g}</text>')
    parts.append(f'<text x="{(left + width - right) / 2}" y="{height - 10}" text-anchor="middle">{x_label}</text><text x="{left}" y="14">{y_label}</text>')
    for i, (name, curve) in enumerate(curves.items()):
        ink = "#000" if i == 0 else INKS[(i - 1) % len(INKS)]
        places = [at(p) for p in curve]
        parts.append(f'<polyline points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in places)}" fill="none" stroke="{ink}" stroke-width="2"/>')
        parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{ink}"/>' for x, y in places]
        parts.append(f'<text x="{width - right + 12}" y="{top + 14 + 18 * i}" fill="{ink}">{name}</text>')
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">'
            f'<title>{y_label} over {x_label}</title><rect width="{width}" height="{height}" fill="#fff"/>{"".join(parts)}</svg>\n')
