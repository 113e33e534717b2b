"""What is told of a full solution, printed and on its page: a row for each contact, facts of every disc and of the drive."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from fem.drive.contact_kinds import CONTACT_KINDS
from fem.drive.full_solution import FullSolution
from fem.drive.meshes import ELEMENTS_PER_HALF_WIDTH
from fem.reducer.solution import ReducerSolution
from fem.solid_drive.width_results import bearing_couples, bore_lean, disc_lean, solid_model, width_results
from ltca.drive.units.quantities import ARCSEC


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """Number of every contact: title when printed and on the page, width and format."""

    printed: str
    title: str
    width: int
    form: str


LOAD = Column(printed="load, N", title="load, N", width=10, form=".1f")
HALF_WIDTH = Column(printed="half-width, µm", title="half-width, µm", width=16, form=".1f")
PLANE_COLUMNS = (LOAD, Column(printed="peak, MPa", title="largest pressure, MPa", width=11, form=".1f"), HALF_WIDTH)
SOLID_COLUMNS = (
    LOAD,
    Column(printed="moment, N·mm", title="moment, N·mm", width=14, form=".1f"),
    Column(printed="K_Hβ", title="K_Hβ", width=8, form=".3f"),
    Column(printed="mid, MPa", title="pressure at mid-width, MPa", width=10, form=".1f"),
    Column(printed="most, MPa", title="largest, MPa", width=11, form=".1f"),
    HALF_WIDTH,
)


def columns_of(disc: FullSolution) -> tuple[Column, ...]:
    """Return the columns of the table of the contacts of a disc."""
    return SOLID_COLUMNS if disc.options.layers else PLANE_COLUMNS


def contact_rows(disc: FullSolution) -> Iterator[tuple[str, str, list[float]]]:
    """Yield short name, full name and numbers of every contact that carries, by kinds."""
    place = disc.model.placement
    along = {}
    if disc.options.layers:
        pairs = ((pair.kind, pair.index) for pair in disc.model.pairs)
        along = dict(zip(pairs, width_results(disc), strict=True))
    for kind, index, load, peak, width in disc.contacts.loaded:
        numbers = [load, peak, 1e3 * width]
        if own := along.get((kind, index)):
            numbers = [load, own.moment, own.load_factor, peak, float(own.largest.max()), 1e3 * width]
        yield CONTACT_KINDS[kind].name_of(index, place), CONTACT_KINDS[kind].title_of(index, place), numbers


def disc_facts(solution: ReducerSolution, number: int) -> Iterator[tuple[str, str]]:
    """Yield titles and words of what a disc has besides its contacts."""
    disc = solution.discs[number]
    if len(solution.discs) > 1:
        share = 100.0 * float(solution.torque_share[number])
        yield "its part of the moment on the wheel", f"{disc.state.wheel_moment / 1e3:.6g} N·m, {share:.2f} %"
    several = disc.model.placement.cranks > 1
    for crank, (radial, tangential) in enumerate(disc.bearing_components.tolist()):
        which = f" at crank {crank}" if several else ""
        yield f"bearing force on the disc{which}", f"radial {radial:.1f} N, tangential {tangential:.1f} N"
    if not solution.solid:
        return
    if solid_model(disc).widths.even:
        yield "along the width", "all is even, nothing tilts"
        return
    for crank, couple in enumerate(bearing_couples(disc).tolist()):
        which = f" at crank {crank}" if several else ""
        yield f"bearing moment on the disc{which}", f"about x {-couple.imag:.1f} N·mm, about y {couple.real:.1f} N·mm"
    for title, lean in (("at its bore", bore_lean(disc)), ("volume mean", disc_lean(disc))):
        title = f"tilt of the disc{' ' if title.startswith('at') else ', '}{title}"
        yield title, f"about x {-lean.imag:.6g} rad, about y {lean.real:.6g} rad"
    if (play := disc.model.drive.disc.axial_play) is not None:
        taken = 2.0 * abs(bore_lean(disc)) * disc.model.shapes.disc.flank.profile.tip_radius / play
        yield "axial play taken at the rim", f"{100.0 * taken:.3g} % of {play:g} mm"


def drive_facts(solution: ReducerSolution) -> Iterator[tuple[str, str]]:
    """Yield titles and words of what the drive has."""
    angle, options = solution.wheel_angle, solution.options
    yield "wheel angle", f"{angle * ARCSEC:.6g}″ = {angle:.6g} rad"
    yield "moment on the wheel", f"{solution.wheel_moment / 1e3:.6g} N·m"
    if solution.solid:
        yield "strain energy", f"{solution.strain_energy:.6g} N·mm"
        edges = f"{ELEMENTS_PER_HALF_WIDTH / options.size:.3g} elements for a half-width"
        yield "meshes", f"{edges}, {options.layers} layers over half of the width"
    yield "largest unbalanced force", f"{solution.equilibrium_residual:.1e} N"
    yield "unknowns", f"{solution.unknowns:,}"


def tabulate(solution: ReducerSolution) -> Iterator[str]:
    """Yield what is printed, line by line."""
    for number, disc in enumerate(solution.discs):
        columns = columns_of(disc)
        first = "contact" if len(solution.discs) == 1 else f"disc {number}, contact"
        yield f"{first:<24}" + "".join(f"{column.printed:>{column.width}}" for column in columns)
        for name, _, numbers in contact_rows(disc):
            cells = zip(columns, numbers, strict=True)
            yield f"{name:<24}" + "".join(f"{value:>{column.width}{column.form}}" for column, value in cells)
        yield from (f"{title}: {words}" for title, words in disc_facts(solution, number))
    yield from (f"{title}: {words}" for title, words in drive_facts(solution))
    iterations = " + ".join(str(disc.pose_iterations) for disc in solution.discs)
    yield f"{iterations} pose iterations, {solution.seconds['total']:.1f} s"
