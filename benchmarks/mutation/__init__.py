"""What ``benchmarks/mutants.py`` is made of, in the order it is used.

formulas       Places in the packages' numerics where one formula can be broken, and the broken source.
processes      A warm process that forks for every run of pytest: seconds saved each time, limits on time and memory.
covered_lines  Which tests run which lines, test file by test file, kept until a source or the test file changes.
"""
