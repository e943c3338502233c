"""`tetsuame view`: one HTML file that plays a run in a browser, offline. The drawing is done with three.js, which is taken from
Debian's package libjs-three (or a file that is named) and written into the page."""
import argparse
import base64
import html
import json
import zlib
from pathlib import Path

import numpy as np

from . import COMPLETED, fields, plots, runs, style
from .reading import Unreadable, read_text

LIBRARIES = [Path("/usr/share/javascript/three/three.min.js"), Path("/usr/share/nodejs/three/build/three.min.js")]
TEMPLATE = Path(__file__).parent / "viewer.html"
COLUMNS, POINTS = 12, 1000  # of the history: more would be too small to see


def library(named: Path | None) -> str:
    for path in [named] if named else LIBRARIES:
        if path.is_file():
            return read_text(path)
    raise Unreadable(f"{named}: no such file" if named else
                     "no three.min.js on this machine: install Debian's package libjs-three, or name the file by --three")


def chosen(snapshots: list, bytes_each: float, most: float) -> list:
    """As many, evenly, as the page may hold."""
    keep = max(int(most / bytes_each), 2)
    if keep >= len(snapshots):
        return snapshots
    return [snapshots[round(i)] for i in np.linspace(0, len(snapshots) - 1, keep)]


def bounds(snapshots: list) -> tuple[np.ndarray, np.ndarray]:
    """Of the box, and of what has left it."""
    low, high = np.zeros(snapshots[0].dimension), snapshots[0].lengths.copy()
    for snapshot in snapshots:
        places = snapshot["Coordinates"]
        low, high = np.minimum(low, places.min(axis=0)), np.maximum(high, places.max(axis=0))
    return low, high


def frames(snapshots: list, described: list[dict]) -> list[str]:
    """Frame after frame as deflated bytes, in base64: places as 16 bits of the box, a plane of bytes each, then fields as 8 bits of
    their range; each less what it was in the frame before, which deflates to half."""
    low, high = bounds(snapshots)
    ids = np.sort(snapshots[0]["ParticleIDs"])
    made, before = [], None
    for snapshot in snapshots:
        order = np.argsort(snapshot["ParticleIDs"], kind="stable")
        if not np.array_equal(snapshot["ParticleIDs"][order], ids):
            raise Unreadable(f"{snapshot.path}: does not hold the particles of {snapshots[0].path}")
        places = (snapshot["Coordinates"][order] - low) / (high - low)
        now = [np.round(places * 65535).astype(np.uint16).T]
        for field in described:
            values = snapshot[field["name"]][order].astype(float)
            if field["logarithmic"]:
                values = np.log10(np.maximum(values, 1e-300))
            least, most = field["range"]
            now.append(np.round(np.clip((values - least) / (most - least), 0, 1) * 255).astype(np.uint8))
        change = now if before is None else [a - b for a, b in zip(now, before)]  # modulo 2^16 and 2^8
        planes = [plane for axis in change[0] for plane in ((axis & 255).astype(np.uint8), (axis >> 8).astype(np.uint8))]
        made.append(base64.b64encode(zlib.compress(b"".join(part.tobytes() for part in [*planes, *change[1:]]), 6)).decode())
        before = now
    return made


def describe(snapshots: list, names: list[str]) -> list[dict]:
    described = []
    for name in names:
        look = fields.look(name)
        low, high = fields.limits(snapshots, name)
        logarithmic = look.logarithmic and low > 0
        inner = (float(np.log10(low)), float(np.log10(high))) if logarithmic else (float(low), float(high))
        table = (style.plt.get_cmap(look.colours)(np.arange(256))[:, :3] * 255).round().astype(np.uint8)
        described.append({"name": name, "label": look.label, "unit": snapshots[0].unit(name), "low": float(low), "high": float(high), "range": inner,
                          "logarithmic": bool(logarithmic), "colours": base64.b64encode(table.tobytes()).decode()})
    return described


def histories(run: runs.Run) -> tuple[list[float], list[dict]]:
    """Times and columns, thinned; gaps where a value is not finite."""
    try:
        table = run.history
    except Unreadable:
        return [], []
    if "time" not in table or len(table["time"]) < 2:
        return [], []
    rows = np.unique(np.linspace(0, len(table["time"]) - 1, POINTS).round().astype(int))
    columns = [name for name in table if name not in plots.OF_THE_RUN and plots.varies(table[name])][:COLUMNS]
    return table["time"][rows].tolist(), [
        {"name": name, "unit": table.units[name], "values": [float(f"{value:.6g}") if np.isfinite(value) else None for value in table[name][rows]]}
        for name in columns]


def page(run: runs.Run, wanted: list[str] | None, three: str, megabytes: float) -> str:
    if not run.snapshots:
        raise Unreadable(f"{run.directory}: no snapshot in it")
    names = fields.shown(run.snapshot(), wanted, most=3)
    first = run.snapshots[0]
    room = megabytes * 1e6 - len(three) - 5e5
    # Before it is deflated, in base64; what deflating saves is seen on the first frames.
    try_out = run.snapshots[:2]
    each = len(frames(try_out, describe(try_out, names))[-1])
    kept = chosen(run.snapshots, each * 1.25, room)
    while True:
        described = describe(kept, names)
        chunks = frames(kept, described)
        if sum(map(len, chunks)) <= room or len(kept) <= 2:
            break
        kept = chosen(kept, sum(map(len, chunks)) / len(chunks) * 1.02, room)
    time, columns = histories(run)
    size, unit = fields.scaled("s", kept[-1].time)
    low, high = bounds(kept)
    about = {"dimension": first.dimension, "particles": first.particles, "low": low.tolist(), "high": high.tolist(),
             "spacing": float(np.median(first.spacing)), "times": [snapshot.time for snapshot in kept], "time_size": size, "time_unit": unit,
             "fields": described, "history_time": time, "histories": columns,
             "left_out": f"{len(kept)} of {len(run.snapshots)} snapshots" if len(kept) < len(run.snapshots) else ""}
    parts = {"TITLE": html.escape(f"{run.program}, {run.directory.resolve().name}"), "LIBRARY": three.replace("</script", "<\\/script"),
             "ABOUT": json.dumps(about).replace("<", "\\u003c"),
             "CHUNKS": "\n".join(f'<script type="text/plain" id="frame{index}">{chunk}</script>' for index, chunk in enumerate(chunks))}
    text = TEMPLATE.read_text(encoding="utf-8")
    for name, part in parts.items():
        text = text.replace(f"@{name}@", part)
    return text


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="tetsuame view", description="Writes DIR/view.html, which plays the run in any browser, without a network.")
    parser.add_argument("directory", metavar="DIR", help="of the run; &output interval says how many snapshots it has")
    parser.add_argument("--fields", metavar="A,B", type=lambda text: text.split(","), help="to choose colours from (the first three that vary)")
    parser.add_argument("--megabytes", type=float, default=60, help="of the page at most; snapshots are left out evenly (%(default)g)")
    parser.add_argument("--three", metavar="FILE", type=Path, help="three.min.js of three.js, if not from Debian's libjs-three")
    parser.add_argument("--output", metavar="FILE", type=Path, help="instead of DIR/view.html")
    o = parser.parse_args(arguments)
    if not 2 <= o.megabytes <= 2000:
        parser.error("--megabytes: 2 to 2000")
    run = runs.Run(o.directory)
    text = page(run, o.fields, library(o.three), o.megabytes)
    target = o.output or run.directory / "view.html"
    target.write_text(text, encoding="utf-8")
    print(f"{target} ({len(text) / 1e6:.1f} MB)")
    return COMPLETED
