"""Whether pyvista can render off-screen here, tried in a subprocess.

Where the GL libraries are missing VTK does not raise, it ends the process; so a child process tries first.
"""

from __future__ import annotations

import functools
import os
import subprocess
import sys

_PROBE = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(16, 16))
plotter.add_mesh(pyvista.Sphere())
plotter.screenshot(None, return_img=True)
plotter.close()
print("rendered")
"""
PROBE_SECONDS = 60.0


@functools.cache
def rendering_problem() -> str:
    """Return why pyvista cannot render off-screen in this process's environment, "" when it can.

    The result of the first call is cached: the probe takes about a second.
    """
    # A way out for a machine whose driver passes the trial and fails later.
    if os.environ.get("CYCLO_NO_PYVISTA"):
        return "CYCLO_NO_PYVISTA is set"
    try:
        probe = subprocess.run(
            [sys.executable, "-c", _PROBE],
            capture_output=True,
            text=True,
            errors="replace",
            timeout=PROBE_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"the trial rendering did not end: {error}"
    if probe.returncode == 0 and "rendered" in probe.stdout:
        return ""
    if probe.returncode < 0:
        return f"the trial rendering was ended by signal {-probe.returncode} (GL libraries missing?)"
    lines = probe.stderr.strip().splitlines()
    return f"the trial rendering failed: {lines[-1] if lines else f'exit status {probe.returncode}'}"
