"""The ``drape`` command, by the same code as the one that ``cargo install`` brings."""

import signal
import sys

from . import _native


def main() -> int:
    """Runs ``drape`` with the arguments of this process; gives its exit code."""
    # The command has no need of Python's own handler: Ctrl-C ends it as it ends any program.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    again = [sys.executable, "-m", "mesh_draping"]
    return _native.run_command(["drape", *sys.argv[1:]], again, _native.__file__)


if __name__ == "__main__":
    sys.exit(main())
