"""`tetsuame movie`: a run's snapshots as MP4 (by ffmpeg) or GIF."""
import argparse
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

from . import COMPLETED, fields, plots, runs, scene, style, writing
from .reading import Unreadable

VIEW = 960  # pixels, of a view's width


def frames(run: runs.Run, names: list[str], pixels: int, axis: int):
    """Pictures of all snapshots, as arrays of red, green, blue. Axes are drawn once, images filled anew."""
    figure = images = None
    bodies = []
    ranges = {name: fields.limits(run.snapshots, name) for name in names}
    for snapshot in run.snapshots:
        pictures = {name: snapshot.map(name, pixels, axis) for name in names}
        if figure is None:
            wide = np.ptp(pictures[names[0]].extent[:2]) / np.ptp(pictures[names[0]].extent[2:])
            each = min(max(5.2 * wide * 0.95, 3.4), 9.0)  # inches
            height = min(5.2, each / wide + 0.6)
            figure, panels = style.plt.subplots(1, len(names), figsize=(len(names) * each, height), squeeze=False)
            images = {name: plots.draw_map(ax, pictures[name], name, snapshot.unit(name), ranges[name]) for ax, name in zip(panels[0], names)}
        for name, image in images.items():
            image.set_data(pictures[name].values / image.tetsuame_size)
            image.set_extent([edge / image.tetsuame_across for edge in pictures[name].extent])
        for old in bodies:
            old.remove()
        bodies = [drawn for ax, name in zip(panels[0], names) if (drawn := plots.draw_bodies(ax, snapshot, pictures[name]))]
        panels[0][0].set_title(plots.when(snapshot))
        figure.canvas.draw()
        figure.set_layout_engine("none")  # places are found once
        yield np.asarray(figure.canvas.buffer_rgba())[..., :3]
    style.plt.close(figure)


def views(snapshots: list, columns: int, fastest: float, cut: float | None = None):
    """Water in three dimensions, coloured by its speed up to the fastest, m/s, as such pictures. cut: the z, m, beyond which nothing is shown."""
    tall = scene.tall(snapshots[0])
    for snapshot in snapshots:
        figure, ax = style.plt.subplots(figsize=(columns / 100, columns / 100 * tall + 0.3), dpi=100)
        scene.draw(ax, snapshot, columns, fastest, cut)
        ax.set_title(plots.when(snapshot))
        figure.canvas.draw()
        yield np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()
        style.plt.close(figure)


def write_mp4(pictures, target: Path, rate: float) -> None:
    """Even sides, as H.264 wants them, by repeating the last row or column."""
    encoder = None
    with writing.replacing(target) as path:
        try:
            for picture in pictures:
                picture = np.pad(picture, [(0, picture.shape[0] % 2), (0, picture.shape[1] % 2), (0, 0)], mode="edge")
                if encoder is None:
                    encoder = subprocess.Popen(
                        ["ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{picture.shape[1]}x{picture.shape[0]}",
                         "-r", str(rate), "-i", "-", "-pix_fmt", "yuv420p", "-c:v", "libx264", "-crf", "18", str(path)],
                        stdin=subprocess.PIPE, stderr=subprocess.PIPE)
                encoder.stdin.write(picture.tobytes())
        except BrokenPipeError:
            pass  # it has said why, below
        except BaseException:
            if encoder:
                encoder.kill()
            raise
        _, said = encoder.communicate()
        if encoder.returncode:
            raise OSError(0, "ffmpeg: " + said.decode(errors="replace").strip().partition("\n")[0])


def write_gif(pictures, target: Path, rate: float) -> None:
    from PIL import Image  # comes with matplotlib

    first, *rest = [Image.fromarray(picture).quantize(128) for picture in pictures]
    with writing.replacing(target) as path:
        first.save(path, "GIF", save_all=True, append_images=rest, duration=round(1000 / rate), loop=0)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="tetsuame movie", description="Shows the snapshots of a run one after the other: DIR/movie.mp4.")
    parser.add_argument("directory", metavar="DIR", help="of the run; &output interval says how many snapshots it has")
    parser.add_argument("--fields", metavar="A,B", type=lambda text: text.split(","), help="side by side (the first that varies)")
    parser.add_argument("--gif", action="store_true", help="write movie.gif, which needs no ffmpeg and opens in any browser")
    parser.add_argument("--rate", type=float, default=20, help="pictures a second (%(default)g)")
    parser.add_argument("--pixels", type=int, default=300, help="along the box's longer side, for the field (%(default)d)")
    parser.add_argument("--axis", choices="xyz", default="z", help="of a 3-D run: the slice through the middle is normal to it (%(default)s)")
    parser.add_argument("--view", action="store_true",
                        help="of water in 3-D: its surface and bodies from a side and above, by speed, in place of a field")
    parser.add_argument("--cut", type=float, metavar="Z", help="with --view: what has a larger z (m) is cut away")
    parser.add_argument("--output", metavar="FILE", type=Path, help="instead of DIR/movie.mp4 or DIR/movie.gif")
    o = parser.parse_args(arguments)
    if o.cut is not None and not np.isfinite(o.cut):
        parser.error("--cut is a number")
    if not 0.1 <= o.rate <= 200 or not 16 <= o.pixels <= 4000:
        parser.error("--rate is 0.1 to 200, --pixels 16 to 4000")
    if o.view and o.fields or o.cut is not None and not o.view:
        parser.error("--view shows speeds, and no --fields; --cut is of --view")
    run = runs.Run(o.directory)
    if o.view and not (run.snapshot().dimension == 3 and fields.is_water(run.snapshot())):
        raise Unreadable(f"{o.directory}: --view is of water with a free surface in three dimensions")
    names = fields.shown(run.snapshot(), o.fields, most=1)
    if len(run.snapshots) < 2:
        raise Unreadable(f"{o.directory}: one snapshot is no movie; set &output interval for more")
    target = o.output or run.directory / ("movie.gif" if o.gif else "movie.mp4")
    as_gif = o.gif or target.suffix == ".gif"
    if not as_gif and shutil.which("ffmpeg") is None:
        raise Unreadable("no ffmpeg on this machine (Debian's package ffmpeg): install it, or use --gif")
    if o.view:
        pictures = views(run.snapshots, VIEW, fields.limits(run.snapshots, "Speed")[1], o.cut)
    else:
        pictures = frames(run, names, o.pixels, "xyz".index(o.axis))
    (write_gif if as_gif else write_mp4)(told(pictures, len(run.snapshots)), target, o.rate)
    print(target)
    return COMPLETED


def told(pictures, count: int):
    """The same, with a line on a terminal that says how far it is."""
    for done, picture in enumerate(pictures, 1):
        yield picture
        if sys.stderr.isatty():
            print(f"\rpicture {done} of {count}", end="\n" if done == count else "", file=sys.stderr, flush=True)
