"""What serves checking alone, importable by tests of your own.

Modules in the order data passes:

==================  ============================================================
random_drives       Random but valid drives, to try the analysis on what nobody thought of
practical_drives    Drives as people draw them: round numbers, zeros and equalities, steel, aluminium or plastic
crank_drives        Reducers of all kinds: one or several cranks, with and without pin shaft, first stage and supports, either
                    member held
pin_drives          Such reducers whose pins are loose, sleeved or bend, or not, and such with friction
actual_parts        Every part of a drive at its actual place, written out from the definition apart from `ltca.geometry`
yielding_pins       Where loose and bent pins are, and what they store: coordinates of their own, apart from `ltca.laws`
friction_check      What rubs in a drive that turns: forces, work and moments, apart from `ltca.equilibrium.friction`
balance_check       Whether a pose balances, found without the code that balances it
field_changes       One sensible change for every leaf field of a drive: what the contract is walked with
malformed           Malformed drive and study files by a seeded generator: values, texts, structures and bytes nobody
                    should write
elastic_cylinder    An elastic cylinder between two rigid planes, solved with its true boundary: what half-spaces are
                    measured by
closed_form_bodies  Influence coefficients of bodies in closed form: a coefficient file without finite elements
==================  ============================================================
"""
