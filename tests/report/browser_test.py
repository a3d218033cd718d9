#!/usr/bin/env python3
"""The page of `pelage report` in a real browser: it is opened from its files, without a network, and used as a person uses it.

  tests/report/browser_test.py PELAGE [--screenshots DIR]

Every pixel of the pictures is known, so what the page shows is compared with what it should show. Exit 77: no browser.
"""
import argparse
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
from devtools import Chromium, find_chromium
from exr import write_exr

SKIPPED = 77
WIDTH, HEIGHT = 48, 32
METHODS = {"one": 0.30, "eight": 0.10, "truth": 0.0}  # how far each is from the truth
STYLES, LIGHTS = ("straight", "curly"), ("front", "back")
HOSTILE = "</script><script>window.hacked = 1</script><img src=x onerror='window.hacked = 2'> & {{data}}"


def covers_hair(x, y):
    return (x - WIDTH / 2) ** 2 + (y - HEIGHT / 2) ** 2 < 140


def color(case, method, x, y):
    """Linear R, G, B: a ramp with a disk of stripes, whose left half the lesser methods get wrong."""
    base = (x / WIDTH * 0.5, y / HEIGHT * 0.5, 0.1 + 0.02 * case)
    if not covers_hair(x, y):
        return base
    stripe = 0.8 if (x + y) % 4 < 2 else 0.3
    wrong = METHODS[method] if x < WIDTH / 2 else 0
    return (stripe * 0.6 + wrong, stripe * 0.35, stripe * 0.15)


def srgb_byte(x):
    x = min(max(x, 0), 1)
    return round(255 * (12.92 * x if x <= 0.0031308 else 1.055 * x ** (1 / 2.4) - 0.055))


def aces_bytes(rgb):
    """Stephen Hill's fit, typed from its publication (references.bib: Hill2016Aces), not from the page."""
    first = ((0.59719, 0.35458, 0.04823), (0.07600, 0.90834, 0.01566), (0.02840, 0.13383, 0.83777))
    second = ((1.60475, -0.53108, -0.07367), (-0.10208, 1.10813, -0.00605), (-0.00327, -0.07276, 1.07602))
    v = [sum(m * c for m, c in zip(row, rgb)) for row in first]
    v = [(x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.4329510) + 0.238081) for x in v]
    return [srgb_byte(sum(m * c for m, c in zip(row, v))) for row in second]


def write_cases(folder):
    cases = []
    for number, (style, light) in enumerate((s, l) for s in STYLES for l in LIGHTS):
        images = []
        for method in METHODS:
            name = f"{style}-{light}-{method}.exr"
            channels = {c: (lambda x, y, i=i: color(number, method, x, y)[i]) for i, c in enumerate("RGB")}
            if method == "truth":
                channels["coverage"] = lambda x, y: float(covers_hair(x, y))
            write_exr(folder / name, WIDTH, HEIGHT, channels)
            images.append({"method": method, "file": name, "samples": {"one": 1, "eight": 8, "truth": 1024}[method],
                           "time": {"one": 0.5, "eight": 2.5, "truth": 300}[method] * (1 + number / 10),
                           "command": f"pelage render {style}.json -o {name} --note '<b>{method}</b>'"})
        cases.append({"title": f"{style} hair, {light} light" + (HOSTILE if number == 3 else ""), "images": images,
                      "axes": {"hairstyle": style, "light": light, "distance": 1 + number % 2}, "settings": {"strands": 1000}})
    (folder / "cases.json").write_text(json.dumps({
        "title": "A test & its <report>", "about": "Every pixel is known.", "machine": "none", "reference": "truth",
        "axes": ["hairstyle", "light", "distance"], "cases": cases,
        "methods": [{"name": "one", "label": "Raster, 1 sample", "series": "Raster"},
                    {"name": "eight", "label": "Raster, 8 samples", "series": "Raster"},
                    {"name": "truth", "label": "Path traced"}]}))


class Page(unittest.TestCase):
    """One page for all tests, in the order of their names; each starts from the place that it opens."""

    @classmethod
    def setUpClass(cls):
        cls.work = tempfile.TemporaryDirectory(prefix="pelage report ")  # with a blank, as people's folders have
        folder = pathlib.Path(cls.work.name)
        write_cases(folder)
        subprocess.run([PELAGE, "report", folder / "cases.json", "-o", folder / "out"], check=True, stderr=subprocess.DEVNULL)
        cls.url = (folder / "out" / "index.html").as_uri()
        cls.browser = Chromium(BROWSER)

    @classmethod
    def tearDownClass(cls):
        cls.browser.__exit__()
        cls.work.cleanup()

    def setUp(self):
        self.browser.complaints.clear()

    def tearDown(self):
        self.assertEqual(self.browser.complaints, [], "the page complained")
        for url in self.browser.requests:
            self.assertRegex(url, r"^(file://|data:|about:|blob:)", "a request left the machine")

    def overview(self):
        self.browser.open("about:blank")
        self.browser.open(self.url)
        self.browser.wait_for("document.querySelectorAll('.card img').length > 0 && [...document.images].every(i => i.complete)")

    def case(self, number, left="one", right="truth"):
        self.browser.open("about:blank")
        self.browser.open(f"{self.url}#case={number}&left={left}&right={right}")
        self.browser.wait_for("document.querySelectorAll('.strip canvas[data-zoom]').length === 3")

    def pixel(self, selector, u, v):
        """R, G, B of a canvas at a share of its size."""
        return self.browser.run(f"""(() => {{ const c = document.querySelector({json.dumps(selector)}), one = new OffscreenCanvas(1, 1).getContext("2d");
            one.drawImage(c, -Math.floor({u} * c.width), -Math.floor({v} * c.height));
            return [...one.getImageData(0, 0, 1, 1).data].slice(0, 3); }})()""")

    def assert_color(self, actual, expected, message=""):
        self.assertLessEqual(max(abs(a - b) for a, b in zip(actual, expected)), 1, f"{message} {actual} is not {expected}")

    def place(self, selector):
        return self.browser.run(f"""(() => {{ const d = document.querySelector({json.dumps(selector)}).dataset;
            return [d.zoom, d.x, d.y].map(Number); }})()""")

    def places(self):
        return self.browser.run("[...document.querySelectorAll('canvas.pane')].map(c => [c.dataset.zoom, c.dataset.x, c.dataset.y].map(Number))")

    def column(self, table, number):
        return self.browser.run(f"[...document.querySelectorAll('{table} tbody tr')].map(r => r.cells[{number}].textContent)")

    def number_of(self, head, table="#summary-table"):
        heads = self.browser.run(f"[...document.querySelectorAll('{table} th')].map(t => t.textContent)")
        return next(i for i, text in enumerate(heads) if text.startswith(head))

    # ---- The overview ----

    def test_overview_shows_text_as_text(self):
        self.overview()
        self.assertEqual(self.browser.run("document.querySelector('h1').textContent"), "A test & its <report>")
        self.assertIsNone(self.browser.run("window.hacked"))
        self.assertIn(HOSTILE, self.browser.run("document.querySelectorAll('.card')[3].title"))
        self.case(3)
        self.assertIn(HOSTILE, self.browser.run("document.querySelector('h1').textContent"))
        self.assertIn("<b>one</b>", self.browser.run("document.querySelector('pre').textContent"))
        self.assertIsNone(self.browser.run("window.hacked"))

    def test_summary_is_the_mean_over_hair(self):
        self.overview()
        self.browser.click_on("[data-choice=metric] button")
        inside = [(x, y) for x in range(WIDTH) for y in range(HEIGHT) if covers_hair(x, y)]
        table = subprocess.run([PELAGE, "report", pathlib.Path(self.work.name) / "cases.json", "--markdown"],
                               check=True, capture_output=True, text=True).stdout.splitlines()
        printed = [[cell.strip(" *") for cell in line.split("|")[1:-1]] for line in table[2:]]
        self.assertEqual(self.column("#summary-table", 0), [row[0] for row in printed])
        for i in range(1, len(printed[0])):
            self.assertEqual(self.column("#summary-table", i), [row[i] for row in printed])
        self.assertEqual(len(inside), 437)

    def test_summary_sorts_and_marks_the_best(self):
        self.overview()
        psnr = self.number_of("PSNR")
        best = self.browser.run(f"[...document.querySelectorAll('#summary-table tbody tr')].map(r => r.cells[{psnr}].className.includes('best'))")
        self.assertEqual(best, [False, True])
        self.browser.click_on(f"#summary-table th:nth-child({psnr + 1}) button")
        self.assertEqual(self.column("#summary-table", 0), ["Raster, 8 samples", "Raster, 1 sample"])
        self.browser.click_on(f"#summary-table th:nth-child({psnr + 1}) button")
        self.assertEqual(self.column("#summary-table", 0), ["Raster, 1 sample", "Raster, 8 samples"])
        self.assertEqual(self.browser.run(f"document.querySelectorAll('#summary-table th')[{psnr}].getAttribute('aria-sort')"), "ascending")

    def test_what_looks_the_same_is_best_together_unless_all_of_it_is(self):
        self.overview()
        marked = lambda values: self.browser.run(f"""(() => {{
            const table = sortableTable("t", [{{ label: "x", value: row => row, better: "lower" }}], {values}, {{}}, () => {{}});
            return [...table.querySelectorAll("td")].map(cell => cell.className.includes("best")); }})()""")
        self.assertEqual(marked([2, 0.50001, 0.50002]), [False, True, True])
        self.assertEqual(marked([3, 3]), [False, False])
        self.assertEqual(marked([3]), [False])

    def test_every_axis_of_the_matrix_has_its_name(self):
        self.overview()
        corners = self.browser.run("[...document.querySelectorAll('.matrix .corner')].map(c => c.textContent)")
        self.assertEqual(corners, ["light →", "hairstyle ↓distance →"])

    def test_labels_of_points_cover_no_other(self):
        self.overview()
        boxes = self.browser.run("""placeLabels(["One method", "Another", "A third one", "One more", "The last"].map((label, i) =>
            ({ label, x: 100 + i, y: 100 - i })), { left: 50, right: 400, top: 20, bottom: 250 }).map(l => [l.left, l.right, l.middle])""")
        for i, (left, right, middle) in enumerate(boxes):
            self.assertGreaterEqual(left, 50)
            for other in boxes[:i]:
                self.assertTrue(right <= other[0] or left >= other[1] or abs(middle - other[2]) >= 11, f"{boxes}")

    def test_filter_leaves_what_is_chosen(self):
        self.overview()
        cards = "document.querySelectorAll('.card').length"
        self.assertEqual(self.browser.run(cards), 4)
        self.browser.click_on("[data-axis=hairstyle] [data-value=curly]")
        self.assertEqual(self.browser.run(cards), 2)
        self.assertEqual(self.column("#summary-table", self.number_of("Cases")), ["2", "2"])
        self.browser.click_on("[data-axis=light] [data-value=back]")
        self.assertEqual(self.browser.run(cards), 1)
        self.browser.click_on("[data-axis=hairstyle] [data-value='']")
        self.browser.click_on("[data-axis=light] [data-value='']")
        self.assertEqual(self.browser.run(cards), 4)

    def test_region_changes_the_numbers(self):
        self.overview()
        psnr = self.number_of("PSNR")
        hair = self.column("#summary-table", psnr)
        self.browser.run("[...document.querySelectorAll('.bar button')].find(b => b.dataset.value === 'whole').click()")
        whole = self.column("#summary-table", psnr)
        for on_hair, on_all in zip(hair, whole):
            share = 437 / (WIDTH * HEIGHT)  # outside of the hair nothing is wrong
            self.assertAlmostEqual(float(on_all) - float(on_hair), -10 * math.log10(share), delta=0.11)

    def test_plots_have_numbers(self):
        self.overview()
        titles = self.browser.run("[...document.querySelectorAll('.plot-title')].map(t => t.textContent)")
        self.assertEqual(titles, ["Over time", "Over samples", "Over hairstyle", "Over light", "Over distance"])
        self.assertEqual(self.browser.run("document.querySelectorAll('.plot polyline').length"), 2 + 3 * 2)
        self.assertFalse(self.browser.run("document.querySelector('#plots').innerHTML.includes('NaN')"))

    def test_theme_changes_and_stays(self):
        self.overview()
        background = "getComputedStyle(document.body).backgroundColor"
        light = self.browser.run(background)
        self.browser.click_on("#theme")
        dark = self.browser.run(background)
        self.assertNotEqual(light, dark)
        self.overview()
        self.assertEqual(self.browser.run(background), dark)
        self.browser.press("t", "KeyT")
        self.assertEqual(self.browser.run(background), light)

    def test_card_opens_its_case(self):
        self.overview()
        self.browser.run("document.querySelectorAll('.card')[2].click()")
        self.browser.wait_for("document.querySelectorAll('.strip canvas[data-zoom]').length === 3")
        self.assertEqual(self.browser.run("document.querySelector('h1').textContent"), "curly hair, front light")
        self.browser.press("n", "KeyN")
        self.browser.wait_for("document.querySelector('h1').textContent.startsWith('curly hair, back light')")
        self.browser.press("Escape")
        self.browser.wait_for("document.querySelectorAll('.card').length === 4")

    # ---- A case ----

    def test_pictures_have_the_colors_of_the_files(self):
        self.case(1)
        for method in METHODS:
            for x, y in ((2, 3), (20, 16), (28, 14), (45, 30)):
                shown = self.pixel(f".strip-pane[data-method={method}] canvas", (x + 0.5) / WIDTH, (y + 0.5) / HEIGHT)
                self.assert_color(shown, aces_bytes(color(1, method, x, y)), f"{method} {x} {y}")

    def test_slider_divides_two_methods(self):
        self.case(0, "one", "truth")
        u, v = (18 + 0.5) / WIDTH, (16 + 0.5) / HEIGHT  # hair that `one` gets wrong
        one, truth = (aces_bytes(color(0, method, 18, 16)) for method in ("one", "truth"))
        self.assert_color(self.pixel(".slider canvas", u, v), one, "left of the line")
        left, top, width, height = self.browser.box(".slider")
        self.browser.drag((left + width / 2, top + height / 2), (left + 0.2 * width, top + height / 2))
        self.assertEqual(self.browser.run("document.querySelector('.slider-handle').getAttribute('aria-valuenow')"), "20")
        self.assert_color(self.pixel(".slider canvas", u, v), truth, "right of the line")
        self.assertEqual(self.place(".slider canvas")[0], 1, "dragging the line moved the picture")
        self.browser.run("document.querySelector('.slider-handle').focus()")
        self.browser.press("End")
        self.assert_color(self.pixel(".slider canvas", u, v), one, "the line at the end")

    def test_any_two_methods_can_be_chosen(self):
        self.case(0, "one", "truth")
        self.browser.press("2", "Digit2")
        self.browser.press("#", "Digit3", shift=True)
        self.assertEqual(self.browser.run("[...document.querySelectorAll('.tag')].map(t => t.textContent)"), ["Path traced", "Raster, 8 samples"])
        self.assertIn("left=truth&right=eight", self.browser.run("location.hash"))
        self.browser.run("(() => { const s = document.getElementById('left'); s.value = 0; s.dispatchEvent(new Event('change')); })()")
        self.assertEqual(self.browser.run("document.querySelector('.tag.left').textContent"), "Raster, 1 sample")
        self.browser.press("x", "KeyX")
        self.assertEqual(self.browser.run("document.querySelector('.tag.left').textContent"), "Raster, 8 samples")

    def test_zoom_and_pan_are_linked(self):
        self.case(0)
        left, top, width, height = self.browser.box(".strip-pane[data-method=eight] canvas")
        self.browser.wheel(left + 0.25 * width, top + 0.25 * height, -960)  # 2⁴ times
        places = self.places()
        self.assertEqual(len(places), 4)
        self.assertEqual(places, [places[0]] * 4)
        self.assertAlmostEqual(places[0][0], 16, places=3)
        self.assertAlmostEqual(places[0][1], 0.25 + 0.25 / 16, places=2)  # what was under the pointer stays there
        for method in METHODS:
            x, y = math.floor(places[0][1] * WIDTH), math.floor(places[0][2] * HEIGHT)
            self.assert_color(self.pixel(f".strip-pane[data-method={method}] canvas", 0.5, 0.5), aces_bytes(color(0, method, x, y)), method)
        self.browser.drag((left + 0.5 * width, top + 0.5 * height), (left + 0.1 * width, top + 0.5 * height))
        moved = self.places()
        self.assertEqual(moved, [moved[0]] * 4)
        self.assertAlmostEqual(moved[0][1] - places[0][1], 0.4 / 16, places=2)
        self.browser.press("ArrowDown")
        self.assertGreater(self.place(".slider canvas")[2], moved[0][2])
        self.browser.press("+")
        self.assertAlmostEqual(self.places()[3][0], 24, places=3)
        self.browser.click_on(".strip-pane[data-method=one] canvas", count=2)
        self.assertEqual(self.places(), [[1, 0.5, 0.5]] * 4)

    def test_inspector_tells_linear_values(self):
        self.case(2)
        left, top, width, height = self.browser.box(".slider canvas")
        x, y = 17, 15
        self.browser.move(left + (x + 0.5) / WIDTH * width, top + (y + 0.5) / HEIGHT * height)
        self.assertIn(f"Pixel {x}, {y}", self.browser.run("document.querySelector('.inspector-place').textContent"))
        for method in METHODS:
            cells = self.browser.run(f"[...document.querySelectorAll('.inspector tr[data-method={method}] td')].map(c => c.textContent)")
            for text, value in zip(cells[1:4], color(2, method, x, y)):
                self.assertAlmostEqual(float(text), value, delta=2e-3 * value)
        self.browser.click(left + (x + 0.5) / WIDTH * width, top + (y + 0.5) / HEIGHT * height)
        self.browser.move(left + 5, top + 5)
        self.assertIn(f"Pixel {x}, {y}", self.browser.run("document.querySelector('.inspector-place').textContent"))

    def test_exposure_changes_the_pictures(self):
        self.case(0)
        self.browser.run("(() => { const r = document.getElementById('exposure'); r.value = 1; r.dispatchEvent(new Event('input')); })()")
        self.browser.settle()
        shown = self.pixel(".strip-pane[data-method=truth] canvas", (20 + 0.5) / WIDTH, (16 + 0.5) / HEIGHT)
        self.assert_color(shown, aces_bytes([2 * c for c in color(0, "truth", 20, 16)]))

    def test_error_maps_show_where_it_is_wrong(self):
        self.case(0, "truth", "one")
        wrong, right = ((18.5 / WIDTH, 16.5 / HEIGHT), (40.5 / WIDTH, 2.5 / HEIGHT))
        colors = self.browser.run("report.errorColors.map(hexColor)")
        for mode in self.browser.run("modes.slice(1)"):
            self.browser.run(f"document.querySelector('[data-side=right] [data-value={mode}]').click()")
            self.browser.settle()
            canvas = ".strip-pane[data-method=one] canvas"
            zero = [244] * 3 if mode == "signed" else colors[0]
            self.assert_color(self.pixel(canvas, *right), zero, mode)
            self.assertGreater(max(abs(a - b) for a, b in zip(self.pixel(canvas, *wrong), zero)), 60, mode)
            self.assert_color(self.pixel(".strip-pane[data-method=truth] canvas", *wrong), zero, mode)
            self.assertGreater(self.browser.run("document.querySelectorAll('.legend .ramp').length"), 0)
        self.assertIn("difference", self.browser.run("modes"))
        self.assertIn("error", self.browser.run("modes"), "the library's error map is missing")

    def test_table_row_chooses_and_commands_are_there(self):
        self.case(0, "truth", "one")
        self.browser.run("document.querySelector('#case-table tr[data-method=eight]').click()")
        self.browser.settle()
        self.assertEqual(self.browser.run("document.querySelector('.tag.right').textContent"), "Raster, 8 samples")
        commands = self.browser.run("[...document.querySelectorAll('pre')].map(p => p.textContent)")
        self.assertEqual(len(commands), 3)
        self.assertTrue(commands[0].startswith("pelage render straight.json"))
        self.assertIn("strands1000", self.browser.run("document.querySelector('.settings').textContent"))
        self.assertNotIn("[object", self.browser.run("document.getElementById('app').textContent"))

    def test_zz_no_way_out(self):
        """The page may not ask a server even where a script in it would; runs last, for the browser complains of it."""
        self.overview()
        blocked = self.browser.run("fetch('http://127.0.0.1:9/').then(() => false, () => true)")
        loaded = self.browser.run("""new Promise(done => { const i = new Image(); i.onload = () => done(true); i.onerror = () => done(false);
                                     i.src = 'http://127.0.0.1:9/x.png'; })""")
        self.assertTrue(blocked)
        self.assertFalse(loaded)
        self.assertTrue(any("Content Security Policy" in c for c in self.browser.complaints), self.browser.complaints)
        self.browser.complaints.clear()
        self.browser.requests[:] = [url for url in self.browser.requests if "127.0.0.1:9" not in url]


def take_screenshots(folder):
    os.makedirs(folder, exist_ok=True)
    with tempfile.TemporaryDirectory() as work:
        write_cases(pathlib.Path(work))
        subprocess.run([PELAGE, "report", f"{work}/cases.json", "-o", f"{work}/out"], check=True)
        for dark in (False, True):
            with Chromium(BROWSER, dark=dark) as browser:
                name = f"{folder}/{'dark' if dark else 'light'}"
                browser.open(f"file://{work}/out/index.html")
                browser.screenshot(f"{name}-overview.png", whole=True)
                browser.open("about:blank")
                browser.open(f"file://{work}/out/index.html#case=0")
                browser.wait_for("document.querySelectorAll('.strip canvas[data-zoom]').length === 3")
                browser.screenshot(f"{name}-case.png", whole=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pelage")
    parser.add_argument("--screenshots", metavar="DIR", help="write pictures of the pages there instead of testing")
    parser.add_argument("tests", nargs="*", help="names of tests, e.g. Page.test_filter_leaves_what_is_chosen")
    options = parser.parse_args()
    PELAGE, BROWSER = options.pelage, find_chromium()
    if not BROWSER:
        print("skipped: no Chromium is installed (Debian package chromium-headless-shell)")
        sys.exit(SKIPPED)
    if options.screenshots:
        take_screenshots(options.screenshots)
        sys.exit(0)
    unittest.main(argv=[sys.argv[0], *options.tests], verbosity=2)
