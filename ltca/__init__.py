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
contact_law            what the mechanics needs of a load–approach law
generator_profile      crown and relief fields of the drive as one profile and its law
flank_separation       true separation of flank, circles and races (Eq. 17–19, 53–58)
contact_grid           one contact on its own grid, solved again while the bodies move
end_pressure           largest pressure, of an end cell of stated size
grid_compliance        contact grids inside every iteration: method direct
paper_method           held wheel, finite-difference tangents (Eq. 90–93): method paper
pressure_fields        p(x, y) of every loaded contact, layout of pressure.nc
pressure_figures       contact zone, roller pressure in 3-D and in sections
random_drives          random but valid drives
equilibrium_check      whether a pose balances, by energies alone
loaded_analysis        a drive at many crank angles: loads, pressures, bearing forces
results                labelled dataset and summary
figures, drive_picture figures of a run, picture of the drive
output_files           whole files or none
progress               progress bar on a terminal
cli, commands          the program ``cyclo``
=====================  ==============================================================================
"""
