"""References of many samples take minutes to hours, so they are kept in a folder that outlives builds and output folders.

A reference is found again by what decides its pixels: the bytes of its input files, the options, and a picture of two samples that
the program at hand makes of them. A program whose change does not show in that picture takes references of an older one.
"""
import hashlib
import json
import pathlib
import subprocess
import time

from demo_report import Failure

PROBE_SAMPLES = 2
NICENESS = 10  # a reference steps back behind everything else that runs


class ReferenceCache:
    suffixes = (".exr",)  # of the files that a reference is written as; the first is its name

    def __init__(self, shop, folder):
        self.shop, self.folder = shop, pathlib.Path(folder).resolve()
        self.folder.mkdir(parents=True, exist_ok=True)

    def key(self, arguments, files, label):
        probe = f"probes/{label}.exr"
        self.shop.make(self.command(arguments, PROBE_SAMPLES), files, probe)
        told = hashlib.sha256(json.dumps([pathlib.Path(a).name if a in files else a for a in arguments]).encode())
        for name in [*files, probe]:
            told.update((self.shop.folder / name).read_bytes())
        return told.hexdigest()[:16]

    @staticmethod
    def command(arguments, samples):
        return ["render", *arguments, "--float", "--method", "ssaa", "--spp", str(samples)]

    def picture(self, arguments, files, samples, label):
        """(file, seconds that it took) of `pelage render ARGUMENTS` with that many samples; `files` are those it reads."""
        name = f"{label}-{samples}-{self.key(arguments, files, label)}"
        file, note = self.folder / f"{name}.exr", self.folder / f"{name}.json"
        if not (file.exists() and note.exists()):
            print(f"{label}: reference of {samples} samples, to be kept as {file}", flush=True)
            self.render(arguments, samples, file, note)
        return str(file), json.loads(note.read_text())["seconds"]

    def outputs(self, file):
        return [word for suffix in self.suffixes for word in ("-o", str(file.with_suffix(suffix)))]

    def render(self, arguments, samples, file, note):
        command = self.command(arguments, samples)
        start = time.monotonic()
        done = subprocess.run(["nice", "-n", str(NICENESS), self.shop.pelage, *command, *self.outputs(file)], cwd=self.shop.folder,
                              capture_output=True, text=True)
        if done.returncode != 0:
            raise Failure(done.stderr.strip().splitlines()[0] if done.stderr.strip() else f"exit status {done.returncode}")
        note.write_text(json.dumps({"seconds": round(time.monotonic() - start, 1), "command": " ".join(["pelage", *command])}) + "\n")
