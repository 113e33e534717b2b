"""The program ``cyclo``: finds the commands of all installed packages and runs one of them.

Commands register in the entry-point group ``cyclo.commands``; an entry names a module with ``SUMMARY``, ``EXAMPLES``
(pairs of a command line and what it does), ``configure(parser)`` and ``execute(arguments) -> int``. The modules import
lightly, so ``cyclo --help`` is quick.
"""

from __future__ import annotations

import argparse
import errno
import os
import re
import sys
import traceback
import warnings
from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from importlib.metadata import EntryPoint, entry_points, requires, version
from typing import Any, NoReturn

from ltca.errors import CycloError, did_you_mean, printable
from ltca.output.terminal import prepare_streams

GROUP = "cyclo.commands"
ORDER = (
    "run",
    "check",
    "show",
    "init",
    "fields",
    "quantities",
    "curves",
    "dynamics",
    "tolerance",
    "sweep",
    "optimise",
    "design",
    "studio",
    "mesh",
    "fem",
    "derive",
    "validate",
    "export",
)
USAGE_ERROR, FAULT = 2, 1
OUTPUT_FAULTS = (errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EBADF, errno.EFBIG)
WRONG_PLACE = (errno.ENAMETOOLONG, errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOTDIR, errno.ELOOP)
"""What a path answers that cannot be used by whoever asks."""
NO_MEMORY = ("failed to map segment", "annot allocate memory", "can't start new thread", "can't allocate lock")
"""What the loader of libraries, and threads, say where a library or a stack finds no memory."""
DISTRIBUTION = "cyclo-ltca"
DISTRIBUTIONS = {"distributed": "dask", "skfem": "scikit-fem", "PIL": "pillow"}
"""Packages whose modules have another name."""
DEBUG = "--debug"
EXAMPLES = "examples:"


class _Help(argparse.HelpFormatter):
    """Help that leaves examples as they are written."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return text if text.startswith(EXAMPLES) else super()._fill_text(text, width, indent)


class _Parser(argparse.ArgumentParser):
    """Parser that takes -1e-3 and -20deg for quantities, says what was meant, and tells every mistake in one line."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._negative_number_matcher = re.compile(r"^-\.?\d")
        self.add_argument(
            DEBUG, action="store_true", default=argparse.SUPPRESS, help="show the traceback of an error, and warnings"
        )

    def _print_message(self, message: str, file: Any = None) -> None:
        """Print help and usage; the library would pass over what cannot be written."""
        if message:
            (file or sys.stderr).write(message)

    def error(self, message: str) -> NoReturn:
        """End with the message in one line and exit status 2."""
        self.exit(USAGE_ERROR, f"cyclo: error: {printable(message)} ('{self.prog} --help' shows the usage)\n")

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Return the arguments; for an option that is not there, name the one that was meant."""
        found, rest = self.parse_known_args(args, namespace)
        if rest:
            options = getattr(found, "options", self._option_string_actions)
            name = rest[0].partition("=")[0]
            self.error(f"unrecognized arguments: {' '.join(rest)}{did_you_mean(name, options)}")
        return found

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError as error:
            error.message += did_you_mean(str(value), map(str, action.choices or ()))
            raise


@cache
def _installed() -> dict[str, EntryPoint]:
    """Return the installed commands; asked once, since every distribution is read for it."""
    return {entry.name: entry for entry in entry_points(group=GROUP)}


def build_parser(wanted: str = "") -> argparse.ArgumentParser:
    """Return the parser of ``cyclo``: of the command `wanted` alone where that is installed, otherwise of all, for the help."""
    parser = _Parser(
        prog="cyclo",
        description="Loaded tooth contact analysis of cycloidal gear drives, checked against finite elements.",
    )
    parser.add_argument("--version", action="version", version=f"cyclo {version(DISTRIBUTION)}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True, parser_class=_Parser)
    found = _installed()
    if wanted in found:
        found = {wanted: found[wanted]}
    known = [name for name in ORDER if name in found]
    for name in known + sorted(set(found) - set(known)):
        module = found[name].load()
        command = commands.add_parser(
            name,
            help=module.SUMMARY,
            description=module.SUMMARY,
            epilog=examples_text(getattr(module, "EXAMPLES", ())),
            formatter_class=_Help,
        )
        module.configure(command)
        command.set_defaults(execute=module.execute, options=tuple(command._option_string_actions))
    return parser


def examples_text(examples: Sequence[tuple[str, str]]) -> str | None:
    """Return the end of a command's help; None without examples.

    Examples
    --------
    >>> print(examples_text([("cyclo run paper", "the paper's drive")]))
    examples:
      cyclo run paper
          the paper's drive
    """
    if not examples:
        return None
    return "\n".join([EXAMPLES, *(f"  {line}\n      {told}" for line, told in examples)])


def main(argv: Sequence[str] | None = None) -> int:
    """Run ``cyclo`` and return its exit status: 0 done, 1 a failed check, a fault or a partial result, 2 bad input."""
    words = [_decoded(word) for word in sys.argv[1:]] if argv is None else list(argv)
    debug = DEBUG in words
    prepare_streams()
    if argv is None and not debug and not sys.warnoptions:
        warnings.simplefilter("ignore")  # of libraries, for those who write code
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    from ltca.output.processes import Terminated, ended_by_signals
    from ltca.output.threads import use_one_thread

    use_one_thread()
    try:
        wanted = next((word for word in words if word != DEBUG), "")
        with ended_by_signals():
            status = _run(words, wanted)
            sys.stdout.flush()  # what cannot be written is told, not left to the interpreter's exit
        return status
    except Terminated:
        print("cyclo: terminated", file=sys.stderr)
        return 143
    except KeyboardInterrupt:
        print("cyclo: interrupted", file=sys.stderr)
        return 130
    except Exception as error:  # noqa: BLE001  # the one place where everything ends
        if _reader_has_gone(error):
            # No message, and none from the interpreter's exit either.
            _forget_output()
            return 141
        if isinstance(error, OSError) and error.filename is None and error.errno in OUTPUT_FAULTS:
            error.filename = "standard output"  # our files are named when they cannot be written
            _forget_output()
        if debug:
            traceback.print_exc()
        print(f"cyclo: error: {_told(error)}", file=sys.stderr)
        if isinstance(error, OSError) and error.filename is not None and error.errno in WRONG_PLACE:
            return USAGE_ERROR  # whichever argument it was
        if isinstance(error, ModuleNotFoundError) and what_installs(error.name or ""):
            return USAGE_ERROR
        return error.exit_status if isinstance(error, CycloError) else FAULT


def _run(words: list[str], wanted: str) -> int:
    """Run a command, or print the help that was asked for, and return the exit status."""
    if not set(words) - {DEBUG}:
        build_parser().print_help(sys.stderr)
        return USAGE_ERROR
    try:
        arguments = build_parser(wanted).parse_args(words)
    except SystemExit:
        sys.stdout.flush()
        raise
    return int(arguments.execute(arguments))


def _reader_has_gone(error: Exception) -> bool:
    """Tell whether who read our output (head, less) has gone; Windows calls that an invalid argument."""
    if isinstance(error, OSError) and os.name == "nt":
        return error.errno in (errno.EPIPE, errno.EINVAL) and error.filename is None
    return isinstance(error, BrokenPipeError)


def _forget_output() -> None:
    """Let what standard output still holds go nowhere, so that the interpreter's exit is quiet."""
    with suppress(OSError, ValueError):  # a stream of no file
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _decoded(word: str) -> str:
    """A word of the command line as UTF-8 where the locale could not read it."""
    try:
        return os.fsencode(word).decode("utf-8")
    except UnicodeError:
        return word


def what_installs(module: str) -> str:
    """Return what pip is to install for a module of a package that we ask for, by itself or in an extra; else nothing.

    Examples
    --------
    >>> what_installs("distributed.client"), what_installs("antigravity")
    ("'cyclo-ltca[cluster]'", '')
    """
    top = module.partition(".")[0]
    package = DISTRIBUTIONS.get(top, top).lower().replace("_", "-")
    for line in requires(DISTRIBUTION) or ():
        if re.split(r"[^\w.-]", line)[0].lower().replace("_", "-") == package:
            extra = re.search(r"extra == ['\"]([\w-]+)['\"]", line)
            return f"'{DISTRIBUTION}[{extra[1]}]'" if extra else f"'{line.partition(';')[0].strip()}'"
    return ""


def _told(error: Exception) -> str:
    """What an exception tells the user: its own message where it has one for them, else how to report it."""
    if isinstance(error, CycloError):
        return "\n".join(printable(line) for line in str(error).split("\n"))
    if isinstance(error, ModuleNotFoundError) and (wanted := what_installs(error.name or "")):
        return f"the Python package {(error.name or '').partition('.')[0]} is not installed: pip install {wanted}"
    if isinstance(error, MemoryError):
        return "memory is not enough; ask for fewer positions or samples, or for larger elements"
    if any(sign in str(error) for sign in NO_MEMORY) or (isinstance(error, OSError) and error.errno == errno.ENOMEM):
        return (
            "memory is not enough to load what the command needs: raise the limit (ulimit -v, container), or free some"
        )
    if isinstance(error, UnicodeEncodeError):
        return f"{printable(error.object)[:200]}: cannot be a file name in the encoding {error.encoding}; LC_ALL=C.UTF-8 helps"
    if isinstance(error, OSError) and error.strerror:
        return printable(f"{error.filename or 'a file'}: {error.strerror}")
    message = printable(" ".join(str(error).split()))[:200]
    return (
        f"unforeseen {type(error).__name__}{f': {message}' if message else ''}. This is a fault of cyclo, please report it: "
        f"the command, the drive file and what {DEBUG} adds (CONTRIBUTING.md)"
    )


if __name__ == "__main__":
    sys.exit(main())
