"""Solving the batches of a study, and storing their results.

Modules in the order data passes:

===========  ============================================================
workers      Batches on this process, on a local pool of processes or on a dask.distributed cluster: one loop for all
             of them
warm_worker  What every worker needs, imported and built: the fork server of `ltca.studies.execution.workers` loads
             this module once
storage      The folder of a study: plan and finished batches while it runs, then one dataset and one table that are
             whole or not there
===========  ============================================================

Batches are kept as arrays of numpy, which costs 0.9 ms of the 70 ms that a batch is solved in (a table of Parquet 5 ms, a
netCDF file 17 ms), and executors are those of `concurrent.futures`: neither joblib nor dask keeps finished tasks so that a
study killed at any instant goes on without solving them again.
"""
