"""The drive: validated, frozen definitions of its parts, clearances and load (mm, N, MPa, N·mm, rad)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from math import gcd, pi
from typing import Annotated, Any

from pydantic import Field
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import (
    STRICT,
    Angle,
    NonNegativeLength,
    OneDisc,
    PlacementErrors as PlacementErrors,
    PositiveLength,
    ProfileErrors as ProfileErrors,
    RollerErrors as RollerErrors,
    Runout as Runout,
    SignedLength,
)
from ltca.drive.fingerprints import fingerprint_of
from ltca.drive.materials import (
    LengthProfile as LengthProfile,
    Material as Material,
    Materials as Materials,
    contact_modulus as contact_modulus,
)
from ltca.drive.members.carrier import Carrier as Carrier, CarrierPosts as CarrierPosts
from ltca.drive.members.crank import Crank as Crank, CrankBearing as CrankBearing, CrankSupport as CrankSupport
from ltca.drive.members.first_stage import FirstStage as FirstStage
from ltca.drive.members.inertia import Damping as Damping, Inertia as Inertia
from ltca.drive.members.main_bearing import BearingRow as BearingRow, MainBearing as MainBearing
from ltca.drive.members.operation import (
    Analysis as Analysis,
    Bodies as Bodies,
    Compliance as Compliance,
    Duty as Duty,
    ExternalLoad as ExternalLoad,
    Friction as Friction,
    Installation as Installation,
    Load as Load,
    Lubricant as Lubricant,
    Temperature as Temperature,
)
from ltca.drive.members.pins import (
    PinShaft as PinShaft,
    PinWheel as PinWheel,
    ShaftPinBeam as ShaftPinBeam,
    ShaftPinSeat as ShaftPinSeat,
    WheelPinBeam as WheelPinBeam,
    WheelPinSeat as WheelPinSeat,
)
from ltca.drive.members.preload import Preload as Preload
from ltca.drive.members.ring import Ring as Ring, RingBolts as RingBolts
from ltca.drive.members.width import Contact as Contact, Inclination as Inclination
from ltca.drive.names import Name
from ltca.drive.units.quantities import COUNT, grows
from ltca.errors import DriveError, Problem

SAME_PART = 1e-9
"""Angle below which two flanks are equal, rad: round-off of a phase, which moves a flank by much less than a nanometre."""


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Disc:
    """Cycloid disc.

    Attributes
    ----------
    number_of_teeth : int
        Number of teeth (lobes) z_C of one disc.
    thickness : float
        Thickness of one disc, mm.
    number_of_discs : int
        Discs that share the torque.
    phases : tuple of float
        Phase ζ of each disc's eccentric against that of the crank angle, rad; 2πk/n when left out.
    planes : tuple of float
        Axial place of each disc's middle, mm; side by side about 0 when left out, ``disc.gap`` apart. They matter where pins
        or shafts bend.
    gap : float
        Axial gap between neighbouring discs, in place of ``disc.planes``, mm.
    equidistant_offset : float
        Δr_P: the flank is generated with pins of radius r_P + Δr_P, mm (Eq. 1).
    shifting_offset : float
        ΔR_C: the flank is generated on the pin circle R_C + ΔR_C, mm (Eq. 1).
    hole_errors : PlacementErrors
        Errors of the pin holes.
    profile_errors : ProfileErrors
        Deviation of the flank along its normal.
    runout : Runout
        Centre of the flank against the bore.
    lead_crown_drop : float
        Crown of the flank along its width: by how much its two ends fall short of the middle, parabolic, mm.
    lead_relief_length : float
        Length of the parabolic end relief of the flank at each end of its width, mm; needs ``disc.lead_relief_depth``.
    lead_relief_depth : float
        Depth of the end relief at the very ends, mm; needs ``disc.lead_relief_length``.
    lead_slope : float
        Slope of the flank along its width, rad; positive leaves metal at positive z.
    axial_play : float or None
        By how much the disc is free along the axis, for the check of its tilt; not checked when left out, mm.
    of : tuple of OneDisc
        Values per disc, one entry for every disc; left out where all discs are alike.
    """

    number_of_teeth: Annotated[int, Field(ge=3, le=1000), COUNT]
    thickness: Annotated[PositiveLength, grows("disc")]
    number_of_discs: Annotated[int, Field(ge=1, le=10), COUNT] = 1
    phases: tuple[Angle, ...] = ()
    planes: Annotated[tuple[SignedLength, ...], grows("planes")] = ()
    gap: Annotated[NonNegativeLength, grows("planes")] = 0.0
    equidistant_offset: Annotated[SignedLength, grows("disc", upon="pin_wheel.pin_radius")] = 0.0
    shifting_offset: Annotated[SignedLength, grows("disc", upon="pin_wheel.pin_circle_radius")] = 0.0
    hole_errors: Annotated[PlacementErrors, grows("disc")] = field(default_factory=PlacementErrors)
    profile_errors: Annotated[ProfileErrors, grows("disc")] = field(default_factory=ProfileErrors)
    runout: Annotated[Runout, grows("disc")] = field(default_factory=Runout)
    lead_crown_drop: Annotated[NonNegativeLength, grows("disc")] = 0.0
    lead_relief_length: Annotated[NonNegativeLength, grows("disc")] = 0.0
    lead_relief_depth: Annotated[NonNegativeLength, grows("disc")] = 0.0
    lead_slope: Angle = 0.0
    axial_play: Annotated[PositiveLength | None, grows("disc")] = None
    of: tuple[OneDisc, ...] = ()

    @property
    def disc_phases(self) -> tuple[float, ...]:
        """ζ of every disc, rad."""
        count = self.number_of_discs
        return self.phases or tuple(2.0 * pi * disc / count for disc in range(count))

    @property
    def phase(self) -> float:
        """ζ of the one disc, rad; DriveError for several discs, or values per disc."""
        if self.number_of_discs != 1 or not all(entry.of_bores_alone for entry in self.of):
            said = "must be 1 here, and disc.of left out"
            raise DriveError(
                [Problem.of("disc.number_of_discs", f"= {self.number_of_discs}", said, bound=("equal to", 1))]
            )
        return self.disc_phases[0]

    @property
    def disc_planes(self) -> tuple[float, ...]:
        """Axial place of every disc, mm."""
        count = self.number_of_discs
        pitch = self.thickness + self.gap
        return self.planes or tuple(pitch * (disc - 0.5 * (count - 1)) for disc in range(count))

    @property
    def stack_length(self) -> float:
        """Length about the zero of the planes that holds all discs, with a gap beside the outer ones, mm."""
        return 2.0 * max(abs(plane) for plane in self.disc_planes) + self.thickness + 2.0 * self.gap


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Clearance:
    """Clearances.

    Attributes
    ----------
    bearing : float
        Radial internal clearance of the crank bearing, diametral as usual: half of it widens the bore, mm.
    pin_hole : float
        Pin-hole clearance, added whole to r_PSH − r_PS, mm.
    """

    bearing: NonNegativeLength = 0.0
    pin_hole: NonNegativeLength = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Drive:
    """One drive in one case, complete.

    Attributes
    ----------
    name : str
        Name of the drive, which names folders and figures.
    crank : Crank
        Crankshaft, or several alike.
    pin_wheel : PinWheel
        Wheel with its pins.
    disc : Disc
        Cycloid discs.
    crank_bearing : CrankBearing
        Roller bearing between crank and disc.
    pin_shaft : PinShaft or None
        Pin shaft, the carrier of the cranks, with its pins; drives with several cranks need none.
    ring : Ring or None
        Elastic ring that holds the wheel pins; rigid when left out.
    carrier : Carrier or None
        How the carrier of shaft pins and cranks gives way; rigid in one piece when left out.
    first_stage : FirstStage or None
        Teeth between a central input and several cranks; ``installation.first_stage_ratio`` alone gives its ratio.
    main_bearing : MainBearing or None
        Bearing of the wheel on the pin shaft; rigid when left out.
    load : Load
        Torque and direction.
    installation : Installation
        Which member is fixed.
    clearance : Clearance
        Bearing and pin-hole clearance.
    materials : Materials
        Material of each part.
    friction : Friction or None
        Coefficients of friction; frictionless when left out.
    duty : tuple of Duty
        Torques and speeds over the life of the drive, for lives alone; those of ``load`` when left out.
    lubricant : Lubricant or None
        Lubricant of rollers and races, for lives alone; unmodified when left out.
    temperature : Temperature or None
        Temperatures of the parts; lengths of a file are those at 20 °C.
    inertia : Inertia or None
        Inertias of input, output and cranks beside those of shapes and densities, for vibrations alone.
    damping : Damping or None
        Damping of vibrations, for these alone.
    analysis : Analysis
        Engine of an analysis that does not name one; no property of the drive.
    contact : Contact
        Slices along the width of the contacts.
    case : str
        Name of the case in the file, for names of results; neither compared nor hashed.

    Examples
    --------
    >>> import ltca
    >>> drive = ltca.load_drive("robot-joint").cases["nominal"]
    >>> drive.pin_wheel.number_of_pins, drive.disc.number_of_discs, drive.transmission_ratio
    (40, 2, -39.0)
    """

    name: Name = "drive"
    crank: Crank
    pin_wheel: PinWheel
    disc: Disc
    crank_bearing: CrankBearing
    pin_shaft: PinShaft | None = None
    ring: Ring | None = None
    carrier: Carrier | None = None
    first_stage: FirstStage | None = None
    main_bearing: Annotated[MainBearing | None, grows("wheel")] = None
    load: Load
    installation: Installation = field(default_factory=Installation)
    clearance: Annotated[Clearance, grows("disc")] = field(default_factory=Clearance)
    materials: Materials = field(default_factory=Materials)
    friction: Friction | None = None
    duty: tuple[Duty, ...] = ()
    lubricant: Lubricant | None = None
    temperature: Temperature | None = None
    inertia: Inertia | None = None
    damping: Damping | None = None
    analysis: Analysis = field(default_factory=Analysis)
    contact: Contact = field(default_factory=Contact)
    case: Name = field(default="nominal", compare=False)

    @property
    def tooth_number_difference(self) -> int:
        """Δz = z_P − z_C."""
        return self.pin_wheel.number_of_pins - self.disc.number_of_teeth

    @property
    def reduction_ratio(self) -> float:
        """u = z_P/Δz, pin shaft fixed."""
        return self.pin_wheel.number_of_pins / self.tooth_number_difference

    @property
    def driving_sign(self) -> int:
        """+1 for a crank driving counter-clockwise, −1 clockwise."""
        return 1 if self.load.direction == "ccw" else -1

    @property
    def load_sign(self) -> int:
        """Sense in which a positive torque of the load turns the output, +1 for counter-clockwise: it opposes a crank that drives
        ccw with the wheel as output; the pin shaft turns the other way, and so does what opposes it.
        """
        return self.driving_sign if self.wheel_is_held else -self.driving_sign

    @property
    def motion_sign(self) -> int:
        """Sense in which the crank turns, +1 for counter-clockwise: against `driving_sign` where the output drives."""
        return self.driving_sign if self.load.driven_by == "input" else -self.driving_sign

    @property
    def wheel_is_held(self) -> bool:
        """Whether the pin wheel is fixed and the pin shaft is the output."""
        return self.installation.held == "pin-wheel"

    @property
    def first_stage_ratio(self) -> float | None:
        """z₂/z₁ of the first stage, by its teeth or as it is given; None without one."""
        return self.installation.first_stage_ratio if self.first_stage is None else self.first_stage.ratio

    @property
    def transmission_ratio(self) -> float:
        """Turns of the input for one of the output.

        A central crank: u with the pin shaft held, −z_C/Δz with the pin wheel held. Several cranks driven from the carrier,
        relative to it: u and −u. Behind a first stage i₁ the input is its sun: −i₁ u and 1 + i₁ u.
        """
        stage = self.first_stage_ratio
        if stage is not None:
            return 1.0 + stage * self.reduction_ratio if self.wheel_is_held else -stage * self.reduction_ratio
        if self.crank.number > 1:
            return -self.reduction_ratio if self.wheel_is_held else self.reduction_ratio
        teeth = self.disc.number_of_teeth if self.wheel_is_held else self.pin_wheel.number_of_pins
        return (-1.0 if self.wheel_is_held else 1.0) * teeth / self.tooth_number_difference

    @property
    def crank_turns_per_input(self) -> float:
        """Turns of the cranks relative to the pin shaft for one of the input.

        The wheel turns relative to the shaft by 1/u of them; with the wheel held that is the negative angle of the output.
        """
        return (-1.0 if self.wheel_is_held else 1.0) * self.reduction_ratio / self.transmission_ratio

    @property
    def crank_speed(self) -> float | None:
        """Magnitude of the speed of the cranks relative to the pin shaft, rad/s; None without `Load.speed`."""
        speed = self.load.speed
        return None if speed is None else abs(self.crank_turns_per_input) * speed * 2.0 * pi / 60.0

    @property
    def input_per_crank_moment(self) -> float:
        """External moment of the input by that of all cranks: 1, −1/i₁ behind a first stage, 0 for cranks driven from the
        carrier.
        """
        if self.crank.number == 1:
            return 1.0
        stage = self.first_stage_ratio
        return 0.0 if stage is None else -1.0 / stage

    @property
    def output_per_wheel_angle(self) -> float:
        """Deviation of the output by `wheel_angle`: 1; with the wheel held −z_P/z_C, with several cranks −1 or (1 − i)/i."""
        if not self.wheel_is_held:
            return 1.0
        if self.crank.number == 1:
            return -self.pin_wheel.number_of_pins / self.disc.number_of_teeth
        return -1.0 / (1.0 - self.input_per_crank_moment / self.reduction_ratio)

    @property
    def carrier_compliance(self) -> float:
        """Deviation of the output by its torque where the carrier twists (``carrier.stiffness_torsion``), rad/(N·mm); 0 where
        it is rigid.

        The carrier passes on what the wheel and the input leave over, :math:`|T_W + T_{in}|` in the mean of a turn: the torque of
        the output with the wheel held, with the pin shaft held 1 − 1/i of it, and its twist counts at the output by the same
        part (virtual work).
        """
        stiffness = None if self.carrier is None else self.carrier.stiffness_torsion
        if stiffness is None:
            return 0.0
        part = 1.0 if self.wheel_is_held else 1.0 - self.input_per_crank_moment / self.reduction_ratio
        return part * part / stiffness

    def output_deviation(self, wheel_angle: Any, torque: Any) -> Any:
        """Return the deviation of the output, ccw positive, rad: that of the wheel against the near flange of the carrier
        (`output_per_wheel_angle`), and the twist between that flange and what it is fixed to (`carrier_compliance`).

        `wheel_angle` in rad and `torque`, on the output in N·mm, positive as the load, are numbers or arrays of one shape.
        """
        found = self.output_per_wheel_angle * wheel_angle
        return found + self.load_sign * self.carrier_compliance * torque if self.carrier_compliance else found

    @property
    def posts(self) -> CarrierPosts | None:
        """Posts that hold the far flange of the carrier; None without a carrier or without posts of its own."""
        return None if self.carrier is None else self.carrier.posts

    @property
    def post_length(self) -> float:
        """Distance of the flanges of the carrier, the length of its posts, mm; placeholder without posts."""
        posts = self.posts
        return self.shaft_pin_span if posts is None or posts.length is None else posts.length

    @property
    def crank_supports(self) -> tuple[float, float] | None:
        """Axial places of the two bearings of every crank: of ``crank.support``, or the middles of the flanges of a carrier
        with posts, mm; None where cranks are held in the plane of every disc.
        """
        if self.crank.support is not None:
            return self.crank.support.positions
        if self.carrier is None or self.posts is None:
            return None
        near, far = self.carrier.flange or (0.0, 0.0)
        return -0.5 * (self.post_length + near), 0.5 * (self.post_length + far)

    def wheel_moment(self, torque: float | None = None) -> float:
        """Return the external moment on the wheel, ccw positive, N·mm, at an output torque of the whole drive (N·mm, its
        load by default).

        For a crank driving counter-clockwise −T_out, with the pin wheel held that by `output_per_wheel_angle`; of a held
        wheel it is the mean over a turn (`ltca.equilibrium.output_torque`).
        """
        total = self.load.torque if torque is None else torque
        return -self.driving_sign * total * abs(self.output_per_wheel_angle)

    def require_torque(self, what: str, torque: float | None = None) -> Drive:
        """Return the drive itself; DriveError where the torque, its load by default, is zero, at which `what` says nothing."""
        if (self.load.torque if torque is None else torque) == 0.0:
            said = f"must be greater than 0 for {what}"
            raise DriveError([Problem.of("load.torque", "= 0 N·mm", said, bound=("greater than", 0.0))])
        return self

    def load_words(self, torque: float | None = None) -> str:
        """Return torque (N·mm; the load by default) and direction for the heading of a table."""
        total = self.load.torque if torque is None else torque
        return f"{total / 1000.0:.6g} N·m {self.load.direction}"

    @property
    def flank_turn(self) -> float:
        """Angle of the flank against the holes in a drive of one disc, −Δz ζ/z_C, rad."""
        return -self.tooth_number_difference * self.disc.phase / self.disc.number_of_teeth

    @property
    def wheel_yields(self) -> bool:
        """Whether the main bearing of the wheel yields."""
        return self.pin_wheel.support_stiffness is not None or self.main_bearing is not None

    @property
    def wheel_tilts(self) -> bool:
        """Whether the main bearing of the wheel yields in tilt, by its own stiffness or by rows with pressure centres apart, and
        contacts have slices, which feel it.
        """
        bearing = self.main_bearing
        if bearing is None or self.contact.slices == 1:
            return False
        return bearing.tilt_stiffness is not None or bearing.rows_resist_tilt

    @property
    def number_of_holes(self) -> int:
        """z_PS, number of shaft pins and of holes; 0 without a pin shaft."""
        return 0 if self.pin_shaft is None else self.pin_shaft.number_of_pins

    @property
    def hole_stiffness(self) -> float:
        """k_PS of one shaft pin, N/mm; placeholder 1 without a pin shaft. DriveError where the pins are beams."""
        if self.pin_shaft is None:
            return 1.0
        if self.pin_shaft.stiffness is None:
            raise DriveError(["pin_shaft.stiffness: is left out, the shaft pins are beams (pin_shaft.beam)"])
        return self.pin_shaft.stiffness

    @property
    def flank_pin(self) -> Material:
        """Material in contact with the flank: of the wheel pins or of their sleeves."""
        return self.materials.sleeve if self.pin_wheel.seat.kind == "sleeve" else self.materials.wheel_pin

    @property
    def body_materials(self) -> Materials:
        """Materials of the plane bodies whose coefficients are derived: `wheel_pin` is the material in contact with the
        flank.
        """
        return replace(self.materials, wheel_pin=self.flank_pin)

    @property
    def pins_are_fixed(self) -> bool:
        """Whether no pin lies loose, carries a sleeve or bends."""
        parts = (self.pin_wheel, self.pin_shaft)
        return all(part is None or (part.seat.kind == "fixed" and part.beam is None) for part in parts)

    @property
    def hole_pin(self) -> Material:
        """Material in contact with the holes: of the shaft pins or of their sleeves."""
        sleeved = self.pin_shaft is not None and self.pin_shaft.seat.kind == "sleeve"
        return self.materials.sleeve if sleeved else self.materials.shaft_pin

    @property
    def pattern(self) -> int:
        """Order of rotational symmetry of holes and bores of the disc."""
        return gcd(self.number_of_holes, 0 if self.crank.number == 1 else self.crank.number)

    @property
    def part_turn(self) -> tuple[float, int, int]:
        """Part and orientation of the disc of a drive of one disc (`part_turn`)."""
        return part_turn(self.flank_turn, self.disc.number_of_teeth, self.pattern)

    @property
    def roller_length(self) -> float:
        """Length of the rollers, mm."""
        length = self.crank_bearing.roller_length
        return self.disc.thickness if length is None else length

    @property
    def wheel_pin_span(self) -> float:
        """Distance of the walls that hold the ends of bending wheel pins, mm; placeholder for pins that are rigid."""
        beam = self.pin_wheel.beam
        return self.disc.stack_length if beam is None or beam.span is None else beam.span

    @property
    def shaft_pin_span(self) -> float:
        """Distance from the flange to the tips of bending shaft pins, mm; placeholder for pins that are springs."""
        beam = None if self.pin_shaft is None else self.pin_shaft.beam
        return self.disc.stack_length if beam is None or beam.span is None else beam.span

    @property
    def bore_radius(self) -> float:
        """Outer-race radius with half the diametral bearing clearance, mm."""
        return self.crank_bearing.outer_race_radius + 0.5 * self.clearance.bearing

    @property
    def hole_radius(self) -> float:
        """Pin-hole radius with the pin-hole clearance, mm; 0 without a pin shaft."""
        return 0.0 if self.pin_shaft is None else self.pin_shaft.hole_radius + self.clearance.pin_hole

    def with_fields(self, changes: Mapping[str, Any]) -> Drive:
        """Return a drive with some fields replaced, checked like a drive file.

        Cases, tolerances and limits stand beside the drives of a file: the changed drive keeps the name of its case, and
        ``file.limits[drive.case]`` are still its limits. Lengths are those at 20 °C where the drive has temperatures.

        Parameters
        ----------
        changes : mapping of str to value
            New values by the names of a drive file: dotted, ``"pin_wheel.pin_radius"``, with an index for an element or an
            entry, ``"pin_wheel.pin_errors.radial.3"``, ``"disc.of.1.runout.amount"``, or tables as a file nests them. Numbers
            in mm, N, MPa, N·mm and rad, or texts with a unit; ``materials.disc`` and the like take a material's name. A
            ``pin_shaft.beam`` replaces ``pin_shaft.stiffness``, and the other way round.

        Returns
        -------
        Drive
            A new drive; this one stays as it is.

        Raises
        ------
        DriveError
            When a name is no field, or a value or the whole is wrong; all mistakes together.

        Examples
        --------
        >>> import ltca
        >>> drive = ltca.load_drive("paper").cases["CS-1"]
        >>> thick = drive.with_fields({"pin_wheel.pin_radius": "6.1 mm", "clearance": {"bearing": "30 µm"}})
        >>> thick.pin_wheel.pin_radius, thick.clearance.bearing, drive.clearance.bearing
        (6.1, 0.03, 0.0)
        """
        from ltca.reading.changes import with_fields

        return with_fields(self, changes)

    def fingerprint(self) -> str:
        """Return a hash of the whole definition of the drive in this case (hex, 16 digits), whatever analyses it."""
        return fingerprint_of(replace(self, analysis=Analysis()))

    def body_shape(self, bodies: Bodies = "plane") -> dict[str, float]:
        """Return the numbers that determine the finite-element bodies, and so their compliance, by name: mm, MPa, counts.

        `bodies` is "plane" or "solid"; solid ones end, so the length of the rollers is one of their numbers.

        Bore and holes have their actual radii, clearances included. Left out are errors of single parts, load, name,
        lengths and profiles along the length, numbers of rollers and discs, and of the shaft pins all but their number and
        circle, which are those of the holes; rigid core of the wheel pins and fixed bore of the race where they are the
        defaults.
        """
        self.require_warmed()
        wheel, disc, bearing, shaft = self.pin_wheel, self.disc, self.crank_bearing, self.pin_shaft
        shape = {
            "crank.eccentricity": self.crank.eccentricity,
            "pin_wheel.number_of_pins": float(wheel.number_of_pins),
            "pin_wheel.pin_radius": wheel.pin_radius,
            "generating_circle_radius": wheel.pin_circle_radius + disc.shifting_offset,
            "generating_pin_radius": wheel.pin_radius + disc.equidistant_offset,
            "disc.number_of_teeth": float(disc.number_of_teeth),
            "disc.thickness": disc.thickness,
            "crank_bearing.inner_race_radius": bearing.inner_race_radius,
            "crank_bearing.roller_radius": bearing.roller_radius,
            "bore_radius": self.bore_radius,
        }
        if bodies == "solid":
            shape["crank_bearing.roller_length"] = self.roller_length
        if shaft is not None:
            shape |= {
                "pin_shaft.number_of_pins": float(shaft.number_of_pins),
                "pin_shaft.pin_circle_radius": shaft.pin_circle_radius,
                "hole_radius": self.hole_radius,
            }
        if self.crank.number > 1:
            shape |= {
                "crank.number": float(self.crank.number),
                "crank.circle_radius": self.crank.circle_radius or 0.0,
                "crank.angle": self.crank.angle,
            }
        turn = self.part_turn[0]
        if turn:
            shape["flank_turn"] = turn
        # Coefficients that were derived before these were fields have the defaults.
        if wheel.held_core_radius != wheel.default_core_radius:
            shape["pin_wheel.core_radius"] = wheel.held_core_radius
        if bearing.held_bore_radius != bearing.default_race_bore_radius:
            shape["crank_bearing.race_bore_radius"] = bearing.held_bore_radius
        for part in ("disc", "wheel_pin", "roller", "inner_race"):
            material = getattr(self.body_materials, part)
            shape[f"materials.{part}.youngs_modulus"] = material.youngs_modulus
            shape[f"materials.{part}.poisson_ratio"] = material.poisson_ratio
        # Sums of radii and clearances must not differ by their rounding.
        return {name: float(f"{value:.12g}") for name, value in shape.items()}

    def require_warmed(self) -> Drive:
        """Return the drive itself; DriveError for one with temperatures, whose lengths are still those at 20 °C."""
        if self.temperature is not None:
            raise DriveError(
                ["temperature: must be left out here: lengths are those at 20 °C still, warm the drive first"]
            )
        return self

    def shape_fingerprint(self, bodies: Bodies = "plane") -> str:
        """Return a hash of `body_shape` of plane or solid bodies (hex, 16 digits), the key of influence coefficients."""
        return fingerprint_of(self.body_shape(bodies))


def part_turn(turned: float, teeth: int, pattern: int) -> tuple[float, int, int]:
    """Return the part that a disc is cut as, and the orientation of that part in the disc.

    Parts are equal where their flanks stand alike to holes and bores. The flank of the disc is turned by `turned` (rad)
    against holes and bores, which have an order of rotational symmetry `pattern` (z_PS for a central crank). Returned are
    ``(turn, steps, tooth_pitches)`` with ``turned = turn + 2π (steps/pattern + tooth_pitches/teeth)``: the least `turn` of
    the flank of the part, from 0 to a tooth pitch, rad; the part is turned by `steps` of the pattern in the disc, and its
    teeth are counted from `tooth_pitches` later.

    Examples
    --------
    >>> part_turn(-3.141592653589793 / 13, 13, 8)  # half a tooth pitch is half a turn of 13 teeth, four hole pitches
    (0.0, 4, -7)
    """
    pitch = 2.0 * pi / teeth

    def left(step: int) -> float:
        rest = (turned - 2.0 * pi * step / pattern) % pitch
        return 0.0 if min(rest, pitch - rest) < SAME_PART else rest

    step = min(range(pattern), key=lambda candidate: (round(left(candidate) / SAME_PART), candidate))
    turn = left(step)
    return turn, step, round((turned - turn - 2.0 * pi * step / pattern) / pitch)
