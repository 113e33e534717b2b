"""Results along the width: what slices carry balances, mirrors, and turns with the whole drive."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refusals import error_says

from ltca.analysis.life.bearing_lives import bearing_lives
from ltca.analysis.loaded_analysis import analyse, analyse_cases
from ltca.analysis.pressure_fields import loads_of, moment_of, pressure_field
from ltca.analysis.results import build_dataset, check_common_shape
from ltca.analysis.run_off import few_slices_warning, run_off_warning
from ltca.analysis.summary import summarise
from ltca.analysis.verdict.lead_crown import best_lead_crown
from ltca.analysis.verdict.values import judge_analysis
from ltca.analysis.width import face_load_factor
from ltca.compliance.response import AlongWidth, ContactPressures, KindPressures
from ltca.drive.members.limits import parse_limits
from ltca.errors import DriveError
from ltca.figures.run_figures import draw_figure, figures_of
from ltca.geometry.coordinates import DISC_PLACE
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

ANGLES = np.array([0.3, 1.7, 3.9])
SLOPE = 3e-4
TILT_STIFFNESS = 1e8
DOCS = Path(__file__).parents[3] / "docs/how-to"


@pytest.fixture(scope="module")
def drive():
    return with_fields(load_drive("paper").cases["CS-1"], {"contact.slices": 5, "load.light_torque": 3e5})


@pytest.fixture(scope="module")
def found(drive):
    """The drive aligned, with a slope of the flank of either sense, and with everything inclined alike, by name."""
    alike = {"inclination.x": 2e-4, "inclination.y": -1e-4}
    inclined = {f"{part}.{name}": size for part in ("pin_wheel", "pin_shaft", "crank") for name, size in alike.items()}
    drives = {
        "aligned": drive,
        "up": with_fields(drive, {"disc.lead_slope": SLOPE}),
        "down": with_fields(drive, {"disc.lead_slope": -SLOPE}),
        "inclined": with_fields(drive, inclined),
    }
    return dict(analyse_cases(drives, ANGLES))


@pytest.fixture(scope="module")
def data(found):
    return {name: build_dataset(name, {name: analysis}) for name, analysis in found.items()}


def test_slices_add_up_to_loads(data):
    """Line loads are those of the slices: nothing but round-off lies between."""
    for name in ("pin", "roller", "pin_shaft"):
        part = {"pin": "pin", "roller": "roller", "pin_shaft": "hole"}[name]
        z = data["up"][f"z_{part}"].values[0]
        total = data["up"][f"{name}_line_load"].sum("slice").values * (z[1] - z[0])
        load = data["up"][f"{name}_load"].values
        assert total == pytest.approx(load, rel=1e-9, abs=1e-9 * load.max())


def test_moments_on_a_disc_balance(found, data):
    """Moments of wheel pins, shaft pins and crank bearing about x and y add up to nothing, the search's residual apart."""
    analysis = found["up"]
    part = analysis.full.response.parts[0]
    moment = np.zeros((ANGLES.size, 2))
    for motion, pairs in ((part.flank, part.leaning_pins), (part.holes, part.leaning_holes)):
        # The disc is pressed against the gradient of the approach; a force F at the height z has the moment (−F_y z, F_x z).
        lever = -np.einsum("bi,bij->bj", pairs.contact.moment, motion.gradient[..., DISC_PLACE])
        moment += np.stack((-lever[:, 1], lever[:, 0]), axis=1)
    bearing = data["up"]["crank_bearing_moment"].values[0, 0, 0]
    assert np.abs(bearing).max() > 1000.0
    assert bearing == pytest.approx(-moment, abs=1e-6 * np.abs(bearing).max())


def test_a_slope_of_the_other_sense_is_the_mirror_image(data):
    """z to −z: slices change places, tilts and moments their sign."""
    up, down = data["up"], data["down"]
    for name in ("pin_line_load", "roller_line_load_inner", "pin_pressure_along_width", "pin_shaft_line_load"):
        # Settled to 1e-9 of the forces by Newton's method from different sides.
        largest = up[name].values.max()
        assert up[name].values == pytest.approx(down[name].values[..., ::-1], abs=1e-6 * largest)
    for name in ("disc_tilt", "crank_bearing_moment"):
        assert up[name].values == pytest.approx(-down[name].values, abs=1e-6 * np.abs(up[name].values).max())
    assert np.abs(up["disc_tilt"].values).max() > 0.3 * SLOPE


def test_what_is_inclined_as_a_whole_tilts_and_carries_as_before(data):
    """All axes rotated by one small vector are the same drive, looked at from the side: squares of 2e-4 are left out."""
    aligned, inclined = data["aligned"], data["inclined"]
    assert inclined["disc_tilt"].values == pytest.approx(np.broadcast_to([2e-4, -1e-4], (1, 1, 3, 2)), abs=1e-8)
    for name in ("pin_line_load", "roller_line_load", "pin_shaft_line_load"):
        assert inclined[name].values == pytest.approx(aligned[name].values, abs=1e-5 * aligned[name].values.max())


def test_ends_are_where_the_pressure_of_a_slope_is_largest(data):
    """Metal left at positive z carries there."""
    loaded = data["up"]["pin_load"].values > 1000.0
    assert (data["up"]["pin_pressure_max_place"].values[loaded] > 4.0).all()
    assert data["up"]["pin_face_load_factor"].values.min() > data["aligned"]["pin_face_load_factor"].values.max()


def test_face_load_factors_of_aligned_and_of_crowned_lines(drive):
    """The bulge of straight ends was in them: 1.14, 1.27 and 1.48 of the aligned paper with 5, 9 and 17 slices."""
    for slices in (5, 9, 17):
        along = analyse(with_fields(drive, {"contact.slices": slices}), ANGLES[:1]).pressures.pins.along
        assert face_load_factor(along)[0, 0] == pytest.approx(1.0, abs=2e-3)  # between 61 lines of the table
    # Nothing is taken off lines whose ends do not carry: a parabola of line loads over the whole width has 3/2, and 1/243 less
    # in the mean over the ninth in the middle.
    crowned = with_fields(drive, {"contact.slices": 17, "disc.lead_crown_drop": 0.01})
    assert face_load_factor(analyse(crowned, ANGLES[:1]).pressures.pins.along)[0, 0] == pytest.approx(1.5, abs=0.1)


@pytest.mark.slow
def test_face_load_factors_settle_with_the_number_of_slices():
    """The last slice of a tilted line came ever closer to its end: 1.194, 1.219, 1.242, 1.272 and 1.324 with 5 to 65 of them.

    Steps from 9 to 17 to 33 slices shrink, and the table of the documents is this one.
    """
    paper = load_drive("paper").cases["CS-3"]
    told = re.findall(
        r"^\| .*\| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|$",
        (DOCS / "width_results.md").read_text("utf-8"),
        re.M,
    )
    found = []
    for crown in (0.0, 0.01):
        each = []
        for slices in (5, 9, 17, 33):
            change = {"contact.slices": slices, "disc.lead_slope": 1e-3, "disc.lead_crown_drop": crown}
            pressures = analyse(with_fields(paper, change), np.array([0.3])).pressures
            kinds = pressures.pins, pressures.outer, pressures.holes
            each.append([float(face_load_factor(kind.along)[0, 0]) for kind in kinds])
        found.append(np.array(each).T)
    straight, crowned = found
    for values in (straight[0], straight[1], crowned[0], crowned[1]):
        steps = np.abs(np.diff(values[1:]))
        assert steps[1] < 0.5 * steps[0]
    # Shaft pins here are springs side by side of which ends are read: within 0.2 % from nine slices on.
    assert np.ptp(straight[2][1:]) < 2e-3 * straight[2][-1]
    rows = [straight[0], crowned[0], straight[1], straight[2]]
    assert np.array(told, dtype=float) == pytest.approx(np.array(rows), abs=6e-4)  # three decimals


def test_the_largest_line_load_is_a_mean_over_a_ninth():
    """A line load q (1 + z/L) in n slices: at its end, less half a ninth, 1.5 − 1/18 of the mean, whatever the number of slices.

    Where a ninth is no whole number of slices, line loads that are even over each slice lack a little: 1/8 of the rise over a
    slice, by the slices in a ninth, at most.
    """
    for slices in (9, 11, 17, 45):
        line = 1.0 + (np.arange(slices) - 0.5 * (slices - 1)) / slices
        lacks = 1.5 - 1.0 / 18.0 - face_load_factor(along_of(line[None, None]))[0, 0]
        assert -1e-12 < lacks < (1e-12 if slices % 9 == 0 else 9.0 / (8.0 * slices**2))


def along_of(line):
    return AlongWidth(
        line_load=line, even_line_load=line, pressure=line, half_width=line, place=line[..., 0], end_load=line[..., :2]
    )


@pytest.fixture(scope="module")
def reducer():
    """The rv whose wheel tilts on its main bearing, at two positions, with its dataset."""
    bearing = {"main_bearing.radial_stiffness": 1e6, "main_bearing.tilt_stiffness": TILT_STIFFNESS}
    drive = with_fields(load_drive("rv").cases["nominal"], {"contact.slices": 5} | bearing)
    analysis = analyse(drive, 0.5 * np.pi * np.arange(2))
    return analysis, build_dataset("rv", {"nominal": analysis})


@pytest.mark.slow
def test_the_tilt_of_a_wheel_is_that_of_its_bearing(reducer):
    """What the bearing carries by its stiffness, whose moment is in the frame of the housing: 0.9 mrad, more than a disc."""
    data = reducer[1]
    tilt, moment = (
        np.hypot(data[f"{name}_x"].values, data[f"{name}_y"].values) for name in ("wheel_tilt", "main_bearing_moment")
    )
    assert moment == pytest.approx(TILT_STIFFNESS * tilt, rel=1e-6)  # Newton's residual is 1e-9 of the loads
    assert np.abs(data["wheel_tilt_x"].values).max() > np.abs(data["disc_tilt"].values).max() > 1e-4


@pytest.mark.slow
def test_moments_of_rollers_add_up_to_those_of_their_bearings(reducer):
    """Line loads alone lacked what varies within slices, 2 to 7 %: nothing stored closed the moments."""
    analysis, data = reducer
    moment, line, z = data["roller_moment"].values[0], data["roller_line_load"].values[0], data["z_roller"].values[0]
    within = moment - (line * z).sum(axis=-1) * (z[1] - z[0])
    # What is even over slices has the greater part, what varies within them the same sense.
    most = np.abs(moment) > 0.5 * np.abs(moment).max()
    assert (within[most] / moment[most]).min() > 0.0
    assert (within[most] / moment[most]).max() < 0.2
    for number, (disc, model) in enumerate(zip(analysis.discs, analysis.model.discs, strict=True)):
        ray = model.geometry.rollers(disc.full.crank_angle).direction
        rays = np.moveaxis(ray.reshape(ray.shape[0], moment.shape[1], -1), 0, 1)
        leverage = (moment[number] * rays).sum(axis=-1)
        expected = np.stack((-leverage.imag, leverage.real), axis=-1)
        given = data["crank_bearing_moment"].values[0, number]
        assert given == pytest.approx(expected, abs=1e-9 * np.abs(given).max())
        # And on the disc they balance those of pins, to Newton's residual.
        part = disc.full.response.parts[0]
        pins = np.einsum("bi,bij->bj", data["pin_moment"].values[0, number], part.flank.gradient[..., DISC_PLACE])
        assert given.sum(axis=0) == pytest.approx(
            np.stack((-pins[:, 1], pins[:, 0]), axis=1), abs=1e-6 * np.abs(given).max()
        )


@pytest.mark.slow
def test_face_load_factors_of_bearings_that_carry_little(reducer):
    """A bearing of the rv that touches with 4 % of the load of another, on another disc, at another position, has none."""
    analysis, data = reducer
    factor, load = data["roller_face_load_factor"].values, data["roller_load"].values.max(axis=-1)
    assert factor.shape == load.shape
    # Of the largest loads of rollers; those near a tenth are decided by the loads without bulges.
    assert np.isfinite(factor[load > 0.11 * load.max()]).all()
    assert np.isnan(factor[load < 0.09 * load.max()]).all()
    assert (load < 0.09 * load.max()).any()
    assert summarise(analysis)["max_roller_face_load_factor"] == pytest.approx(np.nanmax(factor))


def test_the_face_load_factor_of_a_wedge():
    """Four slices in the proportion 1 : 2 : 3 : 4 beside an even lighter contact: the largest is 1.6 of the mean."""
    line = np.array([[[1.0, 2.0, 3.0, 4.0], [2.0, 2.0, 2.0, 2.0]]])
    kind = along_of(line)
    assert face_load_factor(kind) == pytest.approx(1.6)
    assert face_load_factor(kind, 2) == pytest.approx(np.array([[1.6, 1.0]]))
    # What carries less than a tenth of another has none; two drives one after another are judged each by its own.
    light = np.concatenate((line, 0.05 * line))
    kind = along_of(light)
    assert np.isnan(face_load_factor(kind)).tolist() == [[False], [True]]
    assert face_load_factor(kind, series=2) == pytest.approx(1.6)


def test_contacts_over_few_slices_are_told(drive):
    """A crown of 0.5 mm leaves a patch of 4.3 mm of 11.8 (elliptical Hertz): one of three slices took all of the load, with a
    pressure a quarter too small, and nothing was said.
    """

    def told(slices, crown):
        changed = with_fields(drive, {"contact.slices": slices, "disc.lead_crown_drop": crown})
        return " ".join(analyse(changed, ANGLES[:1]).warnings)

    assert "contact.slices = 3: " in (rough := told(3, 0.5))
    assert "(wheel pins over 1 slice)" in rough
    assert "contact.slices = 13 or more tells" in rough
    assert "reach over fewer" not in told(33, 0.5)
    assert "reach over fewer" not in told(3, 0.0)  # which fill all of the width


def test_slices_are_counted_where_contacts_carry_notably():
    """Of contacts that carry a hundredth nothing is said, of those over two slices of five it is."""
    light, heavy = np.array([0.0, 0.0, 0.0, 0.0, 0.1]), np.array([0.0, 1.0, 8.0, 1.0, 0.1])

    def told(*lines):
        line = np.stack(lines)[None]
        kind = KindPressures(
            mid=line[..., 2], largest=line[..., 2], half_width=line[..., 2], end_cell=0.1, along=along_of(line)
        )
        return few_slices_warning(
            5, ContactPressures(pins=kind, outer=kind, inner=kind, holes=kind, rigid_shaft_pins=False)
        )

    assert told(light, heavy) is None
    assert "wheel pins over 2 slices, rollers in the bore over 2 slices" in told(
        np.array([0.0, 0.0, 0.0, 2.0, 3.0]), heavy
    )


def test_the_plane_has_nothing_of_this(drive):
    plane = analyse(with_fields(drive, {"contact.slices": 1}), ANGLES)
    names = set(build_dataset("plane", {"plane": plane}).variables)
    assert not {name for name in names if "line_load" in str(name) or "tilt" in str(name) or str(name) == "slice"}
    assert "max_disc_tilt_rad" not in summarise(plane)


def test_cases_with_other_slices_share_no_dataset(drive):
    with error_says(DriveError, "5 slices (contact"):
        check_common_shape({"one": with_fields(drive, {"contact.slices": 1}), "two": drive})


@pytest.mark.slow
def test_aligned_straight_rollers_live_as_in_the_plane(drive):
    """What slices carry by what they would carry aligned is one; loads differ by 1e-4."""
    angle = 2.0 * np.pi * np.arange(24) / 24.0
    plane, sliced, tilted = (
        bearing_lives(analyse(with_fields(drive, fields), angle)).shortest.life
        for fields in ({"contact.slices": 1}, {}, {"disc.lead_slope": 1e-3})
    )
    assert sliced == pytest.approx(plane, rel=5e-4)
    assert tilted < 0.95 * plane


def test_tilt_is_checked_against_the_axial_play(found):
    analysis = found["up"]
    playing = replace(analysis, drive=with_fields(analysis.drive, {"disc.axial_play": 0.01}))
    checks = {check.value.quantity: check for check in judge_analysis(playing, summarise(playing), {}, lives=False)}
    tilt = np.hypot(*np.moveaxis(build_dataset("", {"": analysis})["disc_tilt"].values, -1, 0)).max()
    profile = analysis.model.discs[0].geometry.profile
    rim = profile.generating_radius + profile.eccentricity - profile.offset
    assert checks["axial_play_taken"].value.value == pytest.approx(2.0 * tilt * rim / 0.01)
    assert checks["axial_play_taken"].fails
    without = judge_analysis(analysis, summarise(analysis), {}, lives=False)
    assert "axial_play_taken" not in {check.value.quantity for check in without}


def test_pressures_anywhere_are_judged_by_yield_at_straight_ends_and_as_allowed_inside(drive, found):
    """3 GPa at straight ends are no failure; with a crown that takes them off the allowable pressure holds."""

    def check_of(analysis, limits=None):
        checks = judge_analysis(analysis, summarise(analysis), limits or {}, lives=False)
        return {check.value.quantity: check for check in checks}

    straight = check_of(found["up"])["pin_pressure_max"]
    assert straight.limit.source.startswith("first yield")
    assert re.search(r"z = 5\.9 mm", straight.value.part)
    crowned = check_of(analyse(with_fields(drive, {"disc.lead_crown_drop": 0.03}), ANGLES))["pin_pressure_max"]
    assert crowned.limit.source.endswith("allowable_pressure")
    limits = parse_limits({"max_pin_pressure_max": 2500.0, "max_disc_tilt": 1e-9}, [])
    asked = check_of(found["up"], limits)
    assert asked["pin_pressure_max"].limit.value == 2500.0
    assert asked["disc_tilt"].fails
    plane = check_of(
        analyse(with_fields(drive, {"contact.slices": 1}), ANGLES), parse_limits({"max_disc_tilt": 1e-3}, [])
    )
    assert "pin_pressure_max" not in plane
    assert "contact.slices = 1" in plane["disc_tilt"].value.reason


def test_the_figure_shows_the_most_loaded_pin_and_roller(data):
    """Steps over the slices, line load above and pressure below."""
    up = data["up"]
    assert "along_width" in figures_of(up)
    axes = draw_figure("along_width", up).axes
    for column, (load, line) in enumerate((("pin_load", "pin_line_load"), ("roller_load", "roller_line_load"))):
        most = np.unravel_index(int(np.argmax(up[load].values)), up[load].shape)
        (steps,) = axes[column].patches
        assert steps.get_data().values == pytest.approx(up[line].values[most])
        assert steps.get_data().edges[[0, -1]] == pytest.approx([-5.9, 5.9])


def test_only_a_crown_that_is_too_small_is_said_to_run_off(drive):
    """The approach is about 0.01 mm: a crown of a tenth of it carries at its ends, one of three times does not."""

    def told(drop):
        analysis = analyse(with_fields(drive, {"disc.lead_crown_drop": drop}), ANGLES)
        return run_off_warning(analysis.drive, analysis.pressures)

    assert told(0.0) is None
    assert "wheel pins (at the lower and the upper end" in told(0.001)
    assert told(0.03) is None


@pytest.mark.slow
def test_the_crown_told_is_the_best_of_its_neighbours(drive):
    """Largest pressures with a tenth more or less of it are higher, or equal within the search's halving of a ladder of twos."""
    sloped = with_fields(drive, {"disc.lead_slope": SLOPE})
    crown = best_lead_crown(sloped, sloped.load.torque)
    angle = 2.0 * np.pi * np.arange(12) / 12.0 + 1e-3
    drives = {str(part): with_fields(sloped, {"disc.lead_crown_drop": part * crown.drop}) for part in (0.5, 1.0, 2.0)}
    largest = {name: one.pressures.pins.largest.max() for name, one in analyse_cases(drives, angle)}
    assert largest["1.0"] == pytest.approx(crown.pressure, rel=1e-6)
    assert largest["1.0"] < 0.95 * min(largest["0.5"], largest["2.0"])
    assert crown.pressure < 0.7 * crown.pressure_now
    assert "disc.lead_crown_drop: 0 →" in crown.words


def test_steep_tilts_are_told(drive):
    """A drive that is inclined as a whole by 6 mrad tilts its disc by that; by 4 mrad nothing is told, nor in the plane."""

    def told(size):
        inclined = {f"{part}.inclination.y": size for part in ("pin_wheel", "pin_shaft", "crank")}
        return [text for text in analyse(with_fields(drive, inclined), ANGLES[:1]).warnings if "discs tilt" in text]

    assert told(6e-3)[0].startswith("discs tilt by up to 6 mrad: gaps and forces are linear")
    assert told(4e-3) == []
    plane = analyse(with_fields(drive, {"contact.slices": 1}), ANGLES[:1])
    assert not any("discs tilt" in text for text in plane.warnings)


@pytest.mark.slow
@pytest.mark.parametrize("contact", ["pin", "roller_outer", "hole"])
def test_pressure_fields_tilt_as_their_contacts_do(found, contact):
    """They were those of aligned straight contacts, the same at both ends. Loads and moments of cells are those of the slices.

    1e-3 of the load by half the length: from one grid to the next loads jump by some 1e-4. The largest pressure of wheel pins
    and rollers is estimated by the slices within 4 % (`docs/theory/width.md`); shaft pins, springs here, have no ends to tell it.
    """
    analysis = found["up"]
    loads = loads_of(analysis, contact)[0]
    pair = int(np.argmax(loads))
    field = pressure_field(analysis, contact, 0, pair, cells=8)
    area = np.diff(field.x_edges)[:, None] * np.diff(field.y_edges)
    heights = 0.5 * (field.y_edges[1:] + field.y_edges[:-1])
    assert (field.pressure * area).sum() == pytest.approx(loads[pair], rel=1e-9)
    moment = moment_of(analysis, contact, 0, pair)
    half = 0.5 * analysis.drive.disc.thickness
    assert abs(moment) > 0.005 * half * loads[pair]
    assert (field.pressure * area * heights).sum() == pytest.approx(moment, abs=1e-3 * half * loads[pair])
    if contact != "hole":
        kinds = {"pin": analysis.pressures.pins, "roller_outer": analysis.pressures.outer}
        assert field.largest == pytest.approx(kinds[contact].largest[0, pair], rel=0.04)
