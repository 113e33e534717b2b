"""Figures of finished cases, kept beside their pages until the manual is whole: an interrupted one goes on where it stood."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

from ltca.output.files import whole_file
from ltca.output.provenance import code_hash
from ltca.output.regular_files import read_regular
from validation.manual.case import Case, Figure, Outcome, solve_case

LARGEST = 10_000_000
"""Bytes of the figures of a case; those of the largest have 30 kB."""


@dataclass(frozen=True, slots=True, kw_only=True)
class KeptOutcomes:
    """Outcomes of cases by the code that found them.

    Attributes
    ----------
    folder : Path
        Where they are kept, a file for each case.
    """

    folder: Path

    def get(self, case: Case) -> tuple[Outcome, bool]:
        """Return the outcome of a case, solved now where the same code has not kept it, and whether it was kept."""
        path = self._path(case)
        # What cannot be read, is damaged or somebody else's is computed again and replaced.
        with suppress(OSError, ValueError, TypeError, AttributeError):
            content = json.loads(read_regular(path, LARGEST).decode("utf-8"))
            return Outcome(case=case, figures=tuple(Figure(**figure) for figure in content)), True
        outcome = solve_case(case)
        with whole_file(path) as part:
            # Not `write_json`: a figure may be no number, which fails its bound.
            part.write_text(
                json.dumps([asdict(one) for one in outcome.figures], indent=1) + "\n", encoding="utf-8", newline="\n"
            )
        return outcome, False

    def forget(self, cases: tuple[Case, ...]) -> None:
        """Remove what is kept of cases, and the folder where nothing is left in it."""
        for case in cases:
            self._path(case).unlink(missing_ok=True)
        with suppress(OSError):
            self.folder.rmdir()

    def _path(self, case: Case) -> Path:
        return self.folder / f"{case.name}_{code_hash('fem', 'ltca', 'validation')}.json"
