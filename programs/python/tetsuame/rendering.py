"""Fields of particles on the pixels of a picture.

A pixel's value is that at its middle of the plane fitted to the particles about it, weighted with their volumes and with
Wendland's C2 kernel (moving least squares of first order [Lancaster and Salkauskas, 1981]): linear fields come out exactly,
at walls and periodic borders too. Where it is known what a field does at a wall, the particles are seen again behind it, as the
programs themselves do: isolines then meet an insulating wall at a right angle, and a wall that keeps its value has it. Values
stay within those of the field but for a few hundredths, so that contacts do not overshoot; pixels that no particle reaches are nan.
"""
import dataclasses
from dataclasses import dataclass

import numpy as np

REACH = 2.0  # the kernel's support, in spacings of a particle
PIXELS_A_SPACING = 2  # more would only cost time
BEYOND = 0.03  # of a field's range: so far may its values go at a wall, half a spacing from the last particle
NEAR, ASIDE = 1.5, 1.3  # spacings: where no particle is so near, and the mean of those within reach is so far, nothing is
MARGIN = 2.0  # spacings, about a body in open space


@dataclass
class Map:
    """values[row, column]: rows from the bottom up. extent: left, right, bottom, top, m. axes: which axes of space these are. names: of
    what the values number. sharp: nothing is between two pixels."""
    values: np.ndarray
    extent: tuple[float, float, float, float]
    axes: tuple[int, int]
    names: tuple[str, ...] = ()
    sharp: bool = False

    @property
    def x(self) -> np.ndarray:
        """Middles of the columns, m."""
        return _middles(self.extent[0], self.extent[1], self.values.shape[1])

    @property
    def y(self) -> np.ndarray:
        return _middles(self.extent[2], self.extent[3], self.values.shape[0])


@dataclass(frozen=True)
class Mirror:
    """A wall in which the particles are seen again, at `place` (m) on an axis; the fluid is on the side of `inward`. The field is even
    about it (nothing flows through the wall), or odd about the `value` that the wall keeps."""
    axis: int
    place: float
    inward: float
    value: float | None = None


def slice_of(snapshot, values: np.ndarray, pixels: int, axis: int, at: float | None, mirrors: tuple[Mirror, ...] = ()) -> Map:
    """Of a snapshot in 2-D, or of the plane normal to `axis` through `at` in 3-D."""
    room = _room(values, mirrors)
    places, spacing, values = _with_images(snapshot["Coordinates"], snapshot.spacing, values, mirrors)
    axes = _across(snapshot.dimension, axis)
    height = np.zeros(len(places))
    if snapshot.dimension == 3:
        height = places[:, axis] - (snapshot.lengths[axis] / 2 if at is None else at)
        if snapshot.periodic[axis]:
            height -= snapshot.lengths[axis] * np.round(height / snapshot.lengths[axis])
    near = np.abs(height) < REACH * spacing
    grid = _Grid(snapshot, axes, pixels, spacing)
    # Sums of w, w d, w d d and of w f, w f d over the particles, d their distances from the pixel in spacings.
    terms = 4 if snapshot.dimension == 3 else 3
    moments = np.zeros((terms, terms, grid.count))
    right = np.zeros((terms, grid.count))
    neighbours = np.zeros(grid.count)
    for pixel, which, d, q in grid.pairs(places[near], spacing[near], height[near] / spacing[near]):
        w = (1 - q) ** 4 * (1 + 4 * q)
        basis = [np.ones_like(q), *d][:terms]
        neighbours += np.bincount(pixel, q < NEAR / REACH, grid.count)
        for i in range(terms):
            right[i] += np.bincount(pixel, w * basis[i] * values[near][which], grid.count)
            for j in range(i, terms):
                moments[i, j] += np.bincount(pixel, w * basis[i] * basis[j], grid.count)
    with np.errstate(divide="ignore", invalid="ignore"):
        aside = np.sqrt((moments[0, 1:] ** 2).sum(axis=0)) / moments[0, 0]
    picture = _solve(moments, right, (neighbours == 0) & ~(aside < ASIDE))
    return grid.map(np.clip(picture, *room) if room else picture)


def grains_of(snapshot, values: np.ndarray, pixels: int, axis: int, at: float | None) -> Map:
    """Spheres of the field Radius, in 3-D those that the plane normal to `axis` through `at` cuts: each has its own value."""
    places, radius = snapshot["Coordinates"], snapshot["Radius"]
    height = np.zeros(len(places))
    if snapshot.dimension == 3:
        height = places[:, axis] - (snapshot.lengths[axis] / 2 if at is None else at)
    cut = np.abs(height) < radius
    grid = _Grid(snapshot, _across(snapshot.dimension, axis), pixels, radius / REACH)
    picture = np.full(grid.count, np.nan)
    for pixel, which, _, _ in grid.pairs(places[cut], radius[cut] / REACH, height[cut] * REACH / radius[cut]):
        picture[pixel] = values[cut][which]
    return dataclasses.replace(grid.map(picture), sharp=True)


def _room(values: np.ndarray, mirrors: tuple[Mirror, ...]) -> tuple[float, float] | None:
    """Within which the picture's values stay; None without particles."""
    if not len(values):
        return None
    kept = [float(values.min()), float(values.max()), *(wall.value for wall in mirrors if wall.value is not None)]
    room = BEYOND * (max(kept) - min(kept))
    return min(kept) - room, max(kept) + room


def _with_images(places: np.ndarray, spacing: np.ndarray, values: np.ndarray, mirrors: tuple[Mirror, ...]):
    """With the images of the particles near a mirror; behind an edge one mirror follows the other."""
    for wall in mirrors:
        depth = (places[:, wall.axis] - wall.place) * wall.inward
        seen = (depth >= 0) & (depth < REACH * spacing)
        images = places[seen].copy()
        images[:, wall.axis] = 2 * wall.place - images[:, wall.axis]
        there = values[seen] if wall.value is None else 2 * wall.value - values[seen]
        places, spacing, values = np.concatenate([places, images]), np.concatenate([spacing, spacing[seen]]), np.concatenate([values, there])
    return places, spacing, values


def column_of(snapshot, values: np.ndarray, pixels: int, axis: int) -> Map:
    """Integral of the field along `axis`: the sum of values times volumes times the kernel's own integral."""
    spacing = snapshot.spacing
    grid = _Grid(snapshot, _across(3, axis), pixels, spacing)
    through = np.zeros(grid.count)
    for pixel, which, _, q in grid.pairs(snapshot["Coordinates"], spacing, np.zeros(len(spacing))):
        # The kernel's integral along a line at distance q, over the unit ball; in m^-2 times m^3.
        weight = np.interp(q, _LINE_AT, _LINE) * spacing[which] / REACH**2
        through += np.bincount(pixel, weight * values[which], grid.count)
    return grid.map(through)


class _Grid:
    """Pixels over a face of the box."""

    def __init__(self, snapshot, axes: tuple[int, int], pixels: int, spacing: np.ndarray):
        self.axes = axes
        self.lengths = snapshot.lengths[list(axes)]
        self.periodic = snapshot.periodic[list(axes)]
        # Free surfaces, and boxes without walls: what lies outside is shown as well, but not the last hundredth where that has flown far away.
        places = snapshot["Coordinates"][:, list(axes)]
        low, high = (np.minimum(0.0, places.min(axis=0)), np.maximum(self.lengths, places.max(axis=0))) if len(places) else (np.zeros(2), self.lengths)
        if (high - low > 2.0 * self.lengths).any():
            most = np.quantile(places, (0.01, 0.99), axis=0)
            low, high = np.minimum(0.0, most[0]), np.maximum(self.lengths, most[1])
        if "GravitationalPotential" in snapshot and len(spacing):  # nothing stands around a body that attracts itself: its surface is seen
            low, high = low - MARGIN * np.median(spacing), high + MARGIN * np.median(spacing)
        self.low = np.where(self.periodic, 0.0, low)
        self.high = np.where(self.periodic, self.lengths, high)
        size = self.high - self.low
        if len(spacing):
            pixels = min(pixels, int(np.ceil(PIXELS_A_SPACING * size.max() / np.median(spacing))))
        self.shape = np.maximum(np.round(size / size.max() * pixels).astype(int), 1)  # columns, rows
        self.pixel = size / self.shape
        self.count = int(self.shape.prod())

    def pairs(self, places: np.ndarray, spacing: np.ndarray, height: np.ndarray):
        """For each offset of a pixel from a particle's own: the pixels, the particles that reach them, their distances by axis in spacings,
        and over the kernel's support."""
        if not len(places):
            return
        flat = places[:, list(self.axes)] - self.low
        own = np.floor(flat / self.pixel).astype(int)
        reach = np.ceil(REACH * spacing.max() / self.pixel).astype(int)
        for right in range(-reach[0], reach[0] + 1):
            for up in range(-reach[1], reach[1] + 1):
                index = own + (right, up)
                d = np.column_stack([((index + 0.5) * self.pixel - flat) / spacing[:, None], height])
                q = np.sqrt(d[:, 0] ** 2 + d[:, 1] ** 2 + d[:, 2] ** 2) / REACH
                index = np.where(self.periodic, index % self.shape, index)
                which = np.flatnonzero(((index >= 0) & (index < self.shape)).all(axis=1) & (q < 1))
                yield index[which, 1] * self.shape[0] + index[which, 0], which, d[which].T, q[which]

    def map(self, values: np.ndarray) -> Map:
        return Map(values.reshape(self.shape[1], self.shape[0]),
                   (float(self.low[0]), float(self.high[0]), float(self.low[1]), float(self.high[1])), self.axes)


def _solve(moments: np.ndarray, right: np.ndarray, empty: np.ndarray) -> np.ndarray:
    """The fitted plane's value at the pixel; the weighted mean where the particles do not span a plane; nan where there are none."""
    terms = len(right)
    matrix = np.moveaxis(moments, 2, 0)
    matrix = matrix + np.triu(matrix, 1).swapaxes(1, 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        value = right[0] / moments[0, 0]
        # Of the matrix over its weight: a unit sphere of particles about the pixel has a determinant of about 0.1.
        spread = np.linalg.det(matrix / np.where(moments[0, 0] > 0, moments[0, 0], 1)[:, None, None])
    good = (spread > 1e-4) & np.isfinite(spread) & ~empty
    if good.any():
        value[good] = np.linalg.solve(matrix[good], right.T[good][:, :, None])[:, 0, 0]
    value[empty] = np.nan
    return value


def _across(dimension: int, axis: int) -> tuple[int, int]:
    return (0, 1) if dimension == 2 else tuple(other for other in range(3) if other != axis)


def _middles(low: float, high: float, count: int) -> np.ndarray:
    return low + (np.arange(count) + 0.5) * (high - low) / count


def _line_integrals(points: int = 200) -> tuple[np.ndarray, np.ndarray]:
    """Of the normalised kernel over the unit ball in 3-D, along lines at these distances from its middle."""
    at = np.linspace(0, 1, points)
    z = (np.arange(2000) + 0.5) / 2000
    r = np.minimum(np.hypot(at[:, None], z), 1)
    return at, 2 * 21 / (2 * np.pi) * ((1 - r) ** 4 * (1 + 4 * r)).mean(axis=1)


_LINE_AT, _LINE = _line_integrals()
