"""A reduced drive as a functional mock-up unit: FMI 2.0, co-simulation, its C sources inside."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterable
from importlib.resources import files
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from ltca.errors import FaultError
from ltca.output.files import whole_file

SOURCE, TABLES = "reduced_drive.c", "reduced_drive_tables.h"
COMPILERS = ("cc", "gcc", "clang")
LONGEST = 120.0
"""Time, s, after which a compiler is given up."""
DATE = (1980, 1, 1, 0, 0, 0)
"""Of all entries: the same drive gives the same bytes."""
VARIABLES = (
    ("input_angle", "input", "rad", "Angle of the input, ccw positive"),
    ("output_angle", "input", "rad", "Angle of the output, ccw positive"),
    ("input_torque", "output", "N.m", "Torque of the drive on the shaft of the input, ccw positive"),
    ("output_torque", "output", "N.m", "Torque of the drive on the shaft of the output, ccw positive"),
    ("wind_up", "output", "rad", "Output angle less input angle by the ratio"),
    ("elastic_torque", "output", "N.m", "Torque of the wind-up without hysteresis"),
)
"""Name, causality, unit, meaning; their places are the value references of reduced_drive.c."""


def _row(values: Iterable[float]) -> str:
    return "{" + ", ".join(f"{float(value):.17g}" for value in values) + "}"


def tables_header(tables: dict[str, Any]) -> str:
    """Return the C header with the tables of a drive.

    Parameters
    ----------
    tables : dict
        Content of the JSON file of the drive, with its name.
    """
    wind_up, friction, loop = tables["wind_up"], tables["friction"], tables["hysteresis"]
    orders, nodes = wind_up["orders"], len(wind_up["torque_N_m"])
    around = loop["factor_orders"]
    ends = {way: [[one[f"cos_{way}"], one[f"sin_{way}"]] for one in around] or [[0.0, 0.0]] for way in ("ccw", "cw")}
    # C has no empty arrays: what has no entries has one that is not read.
    none: list[dict[str, Any]] = [{"cos_rad": [0.0] * nodes, "sin_rad": [0.0] * nodes}]

    def matrix(name: str, key: str) -> str:
        rows = ",\n    ".join(_row(one[key]) for one in orders or none)
        return f"static const double {name}[][NODES] = {{\n    {rows}}};"

    def vector(name: str, values: list[float]) -> str:
        return f"static const double {name}[] = {_row(values or [0.0])};"

    lines = [
        f"/* {tables['fingerprint']}: the drive; N m and rad. */",
        f"enum {{ NODES = {nodes}, ORDERS = {len(orders)}, ELEMENTS = {len(loop['strength'])}, "
        f"FRICTIONS = {len(friction['torque_N_m'])}, FACTORS = {len(around)} }};",
        f"static const double RATIO = {tables['transmission_ratio']:.17g};",
        f"static const double CRANKS = {tables['crank_turns_per_input_turn']:.17g};",
        f"static const double RATED = {tables['limits']['rated_torque_N_m']:.17g};",
        f"static const double BRISTLE_ANGLE = {friction['bristle_angle_rad']:.17g};",
        vector("TORQUE", wind_up["torque_N_m"]),
        vector("MEAN", wind_up["mean_rad"]),
        vector("ORDER", [one["order"] for one in orders]),
        matrix("COSINE", "cos_rad"),
        matrix("SINE", "sin_rad"),
        vector("FLANK", loop["flank"]),
        vector("EXPONENT", loop["exponent"]),
        vector("STRENGTH", loop["strength"]),
        vector("STIFFNESS", loop["stiffness"]),
        vector("WEIGHT_ORDER", loop["weight_order"]),
        vector("WEIGHT_AMPLITUDE", loop["weight_amplitude"]),
        vector("WEIGHT_PHASE", loop["weight_phase_rad"]),
        vector("FACTOR_ORDER", [one["order"] for one in around]),
        *(
            f"static const double FACTOR_{way.upper()}[][2] = {{{', '.join(map(_row, rows))}}};"
            for way, rows in ends.items()
        ),
        vector("FRICTION_TORQUE", friction["torque_N_m"]),
        vector("FRICTION_CCW", friction["at_input_turning_ccw_N_m"]),
        vector("FRICTION_CW", friction["at_input_turning_cw_N_m"]),
    ]
    text = "\n".join(lines) + "\n"
    return f'#define GUID "{hashlib.sha256(text.encode()).hexdigest()[:32]}"\n{text}'


def model_description(tables: dict[str, Any]) -> str:
    """Return modelDescription.xml.

    Parameters
    ----------
    tables : dict
        Content of the JSON file of the drive, with its name.
    """
    name = tables["name"]
    guid = tables_header(tables).partition('"')[2].partition('"')[0]
    told = f"{tables['drive']} {tables['case']}, fingerprint {tables['fingerprint']}: valid to "
    told += f"{tables['limits']['peak_torque_N_m']:g} N m, within "
    told += f"{100.0 * tables['fit_error']['worst']['part_of_torque_range']:.2g} % of the torque range of the analysis"
    scalars = []
    for place, (variable, causality, unit, words) in enumerate(VARIABLES):
        start = ' start="0"' if causality == "input" else ""
        scalars.append(
            f'    <ScalarVariable name="{variable}" valueReference="{place}" causality="{causality}" variability="continuous" '
            f'description="{escape(words)}">\n      <Real unit="{unit}"{start}/>\n    </ScalarVariable>'
        )
    scalars.append(
        f'    <ScalarVariable name="transmission_ratio" valueReference="{len(VARIABLES)}" causality="local" '
        f'variability="constant" initial="exact" description="Turns of the input for one of the output">\n'
        f'      <Real start="{tables["transmission_ratio"]:.12g}"/>\n    </ScalarVariable>'
    )
    outputs = [place for place, row in enumerate(VARIABLES, start=1) if row[1] == "output"]
    unknowns = "\n".join(f'      <Unknown index="{place}" dependencies="1 2"/>' for place in outputs)
    both = "\n".join(f'      <Unknown index="{place}" dependencies="1 2"/>' for place in outputs)
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="{guid}" description={quoteattr(told)}
    version={quoteattr(tables["cyclo_version"])} generationTool={quoteattr("cyclo " + tables["cyclo_version"])}
    variableNamingConvention="flat">
  <CoSimulation modelIdentifier="{name}" canHandleVariableCommunicationStepSize="true" canGetAndSetFMUstate="true"
      canSerializeFMUstate="true" canNotUseMemoryManagementFunctions="true">
    <SourceFiles>
      <File name="{SOURCE}"/>
    </SourceFiles>
  </CoSimulation>
  <UnitDefinitions>
    <Unit name="rad"><BaseUnit rad="1"/></Unit>
    <Unit name="N.m"><BaseUnit kg="1" m="2" s="-2"/></Unit>
  </UnitDefinitions>
  <ModelVariables>
{chr(10).join(scalars)}
  </ModelVariables>
  <ModelStructure>
    <Outputs>
{unknowns}
    </Outputs>
    <InitialUnknowns>
{both}
    </InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""


def platform() -> tuple[str, str]:
    """Return folder and suffix of a binary on this machine, as FMI 2.0 names them."""
    bits = "64" if sys.maxsize > 2**32 else "32"
    if sys.platform == "win32":
        return f"win{bits}", ".dll"
    return (f"darwin{bits}", ".dylib") if sys.platform == "darwin" else (f"linux{bits}", ".so")


def find_compiler() -> str | None:
    """Return a C compiler: the one of the environment variable CC, or one of `COMPILERS`; None where there is none."""
    named = os.environ.get("CC")
    return shutil.which(named) if named else next(filter(None, map(shutil.which, COMPILERS)), None)


def compile_binary(sources: dict[str, str], name: str, compiler: str) -> bytes:
    """Return the shared library of C sources.

    Parameters
    ----------
    sources : dict of str to str
        Files by their names.
    name : str
        Of the library.
    compiler : str
        That takes the options of cc.

    Raises
    ------
    FaultError
        When it does not compile.
    """
    suffix = platform()[1]
    with tempfile.TemporaryDirectory() as folder:
        for file, text in sources.items():
            (Path(folder) / file).write_text(text, encoding="utf-8", newline="\n")
        command = [compiler, "-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden"]
        command += ["-o", name + suffix, SOURCE, "-lm"]
        try:
            run = subprocess.run(
                command, cwd=folder, capture_output=True, text=True, errors="replace", timeout=LONGEST, check=False
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            raise FaultError(f"{compiler}: did not compile the unit: {error}") from error
        if run.returncode:
            raise FaultError(f"{compiler}: did not compile the unit: {run.stderr.strip()[:500]}")
        return (Path(folder) / (name + suffix)).read_bytes()


def write_unit(tables: dict[str, Any], path: Path) -> str:
    """Write the unit; return in words whether it is compiled.

    Parameters
    ----------
    tables : dict
        Content of the JSON file of the drive, with its name.
    path : Path
        Of the file, ``.fmu``.
    """
    name = tables["name"]
    sources = {
        SOURCE: files("ltca.export.simulators").joinpath("sources", SOURCE).read_text(encoding="utf-8"),
        TABLES: tables_header(tables),
    }
    entries: dict[str, bytes] = {"modelDescription.xml": model_description(tables).encode()}
    entries |= {f"sources/{file}": text.encode() for file, text in sources.items()}
    compiler, (folder, suffix) = find_compiler(), platform()
    told = f"not compiled: no C compiler ({', '.join(COMPILERS)}) is there; the sources are inside"
    if compiler is not None:
        entries[f"binaries/{folder}/{name}{suffix}"] = compile_binary(sources, name, compiler)
        told = f"compiled for {folder} by {Path(compiler).name}; the sources are inside"
    with whole_file(path) as part, zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
        for entry, content in entries.items():
            archive.writestr(zipfile.ZipInfo(entry, DATE), content, zipfile.ZIP_DEFLATED)
    return told
