"""The contract: every leaf field of a drive moves the answer of every model, or is refused by its name.

One walk over all fields, with static engines, vibrations and runs in time as its columns. Nothing is ignored: each field of a
small drive with every deviation in it is changed as a person could have changed it; then some number of the answer has to
differ, or a `DriveError` has to name the field. What may leave an answer alone stands in `EXCEPTIONS`, with its reason. Full
finite elements and the commands as programs walk the same list in ``benchmarks/contract.py``, which takes minutes; here they
are walked by what their solution is a function of.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ltca.analysis.drive_curves import fewest_turns
from ltca.analysis.engines import HalfSpace, Hybrid, PlaneStrain
from ltca.analysis.forced_vibration import forced_vibration
from ltca.analysis.loaded_analysis import analyse, analyse_cases
from ltca.analysis.mass_values import mass_values
from ltca.analysis.reactions import reaction_values
from ltca.analysis.time_run import Course, prepare_run, run_in_time
from ltca.analysis.vibration import vibration, vibration_content
from ltca.compliance.coefficients import load_coefficients
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.drive.engine_support import require
from ltca.drive.fields import field_kinds
from ltca.drive.materials import JUDGED_BY
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.errors import DriveError
from ltca.laws import profiled_line_contact
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients
from ltca.testing.field_changes import (
    EXCEPTIONS,
    change_of,
    fault_of_field,
    leaf_fields,
    moves,
    sensible_change,
    with_densities,
)
from validation.methods.grids import GridCompliance

ANGLES = np.array([0.5])
FIELDS = leaf_fields()


@cache
def base_drive(name: str) -> Drive:
    """A drive that the walk starts from: the small one with every deviation, or a shipped one for what that has not."""
    if name != "contract":
        return parse_drive(shipped_drive(name), name).cases["nominal"]
    parts = ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin")
    masses = {f"materials.{part}.density": 7800.0 + 10.0 * number for number, part in enumerate(parts)}
    small = load_drive(Path(__file__).parent / "drive.toml").cases["nominal"]
    return with_fields(small, masses | {"inertia.output": 0.01})


def base_of(name: str, column: str, path: str) -> Drive:
    """The drive of a column in which a field is changed."""
    drive = base_drive(name)
    if column == "fe" and name == "contract":
        # Plane strain has rollers as long as the disc is thick; to be changed, others are left out of the base.
        return with_fields(drive, {"crank_bearing.roller_length": drive.disc.thickness})
    return with_fields(drive, MOVED_BY.get(path, {})) if column == "time" else drive


MOVED_BY: dict[str, dict[str, Any]] = {
    "materials.shaft_pin.density": {"installation.held": "pin-wheel"},
    "materials.carrier.density": {"installation.held": "pin-wheel"},
    "inertia.crank_mass": {
        "crank.support.diameter": 8.0, "crank.support.positions": (-10.0, 12.0), "crank.support.stiffness": (2e5, 3e5)
    },
}  # fmt: skip
"""What lets masses move that stand in the base, in runs in time."""
WITH: dict[str, dict[str, dict[str, Any]]] = {
    "rv": {"crank.circle_radius": {"crank.circle_radius": 40.0}, "disc.planes": {"disc.planes": (-9.0, 9.0)}},
    "sleeved": {"disc.planes": {"disc.planes": (-6.5, 6.5)}},
}
"""Values of fields of drives with several discs or cranks, for which `sensible_change` has no others."""
OF_SEVERAL_CRANKS = (
    "installation.held",
    "installation.first_stage_ratio",
    *(path for path in FIELDS if path.startswith(("first_stage.", "load.external."))),
    *(f"crank.{name}" for name in ("number", "circle_radius", "angle", "eccentricity_error")),
    *(
        f"crank.support.{name}"
        for name in ("diameter", "positions", "stiffness", "clearance", "torsion", "spline_plane")
    ),
    "carrier.stiffness_torsion",
    "carrier.posts.size",
    "materials.carrier.youngs_modulus",
    "materials.crankshaft.youngs_modulus",
    "main_bearing.clearance",
    "crank.of.0.eccentricity_error",
    "crank.of.0.phase_error",
    "disc.of.0.bore_errors.radial",
    "disc.of.0.bore_errors.tangential",
    "disc.planes",
    "pin_wheel.support_stiffness",
    "clearance.bearing",
)
"""The walk starts from a central crank; what several have is changed in an RV reducer."""
OF_LOOSE_PINS = (
    "pin_wheel.pin_errors.diameter",
    "pin_shaft.beam.tip",
    "disc.planes",
    *(f"materials.{part}.youngs_modulus" for part in ("wheel_pin", "shaft_pin", "sleeve")),
    *(f"materials.{part}.poisson_ratio" for part in ("shaft_pin", "sleeve")),
)
"""The walk starts from one disc and has sleeves on the wheel; here two discs bend pins, sleeves are on the shaft."""
OF_VIBRATIONS = (
    *(path for path in field_kinds() if path.startswith(("inertia.", "damping."))),
    "materials.disc.density",
    "load.direction",
    "crank.eccentricity",
)
OF_RUNS_IN_TIME = ("friction.no_load_torque", "load.external.0.force.x", "damping.ratio", "carrier.posts.size")
"""One of each way of the forces that runs in time have of their own."""


def relative(arrays: Sequence[Any], least: float = 1e-9) -> np.ndarray:
    """The largest number of each array, and all its numbers relative to it: solutions from other starts differ by 1e-9 of it.

    Arrays whose numbers are all below the least are round-off.
    """
    parts = []
    for array in (np.ravel(np.asarray(array, dtype=float)) for array in arrays):
        largest = max(float(np.abs(array).max(initial=0.0)), least)
        parts += [[largest], 1.0 + array / largest]
    return np.concatenate(parts)


def of_contacts(pressures: Any) -> Iterator[np.ndarray]:
    for kind in (pressures.pins, pressures.outer, pressures.inner, pressures.holes):
        yield from (kind.mid, kind.largest)


def numbers(analysis) -> np.ndarray:
    """Everything that an analysis found of a case: poses, loads, pressures, what its dataset is made of."""
    contacts, pressures = analysis.full.response, analysis.pressures
    arrays = [analysis.full.pose, analysis.light.pose, analysis.transmission_error]
    arrays += [kind.half_width for kind in (pressures.pins, pressures.outer, pressures.inner, pressures.holes)]
    loads = [contacts.pin_load, contacts.hole_load, contacts.rollers.outer_load, contacts.rollers.inner_load]
    loads += [*reaction_values(analysis).values(), *of_contacts(pressures)]
    if analysis.losses is not None:
        losses = analysis.losses
        arrays += [losses.watts(losses.total), losses.input_torque, losses.efficiency]
        arrays.append(analysis.losses_back.input_torque)
    return np.concatenate([relative(arrays), relative(loads, least=1e-2)])


def direct(drive: Drive) -> np.ndarray:
    """Grids inside every iteration; few cells, for the sake of time: which fields count does not depend on them."""
    HalfSpace(method="direct").prepare(drive)  # which refuses what grids cannot say
    drive = warm_drive(drive)
    singles = single_discs(drive)
    tables = Reducer.of_drive(drive, [HalfSpaceCompliance.of_drive(single) for single in singles])
    near = solve_at_output(tables, [drive], ANGLES[:1], drive.load.torque)
    model = replace(tables, discs=tuple(GridCompliance.of_drive(single, cells=4) for single in singles))
    found = solve_at_output(model, [drive], ANGLES[:1], drive.load.torque, near.pose)
    turned = drive.output_deviation(found.pose[:, -1], drive.load.torque)
    return relative([found.pose, turned, *of_contacts(model.pressures(found.response))])


def paper(drive: Drive) -> np.ndarray:
    prepared = HalfSpace(method="paper").prepare(drive)
    found = prepared.balance(ANGLES, drive.load.torque)
    return relative([found.pose, *of_contacts(prepared.model.pressures(found.response))])


def vibrations(drive: Drive) -> np.ndarray:
    """Everything that masses, modes, orders, critical speeds and the response have."""
    turns = fewest_turns(warm_drive(drive), 40)  # warm rollers are all but a period apart
    found = vibration(drive, engine=HalfSpace(), positions=4, torque_parts=(0.5,), turns=turns)
    content = vibration_content(found)
    critical = [[one["speed_rpm"], one["in_range"]] for one in content["critical_speeds"]]
    parts = [
        list(mass_values(drive).values()),
        found.frequency,
        found.spectrum.amplitude * 1e6,
        content["speed_range_rpm"],
        critical,
    ]
    if drive.damping is not None:
        parts.append(forced_vibration(found, fastest=1000.0, speeds=10).amplitude)
    return np.concatenate([np.ravel(np.asarray(part, dtype=float)) for part in parts])


def run(drive: Drive) -> np.ndarray:
    """Begin and end of a run of some steps.

    Between its steps the solver interpolates, and steps follow round-off: what is read there differs by 1e-6, and rates
    by nearly as much.
    """
    found = run_in_time(prepare_run(drive, HalfSpace(), Course.of_values("steady", 5e-5, 1500.0)), samples=2).samples
    return relative(
        [*(getattr(found, name) for name in found.__slots__ if name not in ("rate", "works")), *found.works.T]
    )


Answers = dict[str, np.ndarray | DriveError]


def answered(answer: Callable[[Drive], np.ndarray]) -> Callable[[dict[str, Drive]], Answers]:
    """Answers of a model to drives one after another, or the error by which it refuses them."""

    def one(drive: Drive) -> np.ndarray | DriveError:
        try:
            return answer(drive)
        except DriveError as error:
            return error

    return lambda drives: {name: one(drive) for name, drive in drives.items()}


@answered
def analysed(drive: Drive) -> np.ndarray:
    return numbers(analyse(drive, ANGLES))


def together(drives: dict[str, Drive]) -> Answers:
    """Analyses on tables, in batches of drives whose models agree; where one is refused beyond the table, one by one."""
    refused = answered(lambda drive: require(warm_drive(drive), "tables"))(drives)
    sound = {name: drive for name, drive in drives.items() if not isinstance(refused[name], DriveError)}
    try:
        return refused | {name: numbers(analysis) for name, analysis in analyse_cases(sound, ANGLES)}
    except DriveError:
        return refused | analysed(sound)


@dataclass(frozen=True)
class Walk:
    """The columns of the walk, and what they have answered."""

    columns: dict[str, Callable[[dict[str, Drive]], Answers]]
    known: dict[tuple[str, str], np.ndarray | DriveError]

    def answers(self, column: str, drives: dict[str, Drive]) -> Answers:
        """Answers to drives by their text, each drive solved once for all fields and tests."""
        missing = {text: drive for text, drive in drives.items() if (column, text) not in self.known}
        found = self.columns[column](missing)
        self.known.update({(column, text): found[text] for text in missing})
        return {text: self.known[column, text] for text in drives}

    def faults(self, name: str, column: str, paths: Sequence[str], deaf_to: str = "") -> list[str]:
        """What is wrong with fields in a column, from a base drive; of a model that is deaf to one of them, if so."""
        pairs, drives, found = {}, {}, []
        for path in paths:
            try:
                base, change = changed_field(name, column, path)
                changed = with_densities(with_fields(base, change))
                if path == deaf_to:
                    changed = base
            except DriveError as error:
                pairs[path] = error, error
                continue
            pairs[path] = repr(base), repr(changed)
            drives |= {repr(base): base, repr(changed): changed}
        answers = self.answers(column, drives)
        for path, (before, after) in pairs.items():
            before, after = answers.get(before, before), answers.get(after, after)
            if name == "contract":
                accepted = partial(self.is_accepted, name, column, path)
                found.append(fault_of_field(path, column, before, after, accepted=accepted))
            elif isinstance(after, DriveError) or not moves(before, after):
                found.append(f"{path} of {name} is refused or ignored by {column}: {after}")
        return [fault for fault in found if fault]

    def is_accepted(self, name: str, column: str, path: str) -> bool:
        """Whether the tables take a change that another engine refuses."""
        try:
            base, change = changed_field(name, column, path)
            analyse(with_fields(base, change), ANGLES)
        except DriveError:
            return False
        return True


def changed_field(name: str, column: str, path: str) -> tuple[Drive, dict[str, Any]]:
    """A base drive in which a field has an effect, and its change."""
    base = base_of(name, column, path)
    # What loose pins have is all there, and nothing to be added.
    base, change = (base, {path: sensible_change(base, path)}) if name == "sleeved" else change_of(base, path)
    return with_densities(base), change | WITH.get(name, {}).get(path, {})


@pytest.fixture(scope="module")
def coefficients(tmp_path_factory):
    """Coefficients of a drive's own bodies in closed form, made once for each distinct shape."""
    folder, known = tmp_path_factory.mktemp("coefficients"), {}

    def of(drive):
        found = []
        for single in single_discs(warm_drive(drive)):
            shape = single.shape_fingerprint()
            if shape not in known:
                path = folder / f"{shape}.nc"
                closed_form_coefficients(single, half_width=0.02, depth=300.0).to_netcdf(path, engine="h5netcdf")
                known[shape] = load_coefficients(path, single)
            found.append(known[shape])
        return found

    return of


_ROUGH_TABLE = cache(partial(profiled_line_contact.profiled_table.__wrapped__, cells=4, nodes=9))


@pytest.fixture
def rough_tables(monkeypatch):
    """Tables of profiled contacts that see every field, and no more."""
    monkeypatch.setattr(profiled_line_contact, "profiled_table", _ROUGH_TABLE)


@pytest.fixture(scope="module")
def walk(coefficients) -> Walk:
    def on(engine):
        return answered(lambda drive: numbers(analyse(drive, ANGLES, engine=engine(coefficients=coefficients(drive)))))

    columns = {"tables": together, "paper": answered(paper), "direct": answered(direct)}
    columns |= {"hybrid": on(Hybrid), "fe": on(PlaneStrain), "dynamics": answered(vibrations), "time": answered(run)}
    return Walk(columns=columns, known={})


def parts() -> Iterator[Any]:
    """Parts of the walk: base drive, column and fields, the fields of a table together.

    Quick is a part of the fields on half-space tables; the others on tables stay in every full run, as a few of vibrations and
    runs in time do. Other columns are walked at night.
    """
    slow, nightly = [pytest.mark.slow], [pytest.mark.slow, pytest.mark.nightly]

    def part(name: str, column: str, label: str, paths: Sequence[str], marks: Sequence[Any] = ()) -> Any:
        return pytest.param(name, column, tuple(paths), id=f"{name}-{column}-{label}", marks=marks)

    # One disc's own part errors go the way of those of all; of two components or materials, and of errors of a part, one
    # stands for both; of a table every fourth field.
    twins = (".y", ".tangential", ".poisson_ratio", ".thermal_expansion")
    quick = [
        path for path in FIELDS[::4] if not ("_profile." in path or path.startswith("disc.of.") or path.endswith(twins))
    ]
    judges = {
        path for path in FIELDS if path.rpartition(".")[2] in JUDGED_BY and not path.startswith("materials.disc.")
    }
    quick = [path for path in quick if path not in judges]
    yield part("contract", "tables", "some", quick)
    # Other materials' limits go the way of the disc's, and no other static engine sees them.
    yield part("contract", "tables", "limits of materials", sorted(judges), nightly)
    yield part("contract", "dynamics", "some", OF_VIBRATIONS, slow)
    yield part("contract", "time", "some", OF_RUNS_IN_TIME, slow)
    known = {"tables": {*quick, *judges}, "dynamics": set(OF_VIBRATIONS), "time": set(OF_RUNS_IN_TIME)}
    for column in ("tables", "paper", "hybrid", "fe", "direct", "dynamics", "time"):
        left = [path for path in FIELDS if path not in known.get(column, judges)]
        for table in dict.fromkeys(path.partition(".")[0] for path in left):
            paths = [path for path in left if path.partition(".")[0] == table]
            yield part("contract", column, table, paths, slow if column == "tables" else nightly)
    for name, paths in (("rv", OF_SEVERAL_CRANKS), ("sleeved", OF_LOOSE_PINS)):
        for column in ("tables", "hybrid", "fe"):
            yield part(name, column, "all", paths, slow if column == "tables" else nightly)


@pytest.mark.parametrize(("name", "column", "paths"), list(parts()))
def test_every_field_is_used_or_refused(name, column, paths, walk, rough_tables):
    assert not walk.faults(name, column, paths)


def test_the_walk_has_every_field_in_every_column():
    walked = {}
    for name, column, paths in (part.values for part in parts()):
        if name == "contract":
            walked.setdefault(column, []).extend(paths)
    judged = {
        path for path in FIELDS if path.rpartition(".")[2] in JUDGED_BY and not path.startswith("materials.disc.")
    }
    for column, paths in walked.items():
        assert len(paths) == len(set(paths)), column
        assert set(FIELDS) - set(paths) == (judged if column in ("paper", "hybrid", "fe", "direct") else set()), column


@pytest.mark.parametrize(
    "column",
    [
        "tables",
        *(
            pytest.param(column, marks=pytest.mark.slow)
            for column in ("dynamics", "time", "paper", "hybrid", "fe", "direct")
        ),
    ],
)
def test_the_walk_sees_what_is_ignored(column, walk):
    """A column that drops a field in silence is found, beside another that it uses."""
    fields = ("crank.eccentricity", "load.torque")
    assert walk.faults("contract", column, fields, deaf_to="load.torque") == [f"load.torque is ignored by {column}"]


def test_every_exception_is_a_field_with_a_reason():
    for model, exceptions in EXCEPTIONS.items():
        assert set(exceptions) <= set(FIELDS), model
        assert all(len(reason) > 10 for reason in exceptions.values()), model
