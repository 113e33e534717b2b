"""Loaded tooth contact analysis of one drive at many crank angles: equilibrium, then pressures and bearing forces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.grids import GridCompliance
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.response import ComplianceModel, ContactPressures, Response
from ltca.drive.parts import Drive
from ltca.equilibrium.balance import Equilibrium, solve_equilibrium
from ltca.equilibrium.paper_method import solve_paper_equilibrium
from ltca.errors import DriveError

FloatArray = NDArray[np.float64]

Method = Literal["tables", "direct", "paper"]
Contacts = Literal["tables", "grids"]
Compliance = Literal["half-space", "fe", "hybrid"]

PAPER_START = 0.95
"""Part of the torque whose solution the paper's iteration starts from: near, but never the answer itself."""

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
    method : Method
        How equilibrium was found.
    contacts : Contacts
        What gave the loads.
    compliance : Compliance
        How the bodies yield.
    full, light : Equilibrium
        At that torque and at the light torque.
    model : ComplianceModel
        The compliance behind both.
    pressures : ContactPressures
        Pressures and half-widths at that torque.
    bearing_radial, bearing_tangential : array, shape (positions,)
        Bearing force on the disc along the eccentricity and 90° ahead, N.
    """

    drive: Drive
    torque: float
    method: Method
    contacts: Contacts
    compliance: Compliance
    full: Equilibrium
    light: Equilibrium
    model: ComplianceModel
    pressures: ContactPressures
    bearing_radial: FloatArray
    bearing_tangential: FloatArray


def analyse(
    drive: Drive,
    crank_angle: FloatArray,
    torque: float | None = None,
    *,
    method: Method = "tables",
    contacts: Contacts | None = None,
    compliance: Compliance = "half-space",
    coefficients: InfluenceCoefficients | None = None,
    hole_near_field: bool = True,
) -> LoadedAnalysis:
    """Analyse a drive.

    Parameters
    ----------
    drive : Drive
        The drive.
    crank_angle : array, shape (positions,)
        φ_C, rad.
    torque : float, optional
        Output torque, N·mm; the drive's own by default.
    method : {"tables", "direct", "paper"}
        ``tables``: equilibrium on tabulated laws; ``direct``: contact grids solved inside every iteration;
        ``paper``: the paper's iteration with held wheel (`ltca.equilibrium.paper_method`), started from our solution at 95 % of
        the torque. ``direct`` starts from the solution on tables.
    contacts : {"tables", "grids"}, optional
        What the paper's iteration runs on, tables by default; the other methods have their own.
    compliance : {"half-space", "fe", "hybrid"}
        ``half-space``: contacts do not feel each other (the paper); ``fe``: plane strain, coefficients from finite
        elements; ``hybrid``: half-space of finite length at the contact, finite elements for the bodies.
    coefficients : InfluenceCoefficients, optional
        Of this drive; what ``fe`` and ``hybrid`` need (`ltca.compliance.coefficients.load_coefficients`).
    hole_near_field : bool
        Whether hole walls yield like a Hertz contact (``fe`` and ``hybrid``).

    Returns
    -------
    LoadedAnalysis
        Loads, pressures, forces, poses.

    Raises
    ------
    ConvergenceError
        When a position does not balance.
    DriveError
        When the torque cannot be carried: a half-width beyond 0.3 of the smallest radius; when method and contacts
        contradict each other; when coefficients are missing.

    Examples
    --------
    >>> import numpy as np
    >>> from ltca.reading.drive_file import load_drive
    >>> result = analyse(load_drive("paper").cases["CS-1"], np.array([0.5]))
    >>> print(f"{result.bearing_tangential[0]:.0f} N")
    6738 N
    """
    torque = drive.load.torque if torque is None else torque
    used = _contacts_of(method, contacts)
    laws = HalfSpaceCompliance.of_drive(drive)
    model: ComplianceModel = laws if used == "tables" else GridCompliance.of_drive(drive)
    if compliance != "half-space":
        if method != "tables":
            raise DriveError([f"method = {method}: runs on half-space compliance only, not on {compliance}"])
        if coefficients is None:
            raise DriveError([f"compliance = {compliance}: needs the influence coefficients of the drive"])
        model = CoupledCompliance.of_drive(drive, coefficients, compliance, hole_near_field=hole_near_field)

    def solve(moment: float, start: FloatArray | None) -> Equilibrium:
        if method == "tables" and compliance == "half-space":
            return solve_equilibrium(laws, crank_angle, moment, start)
        if method in ("tables", "direct"):
            near = solve_equilibrium(laws, crank_angle, moment, start)
            # Grids wider than the bodies are curved have no separation: refused before they are laid.
            _check_half_widths(drive, torque, near.response, laws.pressures(near.response))
            return solve_equilibrium(model, crank_angle, moment, near.pose)
        near = solve_equilibrium(laws, crank_angle, PAPER_START * moment, start)
        return solve_paper_equilibrium(model, crank_angle, moment, near.pose)

    full = solve(drive.wheel_moment(torque), None)
    light = solve(drive.wheel_moment(drive.load.light_torque), full.pose)
    rollers = full.response.rollers
    push = (rollers.outer_load * rollers.outer_direction).sum(axis=1) * np.exp(-1j * full.crank_angle)
    pressures = model.pressures(full.response)
    _check_half_widths(drive, torque, full.response, pressures)
    return LoadedAnalysis(
        drive=drive,
        torque=torque,
        method=method,
        contacts=used,
        compliance=compliance,
        full=full,
        light=light,
        model=model,
        pressures=pressures,
        bearing_radial=push.real,
        bearing_tangential=push.imag,
    )


def _contacts_of(method: Method, contacts: Contacts | None) -> Contacts:
    if method == "paper":
        return contacts or "tables"
    own: Contacts = "grids" if method == "direct" else "tables"
    if contacts not in (None, own):
        raise DriveError([f"contacts = {contacts}: method {method} runs on {own}; only method paper runs on either"])
    return own


def _check_half_widths(drive: Drive, torque: float, contacts: Response, pressures: ContactPressures) -> None:
    flank = contacts.flank
    # 1/ρ = 1/r_pin + κ: the flank's own radius is a bound as well as the pin's.
    curvature = 1.0 / flank.effective_radius - 1.0 / drive.pin_wheel.pin_radius
    flank_radius = 1.0 / np.maximum(np.abs(curvature), 1e-9)
    roller = drive.crank_bearing.roller_radius
    found: list[tuple[str, FloatArray, FloatArray | float]] = [
        ("wheel pin", pressures.pins.half_width, np.minimum(flank_radius, drive.pin_wheel.pin_radius)),
        ("roller on the bore", pressures.outer.half_width, roller),
        ("roller on the inner race", pressures.inner.half_width, roller),
    ]
    problems = []
    for name, half_width, radius in found:
        ratio = half_width / (HALF_WIDTH_BOUND * radius)
        if np.max(ratio) > 1.0:
            worst = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
            bound = float(half_width[worst] / ratio[worst])
            problems.append(
                f"load.torque = {torque:g} N·mm cannot be carried: contact half-width "
                f"{half_width[worst]:.4g} mm of {name} {worst[1]}, must be at most {bound:.4g} mm "
                f"({HALF_WIDTH_BOUND:g} of the smallest radius in contact)"
            )
    if problems:
        raise DriveError(problems)
