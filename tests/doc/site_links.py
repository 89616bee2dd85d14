"""site_links.py HTML: ends with 1 where a page of the site links to a file, a picture or a heading that is not there."""

import html
import pathlib
import re
import sys

site = pathlib.Path(sys.argv[1])
texts = {page.name: page.read_text(errors="replace") for page in site.glob("*.html")}
anchors = {name: set(re.findall(r'(?:id|name)="([^"]+)"', text)) for name, text in texts.items()}
wrong = set()
for name, text in texts.items():
    if "doxygen.css" not in text:
        wrong.add(f"{name}: no style sheet")
    for link in map(html.unescape, re.findall(r'(?:href|src)="([^"]+)"', text)):
        file, _, anchor = link.partition("#")
        if re.match(r"\w+:", link) or anchor == "nested-classes":  # Doxygen 1.9 links to lists of private classes that it omits
            continue
        file = file or name
        if not (site / file).exists() or (anchor and file in anchors and anchor not in anchors[file]):
            wrong.add(f"{name}: {link} is not there")
print("\n".join([*sorted(wrong), f"{len(wrong)} faults in {len(texts)} pages"]))
sys.exit(1 if wrong or len(texts) < 100 else 0)
