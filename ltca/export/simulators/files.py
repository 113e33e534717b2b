"""Which files a format of simulators has, and writing them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from importlib.resources import files
from pathlib import Path
from typing import Any

from ltca.errors import DriveError
from ltca.export.simulators.functional_mockup_unit import write_unit
from ltca.export.simulators.lookup_tables import csv_texts, readme_text
from ltca.export.simulators.modelica_package import modelica_text
from ltca.export.simulators.mujoco_model import mjcf_text
from ltca.export.simulators.urdf_model import urdf_text
from ltca.output.file_names import digest_of, spelled_alike
from ltca.output.files import whole_file, write_json

CALLBACK, LAW = "mujoco_callback.py", "reduced_drive.py"
HOME = "ltca.analysis.reduced_model.reduced_drive"
"""Of the law in the suite; beside the exported files it is `LAW`."""
LONGEST_MODEL = 100
"""Signs of the name of a model that are kept: endings, and what a file is called while it is written, go after it."""
TABLES = ("wind_up.csv", "friction.csv", "hysteresis.csv", "hysteresis_factor.csv")


def model_name(drive: str, case: str, cases: Iterable[str] = ()) -> str:
    """Return a name that XML, C and Modelica take: letters, digits and underscores, a letter first.

    Where other signs than hyphens are replaced, the name is cut, or Windows and macOS take that of another one of all `cases` of
    the drive file for it, it ends with a hash of both names: "groß ö" and "groß ä" are two models, and "a" and "A".

    Examples
    --------
    >>> model_name("robot-joint", "nominal")
    'robot_joint_nominal'
    >>> model_name("d", "a", ["a", "A"]).lower() == model_name("d", "A", ["a", "A"]).lower()
    False
    """
    whole = f"{drive}_{case}"
    name = re.sub(r"[^A-Za-z0-9_]", "_", whole)
    alike = any(other != case and spelled_alike(other) == spelled_alike(case) for other in cases)
    if len(name) > LONGEST_MODEL or re.search(r"[^A-Za-z0-9_-]", whole) or alike:
        name = f"{name[:LONGEST_MODEL]}_{digest_of(whole)}"
    return name if name[0].isalpha() else f"drive_{name}"


def file_names(kind: str, name: str) -> tuple[str, ...]:
    """Return the files of a format, the model first.

    Parameters
    ----------
    kind : {"json", "mujoco", "urdf", "modelica", "fmu"}
        The format.
    name : str
        Of the model.
    """
    return {
        "json": (f"{name}.json", *(f"{name}_{end}" for end in TABLES), LAW, f"{name}_readme.md"),
        "mujoco": (f"{name}.xml", f"{name}.json", CALLBACK, LAW),
        "urdf": (f"{name}.urdf", f"{name}.json"),
        "modelica": (f"{name}.mo",),
        "fmu": (f"{name}.fmu",),
    }[kind]


def require_exportable(kind: str, speed: float | None, without_density: tuple[str, ...]) -> None:
    """Refuse, before anything is solved, what a format needs and the drive file does not say.

    Parameters
    ----------
    kind : str
        The format.
    speed : float or None
        Of the input, turns a minute.
    without_density : tuple of str
        Materials whose density is not known.

    Raises
    ------
    DriveError
        With every one of them.
    """
    problems = []
    if kind == "urdf" and speed is None:
        problems.append(
            "load.speed: must be given for --for urdf, whose <limit> has a velocity: by --speed N (of the input, rpm), in the "
            "drive file, or by [[duty]]"
        )
    if kind in ("mujoco", "urdf"):
        problems += [
            f"{path}: must be given for --for {kind}, whose bodies have inertia, kg/m³ (a named material has it)"
            for path in without_density
        ]
    if problems:
        raise DriveError(problems)


def write_simulator(kind: str, tables: dict[str, Any], out: Path) -> list[str]:
    """Write the files of a format; return what is to be told of them.

    Parameters
    ----------
    kind : {"json", "mujoco", "urdf", "modelica", "fmu"}
        The format.
    tables : dict
        Content of the JSON file of the drive, with its name.
    out : Path
        Folder.
    """
    name = tables["name"]
    if kind == "fmu":
        return [write_unit(tables, out / f"{name}.fmu")]
    if kind == "modelica":
        _write(out / f"{name}.mo", modelica_text(tables))
        return []
    write_json(out / f"{name}.json", tables)
    if kind == "mujoco":
        _write(out / f"{name}.xml", mjcf_text(tables))
        callback = files("ltca.export.simulators").joinpath(CALLBACK).read_text(encoding="utf-8")
        _write(out / CALLBACK, callback.replace(f"from {HOME} import", "from reduced_drive import"))
    if kind == "urdf":
        _write(out / f"{name}.urdf", urdf_text(tables))
    if kind == "json":
        for end, text in csv_texts(tables).items():
            _write(out / f"{name}_{end}", text)
        _write(out / f"{name}_readme.md", readme_text(tables))
    if kind in ("json", "mujoco"):
        _write(out / LAW, files("ltca.analysis.reduced_model").joinpath(LAW).read_text(encoding="utf-8"))
    return []


def _write(path: Path, text: str) -> None:
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
