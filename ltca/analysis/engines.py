"""Engines: how the bodies of a drive yield and how its equilibrium is found, as frozen values with their options.

An engine knows no drive; `prepare` builds what it needs for one, once, and the prepared engine is asked for balanced
positions as often as wanted. Names given as text become engines in `engine_named` and nowhere else.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar, Literal, Protocol, Self, TypeAlias, get_args

from ltca.analysis.half_width_guard import check_half_widths
from ltca.analysis.methods import load_method
from ltca.arrays import FloatArray
from ltca.compliance.coefficient_files import find_coefficients
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.near_field import NEAR_FIELDS
from ltca.compliance.response import Start
from ltca.drive.engine_support import require
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Bodies, Compliance, Drive
from ltca.drive.ring_shape import has_ring_of_elements, nearly_same_ring, ring_fingerprint
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.errors import DriveError, did_you_mean, shortened
from ltca.reading.arguments import bodies_for, compliance_for, refuse_idle_options

Method = Literal["tables", "direct", "paper"]
Contacts = Literal["tables", "grids"]
Given: TypeAlias = InfluenceCoefficients | Sequence[InfluenceCoefficients] | Path | Sequence[Path] | None
"""Influence coefficients as an engine takes them."""

SHARED_BODY = 0.002
"""Relative change of a dimension or an elastic constant up to which a body keeps its coefficients in studies: 0.2 % more of the
radius of its holes moves single loads of the paper's drive by 0.3 %, of bore and flank by less than 0.1 %."""


class PreparedEngine(Protocol):
    """An engine built for one drive."""

    @property
    def model(self) -> Reducer:
        """The compliance whose loads balance."""
        ...

    @property
    def batches(self) -> bool:
        """Whether the model is balanced directly, so that several drives may be rows of one batch."""
        ...

    def balance(self, crank_angle: FloatArray, torque: float, start: FloatArray | None = None) -> Equilibrium:
        """Return balanced positions at an output torque, N·mm, from poses near by if given."""
        ...


class Engine(Protocol):
    """What an analysis runs on."""

    @property
    def compliance(self) -> Compliance:
        """How the bodies yield, by name."""
        ...

    @property
    def bodies(self) -> Bodies:
        """What bodies influence coefficients are of, where they yield by such."""
        ...

    @property
    def options(self) -> dict[str, str]:
        """What distinguishes results of this engine, for attributes of files."""
        ...

    @property
    def batches(self) -> bool:
        """Whether its models can be stacked to that of several drives."""
        ...

    @property
    def rings(self) -> tuple[Drive, ...]:
        """Drives whose rings of finite elements serve drives of nearly their rings."""
        ...

    def with_coefficients(self, drive: Drive) -> Engine:
        """Return the engine with what it has to read or derive for a drive already in it."""
        ...

    def lending(self, drives: Iterable[Drive]) -> Engine:
        """Return the engine on which what is derived for some drives serves others of nearly their bodies."""
        ...

    def lending_rings(self, drives: Iterable[Drive]) -> Engine:
        """Return the engine on which rings of finite elements of some drives serve others of nearly their rings."""
        ...

    def prepare(self, drive: Drive) -> PreparedEngine:
        """Return the engine built for a drive."""
        ...

    def model(self, drive: Drive, *, in_batch: bool = False) -> Reducer:
        """Return the compliance of a drive, for a batch of drives if so (`ltca.arrays.stack_drives`)."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class _OnTables:
    """Equilibrium on a model whose loads come cheaply from anywhere; several drives may be balanced as one batch."""

    batches: ClassVar[bool] = True

    drive: Drive
    model: Reducer

    def balance(self, crank_angle: FloatArray, torque: float, start: FloatArray | None = None) -> Equilibrium:
        """Return balanced positions at an output torque, N·mm, from poses near by if given."""
        return solve_at_output(self.model, [self.drive], crank_angle, torque, start)


@dataclass(frozen=True, slots=True, kw_only=True)
class _FromTables:
    """Equilibrium on a dearer model, started from the solution on tables."""

    batches: ClassVar[bool] = False

    drive: Drive
    tables: Reducer
    model: Reducer

    def balance(self, crank_angle: FloatArray, torque: float, start: FloatArray | None = None) -> Equilibrium:
        near = solve_at_output(self.tables, [self.drive], crank_angle, torque, start)
        # Grids wider than the bodies are curved have no separation: refused before they are laid.
        check_half_widths([self.drive], near.response, self.tables.pressures(near.response), torque)
        return solve_at_output(self.model, [self.drive], crank_angle, torque, near.pose, Start.after(near.response))


def _on_tables(
    drive: Drive, singles: Sequence[Drive], rings: tuple[Drive, ...] = (), *, in_batch: bool = False
) -> Reducer:
    """Return the model of a warm drive on tabulated laws."""
    discs = [HalfSpaceCompliance.of_drive(single, in_batch=in_batch) for single in singles]
    return Reducer.of_drive(drive, discs, ring_lender(drive, rings))


@dataclass(frozen=True, slots=True, kw_only=True)
class HalfSpace:
    """Contacts between half-spaces that do not feel each other (the paper's model).

    Parameters
    ----------
    method : {"tables", "direct", "paper"}
        ``tables``: equilibrium on tabulated laws; ``direct``: contact grids solved inside every iteration, started
        from the solution on tables; ``paper``: the paper's iteration with held wheel, started from our solution at 95 %
        of the torque. Grids and the paper's iteration come with the package `validation` (`ltca.analysis.methods`).
    contacts : {"tables", "grids"}, optional
        What the paper's iteration runs on, tables by default; the other methods have their own.
    rings : tuple of Drive
        Drives whose rings of finite elements also serve drives of nearly their rings, see `lending_rings`.
    asked : bool
        Whether half-spaces were asked for, whatever the drive file says: for the words that give the reason for them.

    Raises
    ------
    DriveError
        When a name is unknown or method and contacts contradict each other.

    Examples
    --------
    >>> import ltca
    >>> ltca.HalfSpace().contacts, ltca.HalfSpace(method="direct").contacts
    ('tables', 'grids')
    >>> drive = ltca.load_drive("robot-joint").cases["nominal"]  # whose own default is hybrid
    >>> ltca.analyse(drive, 1, compliance=ltca.HalfSpace()).engine.compliance
    'half-space'
    """

    compliance: ClassVar[Compliance] = "half-space"
    bodies: ClassVar[Bodies] = "plane"
    batches: ClassVar[bool] = True

    method: Method = "tables"
    contacts: Contacts | None = None
    rings: tuple[Drive, ...] = field(default=(), repr=False)
    asked: bool = field(default=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Check the names; fill in the contacts of the method."""
        _check_name("method", self.method, get_args(Method))
        own: Contacts = "grids" if self.method == "direct" else "tables"
        if self.contacts is not None:
            _check_name("contacts", self.contacts, get_args(Contacts))
            if self.method != "paper" and self.contacts != own:
                raise DriveError(
                    [
                        f"contacts = {self.contacts}: method {self.method} runs on {own}; only method paper runs on "
                        "either"
                    ]
                )
        object.__setattr__(self, "contacts", self.contacts or own)

    @property
    def options(self) -> dict[str, str]:
        """Compliance, method and contacts."""
        return {"compliance": self.compliance, "method": self.method, "contacts": str(self.contacts)}

    def with_coefficients(self, drive: Drive) -> HalfSpace:
        """Return the engine itself: half-spaces need none."""
        return self

    def lending(self, drives: Iterable[Drive]) -> HalfSpace:
        """Return the engine itself: half-spaces need no coefficients."""
        return self

    def lending_rings(self, drives: Iterable[Drive]) -> HalfSpace:
        """Return an engine on which drives of nearly the rings of finite elements of these are served by them."""
        return replace(self, rings=_lent_rings(drives))

    def prepare(self, drive: Drive) -> PreparedEngine:
        """Return the engine built for a drive."""
        drive = warm_drive(drive)
        if self.method != "tables":
            require(drive, self.method)
        singles = single_discs(drive)
        tables = model = _on_tables(drive, singles, self.rings)
        if self.contacts == "grids":
            on_grids = load_method("grids", f"method = {self.method} on contacts = grids")
            model = replace(tables, discs=tuple(on_grids(single) for single in singles), friction=None)
        if self.method == "paper":
            prepare: Callable[[Drive, Reducer, Reducer], PreparedEngine] = load_method("paper", "method = paper")
            return prepare(drive, tables, model)
        if self.method == "direct":
            return _FromTables(drive=drive, tables=tables, model=model)
        return _OnTables(drive=drive, model=tables)

    def model(self, drive: Drive, *, in_batch: bool = False) -> Reducer:
        """Return the tables of a drive."""
        drive = warm_drive(drive)
        return _on_tables(drive, single_discs(drive), self.rings, in_batch=in_batch)


@dataclass(frozen=True, slots=True, kw_only=True)
class CoupledEngine:
    """What the engines on derived coefficients share.

    Parameters
    ----------
    coefficients : InfluenceCoefficients or sequence of them, Path, sequence of Path, or None
        Of the drive, of all its discs alike or of each: read, files of ``cyclo derive`` of which each disc takes the one of
        its shape, or (None) found in the cache or derived and kept there.
    hole_near_field : bool
        Whether hole walls yield like a Hertz contact.
    bodies : {"plane", "solid"}
        What bodies the coefficients are of.
    lenders : tuple of Drive
        Drives of one disc whose coefficients also serve drives of nearly their bodies (`nearly_same_body`), see `lending`.
    rings : tuple of Drive
        Drives whose rings of finite elements also serve drives of nearly their rings, see `lending_rings`.

    Raises
    ------
    DriveError
        When an option is of another kind.
    """

    compliance: ClassVar[Compliance]
    batches: ClassVar[bool] = False

    coefficients: Given = field(default=None, repr=False)
    hole_near_field: bool = True
    bodies: Bodies = "plane"
    lenders: tuple[Drive, ...] = field(default=(), repr=False)
    rings: tuple[Drive, ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        """Check the options; files become a tuple of paths, which nobody changes."""
        if not isinstance(self.hole_near_field, bool):
            raise DriveError([f"hole_near_field = {shortened(self.hole_near_field)}: must be true or false"])
        _check_name("bodies", self.bodies, get_args(Bodies))
        given: Any = self.coefficients
        if isinstance(given, list):
            object.__setattr__(self, "coefficients", tuple(given))
        if other := [own.bodies for own in self._of_discs if own.bodies != self.bodies]:
            raise DriveError([f"coefficients: are of {other[0]} bodies; bodies = {self.bodies!r} asks for others"])
        if given is None or self._of_discs:
            return
        one = isinstance(given, str | Path)
        files: list[Any] = [given] if one else list(given) if isinstance(given, Iterable) else [None]
        if not all(isinstance(file, str | Path) for file in files):
            raise DriveError(
                [
                    f"coefficients = {shortened(given)}: must be influence coefficients, a file or several of 'cyclo derive'"
                ]
            )
        object.__setattr__(self, "coefficients", tuple(Path(file) for file in files))

    @property
    def options(self) -> dict[str, str]:
        """Compliance, whether hole walls yield, and what bodies are."""
        near = "yes" if self.hole_near_field else "no"
        return {
            "compliance": self.compliance,
            "method": "tables",
            "contacts": "tables",
            "hole_near_field": near,
            "bodies": self.bodies,
        }

    @property
    def _of_discs(self) -> tuple[InfluenceCoefficients, ...]:
        """Coefficients that are given or found already, of all discs alike or of each; empty where there are none."""
        given: Any = self.coefficients
        found = given if isinstance(given, tuple) else (given,)
        return found if all(isinstance(each, InfluenceCoefficients) for each in found) else ()

    def with_coefficients(self, drive: Drive) -> Self:
        """Return the engine with the coefficients of a drive in it, disc by disc: read from file or cache, or derived.

        Raises `DriveError` for what the engine cannot represent, before anything is derived.
        """
        require(drive, self.compliance)
        if self._of_discs:
            return self
        singles = single_discs(warm_drive(drive))
        return self.with_coefficients_of(self.bodies_of(singles)).lent_to(singles)

    def lending(self, drives: Iterable[Drive]) -> Self:
        """Return an engine on which drives of nearly the bodies of these are served by their coefficients.

        Of drives that have nearly the same body themselves the first one lends.
        """
        lenders: dict[str, Drive] = {}
        for drive in drives:
            for single in single_discs(warm_drive(drive)):
                if not any(nearly_same_body(body, single, self.bodies) for body in lenders.values()):
                    lenders[single.shape_fingerprint(self.bodies)] = single
        return replace(self, lenders=tuple(lenders.values()))

    def lending_rings(self, drives: Iterable[Drive]) -> Self:
        """Return an engine on which drives of nearly the rings of finite elements of these are served by them."""
        return replace(self, rings=_lent_rings(drives))

    def bodies_of(self, singles: Sequence[Drive]) -> list[Drive]:
        """Return the drives whose coefficients serve warm drives of one disc: lenders that have nearly their bodies."""
        exact = {body.shape_fingerprint(self.bodies): body for body in self.lenders}
        return [
            exact.get(each.shape_fingerprint(self.bodies))
            or next((body for body in self.lenders if nearly_same_body(body, each, self.bodies)), each)
            for each in singles
        ]

    def with_coefficients_of(self, bodies: Sequence[Drive]) -> Self:
        """Return the engine with the coefficients of each of some drives of one disc."""
        files: Any = self.coefficients
        found = tuple(find_coefficients(each, files, engine=self.compliance, bodies=self.bodies) for each in bodies)
        return replace(self, coefficients=found[0] if len(found) == 1 else found)

    def lent_to(self, singles: Sequence[Drive]) -> Self:
        """Return the engine with its coefficients serving drives of one disc that have nearly their bodies.

        Raises `DriveError` for what the engine cannot represent, of those that are served as of those that lend.
        """
        for each in singles:
            require(each, self.compliance)
        found = tuple(own.lent_to(each) for own, each in zip(self._of_discs, singles, strict=True))
        return replace(self, coefficients=found[0] if len(found) == 1 else found)

    def model(self, drive: Drive, *, in_batch: bool = False) -> Reducer:
        """Return the coupled compliance of a drive; coefficients of several drives do not mix in a batch.

        Raises
        ------
        DriveError
            When the coefficients are those of another number of discs.
        """
        drive = warm_drive(drive)
        return self._model(drive, single_discs(drive))

    def _model(self, drive: Drive, singles: Sequence[Drive]) -> Reducer:
        found = self.with_coefficients(drive)._of_discs
        if len(found) not in (1, len(singles)):
            raise DriveError(
                [f"coefficients: are those of {len(found)} discs, must be those of {len(singles)} (or of one, for all)"]
            )
        near_field = NEAR_FIELDS[self.compliance]
        each = found if len(found) == len(singles) else found * len(singles)
        discs = [
            CoupledCompliance.of_drive(single, own, near_field, hole_near_field=self.hole_near_field)
            for single, own in zip(singles, each, strict=True)
        ]
        return Reducer.of_drive(drive, discs, ring_lender(drive, self.rings))

    def prepare(self, drive: Drive) -> PreparedEngine:
        """Return the engine built for a drive; finds or derives its coefficients."""
        drive = warm_drive(drive)
        require(drive, self.compliance)
        singles = single_discs(drive)
        tables = _on_tables(drive, singles, self.rings)
        return _FromTables(drive=drive, tables=tables, model=self._model(drive, singles))


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaneStrain(CoupledEngine):
    """Contacts in plane strain on bodies by finite elements: every contact of a body feels the others (``fe``).

    Examples
    --------
    >>> import ltca
    >>> drive = ltca.load_drive("robot-joint").cases["nominal"]  # its coefficients come with the package
    >>> ltca.analyse(drive, 1, compliance=ltca.PlaneStrain()).engine.compliance
    'fe'
    """

    compliance: ClassVar[Compliance] = "fe"


@dataclass(frozen=True, slots=True, kw_only=True)
class Hybrid(CoupledEngine):
    """Half-spaces of finite length at the contacts, finite elements for what the bodies have beyond (``hybrid``).

    Examples
    --------
    >>> import ltca
    >>> drive = ltca.load_drive("robot-joint").cases["nominal"]  # its coefficients come with the package
    >>> soft, stiff = (ltca.analyse(drive, 1, compliance=engine) for engine in (ltca.Hybrid(), ltca.HalfSpace()))
    >>> angles = [abs(float(found.dataset["wheel_angle"].squeeze())) for found in (soft, stiff)]
    >>> angles[0] > angles[1]  # the bodies yield as well
    True
    """

    compliance: ClassVar[Compliance] = "hybrid"


def nearly_same_body(first: Drive, second: Drive, bodies: Bodies = "plane") -> bool:
    """Tell whether no number that determines the bodies of drives of one disc (`Drive.body_shape`) differs by more than
    `SHARED_BODY` of itself, angles in rad by that; counts are equal.
    """
    one, other = first.body_shape(bodies), second.body_shape(bodies)
    if one.keys() != other.keys():
        return False
    for name, value in one.items():
        if "number_of" in name or name == "crank.number":
            bound = 0.0
        else:
            bound = SHARED_BODY * (1.0 if name in ("flank_turn", "crank.angle") else abs(value))
        if abs(other[name] - value) > bound:
            return False
    return True


def ring_lender(drive: Drive, rings: Iterable[Drive]) -> Drive | None:
    """Return the first of some drives whose ring of finite elements serves that of a warm drive; None for its own."""
    if not has_ring_of_elements(drive):
        return None
    own = ring_fingerprint(drive)
    near = [one for one in rings if nearly_same_ring(one, drive, SHARED_BODY)]
    return None if any(ring_fingerprint(one) == own for one in near) else next(iter(near), None)


def _lent_rings(drives: Iterable[Drive]) -> tuple[Drive, ...]:
    """Drives of distinct rings of finite elements: of such that are nearly the same the first."""
    found: list[Drive] = []
    for drive in map(warm_drive, drives):
        if has_ring_of_elements(drive) and not any(nearly_same_ring(one, drive, SHARED_BODY) for one in found):
            found.append(drive)
    return tuple(found)


def lending_between(cases: Iterable[Drive], engine: Engine) -> Engine:
    """Return the engine on which cases of one file whose bodies hardly differ share the coefficients of the first of them.

    Files of coefficients that are given serve each its own case.
    """
    several = list(cases)
    if len(several) < 2 or not isinstance(engine, CoupledEngine) or engine.lenders or engine.coefficients is not None:
        return engine
    return engine.lending(several)


def lent_words(engine: Engine, drive: Drive) -> str:
    """Return whose coefficients serve a drive in the place of its own; empty where they are its own."""
    if not isinstance(engine, CoupledEngine) or not engine.lenders:
        return ""
    singles = single_discs(warm_drive(drive))
    bodies = zip(engine.bodies_of(singles), singles, strict=True)
    kind = engine.bodies
    lent = [body.case for body, own in bodies if body.shape_fingerprint(kind) != own.shape_fingerprint(kind)]
    if not lent:
        return ""
    return (
        f"influence coefficients are those of case {', '.join(dict.fromkeys(lent))} where no number of a body is off by "
        f"more than {SHARED_BODY:.1%} (single loads within some 0.4 %, stresses 0.7 %)"
    )


def describe_engine(engine: Engine) -> str:
    """Return what an engine is, for the heading of a table.

    Examples
    --------
    >>> describe_engine(HalfSpace()), describe_engine(Hybrid(hole_near_field=False, bodies="solid"))
    ('half-space (tables)', 'hybrid (no hole near field, solid bodies)')
    """
    options = engine.options
    told = [options["method"]] if options["compliance"] == "half-space" else []
    told += [options["contacts"]] if options["contacts"] not in ("tables", *told) else []
    told += ["no hole near field"] if options.get("hole_near_field") == "no" else []
    told += ["solid bodies"] if engine.bodies == "solid" else []
    return options["compliance"] + (f" ({', '.join(told)})" if told else "")


def engine_named(
    compliance: str | Engine = "half-space",
    *,
    method: str | None = None,
    contacts: str | None = None,
    coefficients: Given = None,
    hole_near_field: bool | None = None,
    bodies: str | None = None,
) -> Engine:
    """Return the engine that names and options ask for; what an engine cannot use is refused.

    Parameters
    ----------
    compliance : {"half-space", "fe", "hybrid"} or Engine
        How the bodies yield; an engine brings its own options, so none may stand beside it.
    method, contacts : str, optional
        Of `HalfSpace`.
    coefficients, hole_near_field, bodies : optional
        Of `PlaneStrain` and `Hybrid`.

    Raises
    ------
    DriveError
        When a name is unknown or an option does not belong to the compliance.
    """
    given: dict[str, Any] = {
        name: value
        for name, value in (
            ("method", method),
            ("contacts", contacts),
            ("coefficients", coefficients),
            ("hole_near_field", hole_near_field),
            ("bodies", bodies),
        )
        if value is not None
    }
    if not isinstance(compliance, str):
        if not hasattr(compliance, "prepare") or isinstance(compliance, type):
            raise DriveError([f"compliance = {compliance!r}: must be an engine or one of {_listed(Compliance)}"])
        if given:
            raise DriveError([f"{name}: is an option of the engine given as compliance" for name in given])
        return compliance
    _check_name("compliance", compliance, get_args(Compliance))
    refuse_idle_options(
        compliance,
        method=method,
        contacts=contacts,
        coefficients=coefficients,
        hole_near_field=hole_near_field,
        bodies=bodies,
    )
    if compliance == "half-space":
        return HalfSpace(method=given.get("method", "tables"), contacts=given.get("contacts"))
    if given.get("method") == "tables":
        del given["method"]
    return PlaneStrain(**given) if compliance == "fe" else Hybrid(**given)


def engine_of(
    drives: Iterable[Drive],
    compliance: str | Engine | None = None,
    *,
    method: str | None = None,
    contacts: str | None = None,
    coefficients: Given = None,
    hole_near_field: bool | None = None,
    bodies: str | None = None,
) -> Engine:
    """Return the engine for drives: the one named, or that of their files (`ltca.drive.parts.Analysis`).

    Parameters are those of `engine_named`, where None leaves the choice to method and contacts, which only half-spaces have,
    and else to the drives.

    Raises
    ------
    DriveError
        As `engine_named`; and when the drives are to be analysed differently.
    """
    drives = tuple(drives)
    if compliance is None:
        compliance = compliance_for(drives, method=method, contacts=contacts)
    if bodies is None and isinstance(compliance, str):
        bodies = bodies_for(drives, compliance)
    return engine_named(
        compliance,
        method=method,
        contacts=contacts,
        coefficients=coefficients,
        hole_near_field=hole_near_field,
        bodies=bodies,
    )


def _listed(names: Any) -> str:
    return ", ".join(repr(name) for name in get_args(names))


def _check_name(option: str, name: Any, known: tuple[str, ...]) -> None:
    if name not in known:
        meant = did_you_mean(name, known) if isinstance(name, str) else ""
        raise DriveError(
            [f"{option} = {shortened(name)}: is unknown; must be one of {', '.join(map(repr, known))}{meant}"]
        )
