"""Loaded tooth contact analysis of cycloidal gear drives.

Folders in the order data passes; each one's docstring lists its modules.

=============  ============================================================
errors         what the suite raises on purpose
frozen_arrays  Results that stay as they were returned: read-only arrays
output         The edge: files that are whole or not there, progress on a terminal
drive          What a drive is: frozen definitions of its parts, their deviations and tolerances; nothing computed
geometry       Where everything is and how far it is pressed together at a pose; no forces
contact        One contact between half-spaces: from influence coefficients to the pressure over a patch and the
               stress below it
reading        Drive files: read, checked against physics, changed field by field, written
laws           Load–approach laws of single contacts: tables of the half-space, plane strain, springs, laws in series
compliance     Loads of all pairs at a pose: how the bodies yield, three models behind one interface
equilibrium    The pose that balances
analysis       An analysis of a drive and what is read from it
studies        Studies at scale: tolerances, sweeps, optimiser
figures        Pictures of results, by matplotlib and pyvista
testing        What serves checking alone, importable by tests of your own
commands       The program ``cyclo``
drives         Drives that ship with the package
=============  ============================================================
"""
