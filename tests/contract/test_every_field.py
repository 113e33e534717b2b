"""The contract: every leaf field of a drive moves the answer of every model, or is refused by its name.

Nothing is ignored. Each field of a small drive with every deviation in it is changed as a person could have changed
it; then some number of the answer has to differ, or a `DriveError` has to name the field. What may leave an answer
alone stands in `EXCEPTIONS`, with its reason. Full finite elements and the commands as programs walk the same list in
``benchmarks/contract.py``, which takes minutes; here they are walked by what their solution is a function of.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace, Hybrid, PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.reactions import reaction_values
from ltca.compliance.coefficients import load_coefficients
from ltca.compliance.grids import GridCompliance
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.drive.engine_support import refusal
from ltca.drive.materials import JUDGED_BY
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients
from ltca.testing.field_changes import EXCEPTIONS, change_of, goes_with, leaf_fields, moves, sensible_change

BASE = load_drive(Path(__file__).parent / "drive.toml").cases["nominal"]
ANGLES = np.array([0.5])
# What plane strain cannot say, and what the finite elements refuse, has to be left out of the base to be changed.
PLAIN = with_fields(BASE, {"crank_bearing.roller_length": BASE.disc.thickness})
FULL_FE = with_fields(PLAIN, {"pin_wheel.axis_offset.x": 0.0, "pin_wheel.axis_offset.y": 0.0})


def numbers(analysis):
    """Everything that an analysis found of a case, in one row: poses, loads, pressures, what its dataset is made of."""
    contacts, pressures = analysis.full.response, analysis.pressures
    kinds = (pressures.pins, pressures.outer, pressures.inner, pressures.holes)
    arrays = [
        analysis.full.pose,
        analysis.light.pose,
        analysis.transmission_error,
        contacts.pin_load,
        contacts.hole_load,
    ]
    arrays += [contacts.rollers.outer_load, contacts.rollers.inner_load]
    arrays += [analysis.transmission_error, *map(np.asarray, reaction_values(analysis).values())]
    arrays += [array for kind in kinds for array in (kind.mid, kind.largest, kind.half_width)]
    if analysis.losses is not None:
        found = analysis.losses
        arrays += [found.watts(found.total), found.input_torque, found.efficiency, analysis.losses_back.input_torque]
    return np.concatenate([array.ravel() for array in arrays])


def tables(drive):
    return numbers(analyse(drive, ANGLES))


def direct(drive):
    """Grids inside every iteration; few cells, for the sake of time: which fields count does not depend on them."""
    HalfSpace(method="direct").prepare(drive)  # which refuses what grids cannot say
    drive = warm_drive(drive)
    singles = single_discs(drive)
    tables = Reducer.of_drive(drive, [HalfSpaceCompliance.of_drive(single) for single in singles])
    near = solve_at_output(tables, [drive], ANGLES[:1], drive.load.torque)
    model = replace(tables, discs=tuple(GridCompliance.of_drive(single, cells=4) for single in singles))
    found = solve_at_output(model, [drive], ANGLES[:1], drive.load.torque, near.pose)
    pressures = model.pressures(found.response)
    kinds = (pressures.pins, pressures.outer, pressures.inner, pressures.holes)
    turned = drive.output_deviation(found.pose[:, -1], drive.load.torque)
    return np.concatenate(
        [found.pose.ravel(), turned, *(kind.mid.ravel() for kind in kinds), *(k.largest.ravel() for k in kinds)]
    )


def paper(drive):
    prepared = HalfSpace(method="paper").prepare(drive)
    model, found = prepared.model, prepared.balance(ANGLES, drive.load.torque)
    pressures = model.pressures(found.response)
    kinds = (pressures.pins, pressures.outer, pressures.inner, pressures.holes)
    return np.concatenate(
        [found.pose.ravel(), *(kind.mid.ravel() for kind in kinds), *(k.largest.ravel() for k in kinds)]
    )


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


@pytest.fixture(scope="module")
def models(coefficients):
    return {
        "tables": (BASE, tables),
        "direct": (BASE, direct),
        "paper": (BASE, paper),
        "hybrid": (
            BASE,
            lambda drive: numbers(analyse(drive, ANGLES, engine=Hybrid(coefficients=coefficients(drive)))),
        ),
        "fe": (
            PLAIN,
            lambda drive: numbers(analyse(drive, ANGLES, engine=PlaneStrain(coefficients=coefficients(drive)))),
        ),
    }


@pytest.fixture(scope="module")
def answers():
    return {}


def general(path):
    """The path of a field as it is told: entry 0 stands for any."""
    return path.replace(".0.", ".N.")


def known(answers, model, base, answer):
    """The answer of a model to a drive that several fields start from, found once."""
    key = (model, repr(base))
    if key not in answers:
        answers[key] = answer(base)
    return answers[key]


# Engines beyond the first are walked at night; what is slow of the first stays in every full run.
ENGINES = [
    "tables",
    *(pytest.param(model, marks=[pytest.mark.slow, pytest.mark.nightly]) for model in ("hybrid", "fe")),
]


def walk():
    """Every field of every model; quick are the half-space tables of cylinders, what is told twice once."""
    for model in ("tables", "paper", "hybrid", "fe", "direct"):
        for path in leaf_fields():
            if model != "tables" and path.rpartition(".")[2] in JUDGED_BY and not path.startswith("materials.disc."):
                continue  # no engine sees what results are judged by; the disc's are walked by every one
            judges = path.rpartition(".")[2] in JUDGED_BY and not path.startswith("materials.disc.")
            # One disc's own part errors go the way of those of all, other materials' limits that of the disc's.
            dear = model != "tables" or "_profile." in path or path.startswith("disc.of.") or judges
            # Of two components or materials, and of errors of a part, one stands for both; of a table every fourth field.
            second = path.endswith((".y", ".tangential", ".poisson_ratio", ".thermal_expansion"))
            dear = dear or second or leaf_fields().index(path) % 4 != 0
            marks = [pytest.mark.slow] if dear else []
            marks += [pytest.mark.nightly] if model != "tables" or judges else []
            yield pytest.param(model, path, id=f"{model}-{path}", marks=marks)


@pytest.mark.parametrize(("model", "path"), list(walk()))
def test_every_field_is_used_or_refused(model, path, models, answers, coarse_tables):
    base, answer = models[model]
    base, change = change_of(base, path)
    refused = ""
    try:
        after = answer(with_fields(base, change))
    except DriveError as error:
        refused = str(error)
    if refused:
        # What a part is made of goes with what the drive has it for.
        assert goes_with(path) in refused or path in refused, f"{path} is refused without its name: {refused}"
        if refusal(model, general(path)) is None and refusal(model, goes_with(path)) is None and model != "tables":
            # What `cyclo fields` tells of no engine may be refused of a drive as such: then by the half-space as well.
            with pytest.raises(DriveError):
                tables(with_fields(base, change))
        return
    assert refusal(model, general(path)) is None, f"{path} is told to be refused by {model} (engine_support)"
    before = known(answers, model, base, answer)
    if path in EXCEPTIONS[model]:
        assert not moves(before, after), f"{path} is listed as an exception of {model} but moves the answer"
    else:
        assert moves(before, after), f"{path} is ignored by {model}"


OF_SEVERAL_CRANKS = [
    "installation.held",
    "installation.first_stage_ratio",
    *(path for path in leaf_fields() if path.startswith(("first_stage.", "load.external."))),
    "crank.number",
    "crank.circle_radius",
    "crank.angle",
    "crank.eccentricity_error",
    "crank.support.diameter",
    "crank.support.positions",
    "crank.support.stiffness",
    "carrier.stiffness_torsion",
    "carrier.posts.size",
    "materials.carrier.youngs_modulus",
    "crank.support.clearance",
    "crank.support.torsion",
    "crank.support.spline_plane",
    "main_bearing.clearance",
    "crank.of.0.eccentricity_error",
    "crank.of.0.phase_error",
    "disc.of.0.bore_errors.radial",
    "disc.of.0.bore_errors.tangential",
    "disc.planes",
    "pin_wheel.support_stiffness",
    "clearance.bearing",
    "materials.crankshaft.youngs_modulus",
]


@pytest.mark.slow
@pytest.mark.parametrize("model", ENGINES)
@pytest.mark.parametrize("path", OF_SEVERAL_CRANKS)
def test_fields_of_several_cranks_are_used(path, model, models, answers):
    """The walk above starts from a central crank; what several have is looked at on an RV reducer."""
    _, answer = models[model]
    base = parse_drive(shipped_drive("rv"), "rv").cases["nominal"]
    base, change = change_of(base, path)
    change |= {"crank.circle_radius": {path: 40.0}, "disc.planes": {path: (-9.0, 9.0)}}.get(path, {})
    assert moves(known(answers, model, base, answer), answer(with_fields(base, change)))


OF_LOOSE_PINS = [
    pytest.param("pin_wheel.pin_errors.diameter", marks=pytest.mark.slow),
    "pin_shaft.beam.tip",
    "disc.planes",
    pytest.param("materials.wheel_pin.youngs_modulus", marks=pytest.mark.slow),
    pytest.param("materials.shaft_pin.youngs_modulus", marks=pytest.mark.slow),
    pytest.param("materials.shaft_pin.poisson_ratio", marks=pytest.mark.slow),
    "materials.sleeve.youngs_modulus",
    pytest.param("materials.sleeve.poisson_ratio", marks=pytest.mark.slow),
]


@pytest.mark.slow
@pytest.mark.parametrize("model", ENGINES)
@pytest.mark.parametrize("path", OF_LOOSE_PINS)
def test_fields_of_loose_pins_are_used(path, model, models, answers):
    """The walk above starts from one disc and has sleeves on the wheel; here two discs bend pins, sleeves are on the shaft."""
    _, answer = models[model]
    base = parse_drive(shipped_drive("sleeved"), "sleeved").cases["nominal"]
    change = {path: sensible_change(base, path)} | ({path: (-6.5, 6.5)} if path == "disc.planes" else {})
    assert moves(known(answers, model, base, answer), answer(with_fields(base, change)))


def test_the_walk_sees_what_is_ignored(answers):
    """A model that drops a field in silence is found."""
    path = "crank.axis_offset.x"
    base, change = change_of(BASE, path)
    deaf = with_fields(with_fields(base, change), {path: 0.002})
    assert not moves(tables(base), tables(deaf))
    assert moves(tables(base), tables(with_fields(base, change)))


def test_every_exception_is_a_field_with_a_reason():
    for model, exceptions in EXCEPTIONS.items():
        assert set(exceptions) <= set(leaf_fields()), model
        assert all(len(reason) > 10 for reason in exceptions.values()), model
