"""What is run for slowed_overturn: the boxes, and zeta and xi by the program plan."""
import argparse
import hashlib
import json
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from .. import writing
from .cases import Run, of_size

GROWTH, MAP, STIFFNESS, OVERTURN, VISCOSITY, STIFF, POSTER = "growth", "map", "stiffness", "overturn", "viscosity", "stiff", "poster"
FALLS = ("0.1", "0.2", "0.3")
BY_RULE = 0.005  # error of the growth rate that plan is asked to keep to
GRAVITY, DENSITIES = 10.0, (7000.0, 3000.0)


@dataclass(frozen=True)
class Box:
    name: str
    L: float          # m
    viscosity: float  # Pa s
    zeta: float       # of the overturn
    xi: float

    @property
    def unit(self) -> float:
        """s, eta/(Delta_rho g L)"""
        return self.viscosity / ((DENSITIES[0] - DENSITIES[1]) * GRAVITY * self.L)


# Viscosities of one Reynolds number, but for the note's box. For the overturn the modulus over the dynamic pressure is the same where sound can
# be slowed.
BOXES = {box.name: box for box in (Box("1 km", 1e3, 1e10, 32.0, 40.0), Box("10 km", 1e4, 3e11, 10.0, 40.0), Box("100 km", 1e5, 1e13, 3.2, 40.0),
                                   Box("note's box", 1.5e6, 1e14, 1.0, 6.0))}
ROUND = BOXES["10 km"]


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--particles", type=int, metavar="N", help="rows of particles for the growth (default: 48; with --quick 24)")
    parser.add_argument("--overturn", type=int, metavar="N", help="rows of particles for the overturn (default: 24)")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    tool = Tool(given, root)
    n, over = given.particles or (24 if given.quick else 48), given.overturn or 24
    if n % 24 or n < (24 if given.quick else 48) or over % 2 or over < 24:
        parser.error("--particles: a multiple of 24, at least 48 (with --quick 24); --overturn: even, at least 24")
    runs = growth_runs(tool, given, n)
    if not given.quick:
        runs += map_runs(tool) + viscosity_runs(tool) + stiff_runs(tool, over) + poster_runs(tool)
    runs += stiffness_runs(tool, given, over) + overturn_runs(tool, given, over)
    points = 8 if given.quick else 14
    maps = {name: tool.ask({"time.method": "rk4", **waves(box, 1, 24)}, map_points=points) for name, box in BOXES.items()}  # explicit steps
    tool.keep(given.output, maps)
    return runs


# ---- what is run ------------------------------------------------------------------------------------

class Tool:
    """The program plan, and what makes a run."""

    def __init__(self, given: argparse.Namespace, root: Path):
        self.given = given
        self.linear, self.note, self.poster = (root / "inputs" / f"rti_{name}.nml" for name in ("linear", "note", "poster"))
        self.program = given.binaries.resolve() / "plan"
        self.answers: dict[str, dict] = {}

    def ask(self, settings: dict, source: Path | None = None, map_points: int = 0) -> dict:
        """plan relaxation of the input with these settings; nothing where the program is not there."""
        if not self.program.is_file():
            return {}
        words = [str(source or self.linear), "--error", str(BY_RULE)]
        for key, value in {"time.method": "rkl2", **settings, **self.given_settings()}.items():
            words += ["--set", f"{key}={value}"]
        words += ["--map", str(map_points)] if map_points else []
        mark = hashlib.sha256(self.program.read_bytes() + "\0".join(words).encode()).hexdigest()
        self.answers[mark] = kept(self.given.output).get(mark) or self.answer(words)
        return self.answers[mark]

    def answer(self, words: list[str]) -> dict:
        with tempfile.TemporaryDirectory() as scratch:
            target = Path(scratch) / "plan.json"
            subprocess.run([str(self.program), "relaxation", *words, "--json", str(target)], check=True, stdout=subprocess.DEVNULL)
            return json.loads(target.read_text())

    def given_settings(self) -> dict:
        return dict(setting.split("=", 1) for setting in self.given.settings)

    def keep(self, output: Path, maps: dict[str, dict]) -> None:
        writing.text(writing.folder(output) / "plans.json", json.dumps({"answers": self.answers, "maps": maps}))

    def run(self, case: str, variant: str, n: int, settings: dict, seconds: float, source: Path | None = None) -> Run:
        every = {"time.method": "rkl2", "output.interval": 0, **settings}
        words = (*(f"{key}={value}" for key, value in every.items()), *self.given.settings)
        return of_size("rti", source or self.linear, variant, n, words, case, seconds)


def kept(output: Path) -> dict:
    try:
        return json.loads((output / "plans.json").read_text())["answers"]
    except (OSError, ValueError, KeyError):
        return {}


def waves(box: Box, m: int, n: int, amplitude: float = 5e-4) -> dict:
    """Half a wave of m in the box, between free-slip sides."""
    return {"domain.length_x": box.L / (2 * m), "domain.length_y": box.L, "rti.wavelength": box.L / m, "rti.amplitude": amplitude * box.L,
            "domain.particles_x": n // (2 * m), "domain.particles_y": n, "rti.viscosity_upper": box.viscosity, "rti.viscosity_lower": box.viscosity}


def slowed(answer: dict) -> dict:
    """Settings of what plan recommends."""
    return {f"rti.{key}": value for key, value in answer.get("recommended", {}).items() if key in ("zeta", "xi", "xi_lower", "xi_upper")}


def for_growth(answer: dict, by: float = 2.2) -> dict:
    return {"time.t_end": by / answer["numbers"]["growth_1_s"] if answer else 1.0, "output.history_interval": 2}


def growth_runs(tool: Tool, given: argparse.Namespace, n: int) -> list[Run]:
    """n: rows for m = 2, whose waves are half as long; m = 1 has two thirds of them."""
    runs = []
    for box in BOXES.values():
        for m, rows in ((1, n),) if given.quick else ((1, n * 2 // 3), (2, n)):
            answer = tool.ask(waves(box, m, rows))
            settings = waves(box, m, rows) | slowed(answer) | for_growth(answer)
            runs.append(tool.run(GROWTH, f"{box.name}, m = {m}", rows, settings, 6 if rows > 24 else 3))
    return runs


def map_runs(tool: Tool) -> list[Run]:
    """Beside the border and beyond it."""
    runs = []
    for box in BOXES.values():
        answer = tool.ask({"time.method": "rk4", **waves(box, 1, 24)}, map_points=14)
        if not answer:
            continue
        zeta, xi = (answer["map"][key][-1] / 10 for key in ("zeta", "xi"))  # each by itself at the rule's error
        for a, b in ((0.5, 2.5), (2.5, 0.5)):
            values = {"rti.zeta": max(1.0, a * zeta), "rti.xi": max(1.0, b * xi)}
            runs.append(tool.run(MAP, f"{box.name}, {a:g} ζ, {b:g} ξ", 24, waves(box, 1, 24) | values | for_growth(answer), 3))
    return runs


def overturn(box: Box, n: int, zeta: float, xi: float, width: float = 3.5, end: float = 186.0) -> dict:
    return waves(box, 1, n, 0.02) | {"rti.zeta": zeta, "rti.xi": xi, "kernel.h_over_dx": width, "time.t_end": end * box.unit}


def stiffness_runs(tool: Tool, given: argparse.Namespace, n: int) -> list[Run]:
    """The same box with sound slowed less and more: what it does to the overturn, with two kernels."""
    box = BOXES["1 km"]
    values = {2.5: (10, 30, 60), 3.5: (10, 60)} if not given.quick else {3.5: (60,)}
    return [tool.run(STIFFNESS, f"h = {width:g} Δx, ζ = {zeta}", n, overturn(box, n, zeta, box.xi, width), 100 / zeta**0.8, tool.note)
            for width, of in values.items() for zeta in of]


def overturn_runs(tool: Tool, given: argparse.Namespace, n: int) -> list[Run]:
    runs = []
    for box in BOXES.values():
        for xi in (box.xi, 2 * box.xi) if box.zeta == 1.0 else (box.xi,):  # the note's box is its own reference, of xi to 0
            if not given.quick or box.name in ("1 km", "note's box"):
                variant = box.name if xi == box.xi else f"{box.name}, twice ξ"
                runs.append(tool.run(OVERTURN, variant, n, overturn(box, n, box.zeta, xi), 9, tool.note))
    return runs


def viscosity_runs(tool: Tool) -> list[Run]:
    """Less and less viscous, down to what this many particles bear."""
    runs = []
    for viscosity in (4e8, 4e7, 1e7, 2.5e6):
        box = Box(ROUND.name, ROUND.L, viscosity, 4.0, 1.0)
        answer = tool.ask(waves(box, 1, 32))
        settings = waves(box, 1, 32) | {"rti.zeta": box.zeta} | for_growth(answer)
        runs.append(tool.run(VISCOSITY, f"η = {viscosity:.1e}", 32, settings, 4))
        if viscosity == 4e7 and answer:
            more = {"rti.zeta": box.zeta, "kernel.h_over_dx": 3.5} | for_growth(answer, 9.0)
            runs += [tool.run(VISCOSITY, f"η = {viscosity:.1e}, overturn", n, waves(box, 1, n, 0.02) | more, n * n / 150, tool.note) for n in (32, 48)]
    return runs


def stiff_runs(tool: Tool, n: int) -> list[Run]:
    note = BOXES["note's box"]
    runs = []
    for viscosity in (1e16, 1e18):
        box = Box(note.name, note.L, viscosity, 1.0, note.xi * viscosity / note.viscosity)
        runs.append(tool.run(STIFF, f"η = {viscosity:.0e}", n, overturn(box, n, box.zeta, box.xi), 9, tool.note))
    box = Box(note.name, note.L, 1e18, 1.0, 1.0)
    settings = waves(box, 1, n, 0.02) | {"rti.viscosity_upper": 1e17}
    answer = tool.ask(settings)
    more = slowed(answer) | {"kernel.h_over_dx": 3.5} | for_growth(answer, 7.0)
    runs.append(tool.run(STIFF, "η = 1e17 over 1e18", n, settings | more, 9, tool.note))
    return runs


def poster_runs(tool: Tool) -> list[Run]:
    shipped, stiff = ({"domain.particles_x": n, "domain.particles_y": n} for n in (32, 24))
    # The poster's conductivity over so much more time would heat the surface until the silicate is vapour: the same Peclet number.
    stiff |= {"rti.viscosity_upper": 1e14, "rti.viscosity_lower": 1e14, "rti.conductivity": 1e13 * 6e11 / 1e14}
    answer = tool.ask(stiff, tool.poster)
    more = slowed(answer) | for_growth(answer, 8.0)
    return [tool.run(POSTER, "as shipped, η = 6e11", 32, shipped | {"time.method": "adaptive", "time.t_end": 12000}, 25, tool.poster),
            tool.run(POSTER, "η = 1e14", 24, stiff | more, 40, tool.poster)]
