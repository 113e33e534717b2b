"""Coupled compliance: the half-space as its limit, its tangent, symmetry, and coefficients of the real bodies."""

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_is, refused_field

from fem.coefficients.dataset import derive_coefficients
from ltca.analysis.engines import Hybrid
from ltca.analysis.loaded_analysis import analyse
from ltca.compliance.coefficients import load_coefficients
from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.errors import DriveError
from ltca.geometry.boundary_stations import Boundary
from ltca.geometry.pairs import ContactGeometry
from ltca.mechanics.answers import disc_response
from ltca.mechanics.contacts import CANDIDATE_MARGIN, ContactSystem, Linearised
from ltca.testing.closed_form_bodies import without_coupling

ANGLES = np.array([0.0, 0.5, 1.7, 4.0])


@pytest.fixture(scope="module")
def derived(paper_cases, tmp_path_factory):
    """Coarse coefficients of the paper's drive: half the stations on elements of twice the size, in seconds."""
    path = tmp_path_factory.mktemp("coefficients") / "coarse.nc"
    made = derive_coefficients(paper_cases["CS-1"], stations=0.5, size=2.0, keep_clearance=False)
    made.to_netcdf(path, engine="h5netcdf")
    return path


def test_without_coupling_it_is_the_half_space(paper_cases):
    for case in ("CS-1", "CS-6"):
        drive = paper_cases[case]
        coupled = CoupledCompliance.of_drive(drive, without_coupling(drive), "half-space", hole_near_field=False)
        plain = HalfSpaceCompliance.of_drive(drive)
        found = solve_equilibrium(Reducer(discs=(coupled,)), ANGLES, drive.wheel_moment())
        expected = solve_equilibrium(Reducer(discs=(plain,)), ANGLES, drive.wheel_moment())
        # Both stop at 1e-9 of the load; near-field approaches settle to 1e-13 mm, 1e-7 N.
        np.testing.assert_allclose(found.response.pin_load, expected.response.pin_load, atol=1e-5)
        np.testing.assert_allclose(found.response.hole_load, expected.response.hole_load, atol=1e-5)
        np.testing.assert_allclose(found.response.rollers.outer_load, expected.response.rollers.outer_load, atol=1e-5)
        np.testing.assert_allclose(found.pose, expected.pose, atol=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("near_field", ["plane-strain", "half-space"])
def test_tangent_and_approaches_of_the_real_bodies(paper_cases, derived, near_field):
    drive = paper_cases["CS-3"]
    model = Reducer(discs=(CoupledCompliance.of_drive(drive, load_coefficients(derived, drive), near_field),))
    angle = np.array([0.5])
    pose = solve_equilibrium(model, angle, drive.wheel_moment()).pose
    response = model.respond(angle, pose)
    step = np.array([1e-6, 1e-6, 1e-8, 1e-8])
    numeric = np.empty((4, 4))
    for column in range(4):
        shift = np.zeros((1, 4))
        shift[0, column] = step[column]
        up, down = model.respond(angle, pose + shift), model.respond(angle, pose - shift)
        numeric[:, column] = (up.force - down.force)[0] / (2.0 * step[column])
    lever = np.array([1.0, 1.0, 52.0, 56.0])
    scaled = response.tangent[0] / np.outer(lever, lever)
    # The change of the coefficients with the place is left out of the tangent: some 1e-4 of it.
    np.testing.assert_allclose(numeric / np.outer(lever, lever), scaled, atol=2e-3 * np.abs(scaled).max())
    np.testing.assert_allclose(scaled, scaled.T, atol=1e-9 * np.abs(scaled).max())
    # A pair is pressed together exactly where it carries.
    assert np.array_equal(response.flank.approach > 0.0, response.pin_load > 0.0)
    assert np.array_equal(response.rollers.outer_approach > 0.0, response.rollers.outer_load > 0.0)
    # The overlap of the undeformed bodies is the pair's own approach and what all others add.
    overlap = ContactGeometry.of_drive(drive).flank(angle, pose).approach
    assert np.all(np.abs(overlap - response.flank.approach)[response.pin_load > 0.0] < 5e-3)


@pytest.mark.slow
def test_softer_bodies_wind_up_more_and_share_more(paper_cases, derived):
    drive = paper_cases["CS-1"]
    coefficients = load_coefficients(derived, drive)
    plain = analyse(drive, ANGLES)
    hybrid = analyse(drive, ANGLES, engine=Hybrid(coefficients=coefficients))
    assert np.all(hybrid.full.pose[:, 3] < plain.full.pose[:, 3])
    assert np.max(hybrid.full.residual) < 1e-6 * 6737.5
    assert hybrid.full.response.hole_load.max() < plain.full.response.hole_load.max()
    assert hybrid.engine.compliance == "hybrid"


def enlarged(drive, factor):
    """The drive with all lengths times a factor under loads times its square."""
    longer = {
        "crank": ("eccentricity",),
        "pin_wheel": ("pin_circle_radius", "pin_radius"),
        "disc": ("thickness", "equidistant_offset", "shifting_offset"),
        "crank_bearing": ("inner_race_radius", "outer_race_radius", "roller_radius", "roller_length"),
        "pin_shaft": ("pin_circle_radius", "pin_radius", "hole_radius", "stiffness"),  # N/mm: force by length
        "clearance": ("bearing", "pin_hole"),
    }
    members = {
        name: replace(getattr(drive, name), **{field: factor * getattr(getattr(drive, name), field) for field in names})
        for name, names in longer.items()
    }
    load = replace(drive.load, torque=factor**3 * drive.load.torque, light_torque=factor**3 * drive.load.light_torque)
    return replace(drive, load=load, **members)


@pytest.mark.slow
def test_a_drive_a_hundred_times_as_large_carries_alike(paper_cases, closed_form):
    """Similarity. Residuals of near fields then end in the round-off of 9 m, some 1e-12 mm, above what is asked of 9 cm."""
    drive, loads = paper_cases["CS-6"], []
    for factor in (1.0, 100.0):
        large = enlarged(drive, factor)
        coefficients = closed_form(large, half_width=0.05 * factor, depth=300.0 * factor)
        model = CoupledCompliance.of_drive(large, coefficients, "plane-strain")
        response = solve_equilibrium(Reducer(discs=(model,)), ANGLES, large.wheel_moment()).response
        loads.append(np.hstack([response.pin_load, response.hole_load, response.rollers.outer_load]) / factor**2)
    # Both stop at 1e-9 of the load.
    np.testing.assert_allclose(loads[1], loads[0], rtol=0.0, atol=3e-9 * loads[0].max())


def test_coefficients_of_other_bodies_are_refused(paper_cases):
    """An analysis never took notice of whose coefficients it was given."""
    drive = paper_cases["CS-1"]
    foreign = without_coupling(replace(drive, crank=replace(drive.crank, eccentricity=3.9)))
    with pytest.raises(DriveError, match="must be those of paper"):
        CoupledCompliance.of_drive(drive, foreign, "half-space")
    lent = foreign.lent_to(drive)
    assert lent.shared
    assert not foreign.shared
    assert CoupledCompliance.of_drive(drive, lent, "half-space").coefficients.shared
    fewer = replace(drive, pin_shaft=replace(drive.pin_shaft, number_of_pins=6))
    with refused_field("pin_shaft.number_of_pins", "= 6", bound=("equal to", 8)):
        foreign.lent_to(fewer)


def test_unknown_near_fields_are_refused(paper_cases):
    drive = paper_cases["CS-1"]
    with error_is(DriveError, "near_field = 'hybrid': must be one of 'plane-strain', 'half-space'"):
        CoupledCompliance.of_drive(drive, without_coupling(drive), "hybrid")


def test_interpolation_is_exact_for_low_harmonics():
    boundary = Boundary(first=3, count=24)
    nodes = 2.0 * np.pi * np.arange(24) / 24
    values = np.concatenate((np.zeros(3), np.cos(2.0 * nodes + 0.3)))
    places = np.linspace(-7.0, 7.0, 101)
    stations, weights = boundary.weights(places)
    found = (values[stations] * weights).sum(axis=-1)
    # Six points at a spacing of 15° on the second harmonic: (h k)^6 · 225/46080 ≈ 1e-4.
    np.testing.assert_allclose(found, np.cos(2.0 * places + 0.3), atol=2e-4)
    np.testing.assert_allclose(weights.sum(axis=-1), 1.0, atol=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize("near_field", ["plane-strain", "half-space"])
def test_contacts_that_are_left_out_change_nothing(paper_cases, closed_form, monkeypatch, near_field):
    """Only contacts near to closing are unknowns; the answer is that of all of them, whichever were left out."""
    drive = paper_cases["CS-6"]
    model = Reducer(discs=(CoupledCompliance.of_drive(drive, closed_form(drive), near_field),))
    pose = solve_equilibrium(model, ANGLES, drive.wheel_moment()).pose
    system = ContactSystem(model)
    near, every = (system.respond(ANGLES, pose, None, roughly=False, everything=all_) for all_ in (False, True))
    assert near.count < every.count == system.contacts
    few, everything = (disc_response(at, 0) for at in (near, every))
    loads = np.abs(every.corrected_load[:, 0])
    approach, within, asked = Linearised._approach, Linearised._within, []

    def overlooked(at):
        """What carries most, where contacts are left out at all."""
        found = np.zeros(loads.shape, dtype=bool)
        for kind in system.of_kind[0] if np.isfinite(at.margin) else ():
            found[:, kind] = loads[:, kind] > 0.5 * loads[:, kind].max(axis=1, keepdims=True)
        return found

    def blind(at, state):
        """Leaves them out as if they were open, but for those that fill up a row: found out, and made good."""
        approach(at, state)
        asked.append(at.margin)
        hidden = overlooked(at)
        if at.before is not None:
            hidden[at.row, at.before.contacts] = False
        at.deformation = np.where(hidden[:, None], -1.0, at.deformation)

    monkeypatch.setattr(Linearised, "_approach", blind)
    monkeypatch.setattr(Linearised, "_within", lambda at: within(at) & ~overlooked(at))
    mended = model.respond(ANGLES, pose)
    assert list(dict.fromkeys(asked)) == [CANDIDATE_MARGIN, np.inf]
    for other, tangent in ((few, near.tangent), (mended, mended.tangent)):
        # Near fields settle to 1e-13 mm, at some 1e6 N/mm.
        for name in ("pin_load", "hole_load"):
            np.testing.assert_allclose(getattr(other, name), getattr(everything, name), atol=1e-6)
        np.testing.assert_allclose(other.force, everything.force, atol=1e-6 * 56.0)
        np.testing.assert_allclose(other.flank.approach, everything.flank.approach, atol=1e-12)
        np.testing.assert_allclose(other.rollers.outer_approach, everything.rollers.outer_approach, atol=1e-12)
        scale = np.abs(every.tangent).max()
        np.testing.assert_allclose(tangent, every.tangent, atol=1e-9 * scale)
