"""Level 5, position by position: each compliance model against the full finite-element solution."""

from __future__ import annotations

import numpy as np

from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCSEC
from validation.compare.compared_positions import ComparedPosition
from validation.compare.comparison import (
    KINDS,
    LOADED_SHARE,
    Kind,
    PositionAnswer,
    PositionDifference,
)
from validation.compare.error_bars import NO_BARS, ErrorBars
from validation.compare.model_positions import FULL
from validation.rows import Row

LOAD_LIMIT, PRESSURE_LIMIT, WHEEL_LIMIT = 5e-3, 2e-2, 0.3
INTERPOLATED_LIMIT = 1e-2
BETWEEN_STATIONS = 0.25

REASONS = {
    "load": "of the largest load of its kind; coefficients on meshes of their own, contacts as Hertz parabolas",
    "pressure": "goes with the square root of the load, and a contact of 5 % may be off by 10 % of its own load",
    "wheel": "seconds of arc; 0.06 % of the wind-up of the paper's drive",
    "same": "contacts above 1 % of the largest are loaded in both or in neither",
}
CAUSES = {
    "half-space": "contacts of half-spaces do not feel each other and the disc between them is rigid: informs only",
    "hybrid": "half-spaces of finite length at the contacts, full FE is plane strain: informs only",
}


def compare_position_rows(compared: ComparedPosition, bars: ErrorBars | None = None) -> list[Row]:
    """Return the rows of one position for all models, with the error bars of the full solution where they are known."""
    rows: list[Row] = []
    for model in compared.answers:
        rows += _contact_rows(compared, model, bars)
        rows += _body_rows(compared, model, bars)
    return [*rows, _interpolation_row(compared, bars)]


class _Maker:
    """Makes the rows of one position and model."""

    def __init__(self, compared: ComparedPosition, model: str) -> None:
        self.case, self.angle, self.model = compared.full.case, compared.full.crank_angle, model

    def row(
        self,
        quantity: str,
        value: float,
        reference: float | None,
        unit: str,
        difference: float,
        limit: float,
        reason: str,
        *,
        contact: str = "",
        difference_unit: str = "",
        error_bar: float | None = None,
    ) -> Row:
        bounded = self.model == "fe"
        return Row(
            level=5,
            quantity=quantity,
            value=value,
            reference=reference,
            unit=unit,
            difference=difference,
            difference_unit=difference_unit,
            limit=limit if bounded else None,
            reason=reason if bounded else CAUSES[self.model],
            case=self.case,
            crank_angle=self.angle,
            contact=contact,
            model=self.model,
            against=FULL,
            error_bar=error_bar,
        )


def _contact_rows(compared: ComparedPosition, model: str, bars: ErrorBars | None = None) -> list[Row]:
    make = _Maker(compared, model)
    answer, reference, difference = compared.answers[model], compared.full.answer, compared.differences[model]
    rows = []
    for kind in KINDS:
        own, other, apart = answer.kinds[kind], reference.kinds[kind], difference.kinds[kind]
        of_kind = NO_BARS if bars is None else bars.kinds.get(kind, NO_BARS)
        for number in np.flatnonzero((own.load > 0.0) | (other.load > 0.0)).tolist():
            name = reference.contact_name(kind, number)
            rows.append(
                make.row(
                    "load", float(own.load[number]), float(other.load[number]), "N", float(apart.load[number]),
                    LOAD_LIMIT, REASONS["load"], contact=name, error_bar=of_kind.load,
                )
            )  # fmt: skip
            for quantity, ours, theirs, change, unit, bar in (
                ("peak pressure at mid-width", own.pressure, other.pressure, apart.pressure, "MPa", of_kind.pressure),
                ("half-width", own.half_width, other.half_width, apart.half_width, "mm", of_kind.half_width),
            ):
                if np.isfinite(change[number]):
                    rows.append(
                        make.row(
                            quantity, float(ours[number]), float(theirs[number]), unit, float(change[number]),
                            PRESSURE_LIMIT, REASONS["pressure"], contact=name, error_bar=bar,
                        )
                    )  # fmt: skip
    return rows


def _body_rows(compared: ComparedPosition, model: str, bars: ErrorBars | None = None) -> list[Row]:
    make = _Maker(compared, model)
    answer, reference, difference = compared.answers[model], compared.full.answer, compared.differences[model]
    wheel = compared.drive.pin_wheel.pin_circle_radius
    lever, levers = _rotation_lever(compared.drive)
    travel = WHEEL_LIMIT / ARCSEC * wheel
    rms = max(kind.rms_load for kind in difference.kinds.values())
    rows = [
        make.row(
            "load differences, root mean square, worst kind", rms, None, "", rms, LOAD_LIMIT, REASONS["load"],
            error_bar=None if bars is None else bars.largest_load,
        ),
        make.row(
            "wheel angle", answer.wheel_angle * ARCSEC, reference.wheel_angle * ARCSEC, '"',
            difference.wheel_angle, WHEEL_LIMIT, REASONS["wheel"], difference_unit='"',
            error_bar=None if bars is None else bars.wheel_angle,
        ),
        make.row(
            "disc displacement", _length(answer), _length(reference), "µm", 1e3 * difference.disc_displacement,
            1e3 * travel, "what 0.3″ of the wheel are at its pins; length of the difference, fitted to the bore",
            difference_unit="µm", error_bar=None if bars is None else 1e3 * bars.disc_displacement,
        ),
        make.row(
            "disc rotation", answer.disc_rotation * ARCSEC, reference.disc_rotation * ARCSEC, '"',
            difference.disc_rotation, WHEEL_LIMIT * wheel / lever,
            f"as the wheel's, at the shorter lever of {levers}", difference_unit='"',
            error_bar=None if bars is None else bars.disc_rotation,
        ),
        make.row(
            "contacts loaded in one answer only", float(len(difference.missing)), 0.0, "",
            float(len(difference.missing)), 0.0, REASONS["same"], contact=", ".join(difference.missing),
            difference_unit="contacts",
        ),
        *_bearing_rows(make, answer, reference, difference, None if bars is None else bars.bearing_force),
    ]  # fmt: skip
    names: dict[Kind, str] = {"pin": "wheel pins", "roller_outer": "rollers", "hole": "shaft pins"}
    for kind, name in names.items():
        if reference.kinds[kind].load.size == 0:
            continue
        ours, theirs = answer.loaded(kind), reference.loaded(kind)
        faint = _faint(answer, kind) + _faint(reference, kind)
        rows.append(
            make.row(
                f"number of loaded {name}", float(ours), float(theirs), "", float(ours - theirs), float(faint),
                "counted above 0.1 % of the largest load; those between that and 1 % may differ",
                difference_unit="contacts",
            )
        )  # fmt: skip
    return rows


def _rotation_lever(drive: Drive) -> tuple[float, str]:
    """Return the radius at which a disc is held against rotation, by pins or cranks the larger one, and its name."""
    shaft, circle = drive.pin_shaft, drive.crank.circle_radius or 0.0
    if shaft is not None and shaft.pin_circle_radius >= circle:
        return shaft.pin_circle_radius, "the shaft pins"
    return circle, "the cranks"


def _bearing_rows(
    make: _Maker,
    answer: PositionAnswer,
    reference: PositionAnswer,
    difference: PositionDifference,
    error_bar: float | None,
) -> list[Row]:
    cranks = reference.bearing_radial.size
    reason = "of the bearing force; a sum of roller loads"
    if cranks > 1:
        reason = "of the largest bearing force of all cranks; a sum of roller loads"
    rows = []
    for crank in range(cranks):
        place = "" if cranks == 1 else f"crank {crank}"
        for way in ("radial", "tangential"):
            ours, theirs, apart = (
                float(getattr(found, f"bearing_{way}")[crank]) for found in (answer, reference, difference)
            )
            rows.append(
                make.row(
                    f"bearing force, {way}", ours, theirs, "N", apart, LOAD_LIMIT, reason, contact=place,
                    error_bar=error_bar,
                )
            )  # fmt: skip
    return rows


def _length(answer: PositionAnswer) -> float:
    return 1e3 * float(np.hypot(answer.disc_radial, answer.disc_tangential))


def _faint(answer: PositionAnswer, kind: Kind) -> int:
    load = answer.kinds[kind].load
    return int(np.count_nonzero((load > 0.0) & (load <= LOADED_SHARE * np.max(load, initial=0.0))))


def _interpolation_row(compared: ComparedPosition, bars: ErrorBars | None = None) -> Row:
    """Return the worst load among contacts well between stations, where the coefficients are interpolated."""
    worst, name, ours, theirs = 0.0, "", 0.0, 0.0
    for kind, distance in compared.station_distance.items():
        apart = compared.differences["fe"].kinds[kind]
        for number in np.flatnonzero((distance >= BETWEEN_STATIONS) & apart.compared).tolist():
            if abs(apart.load[number]) >= abs(worst):
                worst, name = float(apart.load[number]), compared.full.answer.contact_name(kind, number)
                ours = float(compared.answers["fe"].kinds[kind].load[number])
                theirs = float(compared.full.answer.kinds[kind].load[number])
    return _Maker(compared, "fe").row(
        "load, worst contact a quarter of a spacing or more from every station"
        if name
        else "load between stations (no contact there at this angle)",
        ours,
        theirs,
        "N",
        worst,
        INTERPOLATED_LIMIT,
        "of the largest load of its kind; interpolation of the smooth part by six stations",
        contact=name,
        error_bar=None if bars is None else bars.largest_load,
    )


def shared_file_rows(positions: list[ComparedPosition], bars: ErrorBars | None = None) -> list[Row]:
    """Return the rows on the error of one file for all clearance cases: worst load, pressure and wheel angle of ``fe`` with it.

    The positions are of one case with clearance, compared with the coefficients of the disc without clearance.
    """
    cause = "what one file without clearances for all cases costs (cyclo derive --without-clearance); informs only"
    rows = []
    for position in positions:
        difference = position.differences["fe"]
        kind, number, load = difference.worst_load
        pressed, place, pressure = difference.worst_pressure
        own, other = position.answers["fe"], position.full.answer
        loaded, squeezed = (NO_BARS if bars is None else bars.kinds.get(one, NO_BARS) for one in (kind, pressed))
        for quantity, contact, ours, theirs, unit, change, change_unit, bar in (
            ("load, worst contact", difference.contact_name(kind, number), own.kinds[kind].load[number],
             other.kinds[kind].load[number], "N", load, "", loaded.load),
            ("peak pressure at mid-width, worst contact", difference.contact_name(pressed, place),
             own.kinds[pressed].pressure[place], other.kinds[pressed].pressure[place], "MPa", pressure, "", squeezed.pressure),
            ("wheel angle", "", own.wheel_angle * ARCSEC, other.wheel_angle * ARCSEC, '"',
             difference.wheel_angle, '"', None if bars is None else bars.wheel_angle),
        ):  # fmt: skip
            rows.append(
                Row(
                    level=5,
                    quantity=quantity,
                    value=float(ours),
                    reference=float(theirs),
                    unit=unit,
                    difference=change,
                    difference_unit=change_unit,
                    limit=None,
                    reason=cause,
                    case=position.full.case,
                    crank_angle=position.full.crank_angle,
                    contact=contact,
                    model="fe, coefficients shared by all cases",
                    against=FULL,
                    error_bar=bar,
                )
            )
    return rows
