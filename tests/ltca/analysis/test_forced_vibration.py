"""Response over speed against its limits, one mass on one spring in closed form, and centrifugal forces by hand."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from refusals import refused_field

from ltca.analysis.engines import HalfSpace
from ltca.analysis.forced_vibration import (
    MOST_TRUNCATION,
    _deviation,
    _force,
    _nominal_forces,
    _orders,
    _quasi_static,
    _system,
    forced_vibration,
    response_notes,
)
from ltca.analysis.vibration import vibration
from ltca.commands.program import main
from ltca.dynamics.harmonic_balance import PulsatingStiffness
from ltca.dynamics.masses import DISCS, ROLLERS, drive_masses
from ltca.errors import ConvergenceError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, shipped_drive

HEAVY = 1e4
RATIO = 0.05
PAPER = load_drive("paper").cases["CS-1"]


@pytest.fixture(scope="module")
def heavy():
    """The paper's drive with an output that is far heavier than its parts: one mass on one spring."""
    drive = with_fields(PAPER, {"inertia.output": HEAVY, "damping.ratio": RATIO})
    return vibration(drive, engine=HalfSpace(), positions=24, turns=4)


@pytest.fixture(scope="module")
def usual():
    drive = with_fields(PAPER, {"inertia.output": 0.5, "damping.ratio": RATIO})
    return vibration(drive, engine=HalfSpace(), positions=24, turns=4)


def constant(stiffness, positions):
    """A stiffness that does not pulse."""
    return PulsatingStiffness(over_turn=np.broadcast_to(stiffness, (positions, *stiffness.shape)))


def with_mean_stiffness(found):
    """Vibrations whose stiffness does not pulse."""
    return replace(found, stiffness=constant(found.stiffness.mean, len(found.stiffness.over_turn)))


def amplification(part):
    """Motion of a mass by that of the foot of its spring, damper to the ground of the moving foot: 1 + r²/(1 − r² + 2iζr)."""
    return np.abs(1.0 + part**2 / (1.0 - part**2 + 2j * RATIO * part))


def test_one_mass_on_one_spring_follows_the_closed_form(heavy):
    """Every order meets its resonance of ω = √(k̄/J); the compliance of the mean stiffness is known to a thousandth of k̄."""
    first = heavy.at_load[:, 0].mean()
    order = heavy.input_orders[heavy.told_orders[0]]
    resonance = 60.0 * first / order
    found = forced_vibration(with_mean_stiffness(heavy), fastest=3.0 * resonance)
    assert found.truncation == 0.0
    place = heavy.told_orders[0]
    part = found.speed / resonance
    # Beside the peak, where a thousandth of the frequency would be some hundredths of the answer.
    beside = np.abs(part - 1.0) > 0.15
    got = found.order_amplitude[beside, place] / heavy.spectrum.amplitude[place]
    assert got == pytest.approx(amplification(part[beside]), rel=2e-2)
    # At the peak the damping alone counts: √(1 + 1/4ζ²).
    peak = np.max(found.order_amplitude[:, place]) / heavy.spectrum.amplitude[place]
    assert peak == pytest.approx(np.max(amplification(np.linspace(0.9, 1.1, 2001))), rel=2e-2)


@pytest.mark.slow
def test_slow_motion_is_the_quasi_static_one(usual):
    found = forced_vibration(usual, speeds=60, fastest=3.0)
    assert found.order_amplitude[0] == pytest.approx(usual.spectrum.amplitude, rel=1e-6, abs=1e-12)
    # Waves of whole orders over a turn of the motion: their root mean square by summing them, and not by Parseval.
    turn = 2.0 * np.pi * np.arange(4096) / 4096
    waves = np.cos(np.outer(np.arange(1, usual.spectrum.amplitude.size + 1), turn))
    assert found.amplitude[0] == pytest.approx(np.std(usual.spectrum.amplitude @ waves), rel=1e-4)
    for factor in found.factors.values():
        assert factor == pytest.approx(1.0, abs=1e-4)
    assert found.parts_from is None
    assert found.torque_ratio.max() < 1e-4


def test_centrifugal_forces_by_hand(usual):
    """Seen from the crank the disc and half of its rollers are pushed out along the eccentricity by m e ω²."""
    masses = drive_masses(PAPER)
    force = _nominal_forces(usual)
    pushed = (masses.mass_of(DISCS) + 0.5 * masses.mass_of(ROLLERS)) * PAPER.crank.eccentricity
    # Differences of the rows over 1e-4 rad.
    assert force[:2] == pytest.approx([pushed, 0.0], rel=1e-6, abs=1e-9)
    assert force[2:] == pytest.approx(0.0, abs=1e-9)


def test_centrifugal_forces_are_held_by_the_springs(usual):
    """What they displace is that of the stiffness, to first order of the square of the speed."""
    mean = usual.stiffness.mean
    still = _system(replace(usual, stiffness=constant(mean, 8)))
    orders, resting = np.arange(1.0, 4.0), np.zeros((mean.shape[0], 3), dtype=complex)
    outward = still.respond(1.0, orders, _force(still, 1.0, orders, resting, _nominal_forces(usual)))[0].real
    held = usual.basis.T @ mean @ outward
    # Softening by the moving disc itself is (1/ω)² of it: 1e-9 at 1 rad/s against modes of 1000 rad/s.
    assert held == pytest.approx(usual.basis.T @ _nominal_forces(usual), rel=1e-5, abs=1e-9)


@pytest.mark.slow
def test_a_loss_factor_is_twice_the_ratio_at_resonance(heavy):
    resonance = 60.0 * heavy.at_load[:, 0].mean() / heavy.input_orders[heavy.told_orders[0]]
    heavy = with_mean_stiffness(heavy)
    lossy = replace(heavy, drive=with_fields(PAPER, {"inertia.output": HEAVY, "damping.loss_factor": 2.0 * RATIO}))
    each = [forced_vibration(one, speeds=60, fastest=1.5 * resonance) for one in (heavy, lossy)]
    place = heavy.told_orders[0]
    peaks = [found.order_amplitude[:, place].max() for found in each]
    assert peaks[1] == pytest.approx(peaks[0], rel=1e-2)  # apart by ζ² away from the resonance


@pytest.mark.slow
def test_parting_contacts_are_told(heavy):
    """With a ten-thousandth of the critical damping a resonance is 5000 times the transmission error: contacts part before its
    speed is reached.
    """
    order = heavy.input_orders[heavy.told_orders[0]]
    resonance = 60.0 * heavy.at_load[:, 0].mean() / order
    weak = replace(heavy, drive=with_fields(heavy.drive, {"damping.ratio": 1e-4}))
    found = forced_vibration(weak, speeds=60, fastest=1.2 * resonance)
    assert found.parts_from is not None
    assert found.parts_from <= 1.01 * resonance
    assert forced_vibration(heavy, fastest=0.2 * resonance / heavy.input_orders.max() * order).parts_from is None


def test_without_damping_there_is_no_response(usual):
    with refused_field("damping.ratio", "", "must be given (or damping.loss_factor)"):
        forced_vibration(replace(usual, drive=with_fields(PAPER, {"inertia.output": 0.5})))


@pytest.mark.slow
def test_pulsation_of_the_stiffness_moves_the_answer(usual):
    """With it the balance closes: twice the orders change the transmission error by some thousandths (0.003 was measured)."""
    both = [forced_vibration(one, fastest=3000.0, speeds=8) for one in (usual, with_mean_stiffness(usual))]
    assert both[0].mean_at.size == 0
    assert 0.0 < both[0].truncation < 1e-2
    assert np.max(np.abs(both[0].amplitude / both[1].amplitude - 1.0)) > 1e-3
    assert 0.0 < usual.stiffness_rest < 0.05  # rollers that pass


@pytest.mark.slow
def test_too_few_orders_ask_for_positions_that_suffice():
    """Light parts resonate at orders beyond those of the usual positions; a line says so, and the positions that it asks for
    change the transmission error by less than its bound when halved.
    """
    light = with_fields(PAPER, {"damping.ratio": 0.02})
    found = []
    for positions in (24, 384):
        shaken = vibration(light, engine=HalfSpace(), positions=positions, turns=4, torque_parts=())
        found.append((forced_vibration(shaken, speeds=60), shaken))
    notes = [" ".join(response_notes(*one)) for one in found]
    assert found[0][0].truncation > MOST_TRUNCATION
    assert "--positions 384" in notes[0]
    assert found[1][0].truncation < MOST_TRUNCATION
    assert "--positions" not in notes[1]


@pytest.mark.slow
def test_a_balance_that_does_not_converge_leaves_the_mean_there(usual, monkeypatch):
    tried = []

    def refuse(self, speed, force):
        tried.append(speed)
        raise ConvergenceError("no", [])

    monkeypatch.setattr("ltca.dynamics.harmonic_balance.HillSystem._balanced", refuse)
    found = forced_vibration(usual, fastest=3000.0, speeds=8)
    assert found.mean_at == pytest.approx(found.speed)
    assert len(tried) == found.speed.size
    mean = forced_vibration(with_mean_stiffness(usual), fastest=3000.0, speeds=8)
    assert found.amplitude == pytest.approx(mean.amplitude, rel=1e-12)


@pytest.mark.slow
def test_a_balance_converges_where_its_preconditioner_is_ill_conditioned():
    """Preconditioned from the left, the residual that GMRES made small was 1e-14 for an RV drive at 820 to 860 rpm, and that of
    the force above its bound. The force is balanced there: the stiffness carries what inertia and damping leave.
    """
    rv = next(iter(load_drive("rv").cases.values()))
    found = vibration(
        with_fields(rv, {"damping.ratio": 0.03, "inertia.output": 0.5}),
        engine=HalfSpace(), positions=4, turns=4, torque_parts=(),
    )  # fmt: skip
    system, orders, whole = _system(found), _orders(found), found.stiffness.orders
    crank = abs(rv.crank_turns_per_input) * 840.0 * 2.0 * np.pi / 60.0
    force = _force(system, crank, orders, _quasi_static(found), _nominal_forces(found))
    moved = system.respond(crank, orders, force)[: whole + 1]
    angle = 2.0 * np.pi * np.arange(2 * whole + 2) / (2 * whole + 2)
    waves = np.exp(1j * np.multiply.outer(angle, np.arange(whole + 1.0)))
    carried = np.einsum("pij,pj->pi", found.stiffness.over_turn, (waves @ moved).real)
    rates = 1j * crank * np.arange(whole + 1.0)[:, None, None] * np.eye(found.motion.size) + crank * system.spin
    damped = 1j * crank * np.arange(whole + 1.0)[:, None, None] * system.damping
    left = 2.0 * np.fft.rfft(carried, axis=0, norm="forward")[: whole + 1]
    left[0] *= 0.5
    left += np.einsum("oij,oj->oi", system.mass @ rates @ rates + damped, moved) - force[: whole + 1]
    free = left @ found.basis
    assert np.linalg.norm(free) < 1e-8 * np.linalg.norm(force[: whole + 1] @ found.basis)  # 1e-9 is asked for


@pytest.mark.slow
def test_the_command_writes_what_it_prints(tmp_path, capsys):
    drive = tmp_path / "mine.toml"
    text = (
        shipped_drive("paper").partition("[[case]]")[0]
        + '\n[damping]\nratio = "3 %"\n[inertia]\noutput = "0.5 kg·m²"\n'
    )
    drive.write_text(text.replace("[load]\n", "[load]\nspeed = 1500.0\n"), encoding="utf-8")
    out = tmp_path / "out"
    command = [
        "dynamics",
        str(drive),
        "--quick",
        "--positions",
        "6",
        "--turns",
        "4",
        "--out",
        str(out),
        "--figures",
        "svg",
    ]
    assert main(command) == 0
    printed = capsys.readouterr().out
    content = json.loads((out / "dynamics.json").read_text(encoding="utf-8"))
    assert content["input_held"] is True
    assert f"mode {content['critical_speeds'][0]['mode']}, order" in printed
    assert all(one["what_moves"] in printed for one in content["modes"])
    assert len(content["frequency_Hz"][0]) == 6
    assert max(content["response"]["speed_rpm"]) == 1500.0
    page = (out / "report.html").read_text(encoding="utf-8")
    assert all(words in page for words in ("Campbell diagram", "Response over speed", "Masses", "speed of operation"))
    with xr.open_dataset(out / "dynamics.nc") as kept:
        assert float(kept["speed"][0]) == 0.0
        assert 1500.0 in kept["speed"].values
        assert kept["pin_load_order_amplitude"].dims == ("speed", "disc", "pin", "pin_order")
        told = next(one for one in content["response"]["forces"] if one["why"] == "speed of operation")
        pins = told["forces"][0]
        there = kept["pin_load_order_amplitude"].sel(speed=1500.0)
        place = int(np.argmin(np.abs(kept["pin_order"].values - pins["orders"][0])))
        # Stored in single precision.
        assert float(there[..., place].max()) == pytest.approx(pins["largest_amplitude_N"][0], rel=1e-6)
        assert pins["largest_of"][0].startswith("wheel pin ")
    assert {path.name for path in (out / "figures").iterdir()} == {"campbell_diagram.svg", "response.svg"}


@pytest.mark.slow
def test_the_command_refuses_by_name_and_leaves_nothing(tmp_path, capsys):
    drive = tmp_path / "bare.toml"
    text = shipped_drive("paper").replace('roller = { like = "100Cr6", youngs_modulus', "roller = { youngs_modulus")
    drive.write_text(text, encoding="utf-8")
    assert main(["dynamics", str(drive), "--case", "CS-1", "--out", str(tmp_path / "out")]) == 2
    assert "materials.roller.density: must be given for inertias" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_seen_from_the_crank_orders_are_one_apart(usual):
    """A disc on springs alike in all directions answers at the frequency it has at rest: turning with order 3 in the frame of the
    crank, the way this turns, it turns with order 4, and with order 2 the other way.
    """
    size, mass, stiffness, speed = usual.motion.size, 2e-3, 5e4, 400.0
    alike = replace(
        usual,
        mean_mass=mass * np.eye(size),
        stiffness=constant(stiffness * np.eye(size), 16),
        drive=with_fields(PAPER, {"damping.ratio": 1e-9}),
    )
    for sense, order in ((1.0, 4.0), (-1.0, 2.0)):
        system, orders = _system(alike), np.arange(1.0, 8.0)
        turning = np.zeros((size, orders.size), dtype=complex)
        turning[:2, 2] = 1.0, -1j * sense
        found = system.respond(speed, orders, _force(system, speed, orders, turning, np.zeros(size)))[3]
        square = (order * speed) ** 2
        # Damping of 1e-9 is nothing beside the resonance.
        assert found[:2] == pytest.approx(turning[:2, 2] * square / (stiffness / mass - square), rel=1e-6)


def test_the_frame_of_the_crank_spins(usual):
    motion, step = usual.motion, 1e-6
    ends = motion.turned(np.array([0.4 - step, 0.4 + step]))
    assert (ends[1] - ends[0]) / (2.0 * step) == pytest.approx(
        motion.turned(np.array([0.4]))[0] @ motion.spin, abs=1e-9
    )


@pytest.mark.slow
def test_two_discs_without_offsets_answer_with_the_pulsation_at_every_speed():
    """The preconditioner of motions between positions swung up at slow turns, and nearly all speeds fell back to the mean."""
    drive = next(iter(load_drive("robot-joint").cases.values()))
    change = {
        "disc.equidistant_offset": 0.0,
        "disc.shifting_offset": 0.0,
        "inertia.input": 2e-4,
        "inertia.output": 0.5,
        "damping.ratio": 0.05,
    }
    found = vibration(with_fields(drive, change), engine=HalfSpace(), positions=4, turns=4, torque_parts=())
    assert forced_vibration(found, fastest=3000.0, speeds=12).mean_at.size == 0


def test_a_drive_that_turns_as_one_has_no_transmission_error(usual):
    """Its input turns and its output with it by the ratio: the row of the error sees neither, but the output alone."""
    row, motion = _deviation(usual), usual.motion
    assert abs(float(row @ motion.rigid)) < 1e-12 * abs(float(motion.output_turns @ motion.rigid))
    alone = np.where(motion.input_turns != 0.0, 0.0, motion.output_turns)
    assert np.any(alone)
    np.testing.assert_allclose(row * (motion.input_turns == 0.0), alone, rtol=1e-12)
