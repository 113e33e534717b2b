"""Which engine refuses which fields: what a drive must leave out for it.

The refusals themselves are those of `ltca.drive.plane_strain` and of the engines; the walk of the contract
(``tests/contract``, and ``benchmarks/contract.py`` for full finite elements) holds this table against them, field by field.
"""

from __future__ import annotations

from collections.abc import Mapping

ENGINES = {
    "tables": "half-space, tabulated laws (`--method tables`, the default)",
    "direct": "half-space, contact grids (`--method direct`)",
    "paper": "the paper's iteration (`--method paper`)",
    "fe": "plane strain (`--compliance fe`)",
    "hybrid": "half-spaces of finite length on bodies (`--compliance hybrid`)",
    "full FE": "full finite elements (`cyclo fem`, `validate`)",
}
"""What an analysis may run on."""

OF_SEVERAL_CRANKS = (
    "crank.number",
    "crank.circle_radius",
    "crank.angle",
    "installation.first_stage_ratio",
    "disc.of.N.bore_errors",
)
_LOOSE = dict.fromkeys(
    ("pin_wheel.seat", "pin_wheel.beam", "pin_shaft.seat", "pin_shaft.beam"),
    "pins are fixed and do not bend there",
)
_RUBS = {"friction": "nothing rubs there"}
_YIELDS = dict.fromkeys(("crank.support", "pin_wheel.support_stiffness"), "cranks and wheel stand still there")
_ALONG = dict.fromkeys(
    ("crank_bearing.roller_length", "crank_bearing.roller_profile", "pin_wheel.pin_profile"),
    "it is two-dimensional: nothing varies along the length, and rollers are as long as the disc is thick",
)
REFUSED: Mapping[str, Mapping[str, str]] = {
    "tables": {},
    "direct": _LOOSE | _RUBS,
    "paper": _LOOSE
    | _RUBS
    | _YIELDS
    | {"disc.number_of_discs": "it knows one disc"}
    | dict.fromkeys(OF_SEVERAL_CRANKS, "it knows one crank"),
    "fe": _ALONG,
    "hybrid": {},
    "full FE": _LOOSE | _RUBS | _YIELDS | _ALONG | {"pin_wheel.axis_offset": "wheel and pin shaft have one axis there"},
}
"""Tables and fields, by their paths, that an engine refuses by name, each with the reason."""


def refusal(engine: str, path: str) -> str | None:
    """Return why an engine refuses a field; None where it takes it.

    Parameters
    ----------
    engine : str
        One of `ENGINES`.
    path : str
        A field, ``disc.thickness``.

    Examples
    --------
    >>> refusal("fe", "crank_bearing.roller_profile.crown_drop")
    'it is two-dimensional: nothing varies along the length, and rollers are as long as the disc is thick'
    >>> refusal("fe", "disc.thickness")
    """
    return next((why for name, why in REFUSED[engine].items() if path == name or path.startswith(f"{name}.")), None)


def refusals(path: str) -> dict[str, list[str]]:
    """Return the engines that refuse a field, by their reason.

    Parameters
    ----------
    path : str
        A field, ``disc.thickness``.
    """
    found: dict[str, list[str]] = {}
    for engine in ENGINES:
        if (reason := refusal(engine, path)) is not None:
            found.setdefault(reason, []).append(engine)
    return found
