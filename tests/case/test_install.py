#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is installed serves: the example against the shared and the static library by pkg-config and
by CMake's package, the Python module, manual pages, words for shells, and all of it from the .debs; the wheel.

usage: test_install.py PROGRAM SOURCE_FOLDER BUILD_FOLDER
"""

import glob
import importlib.util
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE, BUILD = map(os.path.abspath, sys.argv[1:4])
BLOCK = os.path.join(SOURCE, "cases", "block.yaml")
sys.path.insert(0, os.path.join(SOURCE, "tests", "support"))
import completed  # noqa: E402


def call(*words, **options):
    options.setdefault("cwd", SOURCE)
    done = subprocess.run(words, capture_output=True, text=True, check=False,
                          stdin=subprocess.DEVNULL, timeout=200, **options)
    if done.returncode != 0:
        raise AssertionError(f"{words}\n{done.stdout}{done.stderr}")
    return done.stdout


def declared():
    """Every function and object that a public header declares, comments left out."""
    found = set()
    for path in glob.glob(os.path.join(SOURCE, "include", "lacuna", "*.h")):
        with open(path, encoding="utf-8") as file:
            text = re.sub(r"//[^\n]*|/\*.*?\*/", "", file.read(), flags=re.DOTALL)
        text = re.sub(r"^#(?:[^\n]*\\\n)*[^\n]*", "", text, flags=re.MULTILINE)
        text = re.sub(r"static inline[^;{]*\{.*?^\}", "", text, flags=re.DOTALL | re.MULTILINE)
        found |= set(re.findall(r"\b(lac_\w+)\(", text))
        for names in re.findall(r"^extern const \w+ ([^;]*);", text, re.MULTILINE):
            found |= set(names.replace(",", " ").split())
    return found


class Prefix:
    """Checks of a folder that holds bin, lib ... as installed."""

    def checks_of_library(self):
        library = os.path.realpath(os.path.join(self.prefix, "lib", "liblacuna.so"))
        self.assertRegex(call("readelf", "-d", library), r"SONAME.*\[liblacuna\.so\.0\.2\]")
        listing = call("nm", "-D", "--defined-only", library)
        names = {line.split()[-1].split("@")[0] for line in listing.splitlines()}
        self.assertEqual({n for n in names if not n.startswith("LACUNA_")}, declared())

    def checks_of_program(self):
        lacuna = os.path.join(self.prefix, "bin", "lacuna")
        case = os.path.join(self.prefix, "share", "lacuna", "cases", "block.yaml")
        self.assertIn("failure", call(lacuna, "run", case, "-o",
                                      os.path.join(self.folder, "block.nc"), "--force"))
        for case in ("seas/bp1", "peers/plane-patch", "load/field"):  # with the maps that they read
            call(lacuna, "check", os.path.join(self.prefix, "share", "lacuna", "cases", case + ".yaml"))

    def checks_of_pages(self):
        commands = completed.commands(PROGRAM)
        self.assertIn("run", commands)
        for page in ["lacuna"] + [f"lacuna-{name}" for name in commands]:
            found = glob.glob(os.path.join(self.prefix, "share", "man", "man1", page + ".1*"))
            self.assertEqual(len(found), 1, page)
        for words in ("bash-completion/completions/lacuna", "zsh/vendor-completions/_lacuna",
                      "zsh/site-functions/_lacuna", "fish/vendor_completions.d/lacuna.fish"):
            self.assertTrue(os.path.exists(os.path.join(self.prefix, "share", words)), words)

    def checks_of_documents(self):
        """What an installed page leads to is installed; of cases, in their own place."""
        top = os.path.join(self.prefix, "share", "doc", "lacuna")
        pages = glob.glob(os.path.join(top, "**", "*.md"), recursive=True)
        self.assertIn(os.path.join(top, "docs", "howto-simulate.md"), pages)
        for page in pages:
            with open(page, encoding="utf-8") as file:
                text = re.sub(r"```.*?```", "", file.read(), flags=re.DOTALL)
            for link in re.findall(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)", text):
                target = os.path.normpath(os.path.join(os.path.dirname(page), link))
                target = target.replace(os.path.join(top, "cases"),
                                        os.path.join(self.prefix, "share", "lacuna", "cases"))
                self.assertTrue(os.path.exists(target), f"{page}: {link}")

    def checks_of_python(self):
        module = os.path.join(self.prefix, "lib", "python3", "dist-packages")
        environment = {k: v for k, v in os.environ.items() if k != "LACUNA_LIBRARY"}
        environment["PYTHONPATH"] = module
        printed = call(sys.executable, "-c",
                       f"import lacuna; print(lacuna._library._name, lacuna.run({BLOCK!r}).failed)",
                       env=environment)
        self.assertEqual(printed.split()[1], "1")
        self.assertTrue(os.path.realpath(printed.split()[0]).startswith(self.prefix))


class Installed(Prefix, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = os.path.realpath(tempfile.mkdtemp(prefix="lacuna-install-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        first = os.path.join(cls.folder, "first")
        call("cmake", "--install", BUILD, "--prefix", first)
        cls.prefix = os.path.join(cls.folder, "moved")  # nothing knows where it was put
        os.rename(first, cls.prefix)

    def example(self, program):
        environment = dict(os.environ, LD_LIBRARY_PATH=os.path.join(self.prefix, "lib"))
        printed = call(program, BLOCK, env=environment).splitlines()
        self.assertEqual(printed[0], "1.653e-09 m/s after 0.0000 day")
        # as `lacuna run` says, and verify.test_block from a closed form
        self.assertRegex(printed[-1], r"^fails after 15\.278\d day$")
        return call("readelf", "-d", program)

    def flags(self, *words):
        pages = os.path.join(self.prefix, "lib", "pkgconfig")
        return shlex.split(call("pkg-config", *words, "--cflags", "--libs", "lacuna", env=dict(
            os.environ, PKG_CONFIG_PATH=pages)))

    def compile(self, name, *flags):
        program = os.path.join(self.folder, name)
        call("cc", "-std=c11", "-pedantic", "-Wall", "-Wextra", "-Werror",
             os.path.join(SOURCE, "docs", "embed", "creep.c"), *flags, "-o", program)
        return program

    def test_pkg_config(self):
        needed = self.example(self.compile("shared", *self.flags()))
        self.assertIn("liblacuna.so.0.2", needed)
        self.assertNotIn("sundials", needed)

    def test_pkg_config_static(self):
        flags = [re.sub("^-llacuna$", "-l:liblacuna.a", f) for f in self.flags("--static")]
        self.assertNotIn("liblacuna", self.example(self.compile("static", *flags)))

    def test_cmake_package(self):
        build = os.path.join(self.folder, "build")
        call("cmake", "-S", os.path.join(SOURCE, "docs", "embed"), "-B", build,
             "-DCMAKE_PREFIX_PATH=" + self.prefix)
        call("cmake", "--build", build)
        self.assertIn("liblacuna.so.0.2", self.example(os.path.join(build, "creep")))

    def test_example_says_what_is_wrong(self):
        program = self.compile("wrong", *self.flags())
        environment = dict(os.environ, LD_LIBRARY_PATH=os.path.join(self.prefix, "lib"))
        done = subprocess.run([program, "nowhere.yaml"], capture_output=True, text=True,
                              check=False, env=environment)
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr, "^creep: .*nowhere.yaml")

    def test_library(self):
        self.checks_of_library()

    def test_program(self):
        self.checks_of_program()

    @unittest.skipUnless(shutil.which("scdoc"), "manual pages need scdoc")
    def test_pages(self):
        self.checks_of_pages()

    @unittest.skipUnless(shutil.which("scdoc") and shutil.which("man"), "needs scdoc and man-db")
    def test_man_finds_the_pages_beside_the_program(self):
        path = BUILD + os.pathsep + os.environ["PATH"]
        self.assertEqual(call("man", "-w", "lacuna-run", env=dict(os.environ, PATH=path)).strip(),
                         os.path.join(BUILD, "man", "man1", "lacuna-run.1"))

    def test_documents(self):
        self.checks_of_documents()

    def test_tools_draw_from_where_they_are(self):
        run, picture = (os.path.join(self.folder, name) for name in ("drawn.nc", "drawn.png"))
        call(os.path.join(self.prefix, "bin", "lacuna"), "run", BLOCK, "-o", run, "--force")
        call(sys.executable, os.path.join(self.prefix, "share", "lacuna", "tools", "plot_run.py"),
             run, "-o", picture, env=dict(os.environ, MPLBACKEND="Agg"))
        self.assertGreater(os.path.getsize(picture), 10000)

    def test_python(self):
        self.checks_of_python()

    def test_headers_stand_alone(self):
        """Each by itself, as any of them may be the first that somebody includes, in C and in C++."""
        names = sorted(os.listdir(os.path.join(self.prefix, "include", "lacuna")))
        self.assertEqual(names, sorted(os.listdir(os.path.join(SOURCE, "include", "lacuna"))))
        compilers = [("cc", "-xc", "-std=c11")]
        if shutil.which("c++"):
            compilers.append(("c++", "-xc++", "-std=c++17"))
        for name in names:
            source = os.path.join(self.folder, "alone")
            with open(source, "w", encoding="utf-8") as file:
                file.write(f"#include <lacuna/{name}>\nint alone;\n")
            for words in compilers:
                call(*words, "-fsyntax-only", "-Wall", "-Wextra", "-pedantic", "-Werror", "-I",
                     os.path.join(self.prefix, "include"), source)

    @unittest.skipUnless(shutil.which("c++"), "needs a C++ compiler")
    def test_cpp_program(self):
        program = os.path.join(self.folder, "force")
        call("c++", "-std=c++17", "-pedantic", "-Wall", "-Wextra", "-Werror",
             os.path.join(SOURCE, "docs", "embed", "force.cpp"), *self.flags(), "-o", program)
        environment = dict(os.environ, LD_LIBRARY_PATH=os.path.join(self.prefix, "lib"))
        printed = call(program, os.path.join(SOURCE, "cases", "rg", "cons.yaml"), env=environment)
        self.assertRegex(printed, r"^critical shear force over f P: 0\.714\d$")

    @unittest.skipUnless(shutil.which("c++") or shutil.which("clang++"), "needs a C++ compiler")
    def test_headers_serve_from_cpp(self):
        """All functions and rows of the headers, by the names that they have in C."""
        source, made = os.path.join(self.folder, "all.cpp"), os.path.join(self.folder, "all.o")
        headers = sorted(os.listdir(os.path.join(self.prefix, "include", "lacuna")))
        with open(source, "w", encoding="utf-8") as file:
            file.writelines(f"#include <lacuna/{name}>\n" for name in headers)
            file.write("const void *all[] = {%s};\n" % ", ".join(
                f"(const void *)&{name}" for name in sorted(declared())))
        call(shutil.which("c++") or "clang++", "-std=c++17", "-pedantic", "-Wall", "-Wextra", "-Werror", "-c", "-I",
             os.path.join(self.prefix, "include"), source, "-o", made)
        wanted = {line.split()[-1] for line in call("nm", "-u", made).splitlines()}
        self.assertEqual({name for name in wanted if "lac_" in name}, declared())


@unittest.skipUnless(shutil.which("dpkg-shlibdeps") and shutil.which("file"),
                     "needs dpkg-dev and file")
class Package(Prefix, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = os.path.realpath(tempfile.mkdtemp(prefix="lacuna-deb-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        call("cpack", "--config", os.path.join(BUILD, "CPackConfig.cmake"), "-B", cls.folder)
        cls.package, = glob.glob(os.path.join(cls.folder, "lacuna_*.deb"))
        cls.python, = glob.glob(os.path.join(cls.folder, "python3-lacuna_*_all.deb"))
        cls.library, = glob.glob(os.path.join(cls.folder, "liblacuna0*.deb"))
        cls.dev, = glob.glob(os.path.join(cls.folder, "liblacuna-dev_*.deb"))
        cls.all = glob.glob(os.path.join(cls.folder, "*.deb"))
        for package in (cls.package, cls.python, cls.library, cls.dev):
            call("dpkg-deb", "-x", package, os.path.join(cls.folder, "root"))
        cls.prefix = os.path.join(cls.folder, "root", "usr")

    def test_dependencies(self):
        needs = re.sub(r"\([^)]*\)", "", call("dpkg-deb", "-f", self.package, "Depends"))
        names = {name.strip() for name in needs.split(",")}
        libraries = ("libc6", "libgomp", "libgsl", "libnetcdf", "libyaml", "libudunits2", "libfftw3",
                     "libsundials", "libmicrohttpd")
        if any(name.startswith("libsundials-core") for name in names):
            libraries += ("libopenmpi",)  # from SUNDIALS 7 on its contexts are made with MPI's "none"
        for library in libraries:
            self.assertTrue([name for name in names if name.startswith(library)], names)
        self.assertFalse([name for name in names if not name.startswith(libraries)], names)
        self.assertEqual(call("dpkg-deb", "-f", self.package, "Version").strip(),
                         call(PROGRAM, "--version").split()[1])

    def test_python_package(self):
        """The module and its licence, of the library's version alone; the other packages have all else."""
        field = lambda name: call("dpkg-deb", "-f", self.python, name).strip()  # noqa: E731
        version = call(PROGRAM, "--version").split()[1]
        self.assertEqual((field("Package"), field("Version"), field("Architecture")), ("python3-lacuna", version, "all"))
        self.assertEqual(set(field("Depends").split(", ")),
                         {f"liblacuna0.2 (= {version})", f"lacuna (= {version})", "python3", "python3-numpy", "python3-xarray"})
        self.assertEqual(self.files_of(self.python), {"lib/python3/dist-packages/lacuna.py", "share/doc/python3-lacuna/copyright"})

    def files_of(self, package):
        listing = call("dpkg-deb", "-c", package).splitlines()
        return {line.split()[5].removeprefix("./usr/") for line in listing if not line.startswith("d")}

    def test_each_file_is_in_one_package(self):
        """Its licence in each; what only a compiler reads in -dev, what a program loads in the library's."""
        seen = {}
        for package in self.all:
            name = call("dpkg-deb", "-f", package, "Package").strip()
            for path in self.files_of(package):
                self.assertNotIn(path, seen)
                seen[path] = name
            self.assertEqual(seen.get(f"share/doc/{name}/copyright"), name)
            self.assertGreaterEqual(len(call("dpkg-deb", "-f", package, "Description").splitlines()), 2)
        for path, name in (("lib/liblacuna.so.0.2", "liblacuna0.2"), ("lib/liblacuna.so", "liblacuna-dev"), ("lib/liblacuna.a", "liblacuna-dev"),
                           ("include/lacuna/lacuna.h", "liblacuna-dev"), ("lib/pkgconfig/lacuna.pc", "liblacuna-dev"),
                           ("bin/lacuna", "lacuna"), ("bin/lacuna-mpi", "lacuna-mpi")):
            self.assertEqual(seen.get(path, name if path == "bin/lacuna-mpi" else None), name)

    def test_times_are_of_the_release(self):
        """So that the same sources give the same bytes: tools/dev/reproduce."""
        with open(os.path.join(SOURCE, "CITATION.cff"), encoding="utf-8") as file:
            released = re.search(r"^date-released: (\S+)$", file.read(), re.MULTILINE).group(1)
        days = {line.split()[3] for package in self.all for line in
                call("dpkg-deb", "-c", package, env=dict(os.environ, TZ="UTC")).splitlines()}
        self.assertEqual(days, {released})

    def test_it_takes_away_what_python_wrote(self):
        script = call("dpkg-deb", "-I", self.python, "prerm")
        modules = os.path.join(self.folder, "modules")
        os.makedirs(os.path.join(modules, "__pycache__"))
        for name in ("lacuna.cpython-311.pyc", "other.cpython-311.pyc"):
            open(os.path.join(modules, "__pycache__", name), "w", encoding="utf-8").close()
        script = script.replace("/usr/lib/python3/dist-packages", modules)
        call("sh", "-c", script.replace("/usr/share", modules))
        self.assertEqual(os.listdir(os.path.join(modules, "__pycache__")), ["other.cpython-311.pyc"])

    @unittest.skipUnless(shutil.which("dpkg-buildflags"), "needs dpkg-dev")
    def test_it_is_hardened(self):
        """As hardening-check of devscripts sees it."""
        for name in ("bin/lacuna", "lib/liblacuna.so"):
            binary = os.path.realpath(os.path.join(self.prefix, name))
            listing = call("readelf", "-W", "-d", "-l", "--dyn-syms", binary)
            self.assertRegex(listing, "BIND_NOW|FLAGS_1.*NOW", name)
            self.assertIn("GNU_RELRO", listing, name)
            self.assertIn("__stack_chk_fail", listing, name)
            self.assertRegex(listing, r"__\w+_chk\b(?<!__stack_chk)", name)
            self.assertIn("DYN", call("readelf", "-h", binary), name)  # may be put anywhere

    def test_what_is_in_it(self):
        self.checks_of_library()
        self.checks_of_program()
        self.checks_of_python()


@unittest.skipUnless(all(map(importlib.util.find_spec, ("setuptools", "wheel", "pip"))), "needs setuptools, wheel and pip")
class Wheel(unittest.TestCase):
    def setUp(self):
        self.folder = os.path.realpath(tempfile.mkdtemp(prefix="lacuna-wheel-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def test_it_is_installed(self):
        """In an environment of its own, which has the module, the library, the program, and nothing of the build."""
        call(sys.executable, os.path.join(SOURCE, "tools", "python", "make-wheel"), PROGRAM,
             os.path.realpath(os.path.join(BUILD, "liblacuna.so")), self.folder)
        wheel, = glob.glob(os.path.join(self.folder, "*.whl"))
        version = call(PROGRAM, "--version").split()[1]
        self.assertEqual(os.path.basename(wheel), f"lacuna-{version}-py3-none-linux_{platform.machine()}.whl")
        place = os.path.join(self.folder, "own")
        call(sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", place)
        python = os.path.join(place, "bin", "python")
        call(sys.executable, "-m", "pip", "-q", "--python", python, "install", "--no-index", "--no-deps", wheel)
        bare = {"PATH": "/usr/bin:/bin", "HOME": self.folder}
        say = "import lacuna, importlib.metadata as m; print(lacuna._library._name, m.version('lacuna'), lacuna.version(), " \
              f"lacuna.run({BLOCK!r}).failed, lacuna.check({BLOCK!r}).ok)"
        library, *said = call(python, "-c", say, env=bare, cwd=self.folder).split()
        self.assertTrue(library.startswith(place), library)
        self.assertEqual(said, [version, version, "1", "1"])
        self.assertEqual(call(os.path.join(place, "bin", "lacuna"), "--version", env=bare).split()[1], version)
        os.rename(library, library + ".gone")
        done = subprocess.run([python, "-c", "import lacuna"], env=bare, capture_output=True, text=True, check=False)
        self.assertRegex(done.stderr.splitlines()[-1],
                         r"^ImportError: no library of Lacuna: liblacuna\.so\.0\.2: cannot open .*; LACUNA_LIBRARY names it$")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
