"""Fault kinds of `benchmarks/faults.py`, one module per kind with ``configure(parser)`` and ``execute(arguments)``.

=========  ============================================================
programs   Start commands as processes and compare their output folders
malformed  Malformed drives and studies: refused with a short message, or solved
kills      Commands killed at random times by SIGKILL or SIGTERM and restarted: identical output, no remaining processes or
           temporary files
discs      Full and read-only disks: a one-line message, no incomplete files
folders    Two runs in one folder: one completes, the other is refused with a one-line message
clusters   A dask cluster whose worker or scheduler is killed: identical output, or a one-line message and a successful
           resume
=========  ============================================================
"""
