"""Loaded tooth contact analysis of cycloidal gear drives.

>>> import ltca
>>> drive = ltca.load_drive("paper").cases["CS-1"]
>>> result = ltca.analyse(drive, positions=4)
>>> round(result.summary["mean_tangential_bearing_load_N"])
6737

Folders in the order data passes; each one's docstring lists its modules.

=============  ============================================================
errors         what the suite raises on purpose
arrays         Trees of arrays by position, and results that stay as they were returned
beam           Round shafts and pins as beams: deflections at the planes of the discs under their forces, twists
quantities     The registry of quantities: names, units, dimensions, words and limits of all results
output         The edge: files that are whole or not there, folders of one run, processes that end with ours, progress
drive          What a drive is: frozen definitions of its parts, their deviations and tolerances; nothing computed
geometry       Where everything is and how far it is pressed together at a pose; no forces
contact        One contact between half-spaces: from influence coefficients to the pressure over a patch and the
               stress below it
reading        Files that are read: drives, checked against physics, changed and written; coefficients, by their laws;
               arguments
laws           Load–approach laws of single contacts: tables of the half-space, plane strain, springs
compliance     Loads of all pairs at a pose: how the bodies yield, two kinds of models behind one interface
mechanics      All contacts of a reducer and what couples them, in one system beside these models
equilibrium    The pose that balances
dynamics       Masses, and vibrations about a balanced position
analysis       An analysis of a drive and what is read from it
studies        Studies at scale: tolerances, sweeps, optimiser
figures        Pictures of results, by matplotlib and pyvista
page           Pages of results that open offline
export         Parts carried out: exact outlines, DXF drawings, tables of points (STEP and STL: ``fem.export``)
studio         A drive in the browser, its answer beside it: the server of ``cyclo studio``
testing        What serves checking alone, importable by tests of your own
facade         The front door: `analyse`, its result, derivatives
front          What else ``import ltca`` gives: `check`, `curves`, `vibration`, `concat`
commands       The program ``cyclo``
drives         Drives that ship with the package
=============  ============================================================
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ltca.analysis.engines import HalfSpace, Hybrid, PlaneStrain
    from ltca.drive.parts import Drive
    from ltca.errors import DriveError
    from ltca.facade import analyse, derivatives
    from ltca.front.checks import check
    from ltca.front.curves import curves
    from ltca.front.joined import concat
    from ltca.front.motions import motion
    from ltca.front.vibrations import vibration
    from ltca.reading.drive_file import load_drive

    __version__: str

# Where each name of the front door lives: loaded when it is first asked for, so that `import ltca` stays light.
_HOMES = {
    "Drive": "ltca.drive.parts",
    "DriveError": "ltca.errors",
    "HalfSpace": "ltca.analysis.engines",
    "Hybrid": "ltca.analysis.engines",
    "PlaneStrain": "ltca.analysis.engines",
    "analyse": "ltca.facade",
    "check": "ltca.front.checks",
    "concat": "ltca.front.joined",
    "curves": "ltca.front.curves",
    "derivatives": "ltca.facade",
    "load_drive": "ltca.reading.drive_file",
    "motion": "ltca.front.motions",
    "vibration": "ltca.front.vibrations",
}

__all__ = [
    "Drive", "DriveError", "HalfSpace", "Hybrid", "PlaneStrain", "__version__", "analyse", "check", "concat",
    "curves", "derivatives", "load_drive", "motion", "vibration",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Load a name of the front door."""
    if name == "__version__":
        from importlib.metadata import version

        return version("cyclo-ltca")
    if name not in _HOMES:
        raise AttributeError(f"module 'ltca' has no attribute {name!r}")
    from importlib import import_module

    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Name the front door."""
    return sorted({*globals(), *__all__})
