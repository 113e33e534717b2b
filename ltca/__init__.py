"""Loaded tooth contact analysis of cycloidal gear drives.

Modules in the order data passes through them:

=====================  ==============================================================================
drive                  frozen definitions of parts, clearances, load, materials
deviations             departures of real parts from their drawing
units                  quantities: plain numbers and texts with units
drive_checks           what the numbers of a drive cannot be together
deviation_checks       counts, sizes, flanks that fold or trap pins
drive_fields           fields by dotted path; a drive as text
tolerances             how fields scatter: the [tolerances] table
drive_file             TOML to validated drives, one for each case
unit_circle            e^{iφ} by products
profile_deviation      deviation of the flank along its normal
profile                flank, normals, curvature, nearest point (Eq. 1)
placement              where pins, rollers and holes stand, errors included (Eq. 47–51)
pairs                  approach of every pair at a pose, with derivatives (Eq. 45–64)
tooth_contact          first contact, backlash, unloaded transmission error (Eq. 2–6)
rigid_limit            play of all clearances together, disc floating
influence              Boussinesq–Love influence coefficients of rectangles
unilateral             p ≥ 0 contact problem on cells, exactly
patch                  grid and pressure of one contact patch
slenderness_curve      smooth curves for dimensionless laws
line_contact           load–approach law of uncrowned cylinders, one table for all
length_profile         crown and relief along rollers and pins
profiled_line_contact  load–approach law of crowned or relieved cylinders
hertz                  closed forms to compare with
free_end               factor of free ends on influence coefficients
subsurface             stresses below a patch, largest shear and its depth
roller_series          a roller as two laws in series (Eq. 52, 57, 66)
compliance             loads of all pairs at a pose
plane_contact          load–approach law in plane strain, with a datum
series_law             springs and contacts in series
coefficients           influence coefficients of the bodies, at any place
coefficient_files      where coefficients come from: file, cache, derivation
body_part              what finite elements have beyond the near fields
coupled_compliance     loads of contacts that feel each other (fe, hybrid)
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
torque_curve           torque against wind-up, lost motion, stiffness
transmission_error_spectrum  orders of the transmission error by name
rating_life            life of the crank bearing (ISO 281, ISO/TS 16281)
pressure_safety        flank pressure against a limit
studies                samples by the thousand: tolerances, sweeps, optimiser
results                labelled dataset and summary
figures, drive_picture, curve_figures  figures of a run, picture of the drive, curves
output_files           whole files or none
progress               progress bar on a terminal
cli, commands          the program ``cyclo``
=====================  ==============================================================================
"""
