"""Input: drive files, read, checked against physics, changed and written; coefficient files, checked by laws; arguments.

Modules in the order data passes:

==================  ============================================================
arguments           Arguments that commands share: the same names, metavars, units, bounds and default folders in all of
                    them
toml_text           TOML files as plain tables: any file is read, or refused in one sentence
drive_file          Reading drive files: TOML to validated drives, one for each case, with every mistake reported at
                    once
measured            Files of measured flanks, as deviations
physical_checks     Physical checks of a drive: contradictions between numbers that are valid by themselves
member_checks       Checks of the members together: cranks, values per disc, supports, seats and beams of pins, duty
disc_checks         Checks of a drive of one disc: tooth numbers, flank, pins, bearing, holes and bores, deviations
coefficient_file    Files of influence coefficients: written whole with a checksum, read only when schema, laws and
                    checksum hold
==================  ============================================================
"""
