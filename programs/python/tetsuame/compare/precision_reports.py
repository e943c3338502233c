"""What the comparison of precisions asks of the other reports: their runs, by the words of their command lines, and the figures that they
judge, as they measure them."""
import argparse
from dataclasses import dataclass, replace
from pathlib import Path

from . import convection, letters, rti, shock, table
from .cases import Run, of_letter, of_size
from .outcomes import Outcome


@dataclass(frozen=True)
class Figure:
    """Of a report: its value, and what it would be without an error; None where that is not known. kept: a relative change of what is kept,
    which has a demand of its own."""
    value: float | None
    exact: float | None = None
    kept: bool = False


class Drops:
    """The programs drop and conduction, and rti on problems of its own, have no report that compares schemes: their figures are of summary.json."""
    # Of each input: what else is set where it takes long. Figures with theory: by the name of the metric's end.
    SETTINGS = {"drop_emulsion": ("time.t_end=1000",), "pond_on_mantle": ("time.t_end=3000",)}
    KNOWN = {"fall_velocity": "fall_velocity_theory", "equilibration": "equilibration_reference",
             "equilibration_time": "equilibration_time_reference", "growth_rate": "growth_rate_theory"}
    # A drop in two dimensions that surface tension holds together falls at Re = 40, which no theory of creeping flow or of small swings is for.
    WITHOUT_THEORY = {"drop_surface_tension"}
    OTHERS = ("metal_centroid", "stretch", "oscillation_period", "concentration_metal", "melt_fraction", "metal_depth", "v_rms_max", "heat",
              "density_ratio_min", "density_ratio_max")
    KEPT = ("energy_residual", "heat_residual", "element_mass_error")

    @staticmethod
    def add_options(parser: argparse.ArgumentParser) -> None:
        parser.add_argument("--cases", help="PROGRAM:INPUT:N,…")

    @classmethod
    def plan(cls, given: argparse.Namespace, root: Path, _parser) -> list[Run]:
        runs = []
        for case in given.cases.split(","):
            program, name, n = case.split(":")
            path, n = root / "inputs" / f"{name}.nml", int(n)
            # As many a length along y as along x.
            wide = convection.aspect(path)
            own = (f"domain.particles_x={n}", f"domain.particles_y={round(n / wide)}", *cls.SETTINGS.get(name, ()))
            runs.append(of_size(program, path, program, n, (*own, *given.settings), name))
        return runs

    @classmethod
    def figures(cls, outcome: Outcome, _outcomes: list[Outcome]) -> dict[str, Figure]:
        known = {} if outcome.case.file in cls.WITHOUT_THEORY else cls.KNOWN
        found = {name: Figure(outcome.number("metrics", name), outcome.number("metrics", known[name]) if name in known else None)
                 for name in (*cls.KNOWN, *cls.OTHERS)}
        found |= {name: Figure(outcome.number("metrics", name), 0.0, kept=True) for name in cls.KEPT}
        return found | {name: Figure(outcome.number("errors", name), 0.0) for name in ("temperature_l2", "temperature_max")}


class AtRest:
    """Programs C to F and Y on the states of the notes at rest."""
    @staticmethod
    def add_options(parser: argparse.ArgumentParser) -> None:
        letters.add_options(parser)
        parser.add_argument("--more", help="programs beside A to F: LETTER,…", default="Y")

    @staticmethod
    def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
        runs = letters.plan(given, root, parser)
        inputs = dict.fromkeys(one.input for one in runs)
        return runs + [of_letter(letter, path, "", tuple(given.settings)) for path in inputs for letter in given.more.split(",")]

    @staticmethod
    def figures(outcome: Outcome, _outcomes: list[Outcome]) -> dict[str, Figure]:
        return {name: Figure(table.error(outcome, name), 0.0)
                for name in ("pressure_mean", "pressure_max", "density_max", "displacement_max_over_dx")}


class Layers:
    """Metal over silicate."""
    add_options, plan = staticmethod(rti.add_options), staticmethod(rti.plan)

    @staticmethod
    def figures(outcome: Outcome, outcomes: list[Outcome]) -> dict[str, Figure]:
        row = rti.row(outcome, outcomes)
        if outcome.case.file == rti.GROWTH:
            return {"growth_rate": Figure(row["growth_rate"], row["growth_theory"])}
        low, high = row["density_ratio"]
        return {"metal_centroid": Figure(row["metal_centroid"]), "density_ratio_min": Figure(low), "density_ratio_max": Figure(high),
                "energy_residual": Figure(row["energy_residual"], 0.0, kept=True)}


class Cells:
    """Convection. Case 2a takes 2e5 evaluations to its steady state: here it runs until the first plume is below the lid."""
    SETTINGS = {"blankenbach_2a": ("convection.viscosity_ramp=0", "time.t_end=2e15")}
    add_options = staticmethod(convection.add_options)

    @classmethod
    def plan(cls, given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
        return [replace(one, settings=(*cls.SETTINGS.get(one.file, ()), *one.settings)) for one in convection.plan(given, root, parser)]

    @staticmethod
    def figures(outcome: Outcome, outcomes: list[Outcome]) -> dict[str, Figure]:
        row = convection.row(outcome, outcomes)
        return {name: Figure(one["value"], one["reference"] if row["steady"] else None) for name, one in row["values"].items()}


class Gas:
    """Contacts and shocks; with --inputs those that the report has not."""
    PERIODIC = {"square", "square_equal_mass", "gresho", "kelvin_helmholtz"}  # in which momentum is kept

    @staticmethod
    def add_options(parser: argparse.ArgumentParser) -> None:
        shock.add_options(parser)
        parser.add_argument("--inputs", help="INPUT:N,…")

    @staticmethod
    def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
        if not given.inputs:
            return shock.plan(given, root, parser)
        return [of_size("shock", root / "inputs" / f"{name}.nml", scheme, int(n),
                        (f"domain.particles_x={n}", f"shock.scheme={scheme}", *given.settings))
                for name, n in (one.split(":") for one in given.inputs.split(",")) for scheme in given.schemes.split(",")]

    @classmethod
    def figures(cls, outcome: Outcome, outcomes: list[Outcome]) -> dict[str, Figure]:
        row = shock.row(outcome, outcomes)
        found = {name: Figure(value, 0.0) for name, value in row["errors"].items()}
        found |= {name: Figure(value["value"], 0.0 if name.startswith("square") else value["exact"]) for name, value in row["metrics"].items()}
        if outcome.case.file in cls.PERIODIC:
            found["momentum_drift"] = Figure(outcome.number("conservation", "momentum"), 0.0, kept=True)
        return found | {"energy_drift": Figure(row["energy_drift"], 0.0, kept=True)}


@dataclass(frozen=True)
class Part:
    """Problems of one report, whose figures speak for the default of one program.

    words: of the report's command line; coarse: for runs in double alone at fewer particles, from which the error follows of figures
    without a theory; the latter two: with --quick."""
    speaks_for: str
    report: type
    words: str
    coarse: str = ""
    quick: str = ""
    quick_coarse: str = ""


# Seconds of a run at so many particles along x; not here: about half a second.
SECONDS = {"growth": (3, 48), "overturn": (5, 40), "pond_on_mantle": (15, 48), "rti_van_keken": (35, 32), "drop_cylinder": (18, 60),
           "partitioning": (35, 60), "drop_emulsion": (18, 64), "drop_surface_tension": (12, 40), "blankenbach_1b": (5, 24), "air_1e4": (4, 24),
           "kelvin_helmholtz": (9, 64), "sedov_octant": (30, 16), "gresho": (2, 32), "square": (2, 32), "square_equal_mass": (2, 32),
           "noh": (10, 48), "rayleigh_taylor": (15, 32)}

# Another eighth digit, where a run ends when it sees fit or a flow is chaotic: what that changes in double, precision may change too.
NUDGE = {"blankenbach_1a": "initial.perturbation=0.30000003", "blankenbach_1b": "initial.perturbation=0.30000003",
         "blankenbach_2a": "initial.perturbation=0.30000003", "air_1e4": "initial.perturbation=0.050000005",
         "pond_on_mantle": "rti.gravity=10.000001", "drop_surface_tension": "drop.gravity=10.000001"}

PARTS = (
    Part("schemes, at rest", AtRest, "--programs C,D,E,F --inputs 12,13,13_linear,column", "",
         "--programs C,F --inputs 12,13,column"),
    Part("rti", Layers, "--schemes rti --particles 48 --overturn 40", "--schemes rti --particles 24 --overturn 28",
         "--schemes rti --particles 24 --overturn 24", "--schemes rti --particles 16 --overturn 16"),
    Part("rti", Drops, "--cases rti:pond_on_mantle:48,rti:rti_van_keken:32", "--cases rti:pond_on_mantle:32",
         "--cases rti:pond_on_mantle:30", "--cases rti:pond_on_mantle:20"),
    Part("schemes, on two fluids", Layers, "--schemes C;F;Y;N;SSPH --particles 48 --overturn 40",
         "--schemes C;F;Y;N;SSPH --particles 24 --overturn 28", "--schemes C;F --particles 24 --overturn 24",
         "--schemes C;F --particles 16 --overturn 16"),
    Part("schemes, on two fluids", Drops, "--cases disph_c:drop_cylinder:60,disph_f:drop_cylinder:60,disph_c:conduction_plate:50",
         "--cases disph_c:drop_cylinder:40,disph_f:drop_cylinder:40", "--cases disph_c:drop_cylinder:40",
         "--cases disph_c:drop_cylinder:30"),
    Part("drop", Drops, "--cases drop:drop_cylinder:60,drop:partitioning:60,drop:drop_emulsion:64",
         "--cases drop:drop_cylinder:40,drop:partitioning:40,drop:drop_emulsion:48",
         "--cases drop:drop_cylinder:40,drop:partitioning:40,drop:drop_emulsion:32",
         "--cases drop:drop_cylinder:30,drop:partitioning:30,drop:drop_emulsion:24"),
    Part("drop, surface tension", Drops, "--cases drop:drop_surface_tension:40", "--cases drop:drop_surface_tension:30"),
    Part("conduction", Drops, "--cases conduction:conduction_plate:50,conduction:conduction_half_space:50",
         "--cases conduction:conduction_plate:30,conduction:conduction_half_space:30",
         "--cases conduction:conduction_plate:30,conduction:conduction_half_space:50",
         "--cases conduction:conduction_plate:20,conduction:conduction_half_space:30"),
    Part("convection", Cells, "--inputs blankenbach_1a,blankenbach_1b,air_1e4,blankenbach_2a --particles 24",
         "--inputs blankenbach_2a --particles 16", "--inputs blankenbach_1a,air_1e4 --particles 16"),
    Part("shock", Gas, "--tests sod,strong --schemes ssph,disph,gsph,gdisph --particles 400", "",
         "--tests sod --schemes disph,gdisph --particles 200"),
    Part("shock", Gas, "--tests vacuum,melts --schemes ssph,disph,gsph,gdisph --particles 280"),
    Part("shock, the square", Gas, "--tests square,square_equal_mass --schemes ssph,disph,gsph,gdisph --particles 32",
         "--tests square,square_equal_mass --schemes ssph,disph,gsph,gdisph --particles 24", "--tests square --schemes disph,gdisph --particles 16"),
    Part("shock", Gas, "--tests gresho,explosion_2d --schemes ssph,disph,gsph,gdisph --particles 32",
         "--tests gresho --schemes ssph,disph,gsph,gdisph --particles 24"),
    Part("shock", Gas, "--tests kelvin_helmholtz --schemes ssph,disph,gsph,gdisph --particles 64", "",
         "--tests kelvin_helmholtz --schemes disph,gdisph --particles 40"),
    Part("shock", Gas, "--inputs sedov_octant:16 --schemes gsph,gdisph", "--inputs sedov_octant:12 --schemes gsph,gdisph",
         "--inputs sedov_octant:10 --schemes gdisph"),
    Part("shock", Gas, "--inputs noh:48,rayleigh_taylor:32,iron_silicate_shock:400 --schemes disph,gdisph",
         "--inputs rayleigh_taylor:24 --schemes disph,gdisph"),
)
