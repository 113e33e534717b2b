"""The program ``cyclo``: finds the commands of all installed packages and runs one of them.

Commands register in the entry-point group ``cyclo.commands``; an entry names a module with ``SUMMARY``,
``configure(parser)`` and ``execute(arguments) -> int``. The modules import lightly, so ``cyclo --help`` is quick.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Sequence
from importlib.metadata import entry_points, version
from typing import Any

from ltca.errors import CycloError

GROUP = "cyclo.commands"
ORDER = ("run", "show", "init", "curves", "tolerance", "sweep", "optimise", "mesh", "fem", "derive", "validate")


class _Parser(argparse.ArgumentParser):
    """Parser that takes -1e-3 for a negative number, not for an option."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._negative_number_matcher = re.compile(r"^-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")


def build_parser(wanted: str = "") -> argparse.ArgumentParser:
    """Return the parser of ``cyclo``.

    Parameters
    ----------
    wanted : str
        Command to be run: if it is installed, it alone is loaded; otherwise all are, for the help.
    """
    parser = _Parser(
        prog="cyclo",
        description="Loaded tooth contact analysis of cycloidal gear drives, checked against finite elements.",
    )
    parser.add_argument("--version", action="version", version=f"cyclo {version('cyclo-ltca')}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True, parser_class=_Parser)
    found = {entry.name: entry for entry in entry_points(group=GROUP)}
    if wanted in found:
        found = {wanted: found[wanted]}
    known = [name for name in ORDER if name in found]
    for name in known + sorted(set(found) - set(known)):
        module = found[name].load()
        command = commands.add_parser(name, help=module.SUMMARY, description=module.SUMMARY)
        module.configure(command)
        command.set_defaults(execute=module.execute)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run ``cyclo`` and return its exit status: 0 done, 1 a check failed or a fault, 2 bad input."""
    words = list(sys.argv[1:] if argv is None else argv)
    # One thread each: the matrices of a batch are small, and threads that share two cores slow each other down.
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    from ltca.output.processes import Terminated, ended_by_signals

    arguments = build_parser(words[0] if words else "").parse_args(words)
    try:
        with ended_by_signals():
            return int(arguments.execute(arguments))
    except CycloError as error:
        print(f"cyclo: error: {error}", file=sys.stderr)
        return error.exit_status
    except Terminated:
        print("cyclo: terminated", file=sys.stderr)
        return 143
    except KeyboardInterrupt:
        print("cyclo: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        # The reader of our output (head, less) has gone: no message, and none from the interpreter's exit either.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141


if __name__ == "__main__":
    sys.exit(main())
