#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the documentation as a site of static pages, with mkdocs (Debian: mkdocs).

    /usr/bin/python3 tools/dev/docs_site.py [--output FOLDER]        build/site unless said

The pages are those of the repository. Manual pages, cases, public headers and notebooks with what they
gave become pages too. How they look is in tools/dev/site. What mkdocs warns of, a link to a page that is not there above all, ends the build.
"""

import argparse
import base64
import glob
import html
import json
import os
import re
import shutil
import sys
import tempfile

try:
    from mkdocs.commands.build import build
    from mkdocs.config import load_config
    from mkdocs.exceptions import Abort
except ImportError as missing:
    sys.exit(f"docs_site: {missing.name} is not there: apt-get install mkdocs, and call it by /usr/bin/python3")

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
LOOKS = os.path.join(ROOT, "tools", "dev", "site")
TOP = ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md")
LINK = re.compile(r"(\]\()([^)#:\s]*)((?:#[^)\s]*)?\))")

# What stands where in the contents, in this order; `docs/*.md` at last has what is left.
CONTENTS = (
    ("Start", ("README.md", "docs/README.md", "docs/install.md", "docs/tutorial-first-slope.md",
               "docs/tutorial-*.md", "docs/faq.md", "docs/glossary.md", "docs/how-sure.md",
               "docs/validation.md")),
    ("How to", ("docs/howto-simulate.md", "docs/howto-compare.md", "docs/howto-forecast.md",
                "docs/howto-trade.md", "docs/howto-*.md", "docs/report.md", "docs/paper-figures.md",
                "docs/surfaces-from-files.md", "docs/notebook/*.md")),
    ("Choices", ("docs/choosing.md", "docs/trade.md", "docs/*.md")),
    ("Theory", ("docs/theory/*.md",)),
    ("Reference", ("docs/case.md", "docs/format.md", "docs/tables/*.md", "commands/lacuna.md", "commands/*.md",
                   "cases.md", "headers.md")),
    ("Development", TOP[1:] + ("docs/adr/README.md", "docs/adr/*.md", "docs/paper/*.md")),
)


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def anchor(heading, _separator=None):
    """The name of a heading in a link, as on GitHub; tools/dev/lint/docs.py has the same."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def spaced(text):
    """Lists and tables begin after an empty line, and what belongs to an item of a list stands four
    spaces in: GitHub asks for neither."""
    lines, fenced, listed, loose, before = [], False, False, False, ""
    for line in text.split("\n"):
        if line.startswith("```"):
            fenced = not fenced
            line = line.split(" ")[0]  # of "```c FILE" the language
        item = re.match(r"([-*] |\d+\. )", line)
        starts = item or line.startswith("|")
        if not fenced:
            goes_on = re.match(r"([-*] |\d+\. |\|)", before) or (listed and before.startswith(" "))
            if starts and before.strip() and (loose or not goes_on):
                lines.append("")
            listed = bool(item) or (listed and (not line.strip() or line.startswith(" ")))
            loose = listed and (loose or not line.strip())
            if listed and not item:
                line = re.sub(r"^ {2,3}(?=\S)", "    ", line)
        lines.append(line)
        before = line
    return "\n".join(lines)


def linked(text, path):
    """Links to folders and to cases lead to the pages that stand for them."""
    def lead(match):
        target = os.path.normpath(os.path.join(os.path.dirname(path), match.group(2)))
        if not match.group(2) or target.endswith((".md", ".png")):
            return match.group()
        if target.startswith("cases"):
            target = "cases.md"
        elif target.endswith(".ipynb"):
            target = target[:-5] + "md"
        elif os.path.isdir(os.path.join(ROOT, target)):
            target = os.path.join(target, "README.md")
        return match.group(1) + os.path.relpath(target, os.path.dirname(path)) + match.group(3)
    return LINK.sub(lead, text)


def manual(text):
    """A manual page of scdoc as Markdown."""
    lines, fenced = ["# " + text.split("(")[0]], False
    for line in text.split("\n")[1:]:
        fenced ^= line.startswith("```")
        if not fenced and not line.startswith("```"):
            line = re.sub(r"^#", "##", line)
            line = re.sub(r"<", "&lt;", line)
            line = re.sub(r"\*([^*\s][^*]*)\*", r"**\1**", line)
            line = re.sub(r"(?<![\w\\])_([^_]+)_(?!\w)", r"*\1*", line)
            indented = line.startswith("\t")
            first = indented and not lines[-1].startswith((":   ", "    ")) and lines[-1].strip()
            line = (":   " if first else "    " if indented else "") + line.lstrip("\t")
        lines.append(line)
    text = "\n".join(lines)
    return re.sub(r"\*\*(lacuna(?:-\w+)?)\*\*\(1\)", r"[\1](\1.md)", text)


def notebook(path, write):
    """A notebook as Markdown: its words, its code, and what the code gave; `write` keeps its pictures."""
    name, parts, pictures = os.path.basename(path), [], 0
    for cell in json.loads(read(os.path.join(ROOT, path)))["cells"]:
        source = "".join(cell["source"])
        parts.append(spaced(source) if cell["cell_type"] == "markdown" else f"```python\n{source}\n```")
        for given in cell.get("outputs", ()):
            held = given.get("data", {})
            text = "".join(given.get("text", held.get("text/plain", ()))).rstrip()
            if "image/png" in held:
                pictures += 1
                picture = f"{name[:-6]}-{pictures}.png"
                write(os.path.join(os.path.dirname(path), picture), base64.b64decode("".join(held["image/png"])))
                parts.append(f"![What the code above draws]({picture})")
            elif text:
                parts.append(f'<div class="output"><pre>{html.escape(text)}</pre></div>')
    parts.insert(1, f'The notebook itself: <a href="{name}">{name}</a>.')
    return "\n\n".join(parts) + "\n"


def cases():
    """Every bundled case, with what its first lines say."""
    parts = ["# Cases\n\nWhat `lacuna run`, `contact`, `rg` and `fit` can be tried on; each says what it shows."]
    for path in sorted(glob.glob("cases/**/*.yaml", root_dir=ROOT, recursive=True),
                       key=lambda p: (os.path.dirname(p), p)):
        parts.append(f"## {path}\n\n```yaml\n{read(os.path.join(ROOT, path)).rstrip()}\n```")
    return "\n\n".join(parts) + "\n"


def headers():
    """The public headers, the contracts of their functions included."""
    parts = ["# Public headers\n\nWhat `#include <lacuna/lacuna.h>` brings: "
             "[how to use the library](docs/howto-embed.md)."]
    for path in sorted(glob.glob(os.path.join(ROOT, "include", "lacuna", "*.h"))):
        text = re.sub(r"^/\* SPDX.*\n#ifndef.*\n#define.*\n|#endif\s*$", "", read(path))
        parts.append(f"## {os.path.basename(path)}\n\n```c\n{text.strip()}\n```")
    return "\n\n".join(parts) + "\n"


def stage(folder):
    """Puts all pages into a folder, laid out as the repository is."""
    def write(path, text):
        target = os.path.join(folder, path)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        with open(target, "wb") as file:
            file.write(text if isinstance(text, bytes) else text.encode())

    pages = list(TOP) + sorted(glob.glob("docs/**/*.md", root_dir=ROOT, recursive=True))
    for path in pages:
        write(path, linked(spaced(read(os.path.join(ROOT, path))), path))
    theory = in_order([p for p in pages if p.startswith("docs/theory/")])
    write("docs/theory/README.md", "# Theory\n\n" + "\n".join(
        f"- [{title(os.path.join(ROOT, p))}]({os.path.basename(p)})" for p in theory) + "\n")
    for path in sorted(glob.glob("docs/man/*.scd", root_dir=ROOT)):
        name = os.path.basename(path).split(".")[0]
        write(f"commands/{name}.md", manual(read(os.path.join(ROOT, path))))
    write("cases.md", cases())
    for path in glob.glob("docs/notebook/*.ipynb", root_dir=ROOT):
        write(path[:-5] + "md", linked(notebook(path, write), path))
    write("headers.md", headers())
    for path in ["CITATION.cff"] + glob.glob("docs/images/*", root_dir=ROOT) + glob.glob(
            "docs/embed/*", root_dir=ROOT) + glob.glob("docs/notebook/*.ipynb", root_dir=ROOT):
        os.makedirs(os.path.dirname(os.path.join(folder, path)), exist_ok=True)
        shutil.copy(os.path.join(ROOT, path), os.path.join(folder, path))


def version():
    return re.search(r'LACUNA_VERSION "(.*)"', read(os.path.join(ROOT, "include", "lacuna", "version.h"))).group(1)


def title(path):
    return re.search(r"^# (.*)$", read(path), re.MULTILINE).group(1).replace("`", "")


def in_order(pages):
    """Pages in the order in which docs/README.md leads to them; what it does not name comes last."""
    named = re.findall(r"\]\(([^)#]+\.md)", read(os.path.join(ROOT, "docs", "README.md")))
    place = {os.path.normpath(os.path.join("docs", name)): i for i, name in reversed(list(enumerate(named)))}
    return sorted(pages, key=lambda path: place.get(path, -1 if path.endswith("README.md") else len(named)))


def contents(folder):
    """The table of contents: every page once."""
    named = {p for _, patterns in CONTENTS for pattern in patterns if "*" not in pattern
             for p in [pattern]}
    held = {p for _, patterns in CONTENTS for pattern in patterns
            if "*" in pattern and pattern != "docs/*.md"
            for p in glob.glob(pattern, root_dir=folder)}
    seen, sections = set(), []
    for section, patterns in CONTENTS:
        pages = []
        for pattern in patterns:
            found = in_order(sorted(glob.glob(pattern, root_dir=folder)))
            if pattern == "docs/*.md":
                found = [p for p in found if p not in named | held]
            for path in found:
                if path in seen or ("*" in pattern and path in named and path not in patterns):
                    continue
                seen.add(path)
                pages.append({title(os.path.join(folder, path)): path})
        sections.append({section: pages})
    return sections


def widened(match):
    """A table of many short cells: better wider than the page than each row many lines high."""
    cells = re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", match.group(), re.DOTALL)
    longest = max((len(re.sub(r"<[^>]*>", "", cell)) for cell in cells), default=0)
    wide = match.group().count("</th>") >= 7 and longest <= 48
    return match.group().replace("<table>", '<table class="wide">') if wide else match.group()


def finish(folder):
    """Leads home to a page, not to a folder, so that the site can be read from a disk as well."""
    for path in glob.glob(os.path.join(folder, "**", "*.html"), recursive=True):
        text = re.sub(r'href="(?:\./)?((?:\.\./)*)(\.\.?)"', lambda m: 'href="{}index.html"'.format(
            m.group(1) + ("" if m.group(2) == "." else "../")), read(path))
        text = re.sub(r"<table>.*?</table>", widened, text, flags=re.DOTALL)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--output", default=os.path.join(ROOT, "build", "site"))
    output = os.path.abspath(parser.parse_args().output)
    with tempfile.TemporaryDirectory(prefix="lacuna-site-") as folder:
        pages = os.path.join(folder, "pages")
        stage(pages)
        with open(os.path.join(folder, "mkdocs.yml"), "w", encoding="utf-8") as file:
            file.write("site_name: Lacuna\n")
        config = load_config(
            os.path.join(folder, "mkdocs.yml"), docs_dir=pages, site_dir=output, strict=True,
            use_directory_urls=False, nav=contents(pages), site_url="", extra={"version": version()},
            site_description="Creep, acceleration and failure of rough rock joints",
            theme={"name": None, "custom_dir": LOOKS, "static_templates": ["404.html", "search.html"],
                   "include_search_page": True, "search_index_only": False},
            markdown_extensions=["tables", "fenced_code", "def_list",
                                 {"toc": {"slugify": anchor, "toc_depth": 3}}])
        try:
            build(config)
        except Abort as stopped:
            sys.exit(f"docs_site: {stopped}")
    finish(output)
    print(output)


if __name__ == "__main__":
    main()
