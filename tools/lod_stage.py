"""What tools/lod_report.py looks at: grooms with their chains before a camera that goes nearer and farther, and pictures of them beside path-traced ones."""
import json
import math
import subprocess

from demo_report import Failure, light_direction
from png_sheet import read_png
from reference_cache import ReferenceCache

COLORS = {"blond": (0.08, 0.1), "light-brown": (0.28, 0.15), "red-brown": (0.7, 0.9), "black": (6, 0)}  # eumelanin, pheomelanin
SHOTS = {"near": 0.6, "middle": 0.2, "far": 0.02}  # share of the picture that hair takes
FINER = {"near": 1, "middle": 2, "far": 4}  # times as many pixels a side, so that hair takes as many of them everywhere
FALL, FOV, AZIMUTH, ELEVATION = -20, 26, 145, 8  # of light and camera, degrees: hair is seen from behind, aside


class TraceCache(ReferenceCache):
    """References by `pelage trace` of all strands, as PNG too."""
    suffixes = (".exr", ".png")

    @staticmethod
    def command(arguments, samples):
        return ["trace", *arguments, "--spp", str(samples)]


def tell(shop, *arguments):
    """What `pelage ARGUMENTS --json` prints."""
    done = subprocess.run([shop.pelage, *arguments, "--json"], cwd=shop.folder, capture_output=True, text=True)
    if done.returncode != 0:
        raise Failure(done.stderr.strip().splitlines()[0] if done.stderr.strip() else f"exit status {done.returncode}")
    return json.loads(done.stdout)


def groom(shop, style, options):
    """(file of a groom, file of it with its chain, stamp of building that)."""
    plain, file = f"grooms/{style}-{options.strands}.pelage", f"grooms/{style}-{options.strands}-lod.pelage"
    shop.make(["grow", style, "--strands", str(options.strands), "--points", "64"], [], plain)
    return plain, file, shop.make(["lod", "build", plain], [plain], file, json_output=True)


class Stage:
    """A groom before a camera that goes nearer and farther."""
    azimuth, mannequin = AZIMUTH, [{"shape": "mannequin"}]

    def __init__(self, shop, style, options):
        self.shop, self.options, self.style = shop, options, style
        self.plain, self.file = self.grown()  # the groom; the same with its chain
        box = tell(shop, "info", self.file)["bounds"]
        self.target = [(a + b) / 2 for a, b in zip(box["lower"], box["upper"])]
        self.size = max(b - a for a, b in zip(box["lower"], box["upper"]))

    def grown(self):
        return groom(self.shop, self.style, self.options)[:2]

    def scene(self, away, pixels, color="light-brown", light=45, head=True, background=(0.12, 0.13, 0.15)):
        azimuth, elevation = math.radians(self.azimuth), math.radians(ELEVATION)
        back = (math.sin(azimuth) * math.cos(elevation), math.sin(elevation), math.cos(azimuth) * math.cos(elevation))
        camera = {"eye": [round(c + away * b, 5) for c, b in zip(self.target, back)], "target": self.target, "fov": FOV}
        eumelanin, pheomelanin = COLORS[color]
        return {"camera": camera, "meshes": self.mannequin if head else [],
                "lights": [{"type": "directional", "direction": light_direction(camera, light, FALL), "intensity": [6, 6, 6]}],
                "grooms": [{"file": f"../{self.file}", "material": {"eumelanin": eumelanin, "pheomelanin": pheomelanin}}],
                "settings": {"width": pixels, "height": pixels, "background": list(background)}}

    def write(self, name, scene):
        file = f"scenes/{name}.json"
        (self.shop.folder / file).write_text(json.dumps(scene, indent=1) + "\n")
        return file

    def render(self, name, scene, *arguments, output=None):
        """(file, stamp) of a picture; `name` says what is seen, `output` what is made of it."""
        file, output = self.write(name, scene), output or f"pictures/{name}.exr"
        return output, self.shop.make(["render", file, *arguments], [file, self.file], output, json_output=True)

    def covered(self, away):
        """Share of the picture that hair takes."""
        self.render(f"{self.style}-share", self.scene(away, 128), "--no-lod", "--view", "coverage", output=f"pictures/{self.style}-share.png")
        picture = read_png(self.shop.folder / f"pictures/{self.style}-share.png")
        return sum(linear(v) for row in picture.rows for v in row[::3]) / (picture.width * picture.height)

    def distance(self, share):
        """Metres from which hair takes `share` of the picture; as near as it gets where it never does. Kept."""
        note = self.shop.folder / "distances.json"
        known = json.loads(note.read_text()) if note.exists() else {}
        key = f"{self.file} {share}"
        if key not in known:
            away = 0.8 * self.size / math.sqrt(share)
            for _ in range(10):
                found = self.covered(away)
                before, away = away, max(0.7 * self.size, away * min(2, max(0.5, found / share)) ** 0.5)
                if abs(found / share - 1) < 0.03 or away == before:
                    break
            known[key] = round(away, 4)
            note.write_text(json.dumps(known, indent=1) + "\n")
        return known[key]


def linear(value):
    """Of an sRGB byte."""
    v = value / 255
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def work(stamp):
    """Seconds of the stages of a frame, without files."""
    return sum(s["seconds"] for s in stamp["told"]["stages"] if not s["stage"].startswith("io."))


def stage_seconds(told, stage):
    return sum(s["seconds"] for s in told["stages"] if s["stage"] == stage)


def stage_items(told, stage):
    return sum(s["items"] for s in told["stages"] if s["stage"] == stage)


def compare(shop, test, reference, *arguments):
    return tell(shop, "compare", test, reference, *arguments)


class Shot:
    """A hairstyle in a color and a light, so far away that it takes its share of the picture."""

    def __init__(self, stage, shot, color, light):
        self.stage, self.shot, self.color, self.light = stage, shot, color, light
        self.name = f"{stage.style}-{shot}-{color}-{light}"
        self.pixels = FINER[shot] * stage.options.size
        self.scene = stage.scene(stage.distance(SHOTS[shot]), self.pixels, color, light)

    def mask(self):
        scene = self.stage.scene(self.stage.distance(SHOTS[self.shot]), self.pixels)
        return self.stage.render(f"{self.stage.style}-{self.shot}-mask", scene, "--no-lod", "--view", "coverage", "--float")[0]

    def truth(self, cache):
        """All strands, path traced: of the groom without its chain, so that it stays good when chains are built otherwise."""
        scene = {**self.scene, "grooms": [{**self.scene["grooms"][0], "file": f"../{self.stage.plain}"}]}
        file = self.stage.write(f"{self.name}-truth", scene)
        return cache.picture([file], [file, self.stage.plain], self.stage.options.samples, self.name)[0]

    def picture(self, name, arguments):
        """(EXR, PNG, stamp) of a method; arguments are options of `pelage render`."""
        stem = f"pictures/{self.name}-{name}"
        output, stamp = self.stage.render(self.name, self.scene, *arguments, "--method", "ssaa", "--spp", str(self.stage.options.render_samples),
                                          "-o", f"{stem}.png", output=f"{stem}.exr")
        return output, f"{stem}.png", stamp

    def flip(self, picture, truth):
        return compare(self.stage.shop, picture, truth, "--mask", self.mask(), "--tone-map", "aces", "--metrics", "flip")["flip"]

    def energy(self, picture, truth):
        return compare(self.stage.shop, picture, truth, "--mask", self.mask(), "--metrics", "energy")["energy"]

    def tile(self, file, side):
        """The hair of a PNG, magnified to about `side` pixels."""
        whole = read_png(self.stage.shop.folder / file)
        crop = min(whole.width, max(8, int(1.7 * whole.width * math.sqrt(SHOTS[self.shot]))))
        corner = (whole.width - crop) // 2
        return whole.crop(corner, corner, crop, crop).magnified(max(1, side // crop))
