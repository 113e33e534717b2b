"""Bodies of a part, their frame, and compensation for a printer.

A disc is written in its own frame: centre of its bore (of several, of the disc) at the origin, hole 0 on +x, its lower face at
z = 0. The root θ = 0 of its flank would lie on +x, too; the phase ζ of the disc turns the flank by −Δz ζ/z_C against bores and
holes, as it is made. Pins of the wheel stand about the wheel's axis and those of the shaft about the shaft's, number 0 on +x.
The assembly is that of φ_C = 0 in the frame of the pin shaft: each disc on its eccentrics, z as in ``disc.planes``. Flanges of a
carrier are plain discs with the holes of shaft pins and cranks, tied by posts. What a drive does not say has no body: housing,
crankshafts, cages.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.members.width import needs_slices
from ltca.drive.parts import Disc, Drive, Inclination, PlacementErrors, Ring
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError
from ltca.export.flank_outline import FlankSpline, MadeFlank, follow_flank
from ltca.geometry.flank import FlankProfile
from ltca.geometry.length_profile import lead_relief
from ltca.geometry.placement import Placement
from ltca.output.file_names import file_word, shortened_file_name

PARTS = ("disc", "pin-wheel", "pin-shaft", "carrier", "assembly")
"""What can be exported."""
OWN_FRAME = {
    "disc": "origin at the centre of the bore, hole 0 on +x, lower face at z = 0",
    "cranked disc": "origin at the centre of the disc, about which the bores stand; lower face at z = 0",
    "pin-wheel": "origin on the axis of the wheel, pin 0 on +x, lower ends at z = 0",
    "pin-shaft": "origin on the axis of the pin shaft, pin 0 on +x, lower ends at z = 0",
    "carrier": "origin on the axis of the pin shaft, lower face at z = 0; the drive gives neither the radius of the flanges "
    "nor the place of post 0, which stands half-way between two pins or cranks",
    "assembly": "frame of the pin shaft at crank angle 0, z of disc.planes",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Circle:
    """A circle of a part.

    Attributes
    ----------
    feature : str
        What it is: ``bore``, ``hole``, ``pin``, ``slot``, …; drawings have a layer for each.
    name : str
        With its number, ``hole 3``.
    radius : float
        mm.
    centre : complex
        mm.
    """

    feature: str
    name: str
    radius: float
    centre: complex = 0j


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """A body between two heights: a plane outline with holes, straight or with a lead along its width.

    Attributes
    ----------
    name : str
        Of the product.
    outer : FlankSpline or Circle
        Outline.
    inner : tuple of Circle
        Holes.
    of : str
        Disc of an assembly that it belongs to, ``disc 1``; empty for others.
    bottom, top : float
        z of its faces, mm.
    lead : Disc or None
        Disc whose lead the flank has; the outline is that of the middle then.
    """

    name: str
    outer: FlankSpline | Circle
    inner: tuple[Circle, ...] = ()
    of: str = ""
    bottom: float
    top: float
    lead: Disc | None = None

    @property
    def section(self) -> float:
        """Area of the exact section, that of the middle, mm²."""
        outside = self.outer.flank.area() if isinstance(self.outer, FlankSpline) else np.pi * self.outer.radius**2
        return float(outside - np.pi * sum(circle.radius**2 for circle in self.inner))

    @property
    def volume(self) -> float:
        """Exact volume, mm³."""
        volume = self.section * (self.top - self.bottom)
        if self.lead is None or not isinstance(self.outer, FlankSpline):
            return volume
        cuts, (places, weights) = self.heights(np.inf), np.polynomial.legendre.leggauss(4)
        for low, high in pairwise(cuts.tolist()):
            half = 0.5 * (high - low)
            for place, weight in zip((low + half * (1.0 + places)).tolist(), (half * weights).tolist(), strict=True):
                volume += weight * (self.flank(place).area() - self.outer.flank.area())
        return volume

    def heights(self, departure: float) -> FloatArray:
        """Return heights from the lower to the upper face, mm, between which straight lines depart from the lead by less than
        `departure`, mm; where it begins to relieve the ends is one of them.
        """
        if self.lead is None:
            return np.array([self.bottom, self.top])
        half, relief = 0.5 * self.lead.thickness, self.lead.lead_relief_length
        ends = [-half, *((relief - half, half - relief) if 0.0 < relief < half else ()), 0.0, half]
        # Crown and relief are a z² each: a straight line over a length s departs by a s²/4.
        bend = self.lead.lead_crown_drop / half**2 + (self.lead.lead_relief_depth / relief**2 if relief else 0.0)
        finest = 2.0 * np.sqrt(departure / bend) if bend else np.inf
        parts = [
            np.linspace(low, high, max(int(np.ceil((high - low) / finest)), 1), endpoint=False)
            for low, high in pairwise(sorted(ends))
        ]
        return np.append(np.concatenate(parts), half) + 0.5 * (self.bottom + self.top)

    def flank(self, height: float) -> MadeFlank:
        """Return the flank at a height, mm, of a body that has one."""
        assert isinstance(self.outer, FlankSpline)
        if self.lead is None:
            return self.outer.flank
        short = float(lead_relief(self.lead, np.array(height - 0.5 * (self.bottom + self.top))))
        return replace(self.outer.flank, inward=self.outer.flank.inward + short)

    def outline(self, height: float) -> FlankSpline | Circle:
        """Return the outline at a height, mm, with as many pieces as that of the middle."""
        if self.lead is None or not isinstance(self.outer, FlankSpline):
            return self.outer
        return self.outer.along(self.flank(height))


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """A round wall of a member of which the drive says nothing more: a slot of the housing.

    Attributes
    ----------
    circle : Circle
        Its section.
    bottom, top : float
        z of its ends, mm.
    """

    circle: Circle
    bottom: float
    top: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """Content of one file.

    Attributes
    ----------
    name : str
        ``disc``, ``disc_1``, ``pin-wheel``, ``pin-shaft``, ``carrier``, ``assembly``.
    drive, case : str
        Whose.
    frame : str
        Where its origin is.
    compensation : float
        By how much every face is moved into the material, mm.
    bodies : tuple of Body
        Solids.
    walls : tuple of Wall
        What is no solid.
    profiled : tuple of str
        Fields of profiles along the length, and of inclinations, that its straight bodies do not have.
    """

    name: str
    drive: str
    case: str
    frame: str
    compensation: float = 0.0
    bodies: tuple[Body, ...]
    walls: tuple[Wall, ...] = ()
    profiled: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """Drive, case, part and compensation in one line."""
        moved = f", compensated {self.compensation:g} mm" if self.compensation else ""
        return f"{self.drive} {self.case} {self.name.replace('_', ' ')}{moved}"

    @property
    def stem(self) -> str:
        """Of the names of its files."""
        moved = f"_compensated_{self.compensation:g}mm" if self.compensation else ""
        # Names of drives and cases have up to 120 bytes each, those of files 255.
        return file_word(f"{shortened_file_name(f'{self.drive}_{self.case}', 160)}_{self.name}{moved}")

    @property
    def remarks(self) -> tuple[str, ...]:
        """What a reader of the file should know, line by line."""
        inclined = ", ".join(field for field in self.profiled if needs_slices(field))
        section = f"; what is inclined ({inclined}) stands where it is at the zero of disc.planes" if inclined else ""
        lines = (f"cyclo {self.title}", "lengths in mm, at 20 °C", f"frame: {self.frame}{section}")
        if not self.compensation:
            return lines
        into = self.compensation > 0.0
        whither, told = ("into", "shrink, bores and holes grow") if into else ("out of", "grow, bores and holes shrink")
        moved = f"every face is moved {whither} the material by {abs(self.compensation):g} mm"
        return (*lines, f"compensation {self.compensation:g} mm: {moved} (outlines {told} in radius)")

    @property
    def leads(self) -> tuple[str, ...]:
        """What a reader of the file should know of flanks that are not straight along their width, disc by disc."""
        return tuple(f"flank of {body.name}: {_lead_words(body.lead)}" for body in self.bodies if body.lead is not None)


def _lead_words(disc: Disc) -> str:
    words = [f"crown {disc.lead_crown_drop:g} mm"] if disc.lead_crown_drop else []
    if disc.lead_relief_depth:
        words.append(f"end relief {disc.lead_relief_depth:g} mm over {disc.lead_relief_length:g} mm")
    words += [f"slope {disc.lead_slope:g} rad"] if disc.lead_slope else []
    return f"{', '.join(words)}; the outline of a drawing or table is that of the middle"


def make_parts(
    drive: Drive, case: str, part: str = "disc", *, disc: int | None = None, compensation: float = 0.0
) -> tuple[Part, ...]:
    """Return what the files of a part hold: one for each disc, one for any other part.

    Parameters
    ----------
    drive : Drive
        In one case; its lengths are those at 20 °C, temperatures change nothing.
    case : str
        Its name.
    part : str
        One of `PARTS`.
    disc : int, optional
        Of the discs this one alone.
    compensation : float
        By how much every face is moved into the material, mm; negative ones out of it.

    Raises
    ------
    DriveError
        When the drive has no such part, or nothing would be left of it.

    Examples
    --------
    >>> import ltca
    >>> drive = ltca.load_drive("robot-joint").cases["nominal"]
    >>> [len(part.bodies) for part in make_parts(drive, "nominal")], len(make_parts(drive, "nominal", "pin-wheel")[0].bodies)
    ([1, 1], 40)
    """
    drive = replace(drive, temperature=None)
    if disc is not None:
        _require_disc(drive, part, disc)
    makers = {
        "disc": _discs,
        "pin-wheel": _pin_wheel,
        "pin-shaft": _pin_shaft,
        "carrier": _carrier,
        "assembly": _assembly,
    }
    if part == "assembly" and compensation:
        raise DriveError(["--compensate: is for parts that are made one by one, not for --part assembly"])
    if part == "disc":
        numbers = range(drive.disc.number_of_discs) if disc is None else [disc]
        return tuple(_discs(drive, case, number, compensation) for number in numbers)
    return (makers[part](drive, case, 0, compensation),)


def _require_disc(drive: Drive, part: str, disc: int) -> None:
    if part != "disc":
        raise DriveError([f"--disc {disc}: is for --part disc, not for {part}"])
    count = drive.disc.number_of_discs
    if disc >= count:
        raise DriveError([f"--disc {disc}: there is no such disc; disc.number_of_discs = {count}, counted from 0"])


def _discs(drive: Drive, case: str, number: int, compensation: float) -> Part:
    several = drive.disc.number_of_discs > 1
    body = _disc_body(single_discs(drive)[number], "disc", compensation)
    frame = OWN_FRAME["disc" if drive.crank.number == 1 else "cranked disc"]
    phase = drive.disc.disc_phases[number]
    if phase:
        turn = -drive.tooth_number_difference * phase / drive.disc.number_of_teeth
        frame += f"; flank turned by {turn:.9g} rad against bores and holes (phase {phase:.9g} rad)"
    name = f"disc_{number}" if several else "disc"
    return Part(
        name=name,
        drive=drive.name,
        case=case,
        frame=frame,
        compensation=compensation,
        bodies=(replace(body, name=name.replace("_", " ")),),
        profiled=_profiled(drive, "disc"),
    )


def _disc_body(single: Drive, name: str, compensation: float) -> Body:
    """The disc of a drive of one disc, its lower face at z = 0."""
    placement = Placement.of_drive(single)
    flank = MadeFlank(profile=FlankProfile.of_drive(single), inward=compensation)
    _require_flank(flank, f"--compensate {compensation:g} mm")
    bores = placement.bore_centres.tolist()
    inner = [
        Circle(feature="bore", name=_numbered("bore", c, len(bores)), radius=single.bore_radius, centre=centre)
        for c, centre in enumerate(bores)
    ]
    holes = zip(placement.hole_centres.tolist(), placement.hole_radii.tolist(), strict=True)
    inner += [
        Circle(feature="hole", name=f"hole {k}", radius=radius, centre=centre)
        for k, (centre, radius) in enumerate(holes)
    ]
    grown = tuple(_grown(circle, compensation) for circle in inner)
    spline = follow_flank(flank)
    body = Body(
        name=name,
        outer=spline,
        inner=grown,
        bottom=0.0,
        top=single.disc.thickness,
        lead=single.disc if _has_lead(single.disc) else None,
    )
    for height in body.heights(np.inf).tolist():
        outline = body.outline(height)
        assert isinstance(outline, FlankSpline)
        _require_flank(outline.flank, f"{_lead_fields(single.disc)} (falls short by {outline.flank.inward:g} mm)")
        _require_walls(outline, grown, compensation)
    return body


def _has_lead(disc: Disc) -> bool:
    return bool(disc.lead_crown_drop or disc.lead_relief_depth or disc.lead_slope)


def _lead_fields(disc: Disc) -> str:
    given = {"lead_crown_drop": "mm", "lead_relief_depth": "mm", "lead_slope": "rad"}
    return ", ".join(
        f"disc.{name} = {getattr(disc, name):g} {unit}" for name, unit in given.items() if getattr(disc, name)
    )


def _numbered(name: str, number: int, count: int) -> str:
    return name if count == 1 else f"{name} {number}"


def _grown(circle: Circle, by: float) -> Circle:
    """A circle with another radius; what is left of it must be a circle."""
    if circle.radius + by <= 0.0:
        raise DriveError(
            [f"--compensate {abs(by):g} mm: must be less than {circle.radius:g} mm, the radius of {circle.name}"]
        )
    return replace(circle, radius=circle.radius + by) if by else circle


def _require_flank(flank: MadeFlank, given: str) -> None:
    """A flank that is moved by more than its sharpest radius would fold; `given` names what moves it."""
    if not flank.inward:
        return
    # By four times the points of a spline; by half of what would fold it the flank is no use to anybody.
    curvature = flank.profile.curvature(np.linspace(0.0, 2.0 * np.pi, 4 * flank.start().size, endpoint=False))
    sharpest = float(np.max(curvature if flank.inward > 0.0 else -curvature))
    if abs(flank.inward) * sharpest >= 0.5:
        told = "convex" if flank.inward > 0.0 else "concave"
        raise DriveError(
            [
                f"{given}: must be less than {0.5 / sharpest:.4g} mm in size, half of the smallest {told} radius of the flank"
            ]
        )


def _require_walls(spline: FlankSpline, circles: Sequence[Circle], compensation: float) -> None:
    """Bores and holes that cut into each other or through the flank leave no part."""
    walls = [
        (float(np.min(np.abs(spline.points - circle.centre))) - circle.radius, f"{circle.name} and the flank")
        for circle in circles
    ]
    walls += [
        (abs(one.centre - other.centre) - one.radius - other.radius, f"{other.name} and {one.name}")
        for place, one in enumerate(circles)
        for other in circles[:place]
    ]
    narrowest, between = min(walls)
    if narrowest <= 0.0:
        why = f"--compensate {compensation:g} mm" if compensation else "--part disc"
        raise DriveError([f"{why}: {between} cut into each other by {-narrowest:.4g} mm, no disc is left"])


def _in_the_middle(drive: Drive) -> Placement:
    """Where pins stand at z = 0, the zero of the discs' planes, about which they are inclined."""
    first = single_discs(drive)[0]
    return Placement.of_drive(replace(first, disc=replace(first.disc, planes=(0.0,))))


def _stack(drive: Drive) -> tuple[float, float]:
    """From the lowest to the highest face of the discs, on the axis of their planes, mm."""
    half = 0.5 * drive.disc.thickness
    return min(drive.disc.disc_planes) - half, max(drive.disc.disc_planes) + half


def _pins_of_wheel(drive: Drive, place: Placement) -> tuple[list[Body], list[Wall]]:
    """Pins, sleeves and slots, on the axis of the discs' planes."""
    wheel, stack = drive.pin_wheel, _stack(drive)
    seat = wheel.seat
    low, high = stack if wheel.beam is None else (-0.5 * drive.wheel_pin_span, 0.5 * drive.wheel_pin_span)
    bodies, walls = [], []
    for number, (centre, radius) in enumerate(
        zip(place.wheel_pin_centres.tolist(), place.wheel_pin_radii.tolist(), strict=True)
    ):
        held = seat.pin_radius if seat.kind == "sleeve" else radius
        pin = Circle(feature="pin", name=f"pin {number}", radius=held or radius, centre=centre)
        bodies.append(Body(name=pin.name, outer=pin, bottom=low, top=high))
        if seat.kind == "sleeve":
            bodies.append(_sleeve("sleeve", number, radius, seat.bore_radius or 0.0, centre, stack))
        if seat.kind == "slot":
            slot = Circle(feature="slot", name=f"slot {number}", radius=seat.radius or 0.0, centre=centre)
            walls.append(Wall(circle=slot, bottom=low, top=high))
    if drive.ring is not None:
        bodies.append(_ring(drive.ring))
    return bodies, walls


def _ring(ring: Ring) -> Body:
    """The elastic ring about the middle of the discs' planes; the seats of the pins are not cut into it."""
    outer, inner = (
        Circle(feature=feature, name=name, radius=radius, centre=0j)
        for feature, name, radius in (
            ("ring", "ring of the wheel", ring.outer_radius),
            ("ring-bore", "bore of ring of the wheel", ring.inner_radius),
        )
    )
    return Body(name=outer.name, outer=outer, inner=(inner,), bottom=-0.5 * ring.width, top=0.5 * ring.width)


def _pins_of_shaft(drive: Drive, place: Placement) -> list[Body]:
    """Pins and sleeves of the pin shaft, on the axis of the discs' planes."""
    shaft, stack = drive.pin_shaft, _stack(drive)
    if shaft is None:
        return []
    low, high = stack if shaft.beam is None else (-0.5 * drive.shaft_pin_span, 0.5 * drive.shaft_pin_span)
    bodies = []
    for number, (centre, radius) in enumerate(
        zip(place.shaft_pin_centres.tolist(), place.shaft_pin_radii.tolist(), strict=True)
    ):
        sleeved = shaft.seat.kind == "sleeve"
        held = shaft.seat.pin_radius if sleeved else radius
        pin = Circle(feature="shaft-pin", name=f"shaft pin {number}", radius=held or radius, centre=centre)
        bodies.append(Body(name=pin.name, outer=pin, bottom=low, top=high))
        if sleeved:
            bore = shaft.seat.bore_radius or 0.0
            bodies.append(_sleeve("shaft-sleeve", number, radius, bore, centre, stack))
    return bodies


def _sleeve(feature: str, number: int, radius: float, bore: float, centre: complex, stack: tuple[float, float]) -> Body:
    name = f"{feature.replace('-', ' ')} {number}"
    return Body(
        name=name,
        outer=Circle(feature=feature, name=name, radius=radius, centre=centre),
        inner=(Circle(feature=f"{feature}-bore", name=f"bore of {name}", radius=bore, centre=centre),),
        bottom=stack[0],
        top=stack[1],
    )


def _compensated(body: Body, by: float, lift: float) -> Body:
    """A round body for a printer, moved along z."""
    assert isinstance(body.outer, Circle)
    outer, inner = _grown(body.outer, -by), tuple(_grown(circle, by) for circle in body.inner)
    if inner and inner[0].radius >= outer.radius:
        raise DriveError(
            [f"--compensate {by:g} mm: nothing is left of {body.name}, its wall is thinner than twice that"]
        )
    return replace(body, outer=outer, inner=inner, bottom=body.bottom + lift, top=body.top + lift)


def _pin_wheel(drive: Drive, case: str, _: int, compensation: float) -> Part:
    bodies, walls = _pins_of_wheel(drive, _in_the_middle(drive))
    lift = -min(body.bottom for body in bodies)
    return Part(
        name="pin-wheel",
        drive=drive.name,
        case=case,
        frame=OWN_FRAME["pin-wheel"],
        compensation=compensation,
        bodies=tuple(_compensated(body, compensation, lift) for body in bodies),
        walls=tuple(
            Wall(circle=_grown(wall.circle, compensation), bottom=wall.bottom + lift, top=wall.top + lift)
            for wall in walls
        ),
        profiled=_profiled(drive, "pin_wheel"),
    )


def _pin_shaft(drive: Drive, case: str, _: int, compensation: float) -> Part:
    bodies = _pins_of_shaft(drive, _in_the_middle(drive))
    return _of_bodies(drive, case, "pin-shaft", "pin_shaft", bodies, compensation)


def _carrier(drive: Drive, case: str, _: int, compensation: float) -> Part:
    bodies = _carrier_bodies(drive, _in_the_middle(drive))
    return _of_bodies(drive, case, "carrier", "carrier.posts", bodies, compensation)


def _of_bodies(drive: Drive, case: str, name: str, table: str, bodies: Sequence[Body], compensation: float) -> Part:
    """A part of round bodies on the carrier's side, its lowest face at z = 0; DriveError where the drive has no such table."""
    if not bodies:
        raise DriveError([f"--part {name}: there is no {table} in this drive"])
    lift = -min(body.bottom for body in bodies)
    return Part(
        name=name,
        drive=drive.name,
        case=case,
        frame=OWN_FRAME[name],
        compensation=compensation,
        bodies=tuple(_compensated(body, compensation, lift) for body in bodies),
        profiled=_profiled(drive, "pin_shaft"),
    )


MARGIN = 0.25
"""What the flanges reach beyond all that stands in them, in diameters of a post."""


def _carrier_bodies(drive: Drive, place: Placement) -> list[Body]:
    """Posts, and flanges where their thickness is given, on the axis of the discs' planes."""
    carrier, posts, shaft = drive.carrier, drive.posts, drive.pin_shaft
    if carrier is None or posts is None:
        return []
    half, cranks = 0.5 * drive.post_length, drive.crank.number
    beside = drive.crank.angle + np.pi / cranks if shaft is None else np.pi / shaft.number_of_pins
    around = np.exp(1j * (beside + 2.0 * np.pi * np.arange(posts.number) / posts.number))
    bodies = []
    for number, centre in enumerate((posts.radius * around).tolist()):
        post = Circle(feature="post", name=f"post {number}", radius=0.5 * posts.size, centre=centre)
        bodies.append(Body(name=post.name, outer=post, bottom=-half, top=half))
    if carrier.flange is None:
        return bodies
    support = drive.crank.support
    shaft_radius = drive.crank_bearing.inner_race_radius if support is None else 0.5 * support.diameter
    holes = [
        Circle(feature="flange-hole", name=_numbered("hole of crank", c, cranks), radius=shaft_radius, centre=centre)
        for c, centre in enumerate(place.crank_axes.tolist())
    ]
    if shaft is not None:
        sizes = (
            place.shaft_pin_radii
            if shaft.seat.pin_radius is None
            else np.full(place.shaft_pin_radii.size, shaft.seat.pin_radius)
        )
        holes += [
            Circle(feature="flange-hole", name=f"hole of shaft pin {k}", radius=radius, centre=centre)
            for k, (centre, radius) in enumerate(zip(place.shaft_pin_centres.tolist(), sizes.tolist(), strict=True))
        ]
    reach = max(posts.radius + 0.5 * posts.size, *(abs(hole.centre) + hole.radius for hole in holes))
    outline = Circle(feature="flange", name="flange", radius=reach + MARGIN * posts.size)
    for name, bottom, thickness in (
        ("near flange", -half - carrier.flange[0], carrier.flange[0]),
        ("far flange", half, carrier.flange[1]),
    ):
        inner = tuple(replace(hole, name=f"{hole.name}, {name}") for hole in holes)
        bodies.append(
            Body(name=name, outer=replace(outline, name=name), inner=inner, bottom=bottom, top=bottom + thickness)
        )
    return bodies


def _profiled(drive: Drive, *parts: str) -> tuple[str, ...]:
    """Fields of profiles along the length and of inclinations, which no straight body has, of some members."""
    bearing, wheel, shaft = drive.crank_bearing, drive.pin_wheel, drive.pin_shaft
    found: dict[str, list[tuple[str, bool]]] = {
        "pin_wheel": [
            ("pin_wheel.pin_profile", not wheel.pin_profile.is_cylinder),
            ("pin_wheel.inclination", wheel.inclination != Inclination()),
            *_leaning("pin_wheel.pin_errors", wheel.pin_errors),
        ],
        "disc": [
            one for single in single_discs(drive) for one in _leaning("disc.hole_errors", single.disc.hole_errors)
        ],
        "pin_shaft": []
        if shaft is None
        else [
            ("pin_shaft.inclination", shaft.inclination != Inclination()),
            *_leaning("pin_shaft.pin_errors", shaft.pin_errors),
        ],
        "crank_bearing": [
            ("crank_bearing.roller_profile", not bearing.roller_profile.is_cylinder),
            ("crank.inclination", drive.crank.inclination != Inclination()),
        ],
    }
    return tuple(dict.fromkeys(path for part in parts for path, given in found[part] if given))


def _leaning(path: str, errors: PlacementErrors) -> list[tuple[str, bool]]:
    return [(f"{path}.{name}", any(getattr(errors, name))) for name in ("inclination_x", "inclination_y")]


def _assembly(drive: Drive, case: str, _: int, __: float) -> Part:
    singles = single_discs(drive)
    places = [Placement.of_drive(single) for single in singles]
    middle = _in_the_middle(drive)
    wheel, walls = _pins_of_wheel(drive, middle)
    axis = complex(middle.wheel_axis)
    bodies = [_moved(body, axis) for body in wheel] + _pins_of_shaft(drive, middle)
    bodies += _carrier_bodies(drive, middle)
    for number, (single, place) in enumerate(zip(singles, places, strict=True)):
        bodies += _disc_and_bearings(single, place, _numbered("disc", number, len(singles)))
    return Part(
        name="assembly",
        drive=drive.name,
        case=case,
        frame=OWN_FRAME["assembly"],
        bodies=tuple(bodies),
        walls=tuple(replace(wall, circle=_shifted(wall.circle, axis)) for wall in walls),
        profiled=_profiled(drive, "pin_wheel", "disc", "pin_shaft", "crank_bearing"),
    )


def _disc_and_bearings(single: Drive, place: Placement, name: str) -> Iterator[Body]:
    """A disc on its eccentrics at φ_C = 0, the rollers on their inner races."""
    plane, bearing = single.disc.disc_planes[0], single.crank_bearing
    start = np.zeros(1)
    disc = _moved(_disc_body(single, name, 0.0), complex(place.races(start).middle[0]))
    yield replace(disc, of=name, bottom=plane - 0.5 * disc.top, top=plane + 0.5 * disc.top)
    low, high = plane - 0.5 * single.roller_length, plane + 0.5 * single.roller_length
    races = place.races(start).centre[0]
    for crank, centre in enumerate(races.tolist()):
        of = _numbered(f"inner race of {name}", crank, len(races))
        race = Circle(feature="inner-race", name=of, radius=bearing.inner_race_radius, centre=centre)
        yield Body(name=of, outer=race, of=name, bottom=low, top=high)
    radii = place.roller_radii
    centres = races[place.roller_cranks] + (bearing.inner_race_radius + radii) * place.roller_rays(start)[0]
    for number, (centre, radius) in enumerate(zip(centres.tolist(), radii.tolist(), strict=True)):
        roller = Circle(feature="roller", name=f"roller {number} of {name}", radius=radius, centre=centre)
        yield Body(name=roller.name, outer=roller, of=name, bottom=low, top=high)


def _shifted(circle: Circle, by: complex) -> Circle:
    return replace(circle, centre=circle.centre + by)


def _moved(body: Body, by: complex) -> Body:
    outer = body.outer.placed(by) if isinstance(body.outer, FlankSpline) else _shifted(body.outer, by)
    return replace(body, outer=outer, inner=tuple(_shifted(circle, by) for circle in body.inner))
