"""Figures of the page that `./run compare flow` writes, made smaller (docs/studies/2026-11-24_free_surfaces.md).

    python3 docs/figures/free_surfaces.py output/compare/flow
"""
import sys
from pathlib import Path

from PIL import Image

# Name in docs/figures, and by how much it is made smaller.
FIGURES = {"impact": 0.85, "impact_course": 0.8, "fronts": 0.7, "box_pressures": 0.85, "box_heights": 0.8, "box_course": 0.55, "rest": 0.7}

for name, share in FIGURES.items():
    picture = Image.open(Path(sys.argv[1], f"{name}.png")).convert("RGB")
    small = picture.resize([round(share * size) for size in picture.size], Image.Resampling.LANCZOS).quantize(64)
    small.save(Path(__file__).with_name(f"free_surface_{name}.png"), optimize=True)
