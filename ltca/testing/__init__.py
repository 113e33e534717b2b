"""Modules for checking alone, which tests of your own can import.

Modules in the order data passes:

==================  ============================================================
random_drives       Random but valid drives, to test the analysis on unforeseen combinations
practical_drives    Drives as people draw them: round numbers, zeros and equalities, steel, aluminium or plastic
crank_drives        Reducers of all kinds: one or several cranks, with and without pin shaft, first stage and supports, either
                    member held
pin_drives          Reducers of all kinds with loose, sleeved or bending pins, or with friction
actual_parts        Actual places of all parts of a drive, computed from its definition independently of `ltca.geometry`
ring_statics        The elastic ring of the wheel by statics: complementary energy with redundants, independently of `ltca.laws`
yielding_pins       Places and energies of loose and bent pins by explicit coordinates, independently of `ltca.laws`
first_stage_check   First stage and forces from outside: normal forces of teeth, moments by quadrature, hand rotations
bearing_springs     Bearings as one-sided springs, and shafts on them, independently of `ltca.equilibrium.supports`
friction_check      Friction of a drive that turns: forces, work and moments, independently of `ltca.equilibrium.friction`
balance_check       Check of an equilibrium by its potential energy, independently of the code that finds it
slice_law           What contacts in slices carry, by own quadratures, independently of `ltca.laws.sliced_line`
width_check         Check of contacts in slices in six directions per disc, independently of the code that finds them
field_changes       A plausible change of every leaf field of a drive, for the test of the contract
malformed           Malformed drive and study files by a seeded generator: wrong values, texts, structures and bytes
elastic_cylinder    An elastic cylinder between two rigid planes, solved with its true boundary: a reference for half-spaces
closed_form_bodies  Influence coefficients of bodies in closed form: a coefficient file without finite elements
bearing_alone       Rollers of a crank bearing with races displaced against each other, while nothing else carries
==================  ============================================================
"""
