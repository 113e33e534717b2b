"""Files that are read: drives, checked against physics, changed and written; coefficients, by their laws; arguments.

Modules in the order data passes:

==================  ============================================================
arguments           Arguments that commands share: the same names, metavars, units, bounds and default folders in all of
                    them
toml_text           TOML files as plain tables: whatever the file holds, it is read or refused in one sentence
drive_file          Reading drive files: TOML to validated drives, one for each case, with every mistake reported at
                    once
measured            Files of measured flanks, as deviations
physical_checks     Physical checks of a drive: what its numbers, each fine on its own, cannot be together
pin_checks          Checks of seats and beams of pins: fields that belong together, plays, spans and diameters
deviation_checks    Physical checks of deviations, counts and sizes, and of the flank they leave: it neither folds nor
                    traps its pins
contradictions      Which field is behind a contradiction: the one that alone can mend all of it, not the one whose bound
                    it breaks
changes             A drive with some fields replaced, validated like a drive file
writing             A drive as the text of a drive file
coefficient_schema  What a file of influence coefficients must hold to be used; whoever made it
station_walls       Walls of a disc between its stations: how they bend as beams, and what stations far apart miss of
                    the load across them
coefficient_laws    Checks of a file of influence coefficients by laws that need no second computation
coefficient_file    Files of influence coefficients: written whole with a checksum, read only when schema, laws and
                    checksum hold
==================  ============================================================
"""
