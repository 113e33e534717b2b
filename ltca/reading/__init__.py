"""Input: drive files, read, checked against physics, changed and written; coefficient files, checked by laws; arguments.

Modules in the order data passes:

==================  ============================================================
arguments           Arguments that commands share: the same names, metavars, units, bounds and default folders in all of
                    them
toml_text           TOML files as plain tables: any file is read, or refused in one sentence
toml_edit           A value changed in the text of a TOML file, everything else to the letter
drive_file          Reading drive files: TOML to validated drives, one for each case, with every mistake reported at
                    once
bearing_names       Bought bearings in drive files, as fields: names, clearance classes, entries of the user's own
measured            Files of measured flanks, as deviations
physical_checks     Physical checks of a drive: contradictions between numbers that are valid by themselves
member_checks       Checks of the members together: cranks, values per disc, supports, seats and beams of pins, duty
alternatives        Contradictions that a bound of either of two fields resolves, with the fields as data
disc_checks         Checks of a drive of one disc: tooth numbers, flank, pins, bearing, holes and bores, deviations
width_checks        Checks of the width of the contacts: slices, what needs them, leads and inclinations
contradictions      Cause of contradictions: the field that alone can resolve all of them, not the one whose bound is
                    violated
changes             A drive with some fields replaced, validated like a drive file
writing             A drive as the text of a drive file
coefficient_schema  Schema of a file of influence coefficients, of this or another code
station_walls       Walls of a disc between its stations: how they bend as beams, and what stations far apart miss of
                    the load across them
coefficient_laws    Checks of a file of influence coefficients by laws that need no second computation
coefficient_file    Files of influence coefficients: written whole with a checksum, read only when schema, laws and
                    checksum hold
ring_file           Files of the flexibility of a ring of the pin wheel: schema and laws
==================  ============================================================
"""
