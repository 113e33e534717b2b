"""Modules of ``benchmarks/mutants.py``, in the order of their use.

formulas       Mutations of formulas in the numerical code.
processes      Forks of a process with imported packages for every run of pytest, with limits of time and memory.
covered_lines  Coverage map from lines to tests, stored per test file until a source or the test file changes.
"""
