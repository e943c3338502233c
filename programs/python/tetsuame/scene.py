"""Water in three dimensions as a surface, and bodies, seen from a side and from above, y upwards, in parallel projection.

Each particle of water is a sphere. Of each pixel the nearest sphere is taken; its depth is smoothed over a spacing, but not across edges
of the water, and the surface lit by its slopes [W. J. van der Laan, S. Green, M. Sainz (2009), Symp. Interactive 3D Graphics, 91].
Wall particles of bodies are cubes as wide as their spacing. What stands before a plane of constant z may be cut away."""
import numpy as np

from . import style

ASIDE, ABOVE = 28.0, 24.0  # degrees: how far the eye is turned from looking along -z, and how high it is
LIGHT = np.array([-0.35, 0.75, 0.56]) / np.linalg.norm([-0.35, 0.75, 0.56])  # towards it, as the eye sees it: right, up, near
AMBIENT, GLOSS, SHARP = 0.45, 0.2, 40
STONE = 0.72                               # of bodies: white is 1
BALL, BLUR, EDGE = 0.9, 0.55, 1.5          # spacings: a sphere's radius, what is smoothed over, a step in depth that is an edge
ROUNDS = 3                                 # of smoothing
PIXELS = 10.0                              # a spacing, at most: more would only cost time
TALLEST = 4.0                              # a picture's height over its width
NOTHING = -np.inf                          # the depth where nothing is


def turned(places: np.ndarray, aside: float = ASIDE, above: float = ABOVE) -> np.ndarray:
    """To the right, up and towards the eye."""
    a, b = np.radians((aside, above))
    right = np.cos(a) * places[:, 0] - np.sin(a) * places[:, 2]
    near = np.sin(a) * places[:, 0] + np.cos(a) * places[:, 2]
    return np.column_stack([right, np.cos(b) * places[:, 1] - np.sin(b) * near, np.sin(b) * places[:, 1] + np.cos(b) * near])


class Eye:
    """Where places of a box come to lie on a picture of so many columns."""

    def __init__(self, low, high, columns: int, aside: float = ASIDE, above: float = ABOVE):
        self.aside, self.above = aside, above
        corners = np.array(np.meshgrid(*zip(low, high))).reshape(3, -1).T
        flat = self.turned(corners)[:, :2]
        self.low, size = flat.min(axis=0), np.ptp(flat, axis=0)
        self.pixel = max(size[0], size[1] / TALLEST) / columns
        self.shape = (int(np.ceil(size[1] / self.pixel)) + 1, columns)  # rows from the bottom up
        self.extent = (self.low[0], self.low[0] + columns * self.pixel, self.low[1], self.low[1] + self.shape[0] * self.pixel)

    def turned(self, places: np.ndarray) -> np.ndarray:
        return turned(places, self.aside, self.above)

    def pixels(self, places: np.ndarray) -> np.ndarray:
        """Column, row, and depth towards the eye, in pixels."""
        at = self.turned(places)
        return np.column_stack([(at[:, :2] - self.low) / self.pixel, at[:, 2] / self.pixel])


def ball(offset: np.ndarray, radius: float, _eye: Eye) -> np.ndarray:
    """How much nearer than its middle a sphere is at an offset (right, up) from it, in pixels; nan beside it."""
    with np.errstate(invalid="ignore"):
        return np.sqrt(radius**2 - (offset**2).sum(axis=1))


def cube(offset: np.ndarray, half: float, eye: Eye) -> np.ndarray:
    """The same of a cube along the axes, half as wide as this."""
    faces = eye.turned(np.eye(3))
    faces *= np.where(faces[:, 2:] < 0.0, -1.0, 1.0)
    aside, towards = offset @ faces[:, :2].T, np.maximum(faces[:, 2], 1e-12)
    near, far = ((half - aside) / towards).min(axis=1), ((-half - aside) / towards).max(axis=1)
    return np.where(near > far, near, np.nan)


def nearest(eye: Eye, places: np.ndarray, half: float, shape=ball) -> tuple[np.ndarray, np.ndarray]:
    """Of each pixel the depth of the nearest particle there, NOTHING without, and which it is. half: of a particle's width, m."""
    at = eye.pixels(places)
    half = max(half / eye.pixel, 0.75)
    reach = int(np.ceil(half * (1.75 if shape is cube else 1.0)))  # a cube's corner is √3 away
    own = np.floor(at[:, :2]).astype(int)
    depth, which = np.full(eye.shape[0] * eye.shape[1], NOTHING), np.full(eye.shape[0] * eye.shape[1], -1)
    for up in range(-reach, reach + 1):
        for right in range(-reach, reach + 1):
            index = own + (right, up)
            front = at[:, 2] + shape(index + 0.5 - at[:, :2], half, eye)
            seen = np.flatnonzero((index >= 0).all(axis=1) & (index[:, 0] < eye.shape[1]) & (index[:, 1] < eye.shape[0]) & np.isfinite(front))
            seen = seen[np.argsort(front[seen], kind="stable")]
            pixel = index[seen, 1] * eye.shape[1] + index[seen, 0]
            better = front[seen] > depth[pixel]
            depth[pixel[better]], which[pixel[better]] = front[seen[better]], seen[better]  # of several the last, which is the nearest
    return depth.reshape(eye.shape), which.reshape(eye.shape)


def smoothed(depth: np.ndarray, values: np.ndarray, width: float, edge: float) -> tuple[np.ndarray, np.ndarray]:
    """Both by a Gaussian of this width along rows and columns in turn, of pixels whose depth differs by less than `edge`."""
    there = depth > NOTHING
    depth, values = np.where(there, depth, 0.0), np.where(there, values, 0.0)
    far = int(np.ceil(2 * width))
    for axis in (0, 1) * ROUNDS:
        room = [(far, far) if a == axis else (0, 0) for a in (0, 1)]
        around, beside, known = np.pad(depth, room), np.pad(values, room), np.pad(there, room)
        sums = np.zeros((3, *depth.shape))
        for offset in range(-far, far + 1):
            part = tuple(slice(far + offset, far + offset + depth.shape[a]) if a == axis else slice(None) for a in (0, 1))
            weight = np.exp(-0.5 * (offset / width)**2) * (known[part] & there & (np.abs(around[part] - depth) < edge))
            sums += (weight, weight * around[part], weight * beside[part])
        total = np.maximum(sums[0], 1e-300)
        depth, values = sums[1] / total, sums[2] / total
    return np.where(there, depth, NOTHING), np.where(there, values, np.nan)


def slope(depth: np.ndarray, axis: int) -> np.ndarray:
    """Per pixel; where the two sides differ, at an edge, that of the flatter side."""
    steps = np.diff(np.where(depth > NOTHING, depth, np.nan), axis=axis)
    before, behind = (np.pad(steps, [side if a == axis else (0, 0) for a in (0, 1)], constant_values=np.nan) for side in ((1, 0), (0, 1)))
    flatter = np.where(np.abs(np.nan_to_num(before, nan=np.inf)) < np.abs(np.nan_to_num(behind, nan=np.inf)), before, behind)
    even = np.abs(before - behind) < 2.0
    return np.nan_to_num(np.where(even, 0.5 * (before + behind), flatter))


def lit(depth: np.ndarray, colours: np.ndarray, gloss: float = 0.0) -> np.ndarray:
    """Colours of a surface, [row, column, red, green, blue], in the light."""
    normal = np.stack([-slope(depth, 1), -slope(depth, 0), np.ones_like(depth)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    half = (LIGHT + (0, 0, 1)) / np.linalg.norm(LIGHT + (0, 0, 1))
    shade = AMBIENT + (1 - AMBIENT) * np.maximum(normal @ LIGHT, 0.0)
    return colours * shade[..., None] + gloss * (np.maximum(normal @ half, 0.0)**SHARP)[..., None]


def picture(snapshot, columns: int, fastest: float, cut: float | None = None) -> tuple[np.ndarray, Eye]:
    """[row, column, red, green, blue, opacity]: water coloured by its speed up to the fastest, m/s. Places above the box are cut off.
    cut: the z, m, beyond which nothing is shown."""
    spacing = float(np.median(snapshot.spacing))
    eye = Eye(np.zeros(3), snapshot.lengths, columns)
    if spacing > PIXELS * eye.pixel:
        eye = Eye(np.zeros(3), snapshot.lengths, round(columns * PIXELS * eye.pixel / spacing))
    water, wall, speed = snapshot["Coordinates"], snapshot.wall("Coordinates").reshape(-1, 3), snapshot["Speed"]
    if cut is not None:
        wall, kept = wall[wall[:, 2] < cut], water[:, 2] < cut
        water, speed = water[kept], speed[kept]
    depth, which = nearest(eye, water, BALL * spacing)
    depth, speed = smoothed(depth, np.append(speed, 0.0)[which], max(BLUR * spacing / eye.pixel, 0.5), EDGE * spacing / eye.pixel)
    colours = lit(depth, style.plt.get_cmap("viridis")(np.nan_to_num(speed) / fastest)[..., :3], GLOSS)
    before, _ = nearest(eye, wall, 0.501 * spacing, cube)
    colours = np.where((before > depth)[..., None], lit(before, np.full((*eye.shape, 3), STONE)), colours)
    seen = np.maximum(before, depth) > NOTHING
    return np.concatenate([np.clip(colours, 0, 1) * seen[..., None], seen[..., None]], axis=-1), eye


def edges(eye: Eye, low, high) -> list[np.ndarray]:
    """The lines of a box, each two places on the picture; the first three are behind it."""
    corners = np.array([[(low, high)[bit >> axis & 1][axis] for axis in range(3)] for bit in range(8)], float)
    at = eye.turned(corners)
    pairs = [(a, a | 1 << axis) for a in range(8) for axis in range(3) if not a >> axis & 1]
    return [at[list(pair), :2] for pair in sorted(pairs, key=lambda pair: at[list(pair), 2].min())]


def draw(ax, snapshot, columns: int, fastest: float, cut: float | None = None) -> None:
    """A picture within the lines of the box."""
    drawn, eye = picture(snapshot, columns, fastest, cut)
    for index, line in enumerate(edges(eye, np.zeros(3), snapshot.lengths)):
        ax.plot(*line.T, color=style.GREY, linewidth=0.6, zorder=1 if index < 3 else 3)
    ax.imshow(drawn, origin="lower", extent=eye.extent, interpolation="antialiased", zorder=2)
    ax.set(xlim=eye.extent[:2], ylim=eye.extent[2:], aspect="equal")
    ax.axis("off")


def tall(snapshot) -> float:
    """A picture's height over its width."""
    shape = Eye(np.zeros(3), snapshot.lengths, 60).shape
    return shape[0] / shape[1]


def speed_bar(figure, axes, fastest: float) -> None:
    style.colour_bar(figure, style.plt.cm.ScalarMappable(style.plt.Normalize(0, fastest), "viridis"), axes, "speed [m/s]", shrink=0.5)
