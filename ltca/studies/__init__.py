"""Studies at scale: one drive is a sample, thousands of samples times positions are solved in batches.

Modules in the order data passes:

===============  ============================================================
quantities       What a study keeps of each sample: scalars over its positions, by the names of the summary without their
                 units
bound_samples    Which samples bind, by their geometry alone
batch_analysis   The quantities of many drives at once; a sample that cannot be solved says why and stops nobody else
designs          Which samples a study has: every design gives the numbers of any range of samples without the ones before
study            A study: drive, design, positions and quantities, everything a worker needs to solve any batch of it
shapes           Influence coefficients of the shapes that a study has: found before its samples are solved, kept while they
                 are
tolerance_study  Samples drawn from the tolerances of a drive
sweep_file       ``study.toml``: which fields of a drive a sweep varies, how, and what it keeps
execution        Who solves the batches and where their results are kept
run_study        A study from start to files: solve what is left, finish the dataset, sum it up, draw it
study_results    The final dataset and table of a study: written from its samples in order, read back in flat memory
sensitivity      Which tolerances matter: standardised regression over random samples, Sobol indices over Saltelli blocks
binding          Samples that bind, without backlash at the output
yields           The part of the samples that keeps each limit, and all of them, with its confidence
optimiser        Best fields of a drive under limits: scipy's differential evolution on the batch solver, Pareto front of two
                 aims
fine_solution    The quantities of one drive solved finely: many positions for means, extremes searched between them
design_search    From requirements to drives: enumeration by closed forms, refinement, what stands in the way
===============  ============================================================
"""
