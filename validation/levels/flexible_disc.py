"""Level 6: effect of the flexible disc on the figures of a design, and when half-spaces are accurate enough."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fem.drive.contact_kinds import CONTACT_KINDS
from ltca.analysis.loaded_analysis import LoadedAnalysis, analyse
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCSEC
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.placement import position_angles
from ltca.quantities import SCALARS
from validation.compare.compared_positions import ComparedPosition
from validation.compare.comparison import Kind, PositionAnswer
from validation.compare.error_bars import ErrorBars
from validation.compare.model_positions import FULL, MODELS, DiscCoefficients, engine_of
from validation.rows import Row, relative_row, rounded

TURN_POSITIONS = 72
TORQUES = (0.25, 0.5, 1.0, 1.5)
LOAD_TOLERANCE = 0.05
"""Part within which a largest load is accurate enough for a design: the scatter by materials and tolerances."""

CAUSE = "what the rigid disc and uncoupled contacts leave out: informs only"


@dataclass(frozen=True, slots=True, kw_only=True)
class TurnFigures:
    """Figures of one turn with one model: scalars of `ltca.quantities`, and three of the wheel.

    Attributes
    ----------
    max_pin_load, max_roller_load, max_pin_shaft_load : float
        N; not a number without shaft pins.
    max_pin_pressure_mid, max_roller_pressure_mid : float
        MPa.
    wind_up : float
        Mean wheel angle with the backlash that is taken up, seconds of arc, positive in the sense of the load.
    elastic_wind_up : float
        Mean part of it between the light torque and the torque, seconds of arc.
    wheel_swing : float
        Wheel angle peak to peak, seconds of arc.
    """

    max_pin_load: float
    max_roller_load: float
    max_pin_shaft_load: float
    max_pin_pressure_mid: float
    max_roller_pressure_mid: float
    wind_up: float
    elastic_wind_up: float
    wheel_swing: float


LOADS = ("max_pin_load", "max_roller_load", "max_pin_shaft_load")
TITLES: dict[str, tuple[str, str]] = {
    **{
        name: (f"{SCALARS[name].title} over a turn", SCALARS[name].unit)
        for name in (*LOADS, "max_pin_pressure_mid", "max_roller_pressure_mid")
    },
    "wind_up": ("mean wheel angle, backlash included", '"'),
    "elastic_wind_up": ("mean wind-up of the wheel, from the light torque on", '"'),
    "wheel_swing": ("wheel angle, peak to peak over a turn", '"'),
}
"""Title and unit of each figure."""


def turn_figures(analysis: LoadedAnalysis) -> TurnFigures:
    """Return the figures of one turn."""
    response, pressures = analysis.full.response, analysis.pressures
    wheel, light = (state.pose[:, WHEEL_ANGLE] * ARCSEC for state in (analysis.full, analysis.light))
    return TurnFigures(
        max_pin_load=float(np.max(response.pin_load)),
        max_roller_load=float(np.max(response.rollers.outer_load)),
        max_pin_shaft_load=float(np.max(response.hole_load)) if response.hole_load.size else float("nan"),
        max_pin_pressure_mid=float(np.max(pressures.pins.mid)),
        max_roller_pressure_mid=float(max(np.max(pressures.outer.mid), np.max(pressures.inner.mid))),
        wind_up=float(np.mean(-wheel)) * analysis.drive.driving_sign,
        elastic_wind_up=float(np.mean(light - wheel)) * analysis.drive.driving_sign,
        wheel_swing=float(np.ptp(wheel)),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class FlexibilityEffect:
    """Figures of one case by all models, and the changes by the flexible disc.

    Attributes
    ----------
    turn : dict of str to TurnFigures
        By model, at the drive's torque.
    by_torque : dict of float to dict of str to float
        Change of the largest loads from half-space to ``fe``, of the kinds that are there, by multiple of the torque.
    """

    turn: dict[str, TurnFigures]
    by_torque: dict[float, dict[str, float]]


def study_case(drive: Drive, coefficients: DiscCoefficients) -> FlexibilityEffect:
    """Analyse one turn with every model, and with two models at several torques."""
    angles = position_angles(TURN_POSITIONS)
    turn: dict[str, TurnFigures] = {
        model: turn_figures(analyse(drive, angles, engine=engine_of(model, coefficients))) for model in MODELS
    }
    by_torque = {}
    for multiple in TORQUES:
        torque = multiple * drive.load.torque
        half, fe = (
            turn_figures(analyse(drive, angles, torque, engine=engine_of(model, coefficients)))
            for model in (MODELS[0], MODELS[1])
        )
        by_torque[multiple] = {
            name: getattr(fe, name) / getattr(half, name) - 1.0 for name in LOADS if np.isfinite(getattr(half, name))
        }
    return FlexibilityEffect(turn=turn, by_torque=by_torque)


def flexibility_rows(case: str, effect: FlexibilityEffect) -> list[Row]:
    """Return the informing rows of one case over a turn: half-space and hybrid against ``fe``."""
    reference = effect.turn["fe"]
    rows = []
    for model in ("half-space", "hybrid"):
        for name, (title, unit) in TITLES.items():
            value, other = float(getattr(effect.turn[model], name)), float(getattr(reference, name))
            if np.isnan(other):
                continue
            cause = CAUSE if model == "half-space" else "finite length at the contacts: informs only"
            rows.append(relative_row(6, title, value, other, unit, None, cause, case=case, model=model, against="fe"))
    for multiple, changes in effect.by_torque.items():
        for name, change in changes.items():
            quantity = f"{TITLES[name][0]}, change from half-space to fe at {multiple:g} of the torque"
            rows.append(_change_row(case, quantity, change, "fe"))
    return rows


def full_solution_changes(compared: list[ComparedPosition]) -> dict[str, float]:
    """Return the relative change of the largest loads over the positions of a case by the full solution."""

    def largest(answers: list[PositionAnswer], kind: Kind) -> float:
        return max(float(np.max(answer.kinds[kind].load)) for answer in answers)

    half = [position.answers["half-space"] for position in compared]
    full = [position.full.answer for position in compared]
    kinds: tuple[Kind, ...] = ("pin", "roller_outer", "hole")
    return {
        CONTACT_KINDS[kind].load: largest(full, kind) / largest(half, kind) - 1.0
        for kind in kinds
        if full[0].kinds[kind].load.size
    }


def full_solution_rows(case: str, compared: list[ComparedPosition], bars: ErrorBars | None = None) -> list[Row]:
    """Return the informing rows of one case: full solution against half-space at the chosen angles, with error bars if known."""
    rows = []
    for name, change in full_solution_changes(compared).items():
        quantity = f"{SCALARS[f'max_{name}'].title} at the chosen angles, change from half-space to full FE"
        # Changes are parts of the half-space load, bars of the full one.
        bar = None if bars is None else bars.largest_load * (1.0 + change)
        rows.append(_change_row(case, quantity, change, FULL, bar))
    wheel = [
        (position.answers["half-space"].wheel_angle, position.full.answer.wheel_angle, position.full.crank_angle)
        for position in compared
    ]
    half, full, angle = max(wheel, key=lambda item: abs(item[0] / item[1] - 1.0))
    rows.append(
        Row(
            level=6,
            quantity="wind-up at the angle where it differs most",
            value=abs(half) * ARCSEC,
            reference=abs(full) * ARCSEC,
            unit='"',
            difference=half / full - 1.0,
            limit=None,
            reason=CAUSE,
            case=case,
            crank_angle=angle,
            model="half-space",
            against=FULL,
            error_bar=None if bars is None else bars.wheel_angle / (abs(full) * ARCSEC),
        )
    )
    return rows


def _change_row(case: str, quantity: str, change: float, against: str, error_bar: float | None = None) -> Row:
    """Return the informing row of a relative change from half-space to another model."""
    return Row(
        level=6,
        quantity=quantity,
        value=change,
        reference=None,
        unit="",
        difference=change,
        limit=None,
        reason=CAUSE,
        case=case,
        model="half-space",
        against=against,
        error_bar=error_bar,
    )


def judge_half_space(effects: Mapping[str, FlexibilityEffect]) -> list[str]:
    """Return sentences on when half-spaces are accurate enough, by the figures."""
    sentences = []
    for name in LOADS:
        changes = {
            case: getattr(item.turn["fe"], name) / getattr(item.turn["half-space"], name) - 1.0
            for case, item in effects.items()
            if np.isfinite(getattr(item.turn["fe"], name))
        }
        if not changes:
            continue
        low, high = min(changes.values()), max(changes.values())
        safe = [case for case, change in changes.items() if abs(change) <= LOAD_TOLERANCE]
        under = [case for case, change in changes.items() if change > LOAD_TOLERANCE]
        over = [case for case, change in changes.items() if change < -LOAD_TOLERANCE]
        verdict = [
            f"within {100.0 * LOAD_TOLERANCE:g} % in {', '.join(safe)}" if safe else "",
            f"too low, so unsafe, in {', '.join(under)}" if under else "",
            f"too high, so on the safe side, in {', '.join(over)}" if over else "",
        ]
        sentences.append(
            f"{SCALARS[name].title.capitalize()} over a turn: the disc's flexibility changes it by {_range(low, high)}; "
            f"half-spaces give it {'; '.join(part for part in verdict if part)}."
        )
    wind = [
        item.turn["half-space"].elastic_wind_up / item.turn["fe"].elastic_wind_up - 1.0 for item in effects.values()
    ]
    sentences.append(
        f"Mean wind-up from the light torque on: half-spaces differ from fe by {_range(min(wind), max(wind))}; "
        f"what they miss is flexibility of the bodies, so stiffness should not be taken from them."
    )
    torques = sorted({multiple for item in effects.values() for multiple in item.by_torque})
    for multiple in torques:
        worst = max(
            (abs(change), case, name, change)
            for case, item in effects.items()
            for name, change in item.by_torque.get(multiple, {}).items()
        )
        sentences.append(
            f"At {multiple:g} times the torque the largest change of a largest load is {_percent(worst[3])} "
            f"({SCALARS[worst[2]].title}, {worst[1]})."
        )
    return sentences


def _percent(value: float) -> str:
    return f"{100.0 * value:+.1f} %".replace("-", "−")


def _range(low: float, high: float) -> str:
    """Return a range of changes in per cent, one figure where both ends print alike."""
    return _percent(low) if _percent(low) == _percent(high) else f"{_percent(low)} to {_percent(high)}"


def turn_content(effect: FlexibilityEffect) -> dict[str, dict[str, float | None]]:
    """Return the figures of one turn by model, for the report."""
    return {model: {name: rounded(getattr(figures, name)) for name in TITLES} for model, figures in effect.turn.items()}
