"""The page of a run in a real browser: what it draws at each position is what ``results.nc`` holds."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from ltca.page.compared import read_compared
from ltca.page.run_page import run_page
from ltca.reading.drive_file import DriveFile, parse_drive, shipped_drive

pytestmark = [pytest.mark.needs("chromium"), pytest.mark.slow]

# Every case, disc, torque and position: the loads drawn, and what the drawn forces leave of the disc's balance.
TURN = """<script>
addEventListener("load", () => {
  const button = (group, n) => { const all = document.querySelectorAll(`#${group} button`); if (all[n]) all[n].click(); };
  const loads = model => Object.fromEntries([...document.querySelectorAll(`#picture .load[data-model=${model}]`)].map(
    n => [n.dataset.contact, Number(n.dataset.load)]));
  const wait = () => {
    if (!document.documentElement.dataset.ready) { setTimeout(wait, 20); return; }
    seen.ready = performance.now();
    const slider = document.getElementById("angle");
    seen.turns = [];
    for (let state = 0; state < content.names.length * content.discs * 2; state++) {
      const torque = state % 2, disc = (state >> 1) % content.discs, kase = Math.floor(state / 2 / content.discs);
      button("cases", kase); button("discs", disc); button("torques", torque);
      for (let k = 0; k <= Number(slider.max); k++) {
        slider.value = k;
        slider.dispatchEvent(new Event("input", {bubbles: true}));
        const now = placesAt(view), sum = [0, 0];
        let whole = 0;
        for (const c of now.contacts) { sum[0] += c.load * c.to[0]; sum[1] += c.load * c.to[1]; whole += c.load; }
        const told = document.getElementById("angle-text").textContent;
        seen.turns.push([kase, disc, torque, k, loads("first"), Math.hypot(...sum) / whole, told]);
      }
    }
    button("torques", 0);
    seen.second = loads("second");
    const contact = document.querySelector("#picture .contact"), tip = document.getElementById("tip");
    contact.dispatchEvent(new MouseEvent("mouseenter", {clientX: 200, clientY: 200}));
    seen.tip = [tip.hidden, tip.textContent];
    contact.dispatchEvent(new MouseEvent("mouseleave", {}));
    contact.focus();
    seen.focus = [tip.hidden, contact.getAttribute("aria-label")];
    contact.dispatchEvent(new MouseEvent("click", {clientX: 200, clientY: 200}));
    seen.chosen = document.querySelector("[data-plot=load] figcaption").textContent;
    const plot = document.querySelector("[data-plot=te] svg"), box = plot.getBoundingClientRect();
    const left = box.left + 54 / plot.viewBox.baseVal.width * box.width; // of the axes
    for (const name of ["pointerdown", "pointerup"])
      plot.dispatchEvent(new PointerEvent(name, {clientX: left, clientY: box.top + 50, pointerType: "mouse"}));
    seen.clicked = view.index;
    document.getElementById("drive").dispatchEvent(new KeyboardEvent("keydown", {key: "ArrowRight", bubbles: true}));
    seen.key = view.index;
    seen.svg = svgText(document.getElementById("picture")).length > 1000 && svgText(plot).includes("stroke=");
    seen.csv = csvText(document.querySelector("[data-name=loads]"));
    seen.overflow = document.documentElement.scrollWidth - document.documentElement.clientWidth;
    seen.resources = performance.getEntriesByType("resource").map(e => e.name).filter(n => !/^(data|blob):/.test(n));
    leave();
  };
  wait();
});
</script>"""


def dataset_loads(dataset, case, disc, position):
    """Loads over nothing by the names of the page."""
    one = dataset.isel(case=case, disc=disc, position=position)
    cranks = dataset.sizes["crank"]
    found = {f"wheel pin {i}": value for i, value in enumerate(one["pin_load"].values)}
    found |= {f"shaft pin {i}": value for i, value in enumerate(one["pin_shaft_load"].values)}
    for crank in range(cranks):
        of = f"crank {crank}, " if cranks > 1 else ""
        found |= {f"{of}roller {i}": value for i, value in enumerate(one["roller_load"].isel(crank=crank).values)}
    return {name: value for name, value in found.items() if value > 0.0}


def drive_of(kind):
    if kind != "plastic":
        return parse_drive(shipped_drive(kind))
    drive = parse_drive(shipped_drive("paper")).cases["CS-3"]
    soft = replace(drive.materials.disc, youngs_modulus=2800.0, poisson_ratio=0.38)
    load = replace(drive.load, torque=5000.0, light_torque=200.0)
    drive = replace(drive, materials=replace(drive.materials, disc=soft), load=load)
    odd = "</script><script>alert(1)</script>"
    return DriveFile(name=odd, source="", cases={odd: drive}, tolerances={}, limits={odd: {}}, text=odd)


@pytest.mark.parametrize(
    "kind",
    ["rv", *(pytest.param(kind, marks=pytest.mark.nightly) for kind in ("paper", "robot-joint", "sleeved", "plastic"))],
)
@pytest.mark.usefixtures("positions_alone")
def test_arrows_are_the_values_of_the_dataset(kind, run_of, chromium, tmp_path):
    run, dataset = run_of(drive_of(kind), positions=3)
    if kind == "paper":  # beside itself: both arrows are alike
        dataset.to_netcdf(tmp_path / "results.nc", engine="h5netcdf")
        run = replace(run, compared=read_compared(tmp_path))
    seen, console, asked = chromium(run_page(run), TURN, tmp_path, "500,900" if kind == "sleeved" else "1280,900")
    assert seen["errors"] == []
    assert console == []
    assert seen["resources"] == []
    assert asked == set()
    assert len(seen["turns"]) == dataset.sizes["case"] * dataset.sizes["disc"] * 2 * 3
    for case, disc, torque, position, drawn, unbalanced, told in seen["turns"]:
        drawn = {name: load for name, load in drawn.items() if load > 0.0}
        assert told.startswith(f"{120 * position:.2f}° = ")
        # Normals come from cubics through 36 points a lobe: some 1e-3 off where the flank is curved most
        assert unbalanced < 2e-3
        if torque == 0:
            assert drawn == pytest.approx(dataset_loads(dataset, case, disc, position), rel=1e-6)
        else:
            assert drawn
    assert not seen["tip"][0]
    assert "MPa" in seen["tip"][1]
    assert not seen["focus"][0]
    assert re.search(r"\d N, [\d.]+ MPa", seen["focus"][1])
    assert seen["focus"][1].split(":")[0] in seen["chosen"]
    assert (seen["clicked"], seen["key"]) == (0, 1)
    assert seen["svg"]
    assert "bearing load, mean" in seen["csv"]
    assert "−" not in seen["csv"]
    assert seen["overflow"] <= 0
    if kind == "paper":
        last = dataset_loads(dataset, dataset.sizes["case"] - 1, 0, 2)
        assert {name: load for name, load in seen["second"].items() if load > 0.0} == pytest.approx(last, rel=1e-6)
    else:
        assert np.size(list(seen["second"])) == 0


WIDTHS = """<script>
addEventListener("load", () => {
  const wait = () => {
    if (!document.documentElement.dataset.ready) { setTimeout(wait, 20); return; }
    const slider = document.getElementById("angle");
    seen.bars = [];
    for (let k = 0; k <= Number(slider.max); k++) {
      slider.value = k;
      slider.dispatchEvent(new Event("input", {bubbles: true}));
      const heights = [...document.querySelectorAll("#width .bar")].map(bar => Number(bar.getAttribute("height")));
      seen.bars.push([
        view.chosen.number, heights, ...["tilt-keys", "width-keys"].map(key => document.getElementById(key).textContent),
      ]);
    }
    const contact = document.querySelector("#picture .contact");
    contact.dispatchEvent(new MouseEvent("mouseenter", {clientX: 200, clientY: 200}));
    seen.tip = document.querySelectorAll("#tip .bar").length;
    document.querySelectorAll("#torques button")[1].click();
    seen.hidden = document.getElementById("widths").hidden;
    seen.overflow = document.documentElement.scrollWidth - document.documentElement.clientWidth;
    leave();
  };
  wait();
});
</script>"""


@pytest.mark.usefixtures("positions_alone")
def test_bars_and_tilts_are_those_of_the_dataset(run_of, chromium, tmp_path):
    """Bars of the chosen pin stand in the proportion of its line loads, in single precision and whole positions of the page."""
    text = shipped_drive("paper").replace("[pin_shaft]", "[contact]\nslices = 5\n\n[pin_shaft]", 1)
    drive = parse_drive(re.sub(r"(?m)^thickness", "lead_slope = 2e-4\nthickness", text))
    case = next(iter(drive.cases))
    drive = replace(drive, cases={case: drive.cases[case]}, limits={case: drive.limits[case]}, text=text)
    run, dataset = run_of(drive, positions=3)
    seen, console, _ = chromium(run_page(run), WIDTHS, tmp_path, "500,900")
    assert (seen["errors"], console) == ([], [])
    line, tilt, most = (dataset[name].values[0, 0] for name in ("pin_line_load", "disc_tilt", "pin_pressure_max"))
    for position, (pin, heights, told, keys) in enumerate(seen["bars"]):
        expected = line[position, pin]
        assert np.array(heights) / max(heights) == pytest.approx(expected / expected.max(), abs=1e-5)
        assert float(told.partition(" mrad")[0]) == pytest.approx(1e3 * np.hypot(*tilt[position]), abs=6e-4)
        assert f" {most[position, pin]:.0f} MPa at the very end" in keys  # a straight line peaks there
    assert seen["tip"] == 5
    assert seen["hidden"]  # at the light torque nothing is known along the width
    assert seen["overflow"] <= 0
