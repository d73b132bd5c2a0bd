# SPDX-License-Identifier: GPL-3.0-or-later
"""The checks must be able to fail: each meets code that breaks its rule, and code that does not.

    selftest.py [CC]     with a compiler, symbols.py meets a real object file too
"""

import contextlib
import io
import os
import subprocess
import sys
import tempfile
import unittest

import budgets
import docs
import layers
import rows
import sizes
import spdx
import symbols

COMPILER = "cc"


def body(lines):
    return "void f(void)\n{\n" + "    x();\n" * (lines - 3) + "}\n"


class Docs(unittest.TestCase):
    PAGE = ("# A\n\n| symbol | code | unit |\n| --- | --- | --- |\n| v | `speed` | m/s |\n\n"
            "| equation | code | unit | source |\n| --- | --- | --- | --- |\n"
            "| (1) rate | `lac_rate` | 1/s | here |\n\n    v = 1          (1)\n")

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        for path, text in {"src/base/a.c": "double lac_rate, speed;\n", "docs/x.md": cls.PAGE,
                           "include/lacuna/b.h": "int lac_b;\n", "tests/unit/test_a.c": "int main;\n"}.items():
            os.makedirs(os.path.join(cls.folder.name, os.path.dirname(path)), exist_ok=True)
            with open(os.path.join(cls.folder.name, path), "w", encoding="utf-8") as file:
                file.write(text)
        cls.project = docs.Project(cls.folder.name)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def refuses(self, check, text, word):
        found = check(self.project, "docs/x.md", text)
        self.assertEqual(len(found), 1, found)
        self.assertIn(word, found[0])

    def test_good(self):
        for check in (docs.check_names, docs.check_links, docs.check_tables):
            self.assertEqual(check(self.project, "docs/x.md", self.PAGE
                                   + "`src/base/a.c` `a.c` `unit/test_a` [x](x.md#a) `lac_x_…`"), [])
        self.assertEqual(docs.check_page("docs/x.md", self.PAGE), [])

    def test_code_map(self):
        whole = "| `base` | rates | `b.h` |"
        self.assertEqual(docs.check_map(self.project, "docs/x.md", whole), [])
        self.refuses(docs.check_map, whole.replace("`base`", "`basis`"), "src/base")
        self.refuses(docs.check_map, whole.replace("`b.h`", ""), "b.h")

    def test_names_that_are_nowhere(self):
        for text, word in (("`lac_gone`", "lac_gone"), ("src/base/b.c", "b.c"), ("`b.c`", "b.c"),
                           ("`unit/test_b`", "test_b")):
            self.refuses(docs.check_names, text, word)

    def test_links_that_lead_nowhere(self):
        self.refuses(docs.check_links, "[x](y.md)", "y.md")
        self.refuses(docs.check_links, "[x](x.md#b)", "#b")

    def test_code_that_is_nowhere(self):
        self.refuses(docs.check_tables, self.PAGE.replace("`speed`", "`pace`"), "pace")

    def test_equations(self):
        for old, new, word in (("(1) rate", "rate", "in no table"), ("v = 1          (1)", "", "has not"),
                               ("v = 1          (1)\n", "v = 1          (1)\n    w = 2         (1)\n",
                                "two equations"),
                               ("| symbol | code | unit |", "| symbol | name | unit |", "symbols")):
            found = docs.check_page("docs/x.md", self.PAGE.replace(old, new))
            self.assertEqual(len(found), 1, found)
            self.assertIn(word, found[0])

    def test_references(self):
        for text, wrong in (('"docs/x.md, \\"A\\""', 0), ('"docs/x.md, eq. 1"', 0),
                            ('"docs/x.md, \\"B\\""', 1), ('"docs/x.md, eq. 2"', 1),
                            ('"docs/y.md"', 1)):
            self.assertEqual(len(docs.check_references(self.project, "src/a.c", text)), wrong, text)


class Rows(unittest.TestCase):
    LAW = 'const law lac_aging = {.info = {.name = "aging",\n .summary = "heals"}, .v = 1};\n'

    def complaints(self, path, text):
        return rows.check(path, text, rows.names({"src/friction/aging.c": self.LAW, "src/case/registry.c":
                                                  'kind k = {.name = "friction", .summary = "laws"};'}))

    def test_macro(self):
        found = rows.names({"src/load/ramp.c": '.info = LAC_ABOUT("ramp", "x", "y", LAC_ROWS(p, q)),'})
        self.assertEqual(found, {"ramp": {"src/load/ramp.c"}})

    def refuses(self, text):
        found = self.complaints("src/fit/line.c", "int x;\n" + text)
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith("src/fit/line.c:2: "), found)

    def test_compared(self):
        self.refuses('bool b = strcmp(law->info.name, "aging") == 0;')
        self.refuses('bool b = strcmp(name_of(law), \n "aging") == 0;')
        self.refuses('const law *l = find_law("aging");')
        self.refuses("bool b = strcmp(c->load.info->name, names[i]) == 0;")

    def test_good(self):
        for path, text in (("src/friction/aging.c", 'strcmp(name, "aging")'),
                           ("src/fit/line.c", 'strcmp(key, "friction") == 0 && law->heals'),
                           ("src/fit/line.c", '// strcmp(name, "aging")\nprintf("%s aging", about->name);'),
                           ("src/case/slot.c", "strcmp(kind->at(i)->name, name)")):
            self.assertEqual(self.complaints(path, text), [])


class Layers(unittest.TestCase):
    def complaints(self, path, line):
        return layers.check(path, "// first\n" + line + "\n")

    def refuses(self, path, line, *words):
        found = self.complaints(path, line)
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(path + ":2: "), found)
        for word in words:
            self.assertIn(word, found[0])

    def test_upward_include(self):
        self.refuses("src/friction/aging.c", '#include "contact/contact.h"', "must not use contact")
        self.refuses("src/base/units.c", '#include "run/run.h"')
        self.refuses("src/load/load.h", '  # include "model/problem.h"', "model")
        self.refuses("src/run/run.c", '#include "lacuna/lacuna.h"', "cli")

    def test_downward_include(self):
        for path, line in (
            ("src/model/newton.c", '#include "transfer/transfer.h"'),
            ("src/run/run.c", '#include "model/problem.h"'),
            ("src/run/run.c", '#include "base/vmath.h"'),
            ("src/run/run.c", '#include "run/engine.h"'),
            ("src/run/run.c", '#include "engine.h"'),
            ("src/cli/common/main.c", '#include "lacuna/lacuna.h"'),
        ):
            self.assertEqual(self.complaints(path, line), [])

    def test_private_headers(self):
        self.refuses("src/store/store.c", '#include "run/engine.h"', "private to run")
        self.refuses("include/lacuna/case.h", '#include "base/vmath.h"', "public header")

    def test_unknown(self):
        self.refuses("src/run/run.c", '#include "magic/wand.h"', "no module")
        self.assertEqual(len(layers.check("src/magic/wand.c", "")), 1)

    def test_libraries(self):
        self.refuses("src/model/problem.c", "#include <cvodes/cvodes.h>", "src/run/")
        self.refuses("src/model/problem.c", "#include <sunlinsol/sunlinsol_dense.h>", "src/run/")
        self.refuses("src/scene/scene.c", "#include <netcdf.h>", "src/store/")
        self.refuses("include/lacuna/case.h", "#include <yaml.h>", "src/case/")
        self.refuses("src/base/param.c", "#include <udunits2.h>", "src/base/units.c")
        self.refuses("src/contact/solve.c", "#include <fftw3.h>", "src/base/fft.c")
        self.refuses("src/surface/x.c", "#include <Random123/philox.h>", "src/base/rng.c")
        self.refuses("include/lacuna/rg.h", "#include <gsl/gsl_sf.h>", "src/")
        self.refuses("src/cli/run/run.c", "#include <netcdf.h>", "src/store/")
        self.refuses("src/run/run.c", "#include <curl/curl.h>", "is new")
        self.assertEqual(self.complaints("src/run/x.c", "#include <cvodes/cvodes.h>"), [])
        self.assertEqual(self.complaints("src/base/fft.c", "#include <fftw3.h>"), [])
        self.assertEqual(self.complaints("src/cli/common/libraries.c", "#include <netcdf.h>"), [])

    def test_comments_do_not_count(self):
        self.assertEqual(self.complaints("src/base/x.c", '/*\n#include "run/run.h"\n*/'), [])

    def test_no_cycles(self):
        for module, used in layers.USES.items():
            for other in used:
                self.assertNotIn(module, layers.reach(other))


class Sizes(unittest.TestCase):
    def refuses(self, text, *words):
        found = sizes.check("src/x.c", text)
        self.assertEqual(len(found), 1, found)
        for word in words:
            self.assertIn(word, found[0])

    def test_function_length(self):
        self.assertEqual(sizes.check("src/x.c", body(60)), [])
        self.refuses("int a;\n\n" + body(61), ":3:", "f: 61 lines")

    def test_file_length(self):
        self.assertEqual(sizes.check("src/x.c", "\n" * 500), [])
        self.refuses("\n" * 501, "501 lines")

    def test_parameters(self):
        eight = ", ".join(f"int p{i}" for i in range(7)) + ", int (*g)(int, int, int)"
        self.assertEqual(sizes.check("src/x.c", f"int f({eight})\n{{\n}}\n"), [])
        self.refuses(f"int f({eight}, int q)\n{{\n}}\n", "9 parameters")
        self.refuses(
            f"__attribute__((format(printf, 1, 2))) int f({eight}, int q)\n{{\n}}\n", "9 parameters"
        )

    def test_nesting(self):
        heads = ["if (x(1)) {", "for (;;) {", "while (x) {", "do {"]
        deep = "void f(void)\n{\n" + "\n".join(heads) + "\n%s\n" + "}\n" * 3 + "} while (0);\n}\n"
        self.assertEqual(sizes.check("src/x.c", deep % "int a[] = {1, (int){2}};"), [])
        self.refuses(deep % "switch (x) { case 1: break; }", "5 levels")
        self.refuses(deep % "{ x(); }", "5 levels")
        self.refuses(deep % "if (x) y();\nelse { x(); }", "5 levels")

    def test_what_is_no_function(self):
        text = (
            "static const struct row rows[] = {{1, f(2)}, {3, 4}};\n"
            "struct s { int (*call)(int, int); };\n"
            "enum { A = (1), B };\n"
            'static const char *text = "} { (";\n'
            "#define LOOP(x) \\\n    do {         \\\n    } while (0)\n"
            "// }}}\n/* {{{ */\n"
        )
        self.assertEqual(sizes.functions(sizes.source.code(text)), [])
        self.assertEqual(sizes.check("src/x.c", text), [])

    def test_functions_are_found(self):
        text = "static const struct a *g(void)\n{\n}\n\nint h(int a, int b) { return a; }\n"
        found = sizes.functions(text)
        self.assertEqual([row[0] for row in found], ["g", "h"])
        self.assertEqual([row[1] for row in found], [1, 5])
        self.assertEqual([row[3] for row in found], [0, 2])

    def test_broken_braces(self):
        self.refuses("void f(void)\n{\n", "not closed")
        self.refuses("}\n", "too many")


CLEAN = """
#include <math.h>
struct row { const char *name; double (*call)(double); };
const struct row lac_rows[] = {{"sin", sin}};
static const int small[] = {1, 2};
int lac_get(int i) { return small[i]; }
"""


class Symbols(unittest.TestCase):
    def complaints(self, text):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "x.c")
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            made = os.path.join(folder, "x.o")
            subprocess.run([COMPILER, "-O1", "-w", "-c", path, "-o", made], check=True)
            archive = os.path.join(folder, "libx.a")
            subprocess.run(["ar", "rcs", archive, made], check=True)
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(io.StringIO()):
                status = symbols.main(archive)
            self.assertEqual(status != 0, printed.getvalue() != "")
            return printed.getvalue().splitlines()

    def refuses(self, text, *words):
        found = self.complaints(CLEAN + text)
        self.assertEqual(len(found), 1, found)
        for word in words:
            self.assertIn(word, found[0])

    def test_clean(self):
        self.assertEqual(self.complaints(CLEAN), [])

    def test_name(self):
        self.refuses("int helper(void) { return 1; }", "helper", "lac_")

    def test_writable(self):
        self.refuses("int lac_counter;", "lac_counter is writable")
        self.refuses("int lac_counter = 3;", "lac_counter is writable")
        self.refuses("int lac_next(void) { static int n; return ++n; }", "writable")
        self.refuses("int lac_n(void) { static _Thread_local int n; return ++n; }", "writable")
        self.refuses("const char *lac_word = \"a\";", "lac_word is writable")

    def test_calls(self):
        self.refuses("int printf(const char *, ...);\nvoid lac_say(void) { printf(\"%d\", 1); }", "printf")
        self.refuses("void exit(int);\nvoid lac_end(void) { exit(1); }", "exit")
        self.refuses("long time(long *);\nlong lac_now(void) { return time(0); }", "time")
        self.refuses("char *getenv(const char *);\nchar *lac_e(void) { return getenv(\"A\"); }", "getenv")

    def test_empty(self):
        self.assertEqual(len(self.complaints("static int a;")), 1)


class Budgets(unittest.TestCase):
    def measure(self, **files):
        with tempfile.TemporaryDirectory() as root:
            for name, text in files.items():
                path = os.path.join(root, name.replace("__", "/").replace("_h", ".h").replace("_c", ".c").replace("_md", ".md"))
                os.makedirs(os.path.dirname(path), exist_ok=True)
                with open(path, "w", encoding="utf-8") as file:
                    file.write(text)
            return budgets.measure(root)

    def test_numbers(self):
        found = self.measure(src__cli__a_c="// SPDX\n// Why.\n", src__base__b_c="// SPDX\n\n\n",
                             include__lacuna__x_h="\n", src__fit__describe_c="// SPDX\n// Why.\n\n")
        self.assertEqual(found["lines of src and include"], 9)
        self.assertEqual(found["lines that only present results"], 5)
        self.assertEqual(found["public headers"], 1)
        self.assertEqual(found["files without an opening comment"], 1)

    def test_words(self):
        found = self.measure(docs__a_md="one 2\n| three |\n", docs__tables__b_md="made\n", README_md="four\n")
        self.assertEqual(found["words that people write and read"], 4)

    def test_printed(self):
        """What a program prints is not counted; its command, the words around and other blocks are."""
        found = self.measure(docs__a_md="one\n```sh\ntwo\n```\n```text\nprinted\nmore\n```\nthree\n"
                                        "```text\nagain\n```\n```python\nfour\n```\n```json\nfive\n```\n")
        self.assertEqual(found["words that people write and read"], 5 + 3)  # sh, python, json

    def test_circles(self):
        one = {"src__base__a_h": '#include "base/b.h"\n', "src__base__b_c": '#include "base/a.h"\n'}
        self.assertEqual(self.measure(**one)["circles of includes"], 1)
        del one["src__base__b_c"]
        self.assertEqual(self.measure(**one)["circles of includes"], 0)

    def test_records(self):
        found = self.measure(include__lacuna__simulation_h="\n",
                             src__run__own_h='#include "lacuna/simulation.h"\n',
                             src__run__r_c='// SPDX\n// Why.\n#include "own.h"\n',
                             src__run__s_c="// SPDX\n// Why.\n")
        self.assertEqual(found["objects that one field more in a record compiles anew"], 1)

    def test_over(self):
        old = dict(budgets.BUDGETS)
        try:
            budgets.BUDGETS["public headers"] = -1
            with tempfile.TemporaryDirectory() as root, contextlib.redirect_stdout(io.StringIO()), \
                    contextlib.redirect_stderr(io.StringIO()):
                self.assertEqual(budgets.main([root]), 1)
        finally:
            budgets.BUDGETS.update(old)


class Spdx(unittest.TestCase):
    def test_first_line(self):
        name = spdx.NAME
        self.assertEqual(spdx.check("a.c", f"// {name}\n"), [])
        self.assertEqual(spdx.check("a.h", f"/* {name} */\n"), [])
        self.assertEqual(spdx.check("tools/test", f"#!/usr/bin/env bash\n# {name}\n"), [])
        self.assertEqual(len(spdx.check("a.c", f"/* {name} */\n")), 1)
        self.assertEqual(len(spdx.check("a.c", "// SPDX-License-Identifier: MIT\n")), 1)
        self.assertEqual(len(spdx.check("a.py", f"\n# {name}\n")), 1)
        self.assertEqual(len(spdx.check("a.c", "")), 1)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        COMPILER = sys.argv.pop(1)
    unittest.main()
