"""`tetsuame paraview`: a state for ParaView (made for 5.11, Debian 12's) that opens series.xdmf as particles with colours, and in 2-D
walls.xdmf beside it.

A state names each proxy (a source, a view, …) and the properties that are not at their defaults. ParaView takes a relative name of a
file as one in the folder where it was started, so the state has the absolute one.
"""
import argparse
import os
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from . import COMPLETED, fields, runs, style, view, writing
from .reading import Damaged, regular

PIXELS, FONT = (1200, 900), 18  # of pictures that pvbatch makes; the window of ParaView has a size of its own
TOP_LEFT, POINT_DATA, RGB, NEVER, AT_SNAPSHOTS, CIRCLE, SPHERE = 4, 0, 0, -1, 2, 3, 1  # as ParaView numbers them
BACKGROUND, GREY = (0.32, 0.34, 0.43), (0.6, 0.6, 0.6)  # ParaView's own, on which it writes in white; walls


def series(run: runs.Run, name: str) -> Path:
    """The absolute path of a series in the run's folder, which is whole and names files that are there."""
    path = run.directory.resolve() / name
    try:
        named = {item.text.partition(":/")[0].strip() for item in ElementTree.parse(regular(path)).iter("DataItem") if item.text}
    except OSError as problem:
        raise Damaged(f"{path}: {problem.strerror}") from None
    except (ElementTree.ParseError, ValueError, LookupError) as problem:
        raise Damaged(f"{path}: is damaged ({problem}); `--restart` writes it anew") from None
    for name in sorted(named):
        if not os.path.isfile(path.parent / name):
            raise Damaged(f"{path}: names {name}, which is not there")
    return path


def camera(run: runs.Run) -> dict:
    """In 2-D from above, with room for the colour bar on the right; in 3-D all of the box, aslant, y up, as gravity is along -y."""
    low, high = view.bounds(run.snapshots)
    wall = run.snapshots[0].wall("Coordinates")
    if len(wall) and len(low) < 3:
        low, high = np.minimum(low, wall.min(axis=0)), np.maximum(high, wall.max(axis=0))
    flat = len(low) < 3
    middle, size = (np.pad(pair, (0, 3 - len(low))) for pair in ((low + high) / 2, high - low))
    if flat:
        half = 0.55 * max(size[1], size[0] * PIXELS[1] / PIXELS[0] / 0.8)
        focus = middle + (0.1 * 2 * half * PIXELS[0] / PIXELS[1], 0, 0)
        return {"CameraParallelProjection": 1, "CameraParallelScale": half, "CameraFocalPoint": focus, "CenterOfRotation": focus,
                "CameraPosition": focus + (0, 0, 4 * half), "CameraViewUp": (0, 1, 0)}
    half, towards = np.linalg.norm(size) / 2, np.array([0.45, 0.4, 1.0])
    return {"CameraParallelProjection": 0, "CameraFocalPoint": middle, "CenterOfRotation": middle,
            "CameraPosition": middle + towards / np.linalg.norm(towards) * half / np.sin(np.radians(15)), "CameraViewUp": (0, 1, 0),
            "CameraViewAngle": 30}


def colours(look: fields.Look, low: float, high: float, flat: bool) -> dict:
    """Spheres are shaded, which black would not show."""
    logarithmic = look.logarithmic and low > 0
    values = np.geomspace(low, high, 33) if logarithmic else np.linspace(low, high, 33)
    table = style.plt.get_cmap(look.colours)(np.linspace(0 if flat else 0.15, 1, 33))[:, :3]
    return {"RGBPoints": np.column_stack([values, table]).ravel(), "ColorSpace": RGB, "UseLogScale": int(logarithmic), "NanColor": GREY,
            "ScalarRangeInitialized": 1, "AutomaticRescaleRangeMode": NEVER}


class State:
    """The XML, proxy after proxy."""

    def __init__(self):
        self.root = ElementTree.Element("GenericParaViewApplication")
        self.body = ElementTree.SubElement(self.root, "ServerManagerState", version="5.11.0")
        self.listed: dict[str, list] = {}

    def add(self, collection: str, name: str, group: str, kind: str, properties: dict, **proxies) -> ElementTree.Element:
        """Properties are numbers, texts or sequences of these; `proxies`: properties that are other proxies of this state."""
        identity = str(self.next_id)
        proxy = ElementTree.SubElement(self.body, "Proxy", group=group, type=kind, id=identity, servers="1" if group == "sources" else "21")
        for key, values in properties.items():
            values = [values] if isinstance(values, str) or np.ndim(values) == 0 else list(values)
            place = self._property(proxy, key, len(values))
            for index, value in enumerate(values):
                ElementTree.SubElement(place, "Element", index=str(index), value=value if isinstance(value, str) else f"{value:.17g}")
        for key, others in proxies.items():
            place = self._property(proxy, key, len(others))
            for other in others:
                ElementTree.SubElement(place, "Proxy", value=other.get("id"), **({"output_port": "0"} if key == "Input" else {}))
        self.listed.setdefault(collection, []).append((identity, name))
        return proxy

    @property
    def next_id(self) -> int:
        return 100 + sum(map(len, self.listed.values()))

    @staticmethod
    def _property(proxy, key: str, count: int):
        return ElementTree.SubElement(proxy, "Property", name=key, id=f"{proxy.get('id')}.{key}", number_of_elements=str(count))

    def text(self) -> str:
        for collection, items in self.listed.items():
            place = ElementTree.SubElement(self.body, "ProxyCollection", name=collection)
            for identity, name in items:
                ElementTree.SubElement(place, "Item", id=identity, name=name)
        self.listed = {}
        ElementTree.indent(self.root)
        return '<?xml version="1.0"?>\n' + ElementTree.tostring(self.root, encoding="unicode") + "\n"


def state(run: runs.Run, name: str) -> str:
    last, path = run.snapshot(), series(run, "series.xdmf")
    if name != "Speed" and last[name].ndim > 1:
        raise Unreadable(f"{last.path}: {name} is a vector; colours are of a number (Speed is the length of Velocities)")
    array = "Velocities" if name == "Speed" else name
    flat = last.dimension < 3
    times = [snapshot.time for snapshot in run.snapshots]
    size, unit = fields.scaled("s", times[-1])
    made = State()
    reader = made.add("sources", path.name, "sources", "Xdmf3ReaderT", {"FileName": str(path)})
    seen = reader
    clock = made.add("sources", "time", "filters", "TimeToTextConvertor", {"Format": f"t = {{time:.4g}} {unit}", "Scale": 1 / size}, Input=[reader])
    if not flat:
        plane = made.add(f"pq_helper_proxies.{made.next_id + 1}", "ClipFunction", "implicit_functions", "Plane",
                         {"Origin": last.lengths / 2, "Normal": (0, 0, 1)})
        seen = made.add("sources", "half", "filters", "Clip", {"Invert": 1}, Input=[seen], ClipFunction=[plane])
        # What its window offers as the kind of cut.
        choice = ElementTree.SubElement(seen.find("Property[@name='ClipFunction']"), "Domain", name="proxy_list",
                                        id=f"{seen.get('id')}.ClipFunction.proxy_list")
        ElementTree.SubElement(choice, "Proxy", value=plane.get("id"))
    low, high = fields.limits(run.snapshots, name)
    # ParaView's editor of colours ends ParaView where a table has no opacity.
    opacity = made.add("piecewise_functions", f"{array}.PiecewiseFunction", "piecewise_functions", "PiecewiseFunction",
                       {"Points": (low, 0, 0.5, 0, high, 1, 0.5, 0), "ScalarRangeInitialized": 1})
    table = made.add("lookup_tables", f"{array}.PVLookupTable", "lookup_tables", "PVLookupTable", colours(fields.look(name), low, high, flat),
                     ScalarOpacityFunction=[opacity])
    as_points = {"Representation": "Point Gaussian", "GaussianRadius": 0.55 * float(np.median(last.spacing)),
                 "ShaderPreset": CIRCLE if flat else SPHERE, "AmbientColor": GREY, "DiffuseColor": GREY}
    particles = made.add("representations", "particles", "representations", "UnstructuredGridRepresentation",
                         {**as_points, "ColorArrayName": ("", "", "", POINT_DATA, array)}, Input=[seen], LookupTable=[table])
    drawn, readers = [particles], [reader]
    if flat and len(run.snapshots[0].wall("Coordinates")):  # in 3-D they would hide the fluid
        readers.append(made.add("sources", "walls.xdmf", "sources", "Xdmf3ReaderT", {"FileName": str(series(run, "walls.xdmf"))}))
        drawn.append(made.add("representations", "walls", "representations", "UnstructuredGridRepresentation",
                              {**as_points, "ColorArrayName": ("", "", "", "", "")}, Input=[readers[-1]]))
    when = made.add("representations", "when", "representations", "TextSourceRepresentation",
                    {"WindowLocation": TOP_LEFT, "FontSize": FONT}, Input=[clock])
    bar = made.add("scalar_bars", "bar", "representations", "ScalarBarWidgetRepresentation",
                   {"Title": fields.label(name, last.unit(name)), "ComponentTitle": "", "Visibility": 1, "Enabled": 1,
                    "WindowLocation": 0, "Position": (0.87, 0.25), "ScalarBarLength": 0.5,
                    "TitleFontSize": FONT, "LabelFontSize": FONT, "RangeLabelFormat": "%.4g"}, LookupTable=[table])
    shown = made.add("views", "RenderView1", "views", "RenderView",
                     {"ViewSize": PIXELS, "Background": BACKGROUND, "UseColorPaletteForBackground": 0, "OrientationAxesVisibility": int(not flat),
                      "ViewTime": times[0], **camera(run)}, Representations=[*drawn, when, bar])
    # Without a layout ParaView's window would not show the view.
    place = ElementTree.SubElement(made.add("layouts", "Layout #1", "misc", "ViewLayout", {}), "Layout", number_of_elements="1")
    ElementTree.SubElement(place, "Item", direction="0", fraction="0.5", view=shown.get("id"))
    keeper = made.add("timekeeper", "TimeKeeper1", "misc", "TimeKeeper", {"Time": times[0]}, TimeSources=readers, Views=[shown])
    made.add("animation", "AnimationScene1", "animation", "AnimationScene",
             {"AnimationTime": times[0], "StartTime": times[0], "EndTime": times[-1], "PlayMode": AT_SNAPSHOTS}, TimeKeeper=[keeper], ViewModules=[shown])
    return made.text()


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="tetsuame paraview", description="Writes DIR/series.pvsm: File > Load State of ParaView, or "
                                     "paraview --state=DIR/series.pvsm. To be written anew when the folder was moved.")
    parser.add_argument("directory", metavar="DIR", help="of the run")
    parser.add_argument("--field", metavar="A", help="that gives the colours (the first that varies)")
    o = parser.parse_args(arguments)
    run = runs.Run(o.directory)
    text = state(run, fields.shown(run.snapshot(), o.field and [o.field], most=1)[0])
    target = run.directory / "series.pvsm"
    writing.text(target, text)
    print(target)
    return COMPLETED
