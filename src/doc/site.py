#!/usr/bin/env python3
"""site.py BUILD: the Doxyfile of the site on standard output, with the navigation that src/doc/index.md lists.
site.py --filter PAGE: a page as Doxygen 1.9 needs it: its headings with names, to which links lead as on GitHub, and its files
and pictures by their names alone, since the site has them in one folder.

    python3 src/doc/site.py build/doc | doxygen -        # as ./run doc does
"""

import pathlib
import re
import sys
from xml.sax.saxutils import quoteattr

DOC = pathlib.Path(__file__).resolve().parent
TOP = DOC.parents[1]
THEME = pathlib.Path("/usr/share/doxygen-awesome-css")


def page_name(link):
    """Doxygen's name of a page, from a link of index.md."""
    path = (DOC / link).resolve().relative_to(TOP)
    parts = path.with_suffix("").parts
    return "md_" + "_".join(parts[1:] if parts[0] == "include" else parts) + ".html"


def navigation():
    """Tabs: a group per chapter of index.md, and what Doxygen lists of the headers."""
    lines = ['<doxygenlayout version="1.0"><navindex>', '<tab type="mainpage" visible="yes" title="manycontact"/>']
    for chapter in re.split(r"(?m)^## ", (DOC / "index.md").read_text())[1:]:
        title = chapter.split("\n")[0]
        lines.append(f'<tab type="usergroup" visible="yes" title={quoteattr(title)}>')
        for name, link in re.findall(r"(?m)^\* \[(.*?)\]\((.*?)\)", chapter):
            lines.append(f'<tab type="user" visible="yes" url={quoteattr(page_name(link))} title={quoteattr(name)}/>')
        lines.append("</tab>")
    lines.append('<tab type="usergroup" visible="yes" title="C++ API">')
    for kind, title in (("modules", "By topic"), ("classlist", "Classes"), ("namespacemembers", "Functions"), ("filelist", "Headers")):
        lines.append(f'<tab type="{kind}" visible="yes" title="{title}"/>')
    return "\n".join([*lines, "</tab>", "</navindex></doxygenlayout>", ""])


def heading_name(page, heading):
    slug = re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")
    return page.resolve().relative_to(TOP).with_suffix("").as_posix().replace("/", "-") + "-" + slug


LINK = re.compile(r"\]\(([\w./-]+)\)")


def linked_file(page, link):
    """The file of the sources that a page links to or shows, if it is neither a page nor a header."""
    file = (page.parent / link).resolve()
    return file if file.is_file() and file.suffix not in (".md", ".hpp") else None


def linked_files():
    pages = [TOP / "README.md", *DOC.rglob("*.md"), *(TOP / "bench").rglob("README.md"), *(TOP / "tests").rglob("README.md")]
    found = {file for page in pages for link in LINK.findall(page.read_text()) if (file := linked_file(page, link))}
    return sorted(str(file.relative_to(TOP)) for file in found)


def filtered(page):
    lines, fenced = [], False
    page = page.resolve()
    for line in page.read_text().split("\n"):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced and (heading := re.fullmatch(r"(##+) (.*)", line)):
            landing = page.name == "README.md" and page.parent == TOP  # its chapters are no entries of the navigation
            line = f"<h2>{heading[2]}</h2>" if landing else f"{line} {{#{heading_name(page, heading[2])}}}"
        elif not fenced:
            line = re.sub(r"\]\(([\w./-]*)#([\w-]+)\)", lambda m: f"](#{heading_name(page.parent / m[1] if m[1] else page, m[2])})", line)
            line = LINK.sub(lambda m: f"]({file.name})" if (file := linked_file(page, m[1])) else m[0], line)
        lines.append(line)
    return "\n".join(lines)


def main():
    if sys.argv[1] == "--filter":
        print(filtered(pathlib.Path(sys.argv[2])), end="")
        return
    build = pathlib.Path(sys.argv[1])
    build.mkdir(parents=True, exist_ok=True)
    (build / "layout.xml").write_text(navigation())
    print((DOC / "Doxyfile").read_text())
    print(f"OUTPUT_DIRECTORY = {build}\nLAYOUT_FILE = {build / 'layout.xml'}")
    print("HTML_EXTRA_FILES =", *linked_files())
    sheets = [THEME / "doxygen-awesome.css", THEME / "doxygen-awesome-sidebar-only.css"]
    print("HTML_EXTRA_STYLESHEET =", *(s for s in [*sheets, DOC / "site.css"] if s.exists()))


main()
