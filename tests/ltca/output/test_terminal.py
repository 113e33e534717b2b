"""Any encoding, a closed stream and a narrow terminal take every message."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from ltca.output.terminal import PLAIN

ROOT = Path(__file__).parents[3]
pytestmark = pytest.mark.skipif(os.name == "nt", reason="streams are closed by a shell")


def cyclo(*words, closed=(), **environment):
    """Run the program, some streams closed before it starts; return its exit status and what it told."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("LC_", "LANG", "PYTHON"))}
    start = "from ltca.commands.program import main; import sys; sys.exit(main())"
    command = 'exec "$0" -c "$1" "${@:2}"' + "".join(f" {number}>&-" for number in closed)
    done = subprocess.run(
        ["bash", "-c", command, sys.executable, start, *words], cwd=ROOT, capture_output=True, check=False, timeout=600,
        env=kept | {"PYTHONPATH": str(ROOT)} | environment,
    )  # fmt: skip
    return done.returncode, done.stdout, done.stderr


def test_plain_signs_stand_in_any_encoding():
    assert all(plain.isascii() for plain in PLAIN.values())


@pytest.mark.parametrize(
    "encoding",
    ["ascii:strict", "cp1252", *(pytest.param(name, marks=pytest.mark.slow) for name in ("ascii", "latin-1"))],
)
def test_messages_come_out_in_any_encoding(encoding):
    words = ("run", "paper", "--torque", "-5 µm")
    status, _, err = cyclo(*words, LC_ALL="C", PYTHONIOENCODING=encoding)
    assert status == 2
    assert b"must have the unit N" in err
    assert b"Traceback" not in err
    assert err.decode(encoding.partition(":")[0])


@pytest.mark.parametrize(
    "columns", ["1", "wide", *(pytest.param(number, marks=pytest.mark.slow) for number in ("0", "7"))]
)
def test_help_fits_any_terminal(columns):
    status, out, err = cyclo("run", "--help", COLUMNS=columns, LC_ALL="C", PYTHONIOENCODING="ascii")
    assert status == 0
    assert err == b""
    assert b"phi" in out  # the metavar of an angle, which ascii does not have


@pytest.mark.parametrize("closed", [(1,), (2,), (1, 2)])
def test_closed_streams_swallow(closed):
    status, _, err = cyclo("run", "paper", "--positions", "0", closed=closed)
    assert status == 2
    assert b"Traceback" not in err
