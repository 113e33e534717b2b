"""Which parts of a reducer yield in its torsional stiffness, and which are rigid because the file leaves them out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ltca.drive.parts import Drive


@dataclass(frozen=True, slots=True, kw_only=True)
class YieldingParts:
    """Parts by whether they yield.

    Attributes
    ----------
    cycloid_stage : tuple of str
        What yields between held cranks, at their splines, and the output.
    reducer : tuple of str
        The same and what yields between the input and the cranks.
    rigid : tuple of str
        What does not yield because the file leaves it out, with the field that would say how.
    """

    cycloid_stage: tuple[str, ...]
    reducer: tuple[str, ...]
    rigid: tuple[str, ...]

    @property
    def content(self) -> dict[str, list[str]]:
        """The same as files hold it."""
        return {"cycloid_stage": [*self.cycloid_stage], "reducer": [*self.reducer], "rigid": [*self.rigid]}

    @property
    def words(self) -> str:
        """One sentence for screens and pages."""
        return f"the stiffness is that of {', '.join(self.reducer)}; rigid, because left out: {', '.join(self.rigid)}"


def stiffness_notes(cases: Mapping[str, YieldingParts]) -> list[str]:
    """Return whose the torsional stiffness of every case is, one sentence for all that are alike.

    Examples
    --------
    >>> one = YieldingParts(cycloid_stage=("pins",), reducer=("pins",), rigid=("ring",))
    >>> stiffness_notes({"hot": one, "cold": one})
    ['The stiffness is that of pins; rigid, because left out: ring.']
    """
    each: dict[str, list[str]] = {}
    for name, parts in cases.items():
        each.setdefault(parts.words, []).append(name)
    sentences = [f"{words[0].upper()}{words[1:]}." for words in each]
    if len(each) == 1:
        return sentences
    return [f"{', '.join(names)}: {words}" for names, words in zip(each.values(), sentences, strict=True)]


@dataclass(frozen=True, slots=True)
class _Part:
    """A part that may yield: its name, the field that says how, whether a drive has it, and whether it yields there."""

    name: str
    field: str
    there: Callable[[Drive], bool]
    yields: Callable[[Drive], bool]


def _always(_: Drive) -> bool:
    return True


def _has_shaft_pins(drive: Drive) -> bool:
    return drive.pin_shaft is not None


_STAGE = (
    _Part("flanks and wheel pins", "", _always, _always),
    _Part("bending of wheel pins", "pin_wheel.beam", _always, lambda drive: drive.pin_wheel.beam is not None),
    _Part("crank bearings", "", _always, _always),
    _Part("shaft pins and holes", "", _has_shaft_pins, _always),
    _Part("crankshafts and their bearings", "crank.support", _always, lambda drive: drive.crank.support is not None),
    _Part(
        "torsion of the crankshafts", "crank.support.torsion", _always,
        lambda drive: drive.crank.support is not None and drive.crank.support.torsion,
    ),
    _Part("main bearing", "main_bearing", _always, lambda drive: drive.wheel_yields),
    _Part("ring that carries the wheel pins", "ring", _always, lambda drive: drive.ring is not None),
    _Part(
        "flanges and posts of the carrier", "carrier.posts", _always,
        lambda drive: drive.carrier is not None and drive.carrier.posts is not None,
    ),
    _Part(
        "torsion of the carrier", "carrier.stiffness_torsion", _always,
        lambda drive: drive.carrier is not None and drive.carrier.stiffness_torsion is not None,
    ),
)  # fmt: skip
_BEFORE = (
    _Part(
        "first stage", "first_stage.mesh_stiffness", lambda drive: drive.first_stage_ratio is not None,
        lambda drive: drive.first_stage is not None and drive.first_stage.mesh_stiffness is not None,
    ),
)  # fmt: skip


def yielding_parts(drive: Drive) -> YieldingParts:
    """Return which parts of a drive yield in its torsional stiffness.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> found = yielding_parts(load_drive("rv").cases["nominal"])
    >>> found.cycloid_stage
    ('flanks and wheel pins', 'crank bearings', 'crankshafts and their bearings')
    >>> found.rigid[1:3]
    ('torsion of the crankshafts (crank.support.torsion)', 'main bearing (main_bearing)')
    """
    stage = tuple(part.name for part in _STAGE if part.there(drive) and part.yields(drive))
    before = tuple(part.name for part in _BEFORE if part.there(drive) and part.yields(drive))
    rigid = tuple(
        part.name + (f" ({part.field})" if part.field else "")
        for part in (*_STAGE, *_BEFORE)
        if part.there(drive) and not part.yields(drive)
    )
    return YieldingParts(cycloid_stage=stage, reducer=stage + before, rigid=rigid)
