"""`tetsuame view`: one HTML file that plays a run in a browser, offline. The drawing is done with three.js, which is taken from
Debian's package libjs-three (or a file that is named) and written into the page."""
import argparse
import base64
import html
import json
import zlib
from pathlib import Path

import numpy as np

from . import COMPLETED, fields, plots, runs, scene, style, writing
from .reading import Damaged, Unreadable, read_text

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
    """Of the box, and of what has left it: fluid, and bodies that rise out of water."""
    low, high = np.zeros(snapshots[0].dimension), snapshots[0].lengths.copy()
    for snapshot in snapshots:
        places, wall = snapshot["Coordinates"], snapshot.wall("Coordinates")
        if len(places):
            low, high = np.minimum(low, places.min(axis=0)), np.maximum(high, places.max(axis=0))
        if len(wall) and fields.is_water(snapshot) and len(high) > 1:
            high[1] = max(high[1], wall[:, 1].max())
    return low, high


class Particles:
    """Of one kind, fluid or bodies: each ID has a place of its own in every frame, and may be there or not."""

    def __init__(self, snapshots: list, ids, places):
        """ids, places: of a snapshot."""
        self.ids, self.places = lambda snapshot: ids(snapshot).astype(np.int64), places
        self.all = np.unique(np.concatenate([self.ids(snapshot) for snapshot in snapshots]))
        self.before: list[np.ndarray] = []

    def slots(self, snapshot) -> np.ndarray:
        """Where the snapshot's particles stand in a frame."""
        slots = np.searchsorted(self.all, self.ids(snapshot))
        if len(np.unique(slots)) < len(slots):
            raise Damaged(f"{snapshot.path}: holds a particle ID twice")
        return slots

    def planes(self, snapshot, low: np.ndarray, high: np.ndarray, described: list[dict]) -> list[np.ndarray]:
        """Places, a plane of bytes each, whether a particle is there, and fields; each less what it was in the frame before. What is not
        there keeps its place, which deflates to nothing."""
        slots = self.slots(snapshot)
        places = np.round((self.places(snapshot) - low) / (high - low) * 65535).astype(np.uint16)
        values = [(np.uint16, axis) for axis in places.T] + [(np.uint8, np.ones(len(slots), np.uint8))]
        for field in described:
            shown = snapshot[field["name"]].astype(float)
            if field["logarithmic"]:
                shown = np.log10(np.maximum(shown, 1e-300))
            least, most = field["range"]
            shown = np.nan_to_num((shown - least) / (most - least), nan=0.0)
            values.append((np.uint8, np.round(np.clip(shown, 0, 1) * 255).astype(np.uint8)))
        before = self.before or [np.zeros(len(self.all), kind) for kind, _ in values]
        now = [plane.copy() for plane in before]
        now[places.shape[1]][:] = 0
        for plane, (_, each) in zip(now, values):
            plane[slots] = each
        self.before = now
        change = [a - b for a, b in zip(now, before)]  # modulo 2^16 and 2^8
        return [part for plane in change for part in ([(plane & 255).astype(np.uint8), (plane >> 8).astype(np.uint8)] if plane.dtype == np.uint16 else [plane])]


def within(snapshot, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Which wall particles are those of bodies: those that are not behind the sides."""
    places = snapshot.wall("Coordinates").reshape(-1, snapshot.dimension)
    return ((places >= low) & (places <= high)).all(axis=1)


def kinds(snapshots: list) -> tuple[Particles, Particles]:
    """Fluid, and bodies."""
    low, high = bounds(snapshots)

    def ids(snapshot) -> np.ndarray:
        seen, own = within(snapshot, low, high), snapshot.wall("ParticleIDs")
        return (own if len(own) == len(seen) else np.arange(len(seen)))[seen]

    return (Particles(snapshots, lambda snapshot: snapshot["ParticleIDs"], lambda snapshot: snapshot["Coordinates"]),
            Particles(snapshots, ids, lambda snapshot: snapshot.wall("Coordinates").reshape(-1, snapshot.dimension)[within(snapshot, low, high)]))


def frames(snapshots: list, described: list[dict]) -> list[str]:
    """Frame after frame as deflated bytes, in base64: of fluid and of bodies in turn places as 16 bits of the box, then fields as 8 bits of
    their range."""
    (fluid, bodies), (low, high) = kinds(snapshots), bounds(snapshots)
    made = []
    for snapshot in snapshots:
        planes = fluid.planes(snapshot, low, high, described) + bodies.planes(snapshot, low, high, [])
        made.append(base64.b64encode(zlib.compress(b"".join(plane.tobytes() for plane in planes), 6)).decode())
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
    (low, high), (fluid, bodies) = bounds(kept), kinds(kept)
    about = {"dimension": first.dimension, "slots": [len(fluid.all), len(bodies.all)], "low": low.tolist(), "high": high.tolist(),
             "box": first.lengths.tolist(), "particles": [snapshot.particles for snapshot in kept],
             "spacing": [float(np.median(snapshot.spacing)) for snapshot in kept], "times": [snapshot.time for snapshot in kept], "time_size": size, "time_unit": unit,
             "fields": described, "history_time": time, "histories": columns,
             "left_out": f"{len(kept)} of {len(run.snapshots)} snapshots" if len(kept) < len(run.snapshots) else ""}
    parts = {"ASIDE": str(float(np.radians(scene.ASIDE))), "ABOVE": str(float(np.radians(scene.ABOVE))),
             "TITLE": html.escape(f"{run.program}, {run.directory.resolve().name}"), "LIBRARY": three.replace("</script", "<\\/script"),
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
    writing.text(target, text)
    print(f"{target} ({len(text) / 1e6:.1f} MB)")
    return COMPLETED
