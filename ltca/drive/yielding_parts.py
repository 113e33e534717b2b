"""Which parts of a reducer yield in its torsional stiffness, and which are rigid because the file leaves them out."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace

from ltca.drive.parts import Drive

RIGID = 1e6
"""Factor on Young's modulus of posts that are made rigid where leaving them out would let the tips of the shaft pins float."""


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
    """A part that may yield: its name, the field that says how, whether a drive may have it, whether it yields there, and how
    it is made rigid.
    """

    name: str
    field: str
    there: Callable[[Drive], bool]
    yields: Callable[[Drive], bool]
    made_rigid: Callable[[Drive], Drive] | None = None


def _always(_: Drive) -> bool:
    return True


def _has_shaft_pins(drive: Drive) -> bool:
    return drive.pin_shaft is not None


def _has_posts(drive: Drive) -> bool:
    return drive.posts is not None


def _has_far_flange(drive: Drive) -> bool:
    """Tips of bending shaft pins are free, or tied by a ring that floats: without posts no flange there is rigid."""
    return _has_posts(drive) or drive.pin_shaft is None or drive.pin_shaft.beam is None


def _tips_are_tied(drive: Drive) -> bool:
    shaft = drive.pin_shaft
    return shaft is not None and shaft.beam is not None and shaft.beam.tip != "free"


def _twists(drive: Drive) -> bool:
    return drive.carrier is not None and drive.carrier.stiffness_torsion is not None


def _cranks_twist(drive: Drive) -> bool:
    return drive.crank.support is not None and drive.crank.support.torsion


def _teeth_yield(drive: Drive) -> bool:
    return drive.first_stage is not None and drive.first_stage.mesh_stiffness is not None


def _without_twist_of_cranks(drive: Drive) -> Drive:
    assert drive.crank.support is not None
    support = replace(drive.crank.support, torsion=False, spline_plane=None)
    return replace(drive, crank=replace(drive.crank, support=support))


def _without_main_bearing(drive: Drive) -> Drive:
    return replace(drive, main_bearing=None, pin_wheel=replace(drive.pin_wheel, support_stiffness=None))


def _on_rigid_posts(drive: Drive) -> Drive:
    assert drive.carrier is not None
    if not _tips_are_tied(drive):
        return replace(drive, carrier=replace(drive.carrier, posts=None, flange=None))
    stiff = replace(drive.materials.carrier, youngs_modulus=RIGID * drive.materials.carrier.youngs_modulus)
    return replace(drive, materials=replace(drive.materials, carrier=stiff))


def _without_twist_of_carrier(drive: Drive) -> Drive:
    assert drive.carrier is not None
    return replace(drive, carrier=replace(drive.carrier, stiffness_torsion=None))


def _with_rigid_teeth(drive: Drive) -> Drive:
    assert drive.first_stage is not None
    return replace(drive, first_stage=replace(drive.first_stage, mesh_stiffness=None))


_STAGE = (
    _Part("flanks and wheel pins", "", _always, _always),
    _Part(
        "bending of wheel pins", "pin_wheel.beam", _always, lambda drive: drive.pin_wheel.beam is not None,
        lambda drive: replace(drive, pin_wheel=replace(drive.pin_wheel, beam=None)),
    ),
    _Part("crank bearings", "", _always, _always),
    _Part("shaft pins and holes", "", _has_shaft_pins, _always),
    _Part(
        "crankshafts and their bearings", "crank.support", _always, lambda drive: drive.crank.support is not None,
        lambda drive: replace(drive, crank=replace(drive.crank, support=None)),
    ),
    _Part(
        "torsion of the crankshafts", "crank.support.torsion", _always, _cranks_twist, _without_twist_of_cranks,
    ),
    _Part("main bearing", "main_bearing", _always, lambda drive: drive.wheel_yields, _without_main_bearing),
    _Part(
        "ring that carries the wheel pins", "ring", _always, lambda drive: drive.ring is not None,
        lambda drive: replace(drive, ring=None),
    ),
    _Part("flanges and posts of the carrier", "carrier.posts", _has_far_flange, _has_posts, _on_rigid_posts),
    _Part(
        "torsion of the carrier", "carrier.stiffness_torsion", _always, _twists, _without_twist_of_carrier,
    ),
)  # fmt: skip
_BEFORE = (
    _Part(
        "first stage", "first_stage.mesh_stiffness", lambda drive: drive.first_stage_ratio is not None, _teeth_yield,
        _with_rigid_teeth,
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


def removable_parts(drive: Drive) -> tuple[str, ...]:
    """Return the names of the parts that yield in a drive and would be rigid if its file left them out."""
    return tuple(part.name for part in (*_STAGE, *_BEFORE) if part.made_rigid is not None and part.yields(drive))


def with_rigid(drive: Drive, names: Collection[str]) -> Drive:
    """Return a drive with the named parts (`removable_parts`) rigid, in series with all others as before.

    Cranks without bearings of their own do not twist either.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> drive = load_drive("rv").cases["nominal"]
    >>> removable_parts(drive)
    ('crankshafts and their bearings',)
    >>> removable_parts(with_rigid(drive, removable_parts(drive)))
    ()
    """
    for part in (*_STAGE, *_BEFORE):
        if part.name in names and part.made_rigid is not None and part.yields(drive):
            drive = part.made_rigid(drive)
    return drive
