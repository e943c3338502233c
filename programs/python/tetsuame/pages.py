"""HTML pages: one file with style and figures inside, so that it opens anywhere, offline."""
import base64
import time
from html import escape
from pathlib import Path

STYLE = Path(__file__).parent / "report.css"


def document(title: str, parts: list[str]) -> str:
    """The page of these parts, which are HTML; empty ones are left out."""
    return ("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
            f"<title>Tetsuame: {escape(title)}</title>\n<style>\n{STYLE.read_text(encoding='utf-8')}</style>\n</head>\n<body>\n"
            + "\n".join(part for part in parts if part) + "\n</body>\n</html>\n")


def head(title: str, facts: list[str], text: str) -> str:
    """`facts` (with the time of writing before them) and `text` are HTML."""
    said = [time.strftime("%Y-%m-%d %H:%M"), *(fact for fact in facts if fact)]
    return f"<h1>{title}</h1>\n<p class=\"facts\">{' · '.join(said)}</p>\n" + (f"<p>{text}</p>" if text else "")


def section(title: str, *parts: str) -> str:
    return "\n".join([f"<h2>{title}</h2>", *parts])


def write(folder: Path, page: str) -> str:
    """report.html of a folder; what is said of it."""
    target = folder / "report.html"
    target.write_text(page, encoding="utf-8")
    return f"Report: {target}"


def figure(png: bytes, caption: str) -> str:
    """`caption` is HTML."""
    data = base64.b64encode(png).decode()
    return (f"<figure><img alt=\"{escape(caption)}\" src=\"data:image/png;base64,{data}\">"
            f"<figcaption>{caption}</figcaption></figure>")


def numbers(*texts) -> str:
    """Cells that stand to the right."""
    return "".join(f"<td class=\"number\">{text}</td>" for text in texts)


def name(text: str, colour: str = "") -> str:
    """The cell a line begins with, and the colour that it has in the figures."""
    key = f"<span class=\"key\" style=\"background:{colour}\"></span>" if colour else ""
    return f"<td class=\"name\">{key}{escape(text)}</td>"


def table(header: list[str], rows: list[str], kind: str = "", numbers: frozenset[int] = frozenset()) -> str:
    """`rows` are HTML, from <tr> to </tr>; `numbers`: the columns whose heads stand to the right."""
    cells = "".join(f"<th{' class=' + chr(34) + 'number' + chr(34) if index in numbers else ''}>{text}</th>"
                    for index, text in enumerate(header))
    return (f"<div class=\"scroll\"><table{f' class={chr(34)}{kind}{chr(34)}' if kind else ''}>\n<thead><tr>{cells}</tr></thead>\n<tbody>\n"
            + "\n".join(rows) + "\n</tbody></table></div>")


def text_table(header: list[str], rows: list[list[str]], words: int, kind: str = "") -> str:
    """Of plain text: the first `words` columns are words, the others numbers."""
    def cell(index: int, text: str) -> str:
        return f"<td{' class=' + chr(34) + 'number' + chr(34) if index >= words else ''}>{escape(text)}</td>"

    lines = ["<tr>" + "".join(cell(index, text) for index, text in enumerate(row)) + "</tr>" for row in rows]
    return table([escape(text) for text in header], lines, kind, frozenset(range(words, len(header))))
