"""Processor and wall time of the studio from an edit to its coarse answer: server, fork server and workers together.

Edits go one after the other, as when a slider is dragged and let go; the fine answer is not asked for.
"""

from __future__ import annotations

import argparse
import http.client
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from urllib.parse import urlsplit

from ltca.reading.drive_file import shipped_drive

DRIVES = ("paper", "robot-joint")
TURNED = {"paper": ("disc.shifting_offset", 0.09), "robot-joint": ("disc.shifting_offset", 0.005)}
TICK = os.sysconf("SC_CLK_TCK")


def processes(root: int) -> list[int]:
    """Return a process and all below it."""
    children: dict[int, list[int]] = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            except OSError:
                continue
            children.setdefault(parent, []).append(int(entry.name))
    found = [root]
    for process in found:
        found += children.get(process, [])
    return found


def processor_seconds(root: int) -> float:
    """Return the processor time of a process and all below it, those that have ended included."""
    total = 0
    for process in processes(root):
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        total += sum(map(int, fields[11:15]))
    return total / TICK


def measure(drive: str, edits: int) -> tuple[float, list[float]]:
    """Return the processor time by edit and the wall times of all, s."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "ltca.commands.program", "studio", drive, "--no-browser"]
        server = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True)
        try:
            assert server.stdout is not None
            address = urlsplit(server.stdout.readline().split(": ", 1)[1].strip())
            connection = http.client.HTTPConnection(str(address.hostname), address.port)

            def ask(path: str, content: dict[str, object]) -> dict[str, object]:
                connection.request(
                    "POST", address.path + path, json.dumps(content), {"Content-Type": "application/json"}
                )
                return dict(json.loads(connection.getresponse().read()))

            text, (field, value), walls = shipped_drive(drive), TURNED[drive], []
            began = 0.0
            for number in range(edits + 5):
                if number == 5:  # warm
                    began = processor_seconds(server.pid)
                start = time.perf_counter()
                typed = f"{value * (1.0 + 0.01 * (number % 20)):.6g}"
                text = str(ask("edit", {"text": text, "case": "", "changes": {field: typed}})["text"])
                answer = ask("answer", {"text": text, "tab": "one", "case": "", "quality": "coarse"})
                assert "sentence" in answer, answer
                walls += [time.perf_counter() - start] if number >= 5 else []
            return (processor_seconds(server.pid) - began) / edits, walls
        finally:
            server.terminate()
            server.wait()


def main() -> None:
    """Print both times of both drives."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--edits", type=int, default=60, help="default 60")
    edits = parser.parse_args().edits
    for drive in DRIVES:
        seconds, walls = measure(drive, edits)
        ends = f"{1e3 * min(walls):.0f} … {1e3 * max(walls):.0f} ms"
        print(f"{drive}: {1e3 * seconds:.0f} ms of processor an edit; {1e3 * statistics.median(walls):.0f} ms, {ends}")


if __name__ == "__main__":
    main()
