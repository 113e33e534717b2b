"""Who solves the batches of a study, and where their results are kept.

Modules in the order data passes:

===========  ============================================================
workers      Batches on this process, on a local pool of processes or on a dask.distributed cluster: one loop for all
             of them
warm_worker  What every worker needs, imported and built: the fork server of `ltca.studies.execution.workers` loads
             this module once
batch_files  Files of finished batches: each says whose it is and carries a checksum; nothing in them is executed
storage      Files of a study: finished batches while it runs, then one dataset and one table that are whole or not
             there
===========  ============================================================
"""
