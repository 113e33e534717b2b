"""What tests share: drives, the paper's, variations of it, random ones of other sizes and tooth numbers; a browser."""

from __future__ import annotations

import base64
import copy
import gc
import hashlib
import html
import json
import os
import re
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    # Before numpy comes: threads of several libraries on two cores wait for each other.
    os.environ.setdefault(_variable, "1")
# Bytecode is kept even where the environment forbids it: without it every worker spends seconds, every program half of its
# start, on the same compilation again.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

import needs
import numpy as np
import pytest
from coarse_derivations import coarse_derivation

from ltca.analysis import summary
from ltca.compliance import coefficient_files
from ltca.drive.parts import Drive
from ltca.errors import DriveError
from ltca.laws import profiled_line_contact
from ltca.output.provenance import code_hash
from ltca.reading.drive_file import build_drive, load_drive, parse_drive, shipped_drive

gc.disable()  # while some hundred thousand objects come that stay


def pytest_configure(config: pytest.Config) -> None:
    """Let workers take files in the order of the collection, not by their number of tests: see `_longest_first`."""
    if hasattr(config.option, "loadscopereorder"):
        config.option.loadscopereorder = False


def pytest_collection_finish() -> None:
    """Look for garbage among what the tests make, not among modules and the tests themselves."""
    gc.enable()
    gc.freeze()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Skip what is nightly, unless the expression of `-m` names it; what is nightly is slow, too."""
    named = "nightly" in config.option.markexpr
    _mark_by_seconds(items)
    _mark_families(items)
    for item in items:
        if item.get_closest_marker("nightly"):
            item.add_marker("slow")
            if not named:
                item.add_marker(pytest.mark.skip(reason="nightly: python -m pytest -m nightly"))
    if hasattr(config, "workerinput"):
        _longest_first(items)


@cache
def _budget() -> dict[str, Any]:
    """What tests took (``benchmarks/suite_times.py``), and how long those of the quick and of the full set may take, s."""
    return tomllib.loads((Path(__file__).parent / "budget.toml").read_text(encoding="utf-8"))


def _mark_by_seconds(items: list[pytest.Item]) -> None:
    """Mark tests that take longer than those of the quick and of the full set may."""
    budget = _budget()
    for item in items:
        seconds = budget["seconds"].get(item.nodeid, 0.0)
        if seconds > budget["quick_seconds"]:
            item.add_marker("slow")
        if seconds > budget["full_seconds"]:
            item.add_marker("nightly")


def _mark_families(items: list[pytest.Item]) -> None:
    """Mark what is beyond the first of a family: tests of one function that go the same way through the code."""
    quick: Counter[str] = Counter()
    full: Counter[str] = Counter()
    for item in items:
        family = item.get_closest_marker("family")
        if family is None or item.get_closest_marker("nightly"):
            continue
        name = item.nodeid.partition("[")[0]
        if full[name] >= family.kwargs.get("full", sys.maxsize):
            item.add_marker("nightly")
            continue
        full[name] += 1
        if item.get_closest_marker("slow"):
            continue
        if quick[name] >= family.kwargs.get("quick", sys.maxsize):
            item.add_marker("slow")
        quick[name] += 1


def _longest_first(items: list[pytest.Item]) -> None:
    """Put the files with the slowest tests first: a worker that begins one at the end leaves the others without work."""
    seconds: Counter[str] = Counter()
    budget = _budget()
    for name, spent in budget["seconds"].items():
        if spent <= budget["full_seconds"]:
            seconds[name.partition("::")[0]] += spent
    items.sort(key=lambda item: -seconds[item.nodeid.partition("::")[0]])


def _merge(below: dict[str, Any], over: dict[str, Any]) -> dict[str, Any]:
    for key, value in over.items():
        if isinstance(value, dict) and isinstance(below.get(key), dict):
            _merge(below[key], value)
        else:
            below[key] = value
    return below


@pytest.fixture(scope="session")
def paper_cases() -> dict[str, Drive]:
    """The paper's drive in its six cases."""
    return load_drive("paper").cases


@pytest.fixture(scope="session")
def paper_table() -> Callable[..., dict[str, Any]]:
    """Return a function that gives the plain tables of the paper's drive, some fields replaced."""

    def table(**over: Any) -> dict[str, Any]:
        base = tomllib.loads(shipped_drive())
        del base["case"]
        base.pop("tolerances", None)
        return _merge(base, copy.deepcopy(over))

    return table


@pytest.fixture(scope="session")
def vary(paper_table: Callable[..., dict[str, Any]]) -> Callable[..., Drive]:
    """Return a function that builds the paper's drive with some fields replaced, fully checked."""
    return lambda **over: build_drive(paper_table(**over))


@pytest.fixture(scope="session")
def kinds_of_drives(vary: Callable[..., Drive]) -> dict[str, Drive]:
    """The shipped drives, one with 99 sharp lobes, and a plastic one whose flank, holes and bore are not as designed."""
    shipped = {
        name: next(iter(parse_drive(shipped_drive(name), name).cases.values()))
        for name in ("paper", "rv", "robot-joint", "sleeved")
    }
    sharp = {"number_of_pins": 100, "pin_radius": 1.3}
    many = vary(
        name="many",
        crank={"eccentricity": 0.72},
        pin_wheel=sharp,
        pin_shaft={"hole_radius": 10.82},
        disc={"number_of_teeth": 99, "equidistant_offset": 0.02, "shifting_offset": 0.01},
    )
    waves = {"orders": [2, 13, 60], "cosine": [0.004, -0.002, 0.0005], "sine": [0.001, 0.002, 0.0]}
    plastic = vary(
        name="plastic",
        disc={
            "profile_errors": waves,
            "runout": {"amount": 0.01, "angle": 0.7},
            "hole_errors": {"diameter": [0.02] * 8, "radial": [0.01, *[0.0] * 7]},
        },
        clearance={"bearing": 0.03, "pin_hole": 0.05},
        materials={"disc": "PA12"},
    )
    return {**shipped, "many": many, "plastic": plastic}


@pytest.fixture(scope="session")
def random_drives() -> list[Drive]:
    """Six sound drives of random size, tooth number, eccentricity, offsets, clearances and part errors."""
    rng = np.random.default_rng(20240611)
    drives: list[Drive] = []
    while len(drives) < 6:
        pins = int(rng.integers(7, 41))
        radius = rng.uniform(30.0, 200.0)
        eccentricity = rng.uniform(0.4, 0.75) * radius / pins
        pin_radius = rng.uniform(0.25, 0.55) * radius * np.sin(np.pi / pins)
        inner, roller = 0.2 * radius, rng.uniform(0.05, 0.07) * radius
        bore = inner + 2.0 * roller
        rollers = int(rng.uniform(0.6, 0.95) * np.pi / np.arcsin(roller / (inner + roller)))
        root = radius - eccentricity - pin_radius
        holes = int(rng.integers(5, 11))
        circle = 0.5 * (bore + root)
        hole = 0.8 * min(0.5 * (root - bore), circle * np.sin(np.pi / holes))
        size = 2e-4 * radius

        def errors(count: int, size: float = size) -> dict[str, list[float]]:
            return {
                name: (size * rng.uniform(-0.2, 0.2, count)).tolist() for name in ("radial", "tangential", "diameter")
            }

        pocket = errors(rollers)
        del pocket["radial"]
        table: dict[str, Any] = {
            "name": f"random{len(drives)}",
            "crank": {"eccentricity": eccentricity},
            "pin_wheel": {
                "number_of_pins": pins,
                "pin_circle_radius": radius,
                "pin_radius": pin_radius,
                "pin_errors": errors(pins),
            },
            "disc": {
                "number_of_teeth": pins - 1,
                "thickness": 0.13 * radius,
                "equidistant_offset": rng.uniform(1.5, 2.0) * size,
                "shifting_offset": rng.uniform(0.3, 1.2) * size,
                "hole_errors": errors(holes),
            },
            "crank_bearing": {
                "inner_race_radius": inner,
                "outer_race_radius": bore,
                "number_of_rollers": rollers,
                "roller_radius": roller,
                "roller_length": 0.1 * radius,
                "roller_errors": pocket,
            },
            "pin_shaft": {
                "number_of_pins": holes,
                "pin_circle_radius": circle,
                "pin_radius": hole - eccentricity,
                "hole_radius": hole,
                "stiffness": 1.1e4 * radius,
                "pin_errors": errors(holes),
            },
            "load": {"torque": 0.5 * radius**3, "direction": "ccw" if len(drives) % 2 else "cw"},
            "clearance": {"bearing": rng.uniform(0.0, 2.0) * size, "pin_hole": rng.uniform(0.0, 2.0) * size},
        }
        try:
            drives.append(build_drive(table))
        except DriveError:  # a random drive may be unsound: the checks say so, the next one is drawn
            continue
    return drives


_COARSE_TABLE = cache(partial(profiled_line_contact.profiled_table.__wrapped__, cells=6, nodes=25))


@pytest.fixture
def coarse_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tables of profiled contacts in tenths of a second: good to a per cent, and the same for all who ask."""
    monkeypatch.setattr(profiled_line_contact, "profiled_table", _COARSE_TABLE)


@pytest.fixture
def positions_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Summaries without extremes between the positions, most of the time of small runs, for tests that read none."""
    monkeypatch.setattr(summary, "_refined", lambda analyses: [{} for _ in analyses])


@pytest.fixture
def coarse_derivations(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Coefficients in seconds, on the coarsest meshes that pass their checks, in a cache that nobody else reads."""
    code_hash("ltca", "fem")  # by the usual cache, where it is kept
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(coefficient_files, "derivation", coarse_derivation)
    monkeypatch.setattr(coefficient_files, "MAX_DERIVATIONS", 1)


CHROMIUM = needs.program("chromium")
CHROMIUM_FLAGS = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--hide-scrollbars",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-default-apps",
    "--host-resolver-rules=MAP * ~NOTFOUND", "--virtual-time-budget=5000", "--enable-logging=stderr", "--dump-dom",
)  # fmt: skip
WATCH = """<script>
window.seen = {errors: []};
window.addEventListener("error", e => seen.errors.push(String(e.message)));
window.addEventListener("unhandledrejection", e => seen.errors.push(String(e.reason)));
for (const name of ["error", "warn"]) console[name] = (...words) => seen.errors.push(name + ": " + words.join(" "));
window.leave = () => {
  const out = document.createElement("pre");
  out.id = "seen";
  out.textContent = JSON.stringify(seen);
  document.body.innerHTML = "";
  document.body.appendChild(out);
};
</script>"""
"""What a page under test does first: it writes down errors; `leave` hands over what its script has put into `seen`."""


@pytest.fixture(scope="module")
def browser():
    """Chromium as playwright drives it: of real time, for pages whose frames are waited for."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        found = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield found
        found.close()


def hash_of(text):
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii")


@pytest.fixture(scope="session")
def chromium():
    """Open a page in chromium with a script added; return what it saw, console lines and addresses asked for."""

    def visit(text, script, folder, size="1280,900"):
        copy, log = folder / "copy.html", folder / "net.json"
        # The page runs its own script alone; those of the test are let in by their hashes, too.
        added = re.findall(r"<script>(.*?)</script>", script, re.S)
        policy = "script-src " + "".join(f"'sha256-{hash_of(one)}' " for one in added)
        text = text.replace("script-src ", policy, 1)
        copy.write_text(
            text.replace("<head>", "<head>" + WATCH, 1).replace("</body>", script + "</body>"), encoding="utf-8"
        )
        command = [
            CHROMIUM, *CHROMIUM_FLAGS, f"--user-data-dir={folder / 'profile'}", f"--window-size={size}",
            f"--log-net-log={log}", copy.as_uri(),
        ]  # fmt: skip
        run = subprocess.run(command, capture_output=True, text=True, timeout=600, check=True)
        found = re.search(r'<pre id="seen">(.*?)</pre>', run.stdout, re.S)
        assert found, run.stderr[-2000:]
        console = [line for line in run.stderr.splitlines() if "CONSOLE" in line]
        asked = set(re.findall(r'"url":"(https?://[^"]+)"', log.read_text(encoding="utf-8", errors="replace")))
        # chromium itself may look for Google's hosts at every start; a page's own request would name anything else
        return json.loads(html.unescape(found.group(1))), console, {one for one in asked if "google" not in one}

    return visit
