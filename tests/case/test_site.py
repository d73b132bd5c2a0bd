#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The site of the documentation builds, and in it every link leads somewhere, nothing is fetched from
elsewhere, and every page of the repository and every command is in the contents.

usage: test_site.py PROGRAM SOURCE_FOLDER
"""

import glob
import html.parser
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])


class Page(html.parser.HTMLParser):
    """Links, names to link to, and what a browser would fetch."""

    def __init__(self, path):
        super().__init__()
        self.links, self.names, self.fetched, self.tables = [], set(), [], 0
        with open(path, encoding="utf-8") as file:
            self.text = file.read()
        self.feed(self.text)

    def handle_starttag(self, tag, attrs):
        about = dict(attrs)
        self.tables += tag == "table"
        for key in ("id", "name"):
            if about.get(key):
                self.names.add(about[key])
        if tag == "a" and about.get("href"):
            self.links.append(about["href"])
        if tag in ("img", "script", "iframe") and about.get("src"):
            self.fetched.append(about["src"])
        if tag == "link" and about.get("rel") in ("stylesheet", "shortcut icon", "icon"):
            self.fetched.append(about["href"])


@unittest.skipUnless(os.path.exists("/usr/bin/mkdocs"), "mkdocs is not installed")
class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-site-test-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        done = subprocess.run([sys.executable, os.path.join(SOURCE, "tools", "dev", "docs_site.py"),
                               "--output", cls.folder], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise AssertionError(done.stdout + done.stderr)
        cls.paths = [os.path.relpath(path, cls.folder) for path in
                     glob.glob(os.path.join(cls.folder, "**", "*.html"), recursive=True)]
        cls.pages = {path: Page(os.path.join(cls.folder, path)) for path in cls.paths
                     if path != "404.html"}

    def test_links(self):
        broken = []
        for path, page in self.pages.items():
            for link in page.links + page.fetched:
                if re.match(r"https?:|mailto:|data:", link):
                    continue
                target, _, name = link.partition("#")
                there = os.path.normpath(os.path.join(os.path.dirname(path), target)) if target else path
                if there not in self.pages and not os.path.isfile(os.path.join(self.folder, there)):
                    broken.append(f"{path}: {link}")
                elif name and there in self.pages and name not in self.pages[there].names:
                    broken.append(f"{path}: {link} has no such heading")
        self.assertFalse(broken, "\n".join(broken))

    def test_tables_of_many_columns(self):
        """Rows of short cells stay one line high; tables with words keep to the page."""
        wide = {path for path in ("docs/tables/trade.html", "docs/tables/costs.html", "index.html", "docs/tables/case-keys.html") if '<table class="wide">' in self.pages[path].text}
        self.assertEqual(wide, {"docs/tables/trade.html", "docs/tables/costs.html"})
        with open(os.path.join(self.folder, "style.css"), encoding="utf-8") as file:
            self.assertIn("table.wide td { white-space: nowrap; }", file.read())

    def test_nothing_is_fetched_from_elsewhere(self):
        for path, page in self.pages.items():
            outside = [what for what in page.fetched if re.match(r"(https?:)?//", what)]
            self.assertEqual(outside, [], path)

    def test_notebooks_hold_what_they_gave(self):
        page = self.pages["docs/notebook/joint.html"]
        self.assertEqual(sum(what.endswith(".png") for what in page.fetched), 6)
        self.assertIn("slipping cells at the end:", re.sub(r"<pre><code.*?</pre>", "", page.text, flags=re.DOTALL))
        self.assertIn("joint.ipynb", page.links)

    def test_every_page_is_there(self):
        listed = {os.path.normpath(link.partition("#")[0]) for link in self.pages["index.html"].links}
        wanted = glob.glob("docs/**/*.md", root_dir=SOURCE, recursive=True)
        wanted += ["ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "cases.md", "headers.md"]
        wanted += [f"commands/{os.path.basename(path)[:-6]}.md"
                   for path in glob.glob("docs/man/*.scd", root_dir=SOURCE)]
        for path in wanted:
            page = re.sub(r"README\.md$", "index.md", path)[:-3] + ".html"
            self.assertIn(page, listed)

    def test_theory_stands_in_the_order_of_reading(self):
        listed = [os.path.normpath(link) for link in self.pages["index.html"].links]
        places = [listed.index(f"docs/theory/{page}.html")
                  for page in ("surface", "contact", "friction", "creep", "events", "rg", "precursors", "fitting")]
        self.assertEqual(places, sorted(places))

    def test_tables_and_code_are_such(self):
        """Markdown here is not GitHub's: what it does not see stands in the text as it is."""
        left = []
        for path, page in self.pages.items():
            text = re.sub(r"<pre>.*?</pre>|<code>.*?</code>|<script.*?</script>", "", page.text,
                          flags=re.DOTALL)
            for form in ("```", r"\| ?---", r"<p>[-*] ", r"\n[-*] [^\n]*\n[-*] "):
                left += [f"{path}: {found.group()}" for found in re.finditer(form, text)]
        self.assertFalse(left, "\n".join(left))
        self.assertGreater(self.pages["docs/tables/case-keys.html"].tables, 10)

    def test_anchors_are_those_of_the_lint(self):
        def module(*path):
            sys.path.insert(0, os.path.join(SOURCE, *path[:-1]))
            spec = importlib.util.spec_from_file_location(path[-1][:-3], os.path.join(SOURCE, *path))
            found = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(found)
            return found
        lint, site = module("tools", "dev", "lint", "docs.py"), module("tools", "dev", "docs_site.py")
        for heading in ("A block's mass", "θ and v: `a < b`", "1. The file", "x - y"):
            self.assertEqual(lint.anchor(heading), site.anchor(heading))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
