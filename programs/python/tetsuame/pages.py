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


def cell(text, kind: str = "", columns: int = 1) -> str:
    """`text` is HTML; `kind`: number (it stands to the right), good, stop, bad (colours), or several of them."""
    marks = (f" colspan=\"{columns}\"" if columns > 1 else "") + (f" class=\"{kind}\"" if kind else "")
    return f"<td{marks}>{text}</td>"


def number(text) -> str:
    return cell(text, "number")


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
