#!/usr/bin/env python3
"""Every lint finds what it is there for: one broken line at a time in an otherwise clean little tree."""
import os
import subprocess
import sys
import tempfile
import unittest

LINT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tools", "lint.py")

KERNEL = "src/kernel/curve/bases.h"
CLEAN = {
    "src/kernel/kernels.inc": '#include "kernel/curve/bases.h"\n',
    KERNEL: "// Catmull & Rom 1974; references.bib: Catmull1974Splines.\n"
            "const float kBound = 1.0e-6f;\n"
            "struct CurveSpan {\n  Vec3 p0, p1;\n};\n"
            "PELAGE_FN Float curve_half(Float t) {\n"
            "  Mask low = t < Float(0.5f) && t >= Float(-2.0f);\n"
            "  return select(low, t * Float(0.5f), t);\n}\n"
            "PELAGE_FN Float curve_quarter(Float t) { return curve_half(curve_half(t)); }\n",
    "src/raster/dda.cpp": '#include "core/buffer.h"\n#include "frame/frame.h"\n#include "kernel/scalar.h"\n',
    "src/raster/dda_test.cpp": '#include "assemble/assemble.h"\n',
    "src/frame/frame.cpp": '#include "raster/dda.h"\n',
    "include/pelage/io.h": "#include <pelage/image.h>\n",
    "tests/parity/parity_cases.inc": "PELAGE_PARITY(curve_quarter, 0.0f, (0.0f, 1.0f), curve_quarter(a))\n",
    "references.bib": "@inproceedings{Catmull1974Splines,\n}\n",
}

# check, file, line to add, words of the finding
BROKEN = [
    ("includes", "src/raster/dda.cpp", '#include "assemble/assemble.h"', "raster must not include assemble/assemble.h"),
    ("includes", "src/frame/frame.h", '#include "raster/dda.h"', "frame must not include raster/dda.h"),
    ("includes", "src/kernel/scalar.h", '#include "raster/dda.h"', "kernel must not include raster/dda.h"),
    ("includes", "src/frame/frame.cpp", '#include "cli/main.h"', "frame must not include cli/main.h"),
    ("includes", "src/extra/new.cpp", "", "has no row"),
    ("includes", "include/pelage/io.h", '#include "core/buffer.h"', "public header"),
    ("kernel-subset", KERNEL, "#include <cmath>", "no preprocessor"),
    ("kernel-subset", KERNEL, "PELAGE_FN Float curve_x(Float t) { auto s = t; return s; }", "not in the subset: auto"),
    ("kernel-subset", KERNEL, "PELAGE_FN Float curve_x(Float t) { if (t) return t; }", "not in the subset: if"),
    ("kernel-subset", KERNEL, "PELAGE_FN Float curve_x(Float t) { return std::exp(t); }", "no namespaces"),
    ("kernel-subset", KERNEL, "PELAGE_FN void curve_x(Float& t) {}", "no references or pointers"),
    ("kernel-subset", KERNEL, "PELAGE_FN Float curve_x(Float t) { return t * 0.5; }", "ends in f: 0.5"),
    ("kernel-subset", KERNEL, "PELAGE_FN Float curve_x(Float t) { return t * 1e-5; }", "ends in f: 1e-5"),
    ("kernel-subset", KERNEL, "PELAGE_FN Float curve_x(Float t = 1.0f) { return t; }", "no default arguments"),
    ("kernel-subset", KERNEL, "PELAGE_FN Float bend(Float t) { return t; }", "lacks the prefix curve_"),
    ("kernel-subset", KERNEL, "Float curve_x(Float t) { return t; }", "does not start with PELAGE_FN"),
    ("kernel-subset", KERNEL, "PELAGE_FN Float curve_x(Float t) { double s; return t; }", "only real type"),
    ("parity", KERNEL, "PELAGE_FN Float curve_x(Float t) { return t; }", "curve_x has no line"),
    ("kernel-subset", "src/kernel/light/falloff.h", "", "not listed"),
    ("length", "src/raster/dda.cpp", "\n" * 1000, "split it"),
    ("leftovers", "src/raster/dda.cpp", "// TODO: later", "unfinished"),
    ("leftovers", "src/raster/dda.cpp", "#if 0", "dead code"),
    ("leftovers", "src/raster/dda_test.cpp", "TEST(A, DISABLED_B) {}", "disabled test"),
    ("leftovers", "src/raster/dda_test.cpp", "GTEST_SKIP();", "a skip prints its reason"),
    ("leftovers", "test.sh", "cd /home/someone", "a path of one machine"),
    ("whitespace", "src/raster/dda.cpp", "int a; ", "trailing blank"),
    ("whitespace", "src/raster/dda.cpp", "\tint a;", "tab"),
    ("citations", "src/raster/dda.cpp", "// references.bib: Nobody1999Nothing", "not in references.bib"),
    ("citations", "references.bib", "@book{Some2000Book,\n}", "nothing cites Some2000Book"),
    ("links", "src/raster/dda.cpp", "// Derivation: docs/derivations/dda.md", "docs/derivations/dda.md does not exist"),
    ("links", "README.md", "[how](docs/how.md)", "docs/how.md does not exist"),
    ("binaries", "src/raster/shader.spv", "\0", "a binary file outside"),
]


def lint(files, check):
    with tempfile.TemporaryDirectory() as root:
        for name, text in files.items():
            os.makedirs(os.path.dirname(os.path.join(root, name)) or root, exist_ok=True)
            with open(os.path.join(root, name), "w", encoding="utf-8") as f:
                f.write(text)
        done = subprocess.run([sys.executable, LINT, check, "--root", root], capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr


class Lint(unittest.TestCase):
    def test_clean_tree_has_no_findings(self):
        for check in sorted({row[0] for row in BROKEN}):
            with self.subTest(check):
                self.assertEqual(lint(CLEAN, check)[0], 0, lint(CLEAN, check)[1])

    def test_each_broken_line_is_found(self):
        for check, file, line, words in BROKEN:
            with self.subTest(check=check, line=line):
                code, output = lint({**CLEAN, file: CLEAN.get(file, "") + line + "\n"}, check)
                self.assertEqual(code, 1, output)
                self.assertIn(words, output)

    def test_unknown_check_is_an_error(self):
        self.assertEqual(lint(CLEAN, "spelling")[0], 2)


if __name__ == "__main__":
    unittest.main()
