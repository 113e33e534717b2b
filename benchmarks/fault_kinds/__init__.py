"""Faults of `benchmarks/faults.py`, a module for each kind with ``configure(parser)`` and ``execute(arguments)``.

=========  ============================================================
programs   Commands as programs: started, watched, their folders compared
malformed  Malformed drives and studies: refused in a few lines, or solved
kills      Commands killed anywhere, by SIGKILL and SIGTERM, and started again: the same bytes, no child, no temporary file
           left
discs      Full and read-only discs, small file systems of their own: one line, nothing half-written
folders    Two programs in one folder: one goes on as if alone, the other is refused in a line
clusters   A dask cluster whose worker or scheduler is killed: the study ends with the same bytes, or in a line and then
           resumes
=========  ============================================================
"""
