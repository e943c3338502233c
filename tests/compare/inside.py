"""The package's commands within the test's own process, where they need not read numpy and matplotlib first: half a second each."""
import contextlib
import io
import subprocess

from tetsuame import __main__ as command_line


def call(*arguments):
    """What subprocess.run of `python3 -m tetsuame` with these arguments would return."""
    said, complained = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(complained):
        try:
            status = command_line.main([str(word) for word in arguments])
        except SystemExit as end:
            status = end.code
    return subprocess.CompletedProcess(arguments, status, said.getvalue(), complained.getvalue())
