#!/usr/bin/env python3
"""Breaks a kernel header, one small change at a time, and reports which changes its tests did not notice.

  tools/mutate.py src/kernel/math/elementary.h [--tests REGEX] [--library | --also SOURCE …] [--minutes 10] [--seed 1]

Works in a copy of the tree (build/mutate), so the checkout is never touched. Each mutant swaps an operator, a comparison,
a function or moves a constant by 1 %, rebuilds the tests that --tests names (by default those of the header's topic) and runs
them. Only the tests themselves are compiled again, which suits those that call the kernel directly; with --library what
they link is too, for formulas that they reach through a stage, and with --also the named sources of it, for one instruction
set, which is much faster. A surviving mutant is a change that no test noticed; each
is printed. Exit 1 where there is one.
"""
import argparse
import os
import random
import re
import shutil
import subprocess
import sys
import time

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
COPY = os.path.join(ROOT, "build", "mutate", "tree")

# Tests that state what a topic's formulas have to give, by ctest name. Parity is of no use: it breaks all targets alike.
TESTS = {"math": "kernel_math", "curve": "kernel_curve", "scatter": "scatter", "raster": "raster", "light": "light", "shade": "shade",
         "composite": "tonemap", "lod": "bundle_lod", "style": "hairmesh_strands"}

SWAPS = [
    (r" \+ ", " - "), (r" - ", " + "), (r" \* ", " + "), (r" / ", " * "),
    (r" < ", " >= "), (r" > ", " <= "), (r" <= ", " > "), (r" >= ", " < "), (r" == ", " < "),
    (r" && ", " || "), (r" \|\| ", " && "),
    (r"\bmin\(", "max("), (r"\bmax\(", "min("), (r"\bm_sin\(", "m_cos("), (r"\bm_cos\(", "m_sin("), (r"\bsqrt\(", "abs("),
    (r"\bfloor\(", "("), (r"return -", "return "),
]
NUMBER = re.compile(r"(?<![\w.])(\d+\.\d*(?:e[-+]?\d+)?)f\b")


def mutants(lines):
    """(line number, new line) of every single change; comments and stated bounds stay as they are."""
    for number, line in enumerate(lines):
        code = line.split("//")[0]
        if not code.strip() or re.search(r"const float k\w*(Error|Bound)", code):
            continue
        for pattern, replacement in SWAPS:
            for found in re.finditer(pattern, code):
                yield number, code[:found.start()] + replacement + code[found.end():]
        for found in NUMBER.finditer(code):
            value = float(found[1])
            changed = f"{value * 1.01:.9g}" if value else "0.01"
            changed += "" if re.search(r"[.e]", changed) else ".0"
            yield number, code[:found.start()] + changed + "f" + code[found.end():]


def run(command, timeout=600):
    try:
        return subprocess.run(command, cwd=COPY, capture_output=True, text=True, timeout=timeout)
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(command, 124, "", "timed out")


def prepare(tests):
    """A configured copy of the tree; returns the build targets of the tests."""
    if os.path.exists(COPY):
        for name in os.listdir(COPY):
            if name != "build":
                path = os.path.join(COPY, name)
                shutil.rmtree(path) if os.path.isdir(path) else os.remove(path)
    shutil.copytree(ROOT, COPY, dirs_exist_ok=True, copy_function=shutil.copy,
                    ignore=lambda folder, names: [n for n in names if folder == ROOT and re.match(r"build|out$|\.git$", n)])
    data = os.environ.get("PELAGE_DATA", os.path.join(ROOT, "..", "shared", "data"))
    done = run(["cmake", "--preset", "release", "-D", "PELAGE_VULKAN=OFF", "-D", f"PELAGE_DATA={os.path.abspath(data)}"])
    if done.returncode:
        sys.exit(done.stderr)
    listed = run(["ctest", "--preset", "release", "-N", "-R", tests]).stdout
    names = [n for n in re.findall(r"Test +#\d+: (\S+)", listed) if "." not in n]
    if not names:
        sys.exit(f"no test matches {tests}")
    return names


def commands_of(names, sources):
    """The compile and link commands of the tests themselves, as ninja would run them, after those of `sources` of the library."""
    build = os.path.join(COPY, "build", "release")
    commands = []
    for source in sources:
        made = f"CMakeFiles/pelage.dir/{source}.o"
        listed = run(["ninja", "-C", build, "-t", "commands", made]).stdout.strip().split("\n")
        commands += [listed[-1].replace(" -c ", " -DHWY_COMPILE_ONLY_STATIC -c "), f"ar r libpelage.a {made}"]
    for name in names:
        listed = run(["ninja", "-C", build, "-t", "commands", name + "_test"]).stdout.strip().split("\n")
        commands += [c for c in listed if f"/{name}_test.dir/" in c and " -c " in c] + [listed[-1]]
    return [["sh", "-c", f"cd {build} && {command}"] for command in commands]


def survives(names, regex, own_commands):
    builds = own_commands or [["cmake", "--build", "--preset", "release", "--target", *[n + "_test" for n in names]]]
    if any(run(command).returncode for command in builds):
        return None  # does not compile: noticed by the compiler
    return run(["ctest", "--preset", "release", "--stop-on-failure", "-R", regex], 300).returncode == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("header", help="below src/kernel/")
    parser.add_argument("--tests", help="regular expression of ctest names")
    parser.add_argument("--library", action="store_true", help="rebuild what the tests link, too")
    parser.add_argument("--also", nargs="*", default=[], metavar="SOURCE", help="sources of the library to rebuild")
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--seed", type=int, default=1, help="order of the mutants, where time does not suffice for all")
    options = parser.parse_args()
    header = os.path.relpath(os.path.abspath(options.header), ROOT)
    if not re.match(r"src/kernel/\w+/\w+\.h$", header):
        parser.error("a header below src/kernel/<topic>/ is expected")
    names = prepare(options.tests or TESTS.get(header.split("/")[2], header.split("/")[2]))
    regex = "^(" + "|".join(names) + ")$"
    if not survives(names, regex, None):
        sys.exit("the tests fail without any change")
    own_commands = None if options.library else commands_of(names, options.also)

    path = os.path.join(COPY, header)
    with open(path, encoding="utf-8") as f:
        original = f.read()
    lines = original.split("\n")
    todo = list(mutants(lines))
    random.Random(options.seed).shuffle(todo)
    end = time.monotonic() + 60 * options.minutes
    counts = {"killed": 0, "not compiling": 0, "survived": 0}
    for number, line in todo:
        if time.monotonic() > end:
            break
        with open(path, "w", encoding="utf-8") as f:
            f.write("\n".join(lines[:number] + [line] + lines[number + 1:]))
        result = survives(names, regex, own_commands)
        counts["not compiling" if result is None else "survived" if result else "killed"] += 1
        if result:
            print(f"{header}:{number + 1}: survived:\n  - {lines[number].strip()}\n  + {line.strip()}", flush=True)
    with open(path, "w", encoding="utf-8") as f:
        f.write(original)
    print(f"{header}: {sum(counts.values())} of {len(todo)} mutants tried against {', '.join(names)}: " +
          ", ".join(f"{count} {name}" for name, count in counts.items()))
    return 1 if counts["survived"] else 0


if __name__ == "__main__":
    sys.exit(main())
