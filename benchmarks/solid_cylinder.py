"""What a cylinder with free ends yields at a contact beyond plane strain: the table of `ltca.compliance.solid_cylinder`.

``python benchmarks/solid_cylinder.py`` solves cylinders by finite elements in three dimensions (`fem.coefficients`), pressed by
one patch even and linear along their length and balanced by forces of their whole volume, and prints by Poisson ratios (rows)
and radii by the length (columns) what is beyond plane strain, in the logarithm's units. ``--size 2`` beside it is
the error of the mesh.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

import numpy as np

sys.path[0] = str(Path(__file__).resolve().parents[1])  # the package fem, not the benchmark of that name

from fem.coefficients.pieces import Pieces
from fem.coefficients.solid_bodies import SolidOptions
from fem.coefficients.solid_dataset import SectionMesh, solid_round
from fem.mesh.boundary_division import MAX_TURN
from fem.shapes import CircleShape
from ltca.compliance.solid_cylinder import POISSON_RATIOS, RADIUS_BY_LENGTH
from ltca.drive.parts import Material


def ends_of(poisson_ratio: float, ratio: float, size: float, layers: int) -> tuple[float, float]:
    """Return even and linear differences of a cylinder of the radius 1, by κ and 12 κ/t²."""
    length = 1.0 / ratio
    material = Material(youngs_modulus=1.0, poisson_ratio=poisson_ratio)
    pieces = Pieces.of_key(json.dumps(["cylinder", poisson_ratio, ratio, size, layers]))
    options = SolidOptions(thickness=length, layers=layers, tell=lambda _: None, pieces=pieces)
    shape, at = CircleShape(name="cylinder", radius=1.0, core_radius=0.0), np.zeros(1)
    found = solid_round("solid cylinder", shape, at, at, material, SectionMesh(size, MAX_TURN), options)
    unit = 2.0 * (1.0 - poisson_ratio**2) / (np.pi * length)
    return float(found.even[0, 0]) / unit, float(found.linear[0, 0]) / unit * length**2 / 12.0


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=float, default=1.0, help="of elements, as of cyclo derive; default 1")
    parser.add_argument("--layers", type=int, default=4, help="over half of the length; default 4")
    arguments = parser.parse_args()
    every = np.array(
        [[ends_of(nu, ratio, arguments.size, arguments.layers) for ratio in RADIUS_BY_LENGTH] for nu in POISSON_RATIOS]
    )
    for name, table in (("EVEN", every[..., 0]), ("LINEAR", every[..., 1])):
        print(name)
        for row in table:
            print("    (" + ", ".join(f"{value:.4f}" for value in row) + "),", flush=True)


if __name__ == "__main__":
    main()
