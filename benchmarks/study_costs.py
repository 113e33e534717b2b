"""Processor time, peak memory and longest silence of the commands that solve many drives, on small numbers.

    .venv/bin/python benchmarks/study_costs.py [--quick] [NAME …]

The shipped robot joint and a 1:99 joint of it (``examples/walks/joint-99.toml``). A silence is the processor time between two
lines of output. Coefficients that are not shipped are derived and cached by the first command that needs them, and counted.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import threading
import tomllib
from pathlib import Path

from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.reading.writing import drive_text

ROOT = Path(__file__).parents[1]
SWEEP = """drive = "{drive}"
positions = 28
quantities = ["max_pin_load", "ptp_transmission_error"]
design = {{ kind = "grid" }}
[factors]
"load.torque" = {{ low = "100 N m", high = "300 N m", levels = 20 }}
"""
SEARCHED = "--vary disc.equidistant_offset=0.01:0.02 --minimise max_pin_load --generations 1"
COMMANDS = {
    "tolerance": "tolerance {drive} --samples 20 --no-page",
    "sweep": "sweep {sweep} --no-page",
    "optimise": "optimise {drive} " + SEARCHED + " --no-page",
    "design": "design {requirements} --best 1",
    "run with friction": "run {rubbing} --no-page",
}
REQUIREMENTS = (ROOT / "examples" / "requirements" / "possible-robot-joint.toml").read_text(encoding="utf-8")


def measured(words: list[str]) -> tuple[float, float, float, int]:
    """Processor time (s), peak memory (MB), longest silence (s of processor time) and exit status of a command."""
    process = subprocess.Popen(
        [sys.executable, "-m", "ltca.commands.program", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        bufsize=0,
    )
    stat, tick = Path(f"/proc/{process.pid}/stat"), os.sysconf("SC_CLK_TCK")
    seen = [0.0]

    def used() -> float:
        user, system, user_of_children, system_of_children = stat.read_text().rpartition(")")[2].split()[11:15]
        return sum(map(int, (user, system, user_of_children, system_of_children))) / tick

    def listen() -> None:
        assert process.stdout is not None
        for _ in process.stdout:
            try:
                seen.append(used())
            except (OSError, ValueError):  # it has ended
                return

    reader = threading.Thread(target=listen, daemon=True)
    reader.start()
    reader.join()
    _, status, usage = os.wait4(process.pid, 0)
    total = usage.ru_utime + usage.ru_stime
    gaps = [later - earlier for earlier, later in zip(seen, [*seen[1:], total], strict=True)]
    return total, usage.ru_maxrss / 1024.0, max(gaps), os.waitstatus_to_exitcode(status)


def drives(folder: Path) -> dict[str, dict[str, Path]]:
    """Write the files of both joints; return them by joint and place in a command."""
    robot = load_drive("robot-joint").cases["nominal"]
    walk = tomllib.loads((ROOT / "examples" / "walks" / "joint-99.toml").read_text(encoding="utf-8"))["edit"]
    joints = {"robot-joint": load_drive("robot-joint").text, "1:99": ""}
    fine = with_fields(robot, {**walk, "load.torque": 200e3})
    tolerances = '\n[tolerances]\ndisc.runout.amount = { distribution = "normal", tolerance = 0.003, cpk = 1.0 }\n'
    joints["1:99"] = drive_text(fine) + tolerances
    files: dict[str, dict[str, Path]] = {}
    for (name, text), ratio, drive in zip(joints.items(), (39, 99), (robot, fine), strict=True):
        stem = name.replace(":", "-")
        texts = {
            "drive": text,
            "sweep": SWEEP.format(drive=folder / f"{stem}-drive.toml"),
            "requirements": REQUIREMENTS.replace("ratio = 39", f"ratio = {ratio}").replace("140 mm", "180 mm"),
            "rubbing": drive_text(with_fields(drive, {"friction.pin": 0.06, "friction.hole": 0.06})),
        }
        files[name] = {key: folder / f"{stem}-{key}.toml" for key in texts}
        for key, path in files[name].items():
            path.write_text(texts[key], encoding="utf-8")
    return files


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help=f"of {', '.join(COMMANDS)}; default all")
    parser.add_argument("--quick", action="store_true", help="half-spaces alone, without derivations")
    parser.add_argument("--joint", action="append", help="robot-joint or 1:99, repeatable; default both")
    given = parser.parse_args()
    print(f"{'joint':<12}{'command':<20}{'processor time, s':>18}{'peak, MB':>10}{'longest silence, s':>20}  status")
    with tempfile.TemporaryDirectory() as folder:
        for joint, files in drives(Path(folder)).items():
            if given.joint and joint not in given.joint:
                continue
            for number, (name, words) in enumerate(COMMANDS.items()):
                if given.names and name not in given.names:
                    continue
                out = Path(folder) / f"{files['drive'].stem}-{number}"
                told = [*words.format(**files).split(), "--out", str(out), *(["--quick"] if given.quick else [])]
                total, peak, silence, status = measured(told)
                print(f"{joint:<12}{name:<20}{total:>18.1f}{peak:>10.0f}{silence:>20.1f}  {status}", flush=True)


if __name__ == "__main__":
    main()
