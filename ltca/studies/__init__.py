"""Studies at scale: one drive is a sample, thousands of samples times positions are solved in batches.

==================  ============================================================================
quantities          what a study keeps of each sample, by name and unit
batch_analysis      the quantities of many drives at once; a sample that fails says why
designs             which samples there are: random, Sobol, Latin hypercube, grid, list, Saltelli
study               drive, design, positions and quantities: everything a worker needs
shapes              influence coefficients of the shapes that a study has
execution           who solves the batches and where their results are kept
sensitivity         standardised regression, Sobol indices
fine_solution       the quantities of one drive solved finely
study_results       the final dataset read in flat memory
run_study           a study from start to files
tolerance_study     samples drawn from the tolerances of a drive
sweep_file          ``study.toml`` to a study
optimiser           best fields of a drive under bounds, Pareto front of two aims
==================  ============================================================================
"""
