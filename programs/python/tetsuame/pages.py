"""HTML pages: one file with style and figures inside, so that it opens anywhere, offline."""
import base64
import math
import re
import struct
import time
from html import escape
from pathlib import Path

from . import writing

STYLE = Path(__file__).parent / "report.css"
FULL = 1560  # pixels of a picture as wide as the page (style.WIDTH)
LEAST = 640  # its width on a narrow window, where it scrolls: smaller letters could not be read

# The colours e0, e1, … of report.css are those of errors up to these; the last one is of larger ones.
ERRORS = (1e-12, 1e-8, 1e-5, 1e-3, 1e-2, 5e-2, 0.2)


def document(title: str, parts: list[str]) -> str:
    """The page of these parts, which are HTML; empty ones are left out."""
    return ("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
            f"<title>Tetsuame: {escape(title)}</title>\n<style>\n{STYLE.read_text(encoding='utf-8')}</style>\n</head>\n<body>\n"
            + "\n".join(part for part in parts if part) + "\n</body>\n</html>\n")


def head(title: str, facts: list[str], text: str) -> str:
    """`title`: plain text; `facts` (with the time of writing before them) and `text` are HTML."""
    said = [time.strftime("%Y-%m-%d %H:%M"), *(fact for fact in facts if fact)]
    return f"<h1>{escape(title)}</h1>\n<p class=\"facts\">{' · '.join(said)}</p>\n" + (f"<p>{text}</p>" if text else "")


def section(title: str, *parts: str) -> str:
    """`title`: plain text. Nothing where all parts are empty."""
    return "\n".join([f"<h2>{escape(title)}</h2>", *filter(None, parts)]) if any(parts) else ""


def subsection(title: str, *parts: str) -> str:
    return "\n".join([f"<h3>{escape(title)}</h3>", *filter(None, parts)])


def folded(title: str, part: str) -> str:
    """Shown when it is asked for."""
    return f"<details><summary>{escape(title)}</summary>\n{part}</details>"


def paragraph(text: str, kind: str = "") -> str:
    """`text` is HTML. kind: small (a remark), bad (an alarm)."""
    return f"<p class=\"{kind}\">{text}</p>" if kind else f"<p>{text}</p>"


def small(text: str) -> str:
    return paragraph(text, "small")


def listed(items: list[str], kind: str = "") -> str:
    """`items` are HTML."""
    marks = f" class=\"{kind}\"" if kind else ""
    return f"<ul{marks}>\n" + "\n".join(f"<li>{item}</li>" for item in items) + "\n</ul>"


def commands(text: str) -> str:
    return f"<pre><code>{escape(text)}</code></pre>"


def write(folder: Path, page: str) -> str:
    """report.html of a folder; what is said of it."""
    target = folder / "report.html"
    writing.text(target, page)
    return f"Report: {target}"


def figure(drawn, path: Path | None = None, caption: str = "") -> str:
    """A figure of matplotlib's, which is closed, and goes to a file as well if one is named; nothing where there is none. `caption`
    is HTML. The picture is shown as wide as it was drawn; it shrinks with the window down to `LEAST`."""
    if drawn is None:
        return ""
    from . import style  # matplotlib takes a second: not where there is nothing to draw

    png = style.png(drawn)
    if path:
        writing.contents(path, png)
    return _image(png, "png", struct.unpack(">I", png[16:20])[0], caption)


def movie(path: Path, caption: str = "") -> str:
    """A GIF's, as wide as it is. `caption` is HTML."""
    data = path.read_bytes()
    return _image(data, "gif", 2 * struct.unpack("<H", data[6:8])[0], caption)  # figures have twice as many pixels as they are wide


def _image(data: bytes, kind: str, width: int, caption: str) -> str:
    share = min(width / FULL, 1.0)
    plain = escape(re.sub(r"<[^>]*>", "", caption).replace("\n", " "), quote=True)
    return (f"<figure><img style=\"--share: {100 * share:.1f}%; --least: {LEAST * share:.0f}px\" alt=\"{plain}\" "
            f"src=\"data:image/{kind};base64,{base64.b64encode(data).decode()}\"><figcaption>{caption}</figcaption></figure>")


def cell(text, kind: str = "", columns: int = 1) -> str:
    """`text` is HTML; `kind`: number (it stands to the right), good, stop, bad (colours), or several of them."""
    marks = (f" colspan=\"{columns}\"" if columns > 1 else "") + (f" class=\"{kind}\"" if kind else "")
    return f"<td{marks}>{text}</td>"


def number(text) -> str:
    return cell(text, "number")


def error(value: float | None, text: str, kind: str = "") -> str:
    """The cell of a relative error: its colour is that of the logarithm of its size."""
    return cell(text, " ".join(filter(None, ("number", kind, error_class(value)))))


def error_class(value: float | None) -> str:
    if value is None or not math.isfinite(value):
        return ""
    return f"e{sum(abs(value) > limit for limit in ERRORS)}"


def error_key(before: str = "") -> str:
    """What the colours of errors mean, below a remark (HTML) on what stands in the cells."""
    def said(limit: float) -> str:
        return f"{100 * limit:g} %" if limit >= 1e-3 else f"{limit:.0e}".replace("e-0", "e-")

    steps = [f"<span class=\"step e{index}\">≤ {said(limit)}</span>" for index, limit in enumerate(ERRORS)]
    steps.append(f"<span class=\"step e{len(ERRORS)}\">more</span>")
    return (small(before) if before else "") + small(f"Colours of errors: {''.join(steps)}")


def name(text: str, colour: str = "") -> str:
    """The cell a line begins with, and the colour that it has in the figures."""
    key = f"<span class=\"key\" style=\"background:{colour}\"></span>" if colour else ""
    return cell(key + escape(text), "name")


def table(header: list[str], rows: list[list[str]], kind: str = "", groups=()) -> str:
    """`rows` of cells; heads of numbers stand to the right. `groups`: of each row, where a line stands above the first of each."""
    def head(index: int, text: str) -> str:
        right = any(len(row) == len(header) and row[index].startswith("<td class=\"number") for row in rows)
        return f"<th class=\"number\">{text}</th>" if right else f"<th>{text}</th>"

    begins = {index for index, group in enumerate(groups) if index == 0 or group != groups[index - 1]}
    lines = [("<tr class=\"first\">" if index in begins else "<tr>") + "".join(row) + "</tr>" for index, row in enumerate(rows)]
    marks = f" class=\"{kind}\"" if kind else ""
    return (f"<div class=\"scroll\"><table{marks}>\n<thead><tr>{''.join(head(*each) for each in enumerate(header))}</tr></thead>\n<tbody>\n"
            + "\n".join(lines) + "\n</tbody></table></div>")


def columns(of: list, made: dict, kind: str = "", group=None) -> str:
    """A table with a row for each of `of`: the head of each column, and what makes its cell."""
    return table(list(made), [[make(one) for make in made.values()] for one in of], kind, [group(one) for one in of] if group else ())


def text_table(header: list[str], rows: list[list[str]], words: int, kind: str = "") -> str:
    """Of plain text: the first `words` columns are words, the others numbers."""
    lines = [[cell(escape(text), "" if index < words else "number") for index, text in enumerate(row)] for row in rows]
    return table([escape(text) for text in header], lines, kind)


def text_columns(of: list, made: dict, words: int, kind: str = "") -> str:
    """As columns(), of plain text."""
    return text_table(list(made), [[make(one) for make in made.values()] for one in of], words, kind)
