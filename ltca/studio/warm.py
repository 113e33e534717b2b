"""What every worker of the studio needs, imported and built: the fork server loads this module once."""

from __future__ import annotations

import gc

from ltca.output.threads import use_one_thread
from ltca.reading.drive_file import shipped_drive
from ltca.studio.answers import COARSE, FINE, Memory, Question, answer

use_one_thread()

# Tables of laws, compiled templates and whatever libraries load late: of any drive.
for _quality in (COARSE, FINE):
    answer(Question(text=shipped_drive(), source="paper", case="", quality=_quality), Memory())

gc.collect()
gc.freeze()  # what is there stays: collections of workers need not look through it
