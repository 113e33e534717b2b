"""Loaded tooth contact analysis of one drive at many crank angles: equilibrium, then pressures and bearing forces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ltca.compliance import HalfSpaceCompliance
from ltca.drive import Drive
from ltca.equilibrium import Equilibrium, solve_equilibrium
from ltca.errors import DriveError

FloatArray = NDArray[np.float64]

HALF_WIDTH_BOUND = 0.3
"""Largest contact half-width as a part of the smallest radius in contact: beyond it the bodies are no half-spaces
and the separation is no parabola."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadedAnalysis:
    """Result of the analysis of one drive in one case.

    Attributes
    ----------
    drive : Drive
        What was analysed.
    torque : float
        Output torque, N·mm.
    full, light : Equilibrium
        At that torque and at the light torque.
    pin_pressure_mid, pin_half_width : array, shape (positions, z_P)
        MPa, mm.
    roller_pressure_mid_outer, roller_pressure_mid_inner : array, shape (positions, n_BR)
        MPa.
    roller_half_width_outer, roller_half_width_inner : array, shape (positions, n_BR)
        mm.
    bearing_radial, bearing_tangential : array, shape (positions,)
        Bearing force on the disc along the eccentricity and 90° ahead, N.
    """

    drive: Drive
    torque: float
    full: Equilibrium
    light: Equilibrium
    pin_pressure_mid: FloatArray
    pin_half_width: FloatArray
    roller_pressure_mid_outer: FloatArray
    roller_pressure_mid_inner: FloatArray
    roller_half_width_outer: FloatArray
    roller_half_width_inner: FloatArray
    bearing_radial: FloatArray
    bearing_tangential: FloatArray


def analyse(drive: Drive, crank_angle: FloatArray, torque: float | None = None) -> LoadedAnalysis:
    """Analyse a drive with half-space compliance.

    Parameters
    ----------
    drive : Drive
        The drive.
    crank_angle : array, shape (positions,)
        φ_C, rad.
    torque : float, optional
        Output torque, N·mm; the drive's own by default.

    Returns
    -------
    LoadedAnalysis
        Loads, pressures, forces, poses.

    Raises
    ------
    ConvergenceError
        When a position does not balance.
    DriveError
        When the torque cannot be carried: a half-width beyond 0.3 of the smallest radius.

    Examples
    --------
    >>> import numpy as np
    >>> from ltca.drive_file import load_drive
    >>> result = analyse(load_drive("paper").cases["CS-1"], np.array([0.5]))
    >>> print(f"{result.bearing_tangential[0]:.0f} N")
    6740 N
    """
    torque = drive.load.torque if torque is None else torque
    model = HalfSpaceCompliance.of_drive(drive)
    full = solve_equilibrium(model, crank_angle, drive.wheel_moment(torque))
    light = solve_equilibrium(model, crank_angle, drive.wheel_moment(drive.load.light_torque), full.pose)
    contacts = full.response
    laws, rollers, flank = model.roller_laws, contacts.rollers, contacts.flank
    push = (rollers.outer_load * rollers.outer_direction).sum(axis=1) * np.exp(-1j * full.crank_angle)
    analysis = LoadedAnalysis(
        drive=drive,
        torque=torque,
        full=full,
        light=light,
        pin_pressure_mid=model.pin_law.mid_pressure(flank.approach, flank.effective_radius),
        pin_half_width=model.pin_law.half_width(flank.approach, flank.effective_radius),
        roller_pressure_mid_outer=laws.outer.mid_pressure(rollers.outer_approach, laws.outer_radius),
        roller_pressure_mid_inner=laws.inner.mid_pressure(rollers.inner_approach, laws.inner_radius),
        roller_half_width_outer=laws.outer.half_width(rollers.outer_approach, laws.outer_radius),
        roller_half_width_inner=laws.inner.half_width(rollers.inner_approach, laws.inner_radius),
        bearing_radial=push.real,
        bearing_tangential=push.imag,
    )
    _check_half_widths(analysis)
    return analysis


def _check_half_widths(analysis: LoadedAnalysis) -> None:
    drive = analysis.drive
    flank = analysis.full.response.flank
    # 1/ρ = 1/r_pin + κ: the flank's own radius is a bound as well as the pin's.
    curvature = 1.0 / flank.effective_radius - 1.0 / drive.pin_wheel.pin_radius
    flank_radius = 1.0 / np.maximum(np.abs(curvature), 1e-9)
    roller = drive.crank_bearing.roller_radius
    found: list[tuple[str, FloatArray, FloatArray | float]] = [
        ("wheel pin", analysis.pin_half_width, np.minimum(flank_radius, drive.pin_wheel.pin_radius)),
        ("roller on the bore", analysis.roller_half_width_outer, roller),
        ("roller on the inner race", analysis.roller_half_width_inner, roller),
    ]
    problems = []
    for name, half_width, radius in found:
        ratio = half_width / (HALF_WIDTH_BOUND * radius)
        if np.max(ratio) > 1.0:
            worst = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
            bound = float(half_width[worst] / ratio[worst])
            problems.append(
                f"load.torque = {analysis.torque:g} N·mm cannot be carried: contact half-width "
                f"{half_width[worst]:.4g} mm of {name} {worst[1]}, must be at most {bound:.4g} mm "
                f"({HALF_WIDTH_BOUND:g} of the smallest radius in contact)"
            )
    if problems:
        raise DriveError(problems)
