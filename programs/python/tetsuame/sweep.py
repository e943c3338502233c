"""`tetsuame sweep`: one input with many settings, and a page of what came out. Runs that are complete are not run again."""
import argparse
import concurrent.futures
import contextlib
import fcntl
import itertools
import json
import os
import re
import shlex
import subprocess
import sys
import threading
from html import escape
from pathlib import Path

from . import COMPLETED, FAILED, PROGRAMS, pages, runs, writing
from .reading import Damaged, Unreadable, beside, last_line, read_json, read_text, real

MOST = 9  # measures on the page
ENDED = {0: "completed", 3: "failed"}  # statuses after which the same run again would end the same


def settings_of(texts: list[str]) -> list[list[str]]:
    """`a.b=1,2` to ["a.b=1", "a.b=2"]; commas within quotes or brackets separate nothing."""
    found = []
    for text in texts:
        key, equals, values = text.partition("=")
        if not equals or not re.fullmatch(r"\w+\.\w+", key.strip()) or not values.strip():
            raise Unreadable(f"--set {text}: expected group.key=value,value,…")
        found.append([f"{key.strip()}={value.strip()}" for value in re.findall(r"(?:'[^']*'|\"[^\"]*\"|[^,])+", values)])
    return found


def folder_name(settings: tuple[str, ...]) -> str:
    """Of the last parts of keys: `n=24_dt=1`, with what file systems dislike replaced."""
    return "_".join(re.sub(r"[^\w.=+-]", "-", setting.partition(".")[2]) for setting in settings)


class Sweep:
    def __init__(self, o: argparse.Namespace):
        self.o = o
        combinations = list(itertools.product(*settings_of(o.set)))
        self.runs = {o.output / folder_name(settings): settings for settings in combinations}  # by folder
        if len(self.runs) < len(combinations):
            raise Unreadable("two of the runs would have the same folder: a value is given twice, or two keys differ in their group alone")
        self.done, self.lock = 0, threading.Lock()

    def options(self, folder: Path) -> list[str]:
        return [*(part for setting in self.runs[folder] for part in ("--set", setting)), "--output", str(folder)]

    def command(self, folder: Path) -> list[str]:
        start = ["mpirun", "-n", str(self.o.ranks)] if self.o.ranks > 1 else []
        going_on = any(folder.glob("checkpoint_*.h5"))  # else what a run left that was killed early is replaced
        return [*start, str(self.o.programs / self.o.program), str(self.o.input), *self.options(folder),
                *(["--restart", "latest"] if going_on else ["--force"] if folder.exists() else [])]

    def asked(self, folder: Path) -> dict:
        return {"program": self.o.program, "input": read_text(self.o.input), "settings": list(self.runs[folder])}

    def note(self, folder: Path) -> None:
        writing.folder(self.o.output)
        writing.text(beside(folder, ".json"), json.dumps(self.asked(folder), indent=1))

    def status(self, folder: Path) -> str | None:
        """How it ended, if what stands there is this run at its end."""
        try:
            if json.loads(read_text(beside(folder, ".json"))) != self.asked(folder):
                raise Unreadable(f"{folder}: holds a run of another input or program; give another --output, or remove it")
        except (Damaged, ValueError, RecursionError):
            return None
        summary = folder / "summary.json"
        ended = read_json(summary, "the program").get("status") if summary.exists() else None
        return {"completed": "completed", "completed_doubtful": "doubtful", "diverged": "failed", "failed": "failed"}.get(str(ended))

    def one(self, folder: Path) -> str:
        status = self.status(folder)
        said = f"{status} before"
        if not status:
            command, terminal = self.command(folder), beside(folder, ".log")
            self.note(folder)
            terminal.unlink(missing_ok=True)  # a link too
            with open(terminal, "x", encoding="utf-8") as log:
                code = subprocess.run(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL, env={"OMP_NUM_THREADS": "1"} | os.environ).returncode
            status = (self.status(folder) if code == 0 else None) or ENDED.get(code, f"exit {code}")
            said = status if code in ENDED else f"{status}: {last_line(terminal) or 'nothing said'}"
        with self.lock:
            self.done += 1
            print(f"{self.done}/{len(self.runs)}  {folder.name}: {said}", flush=True)
        return status

    def lines(self, statuses: list[str]) -> list[dict]:
        """Of each run its settings, its status and all numbers of its summary."""
        lines = []
        for (folder, settings), status in zip(self.runs.items(), statuses):
            line = dict(setting.split("=", 1) for setting in settings) | {"status": status}
            if status in (*ENDED.values(), "doubtful") and (folder / "summary.json").exists():
                run = runs.Run(folder)
                line |= {name: run.summary.get(name) for name in ("steps", "wall_seconds")} | run.metrics()
            lines.append(line)
        return lines

    def page(self, lines: list[dict]) -> str:
        """report.html; what is said of it."""
        keys = [setting.partition("=")[0] for setting in next(iter(self.runs.values()))]
        measures = [name for name in dict.fromkeys(name for line in lines for name in line)
                    if name not in (*keys, "status") and len({line.get(name) for line in lines}) > 1]
        facts = [escape(self.o.program), escape(str(self.o.input)), f"{len(lines)} runs"]
        columns = {escape(key): lambda line, key=key: pages.cell(escape(line[key])) for key in keys}
        columns |= {"status": lambda line: pages.cell(escape(line["status"]), {"completed": "good", "doubtful": "stop", "failed": "stop"}.get(line["status"], "bad"))}
        columns |= {escape(name.replace("_", " ")): lambda line, name=name: pages.number(f"{line[name]:.6g}" if name in line else "–")
                    for name in measures[:MOST]}
        return pages.write(self.o.output, pages.document("sweep", [
            pages.head("One input with many settings", facts, ""),
            pages.section("Runs", pages.columns(lines, columns, "wide"),
                          pages.small("Numbers of summary.json that are not the same in all runs"
                                      + (f", the first {MOST} of {len(measures)}" if len(measures) > MOST else "")
                                      + "; all of them stand in sweep.csv beside this page.")),
            pages.section("Over the settings",
                          pages.figure(over_settings(lines, keys, [name for name in measures if name != "wall_seconds"][:MOST]),
                                       caption="Numbers of summary.json over the setting that has most values."))]))

    def scripts(self) -> list[str]:
        """Job scripts by `submit`, one for each run that is not at its end."""
        made = []
        for folder in self.runs:
            if self.status(folder):
                continue
            self.note(folder)
            result = subprocess.run([str(self.o.programs / "submit"), self.o.program, str(self.o.input), "--ranks", str(self.o.ranks),
                                     *shlex.split(self.o.submit), *self.options(folder)], capture_output=True, text=True)
            if result.returncode:
                raise Unreadable(result.stderr.strip().partition("\n")[0])
            made.append(str(folder / "job.sh"))
        return made


def as_number(text: str) -> float | None:
    try:
        return real(text)
    except ValueError:
        return None


def over_settings(lines: list[dict], keys: list[str], measures: list[str]):
    """A panel for each measure over the numeric key with most values, a line for each choice of the others; None without such a key."""
    values = {key: {as_number(line[key]) for line in lines} for key in keys}
    numeric = [key for key in keys if None not in values[key] and len(values[key]) > 1]
    if not numeric or not measures:
        return None
    from . import style  # matplotlib takes a second: not before the runs

    key = max(numeric, key=lambda one: len(values[one]))
    others = [other for other in keys if other != key and len({line[other] for line in lines}) > 1]
    curves: dict[str, list[dict]] = {}
    for line in lines:
        curves.setdefault(", ".join(f"{other.partition('.')[2]} = {line[other]}" for other in others), []).append(line)
    figure, panels = style.panels(len(measures), 3, 2.3)
    for ax, measure in zip(panels, measures):
        for index, (title, of) in enumerate(curves.items()):
            points = sorted((as_number(line[key]), line[measure]) for line in of if measure in line)
            if points:
                ax.plot(*zip(*points), marker="o", markersize=3.5, label=title, **style.numbered(index))
        ax.set(title=measure.replace("_", " "), xlabel=key)
        if len(values[key]) <= 8:
            ax.set_xticks(sorted(values[key]))
    if others:
        style.legend_above(figure, panels)
    return figure


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="tetsuame sweep", description="Runs a program on one input with every combination of settings; a table and a page of what came out. "
        "The same command again goes on where it was interrupted.")
    parser.add_argument("input", metavar="INPUT", type=Path, help="a namelist")
    parser.add_argument("--program", required=True, help="disph_c, rti, …")
    parser.add_argument("--set", metavar="GROUP.KEY=V1,V2", action="append", required=True, help="values of a key; may be repeated")
    parser.add_argument("--output", metavar="FOLDER", type=Path, required=True, help="a folder for each run, sweep.csv and report.html")
    parser.add_argument("--jobs", type=int, default=0, help="runs at a time (as many as cores)")
    parser.add_argument("--ranks", type=int, default=1, help="MPI processes of each run (%(default)d)")
    parser.add_argument("--submit", metavar="OPTIONS", help="write job scripts instead, by the program submit with these options: "
                        "'--scheduler slurm --time 02:00:00'")
    parser.add_argument("--programs", metavar="FOLDER", type=Path, default=PROGRAMS, help="where the programs are (%(default)s)")
    o = parser.parse_args(arguments)
    if o.jobs < 0 or o.ranks < 1:
        parser.error("--jobs is 1 or more (0: as many as cores), --ranks 1 or more")
    if not o.input.is_file():
        raise Unreadable(f"{o.input}: no such file")
    if not (o.programs / o.program).is_file():
        raise Unreadable(f"no program '{o.program}' in {o.programs}; ./run build makes them, --programs says where they are")
    sweep = Sweep(o)
    with alone_in(writing.folder(o.output)):
        return carry_out(sweep, o)


@contextlib.contextmanager
def alone_in(folder: Path):
    """Two sweeps at a time would start each run twice. The lock ends with the process."""
    handle = os.open(folder, os.O_RDONLY | os.O_CLOEXEC)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise Unreadable(f"{folder}: another sweep is running in it: wait for its end, or give another --output") from None
    except OSError:
        pass  # a file system without locks
    try:
        yield
    finally:
        os.close(handle)


def carry_out(sweep: Sweep, o: argparse.Namespace) -> int:
    if o.submit:
        print("\n".join(sweep.scripts()))
        return COMPLETED
    jobs = o.jobs or max((os.cpu_count() or 1) // o.ranks, 1)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        try:
            statuses = list(pool.map(sweep.one, sweep.runs))
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            print("\ninterrupted; the same command goes on", file=sys.stderr)
            return 130
    lines = sweep.lines(statuses)
    writing.table(o.output / "sweep.csv", lines)
    print(o.output / "sweep.csv")
    print(sweep.page(lines))
    return COMPLETED if all(status in ("completed", "doubtful") for status in statuses) else FAILED
