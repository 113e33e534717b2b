"""Loaded tooth contact analysis of cycloidal gear drives.

Modules in the order data passes through them:

=====================  ==============================================================================
drive                  frozen definitions of parts, clearances, load, materials
units                  quantities: plain numbers and texts with units
drive_checks           what the numbers of a drive cannot be together
drive_file             TOML to validated drives, one for each case
profile                flank, normals, curvature, nearest point (Eq. 1)
placement              where pins, rollers and holes stand, errors included (Eq. 47–51)
pairs                  approach of every pair at a pose, with derivatives (Eq. 45–64)
tooth_contact          first contact, backlash, unloaded transmission error (Eq. 2–6)
influence              Boussinesq–Love influence coefficients of rectangles
unilateral             p ≥ 0 contact problem on cells, exactly
patch                  grid and pressure of one contact patch
slenderness_curve      smooth curves for dimensionless laws
line_contact           load–approach law of uncrowned cylinders, one table for all
length_profile         crown and relief along rollers and pins
profiled_line_contact  load–approach law of crowned or relieved cylinders
hertz                  closed forms to compare with
roller_series          a roller as two laws in series (Eq. 52, 57, 66)
compliance             loads of all pairs at a pose
equilibrium            the pose that balances (Eq. 43–44, 70–72, 85–89)
clearance_free         LTCA without clearances as one linear system (Eq. 7–40)
loaded_analysis        a drive at many crank angles: loads, pressures, bearing forces
results                labelled dataset and summary
figures, drive_picture figures of a run, picture of the drive
output_files           whole files or none
progress               progress bar on a terminal
cli, commands          the program ``cyclo``
=====================  ==============================================================================
"""
