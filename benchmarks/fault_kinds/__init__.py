"""Faults of `benchmarks/faults.py`, a module for each kind with ``configure(parser)`` and ``execute(arguments)``.

========  ============================================================
programs  Commands as programs: started, watched, their folders compared
kills     Commands killed anywhere, by SIGKILL and SIGTERM, and started again
discs     Full and read-only discs, as small file systems of their own
folders   Two programs in one folder
clusters  A dask cluster whose worker or scheduler is killed
========  ============================================================
"""
