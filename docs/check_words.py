"""Names that the code no longer uses, each with the field's term that took its place: `./run check` finds none of them."""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
EVERYWHERE = "modules|programs|tests"
# Identifier, term, folders in which it is retired: elsewhere it may have another meaning.
RETIRED = [
    ("is_sound", "is_valid", EVERYWHERE),
    ("at_once", "interleave", "modules/(cells|pairs|walls|schemes)"),
    ("chosen", "row_subset, mask", "modules/pairs/(cluster|pairs|workspace)"),
    ("stretch", "row_range, index_range", "modules/(pairs|cells|domain|run|liquid|volume|walls)"),
    ("letter", "message", "modules/(domain|walls|run)"),
    ("told", "rank_readings", "modules/run/load_balance"),
    ("hear_news", "reduce_step_flags", EVERYWHERE),
    ("news", "step_flags", "modules/run"),
    ("hand_on", "update_ghosts_and_images", EVERYWHERE),
    ("begin_motion", "a pass's fields at neighbours (modules/passes)", EVERYWHERE),
    ("begin_state", "a pass's fields at neighbours (modules/passes)", EVERYWHERE),
    ("end_found", "a pass's fields at neighbours (modules/passes)", EVERYWHERE),
    ("fall", "gravity_potential_difference", "modules/(walls|volume|liquid|gradient)"),
    ("liveliness", "speed_limiter", EVERYWHERE),
    ("unevenness", "shifting_sum", EVERYWHERE),
    ("noise", "hyperdiffusion", "modules/problems/convection"),
    ("odd", "reflection_ratio", "modules/(walls|problems/free_surface)"),
    ("beside", "near_walls, concatenate", "modules/(walls|volume|pairs|foundation|problems/free_surface)"),
    ("surroundings", "wall_context", "modules/(volume|liquid|walls)"),
    ("keep_memory", "commit_lagged", EVERYWHERE),
    ("expect_memory", "may_commit", EVERYWHERE),
    ("asks_again", "needs_lagged", EVERYWHERE),
    ("in_both_halves", "duplicate_halves", EVERYWHERE),
    ("where_is", "describe_position", EVERYWHERE),
    ("problem_in_a_box", "particle_simulation", EVERYWHERE),
]


def code_of(line: str) -> str:
    """Without texts and comments."""
    return re.sub(r'"(\\.|[^"\\])*"', '""', line).split("//")[0]


def main() -> int:
    found = []
    for path in sorted(p for folder in EVERYWHERE.split("|") for p in (ROOT / folder).rglob("*.[hc]pp")):
        name = path.relative_to(ROOT).as_posix()
        words = [(old, new) for old, new, where in RETIRED if re.match(where, name)]
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            code = code_of(line)
            found += [f"{name}:{number}: {old}: say {new}" for old, new in words if re.search(rf"\b{old}\b", code)]
    print("\n".join(found) or "words: none that are retired", file=sys.stderr if found else sys.stdout)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
