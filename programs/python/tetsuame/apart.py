"""A command in a process of its own, which damaged files may end: the HDF5 library fails on some in a way that no program can catch."""
import mmap
import os
import signal
import sys

from . import FILE_FAILED, reading

CRASHES = (signal.SIGSEGV, signal.SIGBUS, signal.SIGABRT, signal.SIGFPE, signal.SIGILL)


def run(what, name: str) -> int:
    """What `what()` returns, or FILE_FAILED and one sentence if the process crashed. `name`: of the command, for the message."""
    reading.last_opened = mmap.mmap(-1, 4096)
    child = os.fork()
    if child == 0:
        return what()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):  # the terminal tells both of SIGINT
        signal.signal(number, (lambda *_: None) if number == signal.SIGINT else lambda told, _: os.kill(child, told))
    _, status = os.waitpid(child, 0)
    if os.WIFEXITED(status):
        return os.WEXITSTATUS(status)
    ended = os.WTERMSIG(status)
    if ended in CRASHES:
        path = os.fsdecode(reading.last_opened[:].partition(b"\0")[0])
        print(f"tetsuame {name}: {path or 'a file'}: is damaged; the HDF5 library crashed on it ({signal.Signals(ended).name})", file=sys.stderr)
        return FILE_FAILED
    signal.signal(ended, signal.SIG_DFL)
    os.kill(os.getpid(), ended)  # as a shell expects
    return FILE_FAILED
