"""What every worker needs, imported and built: the fork server of `ltca.studies.execution.workers` loads this module once."""

from __future__ import annotations

import numpy as np

from ltca.output.threads import use_one_thread
from ltca.reading.drive_file import load_drive
from ltca.studies.batch_analysis import BatchSettings, analyse_samples
from ltca.studies.quantities import quantities_for

use_one_thread()

# The tables of line contact do not depend on the drive; solving one position of any drive builds them all.
_ANY = next(iter(load_drive("paper").cases.values()))
analyse_samples([_ANY], BatchSettings(crank_angle=np.zeros(1), quantities=quantities_for(_ANY, None)))
