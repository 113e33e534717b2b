"""Standard streams that take every message, whatever their encoding, also where they are closed."""

from __future__ import annotations

import codecs
import io
import os
import shlex
import sys
from collections.abc import Iterable

PLAIN = {
    "′": "'", "″": '"', "’": "'", "“": '"', "”": '"', "°": " deg", "µ": "u", "μ": "u", "·": " ", "…": "...", "×": "x",
    "–": "-", "—": "-", "−": "-", "±": "+-", "≤": "<=", "≥": ">=", "²": "^2", "³": "^3", "φ": "phi", "π": "pi",
    "Δ": "Delta ", "α": "alpha", "ν": "nu", "ρ": "rho", "σ": "sigma", "θ": "theta", "ζ": "zeta", "⁶⁴": "^64", "→": "->",
    "₀": "_0", "⁶": "^6", "⁴": "^4",
}  # fmt: skip
"""What is printed where an encoding has no such sign."""
HANDLER = "cyclo-plain"


def shell_words(words: Iterable[str], system: str = os.name) -> str:
    """Return words of a command as they are typed, in quotes where a shell would split or read them.

    Examples
    --------
    >>> shell_words(["my.toml"]), shell_words(["my drive.toml"], "posix"), shell_words(["my drive.toml"], "nt")
    ('my.toml', "'my drive.toml'", '"my drive.toml"')
    """
    if system != "nt":
        return shlex.join(words)
    from subprocess import list2cmdline

    return list2cmdline(words)


def _replace(error: UnicodeError) -> tuple[str | bytes, int]:
    """Plain signs for those that an encoding lacks, their number for what has no plain one."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    lacking = error.object[error.start : error.end]
    told = "".join(PLAIN.get(sign) or sign.encode("ascii", "backslashreplace").decode("ascii") for sign in lacking)
    try:
        told.encode(error.encoding)
    except UnicodeError:
        told = "?" * len(lacking)
    return told, error.end


def prepare_streams() -> None:
    """Let stdout and stderr take every sign in any encoding; what is closed swallows.

    No locale, no terminal and no stream may end a computation with an error of printing.
    """
    codecs.register_error(HANDLER, _replace)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            # Closed by whoever started us. It stays open as long as the process.
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8", newline="\n"))  # noqa: SIM115
        elif isinstance(stream, io.TextIOWrapper) and stream.errors in ("strict", "surrogateescape"):
            stream.reconfigure(errors=HANDLER)
