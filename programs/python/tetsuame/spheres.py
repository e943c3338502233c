"""Particles in three dimensions as lit spheres, seen from a side and from above, y upwards: nearer ones hide those behind."""
import numpy as np

ASIDE, ABOVE = 28.0, 24.0  # degrees: how far the eye is turned from looking along -z, and how high it is
LIGHT = np.array([-0.35, 0.75, 0.56])  # towards it, as the eye sees it: right, up, near
AMBIENT = 0.45


def turned(places: np.ndarray, aside: float = ASIDE, above: float = ABOVE) -> np.ndarray:
    """To the right, up and towards the eye, in parallel projection."""
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
        self.pixel = size[0] / columns
        self.shape = (int(np.ceil(size[1] / self.pixel)) + 1, columns)  # rows from the bottom up
        self.extent = (self.low[0], self.low[0] + columns * self.pixel, self.low[1], self.low[1] + self.shape[0] * self.pixel)

    def turned(self, places: np.ndarray) -> np.ndarray:
        return turned(places, self.aside, self.above)


def draw(eye: Eye, places: np.ndarray, diameter: float, colours: np.ndarray) -> np.ndarray:
    """The picture, [row, column, red, green, blue, opacity], of particles with their colours, (n, 3)."""
    at = eye.turned(places)
    at = np.column_stack([(at[:, :2] - eye.low) / eye.pixel, at[:, 2] / eye.pixel])
    radius = max(0.5 * diameter / eye.pixel, 0.75)
    reach = int(np.ceil(radius))
    own = np.floor(at[:, :2]).astype(int)
    pixels, depths, shades, which = [], [], [], []
    for up in range(-reach, reach + 1):
        for right in range(-reach, reach + 1):
            index = own + (right, up)
            d = (index + 0.5 - at[:, :2]) / radius
            inside = (d**2).sum(axis=1)
            k = np.flatnonzero((inside < 1) & (index >= 0).all(axis=1) & (index[:, 0] < eye.shape[1]) & (index[:, 1] < eye.shape[0]))
            near = np.sqrt(1 - inside[k])
            pixels.append(index[k, 1] * eye.shape[1] + index[k, 0])
            depths.append(at[k, 2] + radius * near)
            shades.append(AMBIENT + (1 - AMBIENT) * np.maximum(np.column_stack([d[k], near]) @ (LIGHT / np.linalg.norm(LIGHT)), 0))
            which.append(k)
    pixels, depths, shades, which = map(np.concatenate, (pixels, depths, shades, which))
    order = np.argsort(depths, kind="stable")
    nearest = np.full(eye.shape[0] * eye.shape[1], -1)
    nearest[pixels[order]] = order  # of several the last, which is the nearest
    picture = np.zeros((len(nearest), 4))
    seen = nearest >= 0
    picture[seen, :3] = colours[which[nearest[seen]]] * shades[nearest[seen], None]
    picture[seen, 3] = 1.0
    return picture.reshape(*eye.shape, 4)


def edges(eye: Eye, low, high) -> list[np.ndarray]:
    """The lines of a box, each two places on the picture; the first three are behind it."""
    corners = np.array([[(low, high)[bit >> axis & 1][axis] for axis in range(3)] for bit in range(8)], float)
    at = eye.turned(corners)
    pairs = [(a, a | 1 << axis) for a in range(8) for axis in range(3) if not a >> axis & 1]
    return [at[list(pair), :2] for pair in sorted(pairs, key=lambda pair: at[list(pair), 2].min())]
