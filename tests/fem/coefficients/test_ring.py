"""The plane finite-element ring: closed forms, the curved beam where it holds, laws, and what a drive makes of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says, refused_field

from fem.body import pin_ring
from fem.body.pin_ring import flexibility_of, seat_flexibility, seat_loads
from fem.coefficients.ring import derive_ring
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_pin_ring
from fem.shapes import PinRingShape, SlottedCircle
from ltca.analysis.derivatives import derivatives
from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.commands.program import main
from ltca.compliance import ring as rings
from ltca.compliance.ring import ring_flexibility, slot_yield
from ltca.drive.ring_shape import DEEP_SEATS, deep_seats_warning, ring_fingerprint
from ltca.errors import CycloError, DamagedFileError
from ltca.laws.ring_beam import RingBeam
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.reading.ring_file import check_ring, read_ring, write_ring

NO_BOLTS = np.zeros(0, dtype=complex)
SIZES = {"inner_radius": 60.5, "outer_radius": 72.0, "width": 30.0, "model": "fe"}


def shape_of(inner, outer, circle, seat, pins):
    return PinRingShape(
        inner=SlottedCircle(radius=inner, seats=pins, seat_circle_radius=circle, seat_radius=seat), outer_radius=outer
    )


@pytest.fixture(scope="module")
def small():
    """A ring of few seats, on a coarse mesh."""
    return shape_of(20.2, 26.0, 20.0, 1.5, 6)


@pytest.fixture(scope="module")
def coarse(small):
    return flexibility_of(small, NO_BOLTS, 0.3, 0.3, size=2.0)


@pytest.fixture(scope="module")
def joint():
    drive = load_drive("robot-joint").cases["nominal"]
    return with_fields(drive, {"ring": SIZES})


@pytest.fixture
def derived(monkeypatch, tmp_path):
    """An empty cache, and rings derived on coarse meshes."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(rings, "_KNOWN", {})
    monkeypatch.setattr(rings, "derivation", lambda name: lambda drive: derive_ring(drive, size=2.0))
    return tmp_path


@pytest.mark.parametrize("inner", [19.2, 20.0, 20.9])
def test_the_inner_boundary_is_closed_and_its_area_exact(inner):
    shape = shape_of(inner, 26.0, 20.0, 1.5, 6)
    curve = shape.inner
    parameter = np.linspace(0.0, 2.0 * np.pi, 200_001)
    points = curve.points(parameter)
    assert np.abs(points[0] - points[-1]) < 1e-9
    # Chords of a seat of 1.5 mm leave a circle's area by less than 1e-7 of it.
    hole = 0.5 * float(np.sum((points[:-1].conjugate() * np.diff(points)).imag))
    assert np.pi * 26.0**2 - hole == pytest.approx(shape.area, rel=1e-6)
    corners = curve.points(np.array(curve.corners))
    np.testing.assert_allclose(np.abs(corners), inner, rtol=1e-12)
    np.testing.assert_allclose(np.min(np.abs(corners[:, None] - curve.seat_centres), axis=1), 1.5, rtol=1e-12)
    # Round-off of an angle at corners, where two pieces are equally near.
    back = curve.points(curve.parameter_of(points))
    np.testing.assert_allclose(back, points, atol=1e-9)
    # Metal lies on the other side of the normal.
    off = points - 1e-4 * curve.normals(parameter)
    inside = (np.abs(off) > inner) & (np.min(np.abs(off[:, None] - curve.seat_centres), axis=1) > 1.5)
    assert np.mean(inside) > 0.999  # but for points at corners


def test_a_seat_carries_the_force_without_moment(small):
    balls = [Refinement(float(c.real), float(c.imag), 0.3, 1.6) for c in small.inner.seat_centres]
    body = mesh_pin_ring(small, balls, coarse_size=2.0)
    loads = seat_loads(body, small.inner).toarray()
    force = np.stack([loads[0::2].sum(axis=0), loads[1::2].sum(axis=0)])
    np.testing.assert_allclose(force, np.tile(np.eye(2), 6), atol=1e-12)  # by construction: round-off
    x, y = body.mesh.doflocs
    moment = x @ loads[1::2] - y @ loads[0::2]
    centre = small.inner.seat_centres
    expected = np.stack([-centre.imag, centre.real], axis=1).ravel()
    # Normal pressure on a circle has no moment about its centre; edges leave the circle by 1e-5 of its radius.
    np.testing.assert_allclose(moment, expected, atol=1e-3)


def test_equal_seats_are_equal_and_free_rings_have_no_rigid_motion(small, coarse):
    # Errors of a mesh with some six edges for a seat, before they are averaged.
    assert coarse.turned < 1e-4
    assert coarse.mirror < 1e-4
    matrix = coarse.flexibility.reshape(12, 12)
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-9 * matrix.max())
    values = np.linalg.eigvalsh(matrix)
    assert np.abs(values[:3]).max() < 1e-9 * values[-1]
    assert values[3] > 0.0


def beyond_the_beam(seat):
    """By how much a free ring of 100 … 110 mm with 60 half-slots of a radius yields more than its beam, in cosine rows."""
    found = flexibility_of(shape_of(100.0, 110.0, 100.0, seat, 60), NO_BOLTS, 0.5, 0.3, size=2.0).flexibility
    angle = 2.0 * np.pi * np.arange(60) / 60
    beam = RingBeam(inner_radius=100.0, outer_radius=110.0, width=1.0, youngs_modulus=1.0, poisson_ratio=0.3)
    closed = beam.free(angle, 100.0)
    radial = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    rows = [(radial * np.cos(order * angle)[:, None]).ravel() for order in (2, 3, 4)]
    own, other = ([row @ each.reshape(120, 120) @ row for row in rows] for each in (found, closed))
    return np.array(own) / other - 1.0


@pytest.mark.slow
def test_the_thin_ring_of_small_seats_is_the_curved_beam():
    """h/R = 0.1, 60 seats of h/40: cosine rows of radial forces, by the ring and by the beam, within 1 %.

    What is left at the seats themselves counts little against rows that bend the ring; it is 0.8 % at order 2.
    """
    np.testing.assert_allclose(beyond_the_beam(0.25), 0.0, atol=0.01)


@pytest.mark.slow
def test_beams_are_warned_of_where_seats_make_a_tenth():
    """The bound is read between rings of other seats (`docs/theory/ring_elements.md`); here is one with seats of that depth."""
    beyond = beyond_the_beam(10.0 * DEEP_SEATS)
    # Between 3.3 and 92 % it is interpolated by a power: a third of the tenth tells it from depths of 0.07 and 0.1.
    np.testing.assert_allclose(beyond, 0.1, atol=0.033)


def test_a_beam_with_deep_seats_is_warned_of():
    drive = load_drive("robot-joint").cases["nominal"]  # pins of 2.5 mm on 60 mm

    def told(**fields):
        return deep_seats_warning(with_fields(drive, {"ring": {"inner_radius": 60.0, "width": 30.0, **fields}}))

    assert deep_seats_warning(drive) is None
    assert told(outer_radius=90.0) is None  # 2.5 of 30 mm
    words = told(outer_radius=85.0)
    assert "2.5 mm deep, 0.1 of the radial height of the ring (25 mm)" in words
    assert 'ring.model = "fe"' in words
    assert told(outer_radius=85.0, bolts={"number": 12, "circle_radius": 75.0, "stiffness": 1e6}) == words
    assert told(outer_radius=85.0, model="fe") is None
    assert told(outer_radius=85.0, flange="built-in") is None
    ringed = with_fields(drive, {"ring": {"inner_radius": 60.0, "outer_radius": 85.0, "width": 30.0}})
    assert words in analyse(ringed, [0.4], engine=HalfSpace()).warnings


@pytest.mark.slow
def test_fewer_elements_change_little(small, coarse):
    fine = flexibility_of(small, NO_BOLTS, 0.3, 0.3, size=1.0)
    largest = np.max(np.abs(fine.flexibility))
    assert np.max(np.abs(fine.flexibility - coarse.flexibility)) < 2e-3 * largest  # 0.5e-3 measured


def test_a_ring_on_stiff_bolts_all_around_is_held(small):
    """Bolts that do not yield leave less than a ring held all around leaves, plus what the metal between them gives."""
    angle = 2.0 * np.pi * np.arange(12) / 12
    bolts = 24.0 * np.exp(1j * angle)
    assert bolts.size == 12
    found = flexibility_of(small, bolts, 0.3, 0.3, size=2.0)
    free = flexibility_of(small, NO_BOLTS, 0.3, 0.3, size=2.0)
    held = flexibility_of(small, NO_BOLTS, 0.3, 0.3, held=True, size=2.0)
    from ltca.laws.ring_beam import on_bolts, rigid_motions

    places = np.concatenate([small.inner.seat_centres, bolts])
    modes = rigid_motions(np.angle(places), np.abs(places)).reshape(-1, 3)
    matrix = found.flexibility.reshape(36, 36)
    stiff = on_bolts(matrix, modes, 6, 1e9).reshape(12, 12)
    soft = on_bolts(matrix, modes, 6, 1e-9).reshape(12, 12)
    # Soft bolts: a free ring but for its rigid motion, which a row of forces in equilibrium does not see.
    row = np.concatenate([[1.0, 0.0], np.zeros(4), [-1.0, 0.0], np.zeros(4)])
    assert row @ soft @ row == pytest.approx(row @ free.flexibility.reshape(12, 12) @ row, rel=1e-3)  # of the meshes
    whole, bolted = row @ held.flexibility.reshape(12, 12) @ row, row @ stiff @ row
    assert 0.5 * whole < bolted < row @ free.flexibility.reshape(12, 12) @ row


def test_slots_yield_like_a_plate_under_the_even_harmonics():
    """By the table of `ltca.laws.conforming`: a pressure of one harmonic cos θ all around is Michell's n = 1 alone."""
    kappa, shear = 2.7 / 1.3, 1.0 / 2.6
    radial, tangential = slot_yield(np.pi, 0.3, 3.0)
    closed = (2.0 * kappa / (kappa + 1.0) * np.log(3.0) + 0.5) / (4.0 * np.pi * shear)
    assert radial == pytest.approx(closed, rel=1e-9)
    assert tangential == pytest.approx(closed, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("half_arc", [pytest.param(0.5 * np.pi, marks=pytest.mark.nightly), np.pi / 3.0])
def test_slots_yield_like_a_plate_of_finite_elements(half_arc):
    from scipy.interpolate import CloughTocher2DInterpolator
    from scipy.sparse.linalg import spsolve

    from fem.body.elasticity import assemble_stiffness, traction_load, unknowns_of_boundary
    from fem.mesh.triangulation import mesh_ring
    from fem.shapes import RingShape
    from ltca.drive.materials import Material

    body = mesh_ring(
        RingShape(inner_radius=1.0, outer_radius=200.0), [Refinement(0.0, 0.0, 0.05, 1.2)], coarse_size=15.0, growth=0.2
    )
    steel = Material(youngs_modulus=1.0, poisson_ratio=0.3)
    stiffness = assemble_stiffness(body, steel, thickness=1.0, state="stress")
    free = np.setdiff1d(np.arange(stiffness.shape[0]), unknowns_of_boundary(body, "outer"))
    x, y = body.mesh.doflocs
    near, around = (np.hypot(x, y) > 2.0) & (np.hypot(x, y) < 4.5), 2.0 * np.pi * np.arange(400) / 400
    expected = slot_yield(half_arc, 0.3, 3.0)
    for which, (wave, sign) in enumerate(((np.cos, 1.0), (np.sin, -1.0))):
        whole = half_arc + sign * 0.5 * np.sin(2.0 * half_arc)

        def pressure(places, _, wave=wave, whole=whole):
            angle = np.arctan2(places[1], places[0])
            amount = wave(angle) / whole * (np.abs(angle) < half_arc)
            return amount * np.cos(angle), amount * np.sin(angle)

        force, moved = traction_load(body, "inner", pressure, thickness=1.0), np.zeros(stiffness.shape[0])
        moved[free] = spsolve(stiffness[free][:, free].tocsc(), force[free])
        circle = CloughTocher2DInterpolator(np.column_stack([x[near], y[near]]), moved[which::2][near])
        datum = float(np.mean(circle(3.0 * np.cos(around), 3.0 * np.sin(around))))
        # Pressure that ends within an edge, and a body of 200 radii: 3e-4 measured.
        assert force @ moved - datum == pytest.approx(expected[which], rel=1e-3)


@pytest.mark.slow
def test_a_run_derives_the_ring_once_and_says_so(joint, derived, capsys):
    angle = np.array([0.5])
    found = analyse(joint, angle)
    assert capsys.readouterr().err.count("deriving the ring of robot-joint, once for each shape") == 1
    rings._KNOWN.clear()
    again = analyse(joint, angle)
    assert "deriving" not in capsys.readouterr().err
    np.testing.assert_array_equal(found.full.response.pin_load, again.full.response.pin_load)
    rigid = analyse(replace(joint, ring=None), angle)
    assert found.full.response.pin_load.max() < 0.95 * rigid.full.response.pin_load.max()


@pytest.mark.slow
def test_modulus_width_and_bolts_take_no_new_derivation(joint, derived):
    key = ring_fingerprint(joint)
    for change in ({"ring.width": 20.0}, {"ring.material.youngs_modulus": 1.1e5}, {"load.torque": 1e5}):
        assert ring_fingerprint(with_fields(joint, change)) == key, change
    bolted = with_fields(joint, {"ring.bolts": {"number": 8, "circle_radius": 68.0, "stiffness": 5e5}})
    softer = with_fields(bolted, {"ring.bolts.stiffness": 1e5})
    assert ring_fingerprint(bolted) == ring_fingerprint(softer) != key
    half = ring_flexibility(with_fields(joint, {"ring.width": 60.0}))
    np.testing.assert_allclose(2.0 * half, ring_flexibility(joint), rtol=1e-12)
    for change in ({"ring.inner_radius": 60.6}, {"ring.flange": "built-in"}, {"pin_wheel.pin_radius": 2.49}):
        assert ring_fingerprint(with_fields(joint, change, check=False)) != key, change


@pytest.mark.slow
def test_damaged_and_foreign_files_are_told(joint, derived, tmp_path, capsys):
    path = tmp_path / "ring.nc"
    dataset = derive_ring(joint, size=2.0)
    write_ring(dataset, path)
    assert all(check.passed for check in check_ring(read_ring(path)))
    wrong = dataset.copy(deep=True)
    wrong["flexibility"].values[0, 0, 1, 1] *= 3.0
    write_ring(wrong, path)
    with error_says(DamagedFileError, "breaks laws of a ring's flexibility ", ": symmetry is"):
        read_ring(path)
    write_ring(dataset.assign(flexibility=-dataset["flexibility"]), path)
    with pytest.raises(DamagedFileError, match="smallest eigenvalue is"):
        read_ring(path)
    write_ring(dataset.drop_vars("flexibility"), path)
    with error_says(DamagedFileError, "is no file of a ring's flexibility ", ": it lacks flexibility"):
        read_ring(path)
    # In the cache a damaged file is made again.
    kept = rings.kept_file(rings.file_name(joint))
    ring_flexibility(joint)
    kept.write_bytes(kept.read_bytes()[:2000])
    rings._KNOWN.clear()
    ring_flexibility(joint)
    assert "derived again" in capsys.readouterr().err


@pytest.mark.slow
def test_the_command_derives_and_checks(joint, tmp_path, capsys):
    from ltca.reading.writing import drive_text

    drive, out = tmp_path / "joint.toml", tmp_path / "ring.nc"
    drive.write_text(drive_text(joint), encoding="utf-8")
    assert main(["derive", str(drive), "--part", "ring", "--size", "2", "--out", str(out)]) == 0
    told = capsys.readouterr().out
    assert "40 seats, 0 bolts" in told
    assert told.count(" ok\n") == 6
    assert main(["derive", "--check", str(out), str(drive)]) == 0
    assert "ring, 40 seats and bolts" in capsys.readouterr().out
    for words, said in (
        (["derive", "--check", str(out), "paper"], "belongs to a ring, and paper has none"),
        (["derive", "paper", "--part", "ring"], "ring: is left out in this drive; there is no ring to derive"),
        (["derive", str(drive), "--part", "ring", "--stations", "2"], "--stations: has no meaning with --part ring"),
        (["derive", str(drive), "--part", "ring", "--out", str(drive)], "is no file of a ring that cyclo derive wrote"),
    ):
        assert main(words) == 2
        assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "path", "value", "said", "bound"),
    [
        (
            {"inner_radius": 57.6}, "ring.inner_radius", "= 57.6 mm", "metal between two seats",
            ("at least", pytest.approx(57.725, abs=0.005)),
        ),
        (
            {"inner_radius": 62.2}, "ring.inner_radius", "= 62.2 mm", "the seats are too flat",
            ("at most", pytest.approx(61.795, abs=0.005)),
        ),
        (
            {"bolts": {"number": 8, "circle_radius": 72.0, "stiffness": 5e5}}, "ring.bolts.circle_radius", "= 72 mm",
            "must be 63.45 to 71.05 mm for finite elements of the ring, in metal", None,
        ),
    ],
)  # fmt: skip
def test_rings_that_cannot_be_meshed_are_refused_by_name(joint, change, path, value, said, bound):
    with refused_field(path, value, "for finite elements of the ring", bound=bound) as caught:
        with_fields(joint, {"ring": SIZES | change})
    assert said in str(caught.value)
    beam = with_fields(joint, {"ring": SIZES | {"model": "beam"} | change})
    with refused_field(path, value, said, bound=bound):  # the ring of full finite elements, whatever the model
        seat_flexibility(beam)


def test_rings_of_full_solutions_have_the_elements_of_derived_ones(joint, small, monkeypatch):
    """Their flexibilities are compared to 1e-4, less than the mesh leaves of each: neither is asked for a size."""
    sizes = []

    def stop(shape, bolts, patch, size):
        sizes.append(size)
        raise InterruptedError

    monkeypatch.setattr(pin_ring, "mesh_ring_for_seats", stop)
    for solve in (lambda: seat_flexibility(joint), lambda: flexibility_of(small, NO_BOLTS, 0.3, 0.3)):
        with pytest.raises(InterruptedError):
            solve()
    assert sizes == [1.0, 1.0]


@pytest.mark.slow
def test_nothing_installed_that_derives_is_said(joint, derived, monkeypatch):
    from ltca.compliance import coefficient_files

    monkeypatch.setattr(coefficient_files, "entry_points", lambda group: ())
    monkeypatch.setattr(rings, "derivation", coefficient_files.derivation)
    with error_says(CycloError, 'ring.model = "fe": nothing is installed that derives a ring'):
        ring_flexibility(joint)


@pytest.mark.slow
def test_derivatives_by_what_reshapes_the_ring_are_refused(derived):
    """Differences of two meshes of the ring are noise; of what only scales its flexibility they are not."""
    drive = load_drive("paper").cases["CS-1"]
    sizes = {"inner_radius": 88.5, "outer_radius": 106.0, "width": 20.0, "model": "fe"}
    found = analyse(with_fields(drive, {"ring": sizes}), np.array([0.5]))
    for path in ("ring.inner_radius", "pin_wheel.pin_radius", "ring.material.poisson_ratio"):
        with refused_field(path, "", "reshapes the ring"):
            derivatives(found, [path])
    slopes = derivatives(found, ["ring.width"])
    wider, narrower = (
        analyse(with_fields(drive, {"ring": sizes | {"width": width}}), np.array([0.5])) for width in (20.02, 19.98)
    )
    turned = (wider.transmission_error - narrower.transmission_error) / 0.04
    slope = float(slopes["transmission_error"].values.ravel()[0])
    assert slope == pytest.approx(float(turned[0]), rel=1e-4)  # a central difference over a thousandth
