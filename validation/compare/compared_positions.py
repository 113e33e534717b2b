"""Every chosen position answered by full finite elements and by each compliance model, and their differences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ltca.analysis.loaded_analysis import LoadedAnalysis, analyse
from ltca.arrays import FloatArray
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.drive.parts import Drive
from ltca.geometry.boundary_stations import Boundary
from validation.compare.comparison import Kind, PositionAnswer, PositionDifference, compare_positions
from validation.compare.disc_stresses import DiscStressAnswer, DiscStressDifference, compare_stresses, stresses_of
from validation.compare.finite_element_positions import FullPosition
from validation.compare.model_positions import MODELS, DiscCoefficients, answers_of, engine_of


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedPosition:
    """One disc at one position in all models.

    Attributes
    ----------
    drive : Drive
        The disc that is compared with wheel, crank and pin shaft, in its case.
    full : FullPosition
        The reference.
    answers : dict of str to PositionAnswer
        By compliance model.
    differences : dict of str to PositionDifference
        Model less full solution.
    station_distance : dict of str to array
        By kind, how far each contact on the disc lies from the nearest station of the coefficients, in spacings
        (0 on a station, 0.5 midway).
    stress : dict of str to DiscStressDifference
        By compliance model that gives the stress in the disc, model less full solution.
    """

    drive: Drive
    full: FullPosition
    answers: dict[str, PositionAnswer]
    differences: dict[str, PositionDifference]
    station_distance: dict[Kind, FloatArray]
    stress: dict[str, DiscStressDifference]


def compare_case(
    drive: Drive, positions: Sequence[FullPosition], coefficients: DiscCoefficients
) -> list[ComparedPosition]:
    """Answer the positions of one case with all models and compare them disc by disc, in the order of `positions`.

    A ring of the wheel is of finite elements in all of them, as in the full solution, whatever ``ring.model`` says.
    """
    if drive.ring is not None:
        drive = replace(drive, ring=replace(drive.ring, model="fe"))
    angles = list(dict.fromkeys(position.crank_angle for position in positions))
    analyses = {model: analyse(drive, np.array(angles), engine=engine_of(model, coefficients)) for model in MODELS}
    of_discs = coefficients if isinstance(coefficients, tuple) else (coefficients,)
    discs = [
        _AnsweredDisc.of_analyses({model: analysis.discs[disc] for model, analysis in analyses.items()}, own)
        for disc, own in enumerate(of_discs)
    ]
    return [discs[full.disc].compare(full, angles.index(full.crank_angle)) for full in positions]


@dataclass(frozen=True, slots=True, kw_only=True)
class _AnsweredDisc:
    """All positions of one disc by all models: answers, distances from stations and stresses as in `ComparedPosition`."""

    drive: Drive
    answers: dict[str, list[PositionAnswer]]
    distances: dict[Kind, FloatArray]
    stresses: dict[str, list[DiscStressAnswer]]

    @classmethod
    def of_analyses(cls, analyses: Mapping[str, LoadedAnalysis], coefficients: InfluenceCoefficients) -> _AnsweredDisc:
        return cls(
            drive=analyses["fe"].drive,
            answers={model: answers_of(analysis) for model, analysis in analyses.items()},
            # The stations of a part that is turned in this disc are turned with it.
            distances=_station_distances(analyses["fe"], coefficients.placed_in(analyses["fe"].drive)),
            stresses={model: found for model, analysis in analyses.items() if (found := stresses_of(analysis))},
        )

    def compare(self, full: FullPosition, row: int) -> ComparedPosition:
        answers = self.answers
        return ComparedPosition(
            drive=self.drive,
            full=full,
            answers={model: found[row] for model, found in answers.items()},
            differences={model: compare_positions(found[row], full.answer) for model, found in answers.items()},
            station_distance={kind: values[row] for kind, values in self.distances.items()},
            stress={model: compare_stresses(found[row], full.stress) for model, found in self.stresses.items()},
        )


def _station_distances(analysis: LoadedAnalysis, coefficients: InfluenceCoefficients) -> dict[Kind, FloatArray]:
    response, rotation = analysis.full.response, analysis.full.pose[:, 2, None]
    # The approach of a hole grows when the disc moves along the line of its contact: its gradient is that direction.
    across = np.arctan2(response.holes.gradient[..., 1], response.holes.gradient[..., 0]) - rotation
    bore = np.angle(response.rollers.outer_direction) - rotation

    def distance(parameter: FloatArray, *boundaries: Boundary) -> FloatArray:
        """Of places in equal numbers on one boundary after the other."""
        each = parameter.shape[1] // max(1, len(boundaries))
        count, offset = (np.repeat([getattr(own, name) for own in boundaries], each) for name in ("count", "offset"))
        place = (parameter - offset) * count / (2.0 * np.pi)
        return np.asarray(np.abs(place - np.round(place)))

    return {
        "pin": distance(response.flank.parameter, coefficients.flank),
        "roller_outer": distance(bore, *coefficients.bores),
        "hole": distance(across, *coefficients.holes),
    }
