#!/usr/bin/env python3
"""Rules of the house that a machine can check (HACKING.md says why they are there).

  tools/lint.py [CHECK…] [--root DIR] [--list]

Prints one `file:line: check: what is wrong` a finding; exit 1 where there is one. Without CHECK all run.
A check is a function below that yields (file, line, message); adding one is writing it.
"""
import argparse
import os
import re
import sys

SKIPPED_FOLDERS = re.compile(r"^(\.git|\.cache|build.*|out|__pycache__)$")
CODE = (".h", ".cpp", ".inc", ".comp", ".glsl")
TEXT = CODE + (".py", ".sh", ".cmake", ".txt", ".md", ".json", ".bib", ".in", ".html", ".css", ".js")

# ---------------------------------------------------------------------------------------------------------------------
# Layers: who may include whom. core ← kernel ← stages ← frame ← apps. The headers of frame/ declare what flows between
# stages and how it is read, so every stage sees them; in return they see no stage (only frame's .cpp files do).

STAGES = {"io", "groom", "lod", "assemble", "raster", "light", "shade", "filter", "composite"}
LAYERS = {
    "core": {"core"},
    "kernel": {"core", "kernel"},
    **{stage: {"core", "kernel", "frame", stage} for stage in STAGES},
    "frame": {"core", "kernel", "frame"} | STAGES,
    "metrics": {"core", "io", "metrics"},
    "reference": {"core", "kernel", "io", "frame", "reference"},
    "report": {"core", "io", "report"},
    "backend": {"core", "kernel", "frame", "backend"},
}
FRAME_HEADERS = {"core", "kernel", "frame"}
# Fused on purpose: blocks of points stream from assemble into raster and never stand in memory all at once.
EXCEPTIONS = {
    ("src/raster/raster.cpp", "assemble/assemble.h"),
    # Strands of a hair mesh stand nowhere but on their way from its cage through assemble into raster.
    ("src/lod/bundle_lod.cpp", "groom/hairmesh/prepared.h"),
    ("src/assemble/strand_block.h", "groom/hairmesh/strand_group.h"),
    ("src/raster/deferred.cpp", "assemble/strand_block.h"),
    ("src/raster/deferred.cpp", "groom/hairmesh/prepared.h"),
    ("src/raster/deferred.cpp", "groom/hairmesh/strand_group.h"),
    ("src/shade/deferred.cpp", "groom/hairmesh/prepared.h"),
}


class Tree:
    """The files below a root, read once."""

    def __init__(self, root):
        self.root = root
        self.files = []
        for folder, subfolders, names in os.walk(root):
            subfolders[:] = sorted(s for s in subfolders if not SKIPPED_FOLDERS.match(s))
            self.files += [os.path.relpath(os.path.join(folder, n), root) for n in sorted(names)]
        self._lines = {}

    def lines(self, file):
        if file not in self._lines:
            with open(os.path.join(self.root, file), encoding="utf-8", errors="replace") as f:
                self._lines[file] = f.read().split("\n")
        return self._lines[file]

    def under(self, *prefixes, ends=CODE):
        return [f for f in self.files if f.startswith(prefixes) and f.endswith(ends)]

    def text(self):
        return [f for f in self.files if f.endswith(TEXT) or "." not in os.path.basename(f)]


def without_comment(line):
    return re.sub(r"//.*", "", line)


def check_includes(tree):
    """Include direction: a stage sees core, kernel, itself and the headers of frame; tests and benchmarks see everything."""
    for file in tree.under("src/"):
        if file.endswith("_test.cpp"):
            continue
        layer = file.split("/")[1]
        if layer not in LAYERS:
            yield file, 1, f"src/{layer} has no row in the table of layers (tools/lint.py)"
            continue
        for number, line in enumerate(tree.lines(file), 1):
            found = re.match(r'\s*#\s*include\s*"([^"]+)"', line)
            if not found or "/" not in found[1]:
                continue
            target = found[1]
            allowed = FRAME_HEADERS if re.match(r"src/frame/.*\.h$", file) else LAYERS[layer]
            if target.split("/")[0] not in allowed and (file, target) not in EXCEPTIONS:
                yield file, number, f"{layer} must not include {target}"
    for file in tree.under("include/pelage/"):
        for number, line in enumerate(tree.lines(file), 1):
            if re.match(r'\s*#\s*include\s*"', line):
                yield file, number, "a public header includes <pelage/…> and the standard library only"


# The subset that scalar C++, wide C++ and GLSL share; pattern, what to say.
SUBSET = [
    (r"#", "no preprocessor lines in a kernel header"),
    (r"\b(auto|template|static|inline|constexpr|class|namespace|using|typename|if|else|while|do|switch|goto)\b", "not in the subset: {}"),
    (r"\bstd::|\w::\w", "no namespaces in a kernel header"),
    (r"\b(Float|Vec[234]|Mask|float|int|[A-Z]\w+)\s*[&*]\s*\w+\s*[,)=;]", "no references or pointers"),
    (r"\[\s*[&=]?\s*\]\s*\(", "no lambdas"),
    (r"(?<![\w.])(\d+\.\d*|\.\d+|\d+(?=e))(e[-+]?\d+)?(?![\w.]*f\b|\d|\w)", "a float literal ends in f: {}"),
    (r"\bdouble\b", "Float is the only real type"),
]
PREFIXES = {"math": ("m_", "v_")}


def kernel_headers(tree):
    return [f for f in tree.under("src/kernel/", ends=(".h",)) if f.count("/") >= 3]


def check_kernel_subset(tree):
    """Kernel headers keep to the subset that C++ and GLSL share, and to their topic's prefix."""
    listed = "\n".join(tree.lines("src/kernel/kernels.inc")) if "src/kernel/kernels.inc" in tree.files else ""
    for file in kernel_headers(tree):
        topic = file.split("/")[2]
        prefixes = PREFIXES.get(topic, (topic + "_",))
        if f'"{file[4:]}"' not in listed:
            yield file, 1, "is not listed in src/kernel/kernels.inc"
        depth = 0
        for number, line in enumerate(tree.lines(file), 1):
            code = without_comment(line)
            for pattern, message in SUBSET:
                found = re.search(pattern, code)
                if found:
                    yield file, number, message.format(found[0])
            function = re.match(r"\s*(PELAGE_FN\s+)?(?:Float|Vec[234]|Mask|int|bool|void|[A-Z]\w+)\s+(\w+)\s*\(", code)
            if function and depth == 0:
                if not function[1]:
                    yield file, number, f"{function[2]} does not start with PELAGE_FN"
                if not function[2].startswith(prefixes):
                    yield file, number, f"{function[2]} lacks the prefix {' or '.join(prefixes)}"
                if re.search(r"\([^)]*=[^=]", code.split("{")[0]):
                    yield file, number, "no default arguments"
            depth += code.count("{") - code.count("}")


def check_parity(tree):
    """Every kernel function has a parity case, or one that has it calls it."""
    cases = "tests/parity/parity_cases.inc"
    if cases not in tree.files:
        return
    places, calls = {}, {}
    for file in kernel_headers(tree):
        current = None
        for number, line in enumerate(tree.lines(file), 1):
            code = without_comment(line)
            function = re.match(r"\s*PELAGE_FN\s+\w+\s+(\w+)\s*\(", code)
            if function:
                current = function[1]
                places.setdefault(current, (file, number))
                code = code[function.end():]
            if current:
                calls.setdefault(current, set()).update(re.findall(r"(\w+)\s*\(", code))
    known = set()
    for file in (cases, "tests/parity/parity.h"):
        if file in tree.files:
            for line in tree.lines(file):
                known.update(re.findall(r"(\w+)\s*\(", without_comment(line)))
    open_ends = list(known & places.keys())
    while open_ends:
        new = (calls[open_ends.pop()] & places.keys()) - known
        known |= new
        open_ends += new
    for name, (file, number) in places.items():
        if name not in known:
            yield file, number, f"{name} has no line in {cases}"


def check_length(tree):
    """A file has one reason to be, and at most 1000 lines (600 is where one starts to ask)."""
    for file in tree.under("include/", "src/", "apps/", "tests/", "bench/", "tools/", ends=CODE + (".py", ".sh")):
        count = len(tree.lines(file)) - 1
        if count > 1000:
            yield file, count, f"{count} lines; split it"
        elif count > 600:
            print(f"{file}: note: {count} lines, the soft limit is 600", file=sys.stderr)


LEFTOVERS = [
    (r"\b(TODO|FIXME|XXX|HACK)\b", "unfinished work does not stay in the tree"),
    (r"^\s*#\s*if\s+0\b", "dead code"),
    (r"\bDISABLED_", "a disabled test"),
    (r"GTEST_SKIP\(\)\s*;", "a skip prints its reason"),
    (r"(?<![\w.~$}])/(work|home|tmp|root|Users)/\w", "a path of one machine"),
    (r"__DATE__|__TIME__", "builds do not depend on the clock"),
    (r"<{7} |>{7} ", "a merge conflict"),
]


def check_leftovers(tree):
    """Nothing of one machine, one day or one unfinished thought."""
    for file in tree.text():
        if os.path.basename(file) in ("lint.py", "lint_test.py", "LICENSE"):
            continue
        for number, line in enumerate(tree.lines(file), 1):
            for pattern, message in LEFTOVERS:
                if re.search(pattern, line):
                    yield file, number, message


def check_whitespace(tree):
    """No tabs, no trailing blanks, one newline at the end, LF only."""
    for file in tree.text():
        lines = tree.lines(file)
        if lines[-1] or (len(lines) > 1 and not lines[-2]):
            yield file, len(lines), "ends with exactly one newline"
        for number, line in enumerate(lines, 1):
            if line != line.rstrip():
                yield file, number, "trailing blank"
            if "\t" in line:
                yield file, number, "tab"


def check_citations(tree):
    """Every `references.bib: Key` in the tree exists there, and every entry there is cited."""
    if "references.bib" not in tree.files:
        yield "references.bib", 1, "is missing"
        return
    known = {}
    for number, line in enumerate(tree.lines("references.bib"), 1):
        found = re.match(r"@\w+\{(\w+),", line)
        if found:
            if found[1] in known:
                yield "references.bib", number, f"{found[1]} stands here twice"
            known[found[1]] = number
    cited = set()
    for file in tree.text():
        if file == "references.bib" or os.path.basename(file) in ("lint.py", "lint_test.py"):
            continue
        for number, line in enumerate(tree.lines(file), 1):
            for group in re.findall(r"references\.bib: ((?:\w+[,;] ?)*\w+)", line):
                for key in re.findall(r"\b[A-Za-z]\w*\d{4}\w*", group):
                    cited.add(key)
                    if key not in known:
                        yield file, number, f"{key} is not in references.bib"
            cited.update(key for key in re.findall(r"\b[A-Za-z]\w*\d{4}\w*\b", line) if key in known)
    for key, number in known.items():
        if key not in cited:
            yield "references.bib", number, f"nothing cites {key}"


def check_links(tree):
    """Pages that the text sends its reader to exist."""
    known = set(tree.files) | {os.path.dirname(f) for f in tree.files}
    for file in tree.text():
        if os.path.basename(file) in ("lint.py", "lint_test.py"):
            continue
        for number, line in enumerate(tree.lines(file), 1):
            for target in re.findall(r"(?<![\w/.])((?:docs|tools|tests|src|cmake)/[\w/-]+\.(?:md|sh|py|json|h|cpp|inc))\b", line):
                if target not in known:
                    yield file, number, f"{target} does not exist"
            if file.endswith(".md"):
                for target in re.findall(r"\]\(([^)#:\s]+)\)", line):
                    if os.path.normpath(os.path.join(os.path.dirname(file), target)) not in known:
                        yield file, number, f"{target} does not exist"


BINARY_FOLDERS = ("docs/images/", "tests/golden/", "tests/regress/", "tests/fuzz/")


def check_binaries(tree):
    """Only small pictures and recorded inputs are committed, never what a build makes."""
    for file in tree.files:
        path = os.path.join(tree.root, file)
        size = os.path.getsize(path)
        with open(path, "rb") as f:
            binary = b"\0" in f.read(8192)
        if binary and not file.startswith(BINARY_FOLDERS):
            yield file, 1, "a binary file outside " + ", ".join(BINARY_FOLDERS)
        if size > 1_000_000:
            yield file, 1, f"{size} bytes; the limit is 1 MB"


CHECKS = {name[6:].replace("_", "-"): f for name, f in list(globals().items()) if name.startswith("check_")}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checks", nargs="*", metavar="CHECK", help=", ".join(CHECKS))
    parser.add_argument("--root", default=os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
    parser.add_argument("--list", action="store_true", help="name the checks")
    options = parser.parse_args()
    if options.list:
        print("\n".join(CHECKS))
        return 0
    tree = Tree(options.root)
    count = 0
    for name in options.checks or CHECKS:
        if name not in CHECKS:
            parser.error(f"no check {name}; there are {', '.join(CHECKS)}")
        for file, line, message in CHECKS[name](tree):
            print(f"{file}:{line}: {name}: {message}")
            count += 1
    print(f"{count} findings in {len(tree.files)} files")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
