"""Page of ``cyclo curves``: torque curve, orders of the transmission error, life, flank pressure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ltca.analysis.pressure_safety import PressureSafety
from ltca.analysis.torque_curve import TorqueCurve
from ltca.analysis.transmission_error_orders import Spectrum
from ltca.arrays import FloatArray
from ltca.drive.units.quantities import ARCMIN, ARCSEC
from ltca.page.study_page import Curves, Section
from ltca.page.tables import Table, minus, number, texts, word
from ltca.quantities import SCALARS

ORDERS_SHOWN = 15


def torque_section(curve: TorqueCurve, of: str) -> Section:
    """Return wind-up over torque, and what is read from it; `of` names case and colon, or is empty."""
    # Curves at single crank angles lie on each other; the table has how far they differ.
    many = f"mean of {curve.crank_angle.size} crank angles" if curve.crank_angle.size > 1 else ""
    lines = {many: np.mean(curve.output_angle, axis=0) * ARCMIN}
    plot = Curves(
        title="Wind-up of the output",
        unit="arc minutes",
        axis="torque at the output, N·m",
        x=curve.torque / 1e3,
        lines=lines,
    )
    rows = [
        (SCALARS["backlash_output"].verdict_title, _range(curve.backlash * ARCMIN) + "′"),
        (
            f"lost motion at ±{100.0 * curve.lost_motion_part:g} % of the torque",
            _range(curve.lost_motion * ARCMIN) + "′",
        ),
        (
            "torsional stiffness of the cycloid stage, 50 … 100 % of the torque",
            _range(curve.stiffness / ARCMIN / 1e3) + " N·m/′",
        ),
    ]
    if curve.loop is not None:
        rows.append(("width of the loop of friction there", _range(curve.loop.width * ARCMIN) + "′"))
        rows.append(("energy lost in a loop at the torque", _range(curve.loop.energy / 1e3) + " J"))
    table = Table(name="torque_curve", caption="", columns=["", "over the crank angles"], rows=texts(rows))
    return Section(heading=f"{of}Torque curve", curves=[plot], tables=[table])


def orders_section(spectrum: Spectrum, over: str, of: str) -> Section:
    """Return the orders of the transmission error, the largest in a table."""
    values = np.array([order.value for order in spectrum.orders])
    plot = Curves(
        title="Orders of the transmission error, amplitudes", unit="arc seconds", axis="order, per turn of the crank",
        x=values, lines={"": spectrum.amplitude * ARCSEC}, kind="stems",
    )  # fmt: skip
    rows = [
        [
            word(minus(spectrum.orders[place].name)),
            number(float(values[place])),
            number(float(spectrum.amplitude[place]) * ARCSEC, "{:.4f}", "arcsec"),
        ]
        for place in np.argsort(-spectrum.amplitude, kind="stable")[:ORDERS_SHOWN]
    ]
    rows.append(
        [word("unexplained, root mean square"), word(""), number(spectrum.residual * ARCSEC, "{:.4f}", "arcsec")]
    )
    table = Table(name="orders", caption="", columns=["origin", "order", "amplitude"], rows=rows)
    return Section(heading=f"{of}Transmission error", notes=[f"Orders {over}."], curves=[plot], tables=[table])


def life_section(lines: Sequence[str], of: str) -> Section:
    """Return the section on the life of the crank bearings."""
    return Section(heading=f"{of}Life of the crank bearings", notes=[minus(line.strip()) for line in lines])


def pressure_section(angle: FloatArray, pressure: FloatArray, safety: PressureSafety, of: str) -> Section:
    """Return the largest flank pressure at each position of the turn that holds the largest of all."""
    lines = {"largest of all pins": pressure.max(axis=1)}
    told = f"Largest {safety.largest:.1f} MPa, without a limit."
    if np.isfinite(safety.limit):
        lines["limit"] = np.full(angle.size, safety.limit)
        told = f"Largest {safety.largest:.1f} MPa, safety {safety.safety:.3f} against {safety.limit:g} MPa."
    plot = Curves(
        title="Flank pressure at mid-width", unit="MPa", axis="crank angle in its turn",
        x=np.degrees(angle - angle[0]), lines=lines, degrees=True,
    )  # fmt: skip
    return Section(heading=f"{of}Flank pressure", notes=[told], curves=[plot])


def _range(values: FloatArray) -> str:
    return minus(f"{values.min():.4g} … {values.max():.4g}")
