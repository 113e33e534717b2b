"""The front door: analyse a drive from a notebook, with names that are checked and a result that shows itself."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ltca.analysis import loaded_analysis
from ltca.analysis.engines import Engine
from ltca.analysis.extremes import sampling_warning
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.analysis.reactions import relieved_rows_warning
from ltca.analysis.results import build_dataset
from ltca.analysis.summary import refined_value, summarise
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.drive.parts import Drive
from ltca.errors import ConvergenceError, DriveError
from ltca.front.arguments import angles_given, counted, engine_given, require_drive, torque_given
from ltca.geometry.placement import position_angles
from ltca.output.threads import on_one_thread, one_thread
from ltca.quantities import SCALARS, printed, unit_sign
from ltca.reading.arguments import refuse_impossible_torques

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

MOST_POSITIONS = 1_000_000
_SHOWN = (
    "mean_bearing_load", "max_pin_load", "max_pin_pressure_mid", "max_roller_load", "max_pin_shaft_load",
    "ptp_transmission_error", "backlash_output",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class AnalysisResult:
    """One analysed case. It never changes: every dataset and summary handed out is a new one.

    Attributes
    ----------
    case : str
        Name of the case in the dataset.
    loaded : LoadedAnalysis
        The solution itself: poses, loads, pressures as arrays of (positions, pairs).

    Examples
    --------
    >>> import ltca
    >>> result = ltca.analyse(ltca.load_drive("paper").cases["CS-1"], positions=4)
    >>> result.drive.name, result.engine.compliance, f"{result.torque / 1e3:.1f} N·m", result.warnings == []
    ('paper', 'half-space', '377.3 N·m', False)
    >>> round(result.summary["mean_bearing_load_N"], -1), result.dataset["pin_load"].dims
    (8480.0, ('case', 'disc', 'position', 'pin'))
    >>> len(result.plot.pin_load().axes)
    1
    """

    case: str
    loaded: LoadedAnalysis = field(repr=False)

    @property
    def drive(self) -> Drive:
        """The drive that was analysed."""
        return self.loaded.drive

    @property
    def engine(self) -> Engine:
        """What it ran on."""
        return self.loaded.engine

    @property
    def torque(self) -> float:
        """Output torque, N·mm."""
        return self.loaded.torque

    @property
    @on_one_thread
    def dataset(self) -> xr.Dataset:
        """Labelled dataset as in ``results.nc``, of this one case; its arrays are read-only.

        Positions are found by their number or by their crank angle, ``.sel(crank_angle=0.5, method="nearest")``.
        """
        found = by_angle(build_dataset(self.drive.name, {self.case: self.loaded}))
        for variable in found.variables.values():
            if isinstance(variable.data, np.ndarray):
                variable.data.flags.writeable = False
        return found

    @cached_property
    @on_one_thread
    def _summary(self) -> dict[str, float | None]:
        return summarise(self.loaded)

    @property
    def summary(self) -> dict[str, float | None]:
        """Scalars as in ``summary.json``, units in the keys."""
        return dict(self._summary)

    @property
    def warnings(self) -> list[str]:
        """What to know of drive, positions and answer before they are used, one sentence each, as `cyclo run` prints it."""
        few = sampling_warning(self.drive, self.loaded.full.crank_angle, typed="positions={}")
        warnings = (few, relieved_rows_warning(self.loaded))
        return [*self.loaded.warnings, *(warning for warning in warnings if warning is not None)]

    @on_one_thread
    def pressure(
        self,
        contact: str = "pin",
        number: int | None = None,
        *,
        position: int | None = None,
        crank_angle: float | str | None = None,
        disc: int | None = None,
        crank: int | None = None,
        cells: int = 16,
    ) -> xr.DataArray:
        """Return the pressure over the patch of one contact at one position: along the profile and along the width.

        Solved on a grid at the load of the contact, with its true separation: half-spaces of finite length near the contact,
        whatever yields beyond. What is left open is where the contact carries most.

        Parameters
        ----------
        contact : {"pin", "roller_outer", "roller_inner", "hole"}
            Wheel pin and flank, roller in the bore or on the inner race, shaft pin and hole.
        number : int, optional
            Which pin, roller or hole.
        position : int, optional
            Number of the position.
        crank_angle : float or str, optional
            Its crank angle instead, rad or a text with a unit: one of those analysed.
        disc, crank : int, optional
            Which disc, and for rollers which crank.
        cells : int
            Cells over the half-width and over half the length. Those at the ends are at least a hundredth of the length: at
            the edge of a straight roller or pin half-spaces have no largest pressure, and finer cells would only show more
            of it. So the largest of the cells settles, on the attribute ``pressure_max_MPa``.

        Returns
        -------
        xarray.DataArray, shape (x, y)
            Mean pressure of the cells, MPa, over their middles, mm; ``x_size`` and ``y_size`` are their sizes. Which contact it
            is are scalar coordinates; load, half-width, largest pressure and shear below the surface are attributes.

        Raises
        ------
        DriveError
            When there is no such contact, it carries nothing, or bodies are in plane strain (``fe``), which has no width.

        Examples
        --------
        >>> import ltca
        >>> result = ltca.analyse(ltca.load_drive("paper").cases["CS-1"], crank_angle=[0.3])
        >>> field = result.pressure("pin", 3)
        >>> carried, load = (field * field.x_size * field.y_size).sum(), result.dataset["pin_load"].sel(pin=3)
        >>> f"{carried.item():.0f} N of {load.item():.0f} N"
        '3524 N of 3524 N'
        >>> along = field.max("x")  # over the width: the ends carry more than the middle
        >>> f"{float(along.sel(y=0.0, method='nearest')):.0f} MPa in the middle"
        '1387 MPa in the middle'
        """
        from ltca.front.pressures import contact_pressure

        return contact_pressure(
            self.loaded, self.case, contact, number,
            position=position, crank_angle=crank_angle, disc=disc, crank=crank, cells=cells,
        )  # fmt: skip

    @property
    def plot(self) -> Plots:
        """Figures by name: ``result.plot.pin_load()``."""
        return Plots(dataset=self.dataset)

    def __repr__(self) -> str:
        """Say what was analysed and what came out, on a few lines."""
        positions = self.loaded.full.crank_angle.size
        head = (
            f"{self.drive.name}: {self.engine.compliance}, {positions} position{'s' * (positions > 1)}, "
            f"{self.torque / 1000.0:g} N·m {self.drive.load.direction}"
        )
        rows = [head]
        for shown in (SCALARS[name] for name in _SHOWN):
            value = refined_value(self._summary, shown.key)
            if value is not None and not (positions == 1 and shown.name.startswith("ptp")):
                told = printed(value, f"{{:{shown.digits}}}", shown.unit)
                rows.append(f"  {shown.title:<48}{told} {unit_sign(shown.unit)}")
        shares = [
            value for key, value in self._summary.items() if key.startswith("max_torque_share") and value is not None
        ]
        if len(shares) > 1:
            rows.append(f"  {'largest part of the torque':<48}{max(shares):.3f} on one of {len(shares)} discs")
        return "\n".join(rows)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class Plots:
    """Figures of a result, each a method that returns a matplotlib figure.

    Attributes
    ----------
    dataset : xarray.Dataset
        What is drawn.

    Examples
    --------
    >>> import ltca
    >>> plot = ltca.analyse(ltca.load_drive("paper").cases["CS-1"], positions=4).plot
    >>> wheel = [plot.transmission_error(), plot.pin_load(), plot.loaded_pins(), plot.pin_pressure()]
    >>> crank = [plot.bearing_load(), plot.tangential_bearing_load(), plot.radial_bearing_load(), plot.roller_load()]
    >>> shaft = [plot.pin_shaft_load(), plot.loaded_shaft_pins()]
    >>> {type(figure).__name__ for figure in (*wheel, *crank, *shaft)}
    {'Figure'}

    Figures of what a drive has not are refused by name: ``plot.torque_share()`` is of several discs, ``plot.cranks()`` of several
    cranks, ``plot.along_width()`` of slices.
    """

    dataset: xr.Dataset

    def _drawn(self, name: str) -> Figure:
        from ltca.figures.run_figures import draw_figure

        return draw_figure(name, self.dataset)

    def transmission_error(self) -> Figure:
        """Draw the transmission error at light and full torque over the crank angle."""
        return self._drawn("fig23_transmission_error")

    def pin_load(self) -> Figure:
        """Draw the load of a wheel pin over its mesh: of the first one whose mesh is whole."""
        return self._drawn("fig24_pin_load")

    def loaded_pins(self) -> Figure:
        """Draw the number of loaded wheel pins."""
        return self._drawn("fig25_loaded_pins")

    def pin_pressure(self) -> Figure:
        """Draw the largest flank pressure at a wheel pin, the one of `pin_load`."""
        return self._drawn("fig26_pin_pressure")

    def bearing_load(self) -> Figure:
        """Draw the total bearing load."""
        return self._drawn("fig28_bearing_load")

    def tangential_bearing_load(self) -> Figure:
        """Draw the bearing load 90° ahead of the eccentricity."""
        return self._drawn("fig29_tangential_bearing_load")

    def radial_bearing_load(self) -> Figure:
        """Draw the bearing load along the eccentricity."""
        return self._drawn("fig30_radial_bearing_load")

    def roller_load(self) -> Figure:
        """Draw the load distribution over the rollers."""
        return self._drawn("fig34_roller_load")

    def pin_shaft_load(self) -> Figure:
        """Draw the load of shaft pin 0."""
        return self._drawn("fig35_pin_shaft_load")

    def loaded_shaft_pins(self) -> Figure:
        """Draw the number of loaded shaft pins."""
        return self._drawn("fig36_loaded_shaft_pins")

    def torque_share(self) -> Figure:
        """Draw the part of the torque that each disc carries over the crank angle; 1 throughout of one disc."""
        return self._drawn("torque_share")

    def along_width(self) -> Figure:
        """Draw line load and pressure along the width of the most loaded wheel pin and roller, of contacts in slices.

        Raises
        ------
        DriveError
            In the plane (``contact.slices = 1``).
        """
        if "slice" not in self.dataset.sizes:
            raise DriveError(["contact.slices = 1: must be at least 3 for a figure along the width"])
        return self._drawn("along_width")

    def cranks(self) -> Figure:
        """Draw the moment that holds each crank, and where they yield how far each does."""
        return self._drawn("cranks")

    def __repr__(self) -> str:
        """Name the figures there are."""
        names = [name for name, value in vars(type(self)).items() if isinstance(value, Callable) and name[0] != "_"]  # type: ignore[arg-type]
        return f"figures: {', '.join(names)}"


def analyse(
    drive: Drive,
    positions: int | None = None,
    *,
    crank_angle: ArrayLike | None = None,
    torque: float | str | None = None,
    compliance: str | Engine | None = None,
    method: str | None = None,
    contacts: str | None = None,
    coefficients: InfluenceCoefficients | Path | str | None = None,
    hole_near_field: bool | None = None,
    bodies: str | None = None,
    case: str | None = None,
) -> AnalysisResult:
    """Analyse a drive over a turn of the crank, or at chosen crank angles.

    Parameters
    ----------
    drive : Drive
        One case of a drive file: ``ltca.load_drive("paper").cases["CS-1"]``.
    positions : int, optional
        Crank angles 2πk/N, k = 0 … N−1; 360 by default.
    crank_angle : array, shape (positions,), optional
        Crank angles φ_C, rad, instead; each may be a text with a unit, ``"20 deg"``.
    torque : float or str, optional
        Output torque, N·mm, or a text with a unit, ``"400 N·m"``; the drive's own by default.
    compliance : {"half-space", "fe", "hybrid"} or engine, optional
        How the bodies yield; an engine (`ltca.HalfSpace`, `ltca.PlaneStrain`, `ltca.Hybrid`) brings its options. Left out,
        ``drive.analysis.compliance`` says it: ``hybrid`` unless the drive file has another; a `method` or `contacts` is of
        half-spaces. Of cases whose bodies hardly differ ``ltca.Hybrid().lending(file.cases.values())`` takes the coefficients
        of the first, as ``cyclo run`` does, in the place of deriving those of each.
    method : {"tables", "direct", "paper"}, optional
        How the half-space is solved.
    contacts : {"tables", "grids"}, optional
        What the paper's iteration runs on.
    coefficients : InfluenceCoefficients or path, optional
        Of the bodies, for ``fe`` and ``hybrid``; found in the cache or derived when left out.
    hole_near_field : bool, optional
        Whether hole walls yield like a Hertz contact (``fe`` and ``hybrid``); they do by default.
    bodies : {"plane", "solid"}, optional
        What bodies the coefficients of ``fe`` and ``hybrid`` are of: plane sections, or solids with their ends; left out,
        ``drive.analysis.bodies`` says it.
    case : str, optional
        Name of the case in the dataset; by default that of the file, which changed drives keep, or ``nominal``.

    Returns
    -------
    AnalysisResult
        With ``dataset``, ``summary`` and ``plot``.

    Raises
    ------
    DriveError
        When a name, a number or their combination makes no sense, or the torque cannot be carried.
    ConvergenceError
        When a position does not balance; ``partial`` is the result of those that do, their numbers alone.

    Examples
    --------
    >>> import ltca
    >>> drive = ltca.load_drive("paper").cases["CS-1"]
    >>> result = ltca.analyse(drive, crank_angle=[0.5])
    >>> print(f"{float(result.dataset['bearing_tangential'].sum()):.0f} N")
    6738 N
    >>> half = ltca.analyse(drive, crank_angle="20 deg", torque="188.65 N·m")
    >>> print(f"{float(half.dataset['bearing_tangential'].sum()):.0f} N")
    3370 N
    """
    require_drive(drive)
    if positions is not None and crank_angle is not None:
        raise DriveError(["positions and crank_angle: give one of them"])
    if crank_angle is None:
        crank_angle = position_angles(counted(360 if positions is None else positions, "positions", 1, MOST_POSITIONS))
    angles: Any = angles_given(crank_angle)
    carried = torque_given(drive, torque)
    refuse_impossible_torques([drive], carried, duty=False)
    name = drive.case if case is None else case
    engine = engine_given(
        drive,
        compliance,
        method=method,
        contacts=contacts,
        coefficients=coefficients,
        hole_near_field=hole_near_field,
        bodies=bodies,
    )
    try:
        with one_thread():
            return AnalysisResult(case=name, loaded=loaded_analysis.analyse(drive, angles, carried, engine))
    except ConvergenceError as error:
        if isinstance(error.partial, LoadedAnalysis):
            error.partial = AnalysisResult(case=name, loaded=error.partial)
        raise


@on_one_thread
def derivatives(result: AnalysisResult, fields: Iterable[str]) -> xr.Dataset:
    """Return how what an analysis answers follows fields of its drive: ∂(loads, poses, angles, …)/∂field at every position.

    By the full Jacobian of the balance (`ltca.analysis.derivatives`): nothing is balanced again but where contacts open or close
    on the way.

    Parameters
    ----------
    result : AnalysisResult
        Of `analyse`, with an answer at every position.
    fields : iterable of str
        Real fields by their paths, ``disc.shifting_offset``, ``load.torque``, or elements of arrays,
        ``pin_wheel.pin_errors.radial.3``.

    Returns
    -------
    xarray.Dataset
        The variables of ``result.dataset`` with the dimension ``field`` in the place of ``case``, per unit of the field
        (coordinate ``unit``); ``pose``, mm and rad by the coordinates of the members; and the scalars of ``result.summary``
        that are means, ranges and largest values of these, by their keys. A largest value follows the contact that has it.

    Raises
    ------
    DriveError
        For what is no real field of this drive and, under ``fe`` and ``hybrid``, for one that reshapes a body.
    ConvergenceError
        When positions have no answer, or drives beside this one have none.

    Examples
    --------
    >>> import ltca
    >>> drive = ltca.load_drive("paper").cases["CS-1"]
    >>> slopes = ltca.derivatives(ltca.analyse(drive, crank_angle=[0.5]), ["disc.shifting_offset", "load.torque"])
    >>> print(f"{float(slopes['max_pin_load_N'].sel(field='load.torque')) * 1e3:.2f} N by 1 N·m")
    5.39 N by 1 N·m
    """
    from ltca.analysis.derivatives import derivatives as of_analysis

    return by_angle(of_analysis(result.loaded, fields))


def by_angle(dataset: xr.Dataset) -> xr.Dataset:
    """Return a dataset whose positions are found by their crank angle, too."""
    return dataset.set_xindex("crank_angle")
