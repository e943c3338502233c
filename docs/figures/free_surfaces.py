"""Figures of the page that `./run compare flow` writes, those that are there, made smaller (docs/studies/2026-11-24_free_surfaces.md,
2026-11-24_bodies_that_move.md).

    python3 docs/figures/free_surfaces.py output/compare/flow
"""
import sys
from pathlib import Path

from PIL import Image

# Name in docs/figures, and by how much it is made smaller.
FIGURES = {"impact": 0.85, "impact_course": 0.8, "fronts": 0.7, "box_pressures": 0.85, "box_heights": 0.8, "box_course": 0.55, "rest": 0.7,
           "floating": 0.6, "bowl": 0.4, "building": 0.6, "building_loads": 0.65}

for name, share in FIGURES.items():
    drawn = Path(sys.argv[1], f"{name}.png")
    if not drawn.is_file():
        continue
    picture = Image.open(drawn).convert("RGB")
    small = picture.resize([round(share * size) for size in picture.size], Image.Resampling.LANCZOS).quantize(256)
    small.save(Path(__file__).with_name(f"free_surface_{name}.png"), optimize=True)
