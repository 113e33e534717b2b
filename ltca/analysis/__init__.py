"""An analysis of a drive and what is read from it.

Modules in the order data passes:

=========================  ============================================================
engines                    Engines: how the bodies of a drive yield and how its equilibrium is found, as frozen values with
                           their options
half_space_errors          How far half-spaces are off, measured on the shipped drives, and in which direction
friction                   Losses of a drive that turns, the loop of one whose input is locked
loaded_analysis            Loaded tooth contact analysis of one drive at many crank angles: equilibrium, then
                           pressures and bearing forces
run_off                    How far contacts reach along their width: run-off of crowned ones, and such over too few slices
width                      Along the width of contacts in slices: line loads, pressures, moments, tilts
reactions                  What the bearings of cranks and output carry: forces of discs, first stage and from outside
contact_arrays             Arrays of all contacts by their names in the registry
time_need                  About how long the analysis of a drive takes, told beforehand
light_torque               The answer of an analysis at its light torque, as an analysis at that torque
methods                    Methods of other packages: contact grids and the paper's iteration
half_width_guard           Where half-spaces and the parabolas of tables end: contacts wider than the bodies are curved are
                           refused, by name
extremes                   Extremes of an analysis between its positions: peak-to-peak values and largest loads that do not
                           hang on sampling
results                    The labelled dataset of a run: what ``results.nc`` holds
mass_values                Masses, unbalance and inertias as results hold and print them
summary                    The scalars of one case: what ``summary.json`` holds
summary_rows               Which of them a table shows, in which order
derivatives                Derivatives of loads, poses, angles and pressures of a balanced drive with respect to its fields
pressure_fields            Pressure over every loaded contact at chosen crank angles: solved on grids at the pose
                           found, as one dataset
tilted_fields              The same over contacts in slices, which tilt
torque_curve               Torque against wind-up over both directions, and what is read from it: backlash, lost
                           motion, torsional stiffness
share_causes               Beams and planes by which equal discs share the torque unequally
stiffness_by_part          Torsional stiffness with and without each part that a file describes
transmission_error_orders  Orders of the transmission error by name, fitted together
life                       Rating life and static safety of the crank bearings from the loads of their rollers
force_orders               Spectra of single forces, by the orders of their own passage and of what passes elsewhere
vibration                  Modes over a turn and over torque, orders that excite them, critical speeds
forces_in_motion           Forces of single parts in motion: spectra, largest loads
forced_vibration           Response to the orders of the transmission error over speed, dynamic factors of contacts
force_dataset              What vibrations leave of single forces: the dataset ``dynamics.nc``
time_run                   A drive in time on the laws of its contacts: start, ramp, torque step, reversal, swinging load
time_dataset               What a run in time leaves: dataset and numbers
drive_curves               Curves of one drive: torque curve, orders, lives and pressure over turns
reduced_model              A drive reduced to what simulators of robots and machines hold, with the error of the fit
verdict                    A verdict on a design: values against limits that each have a source, and advice
pressure_safety            Safety of the flank pressure against a limit
memory_need                Memory and disc that an analysis of many positions will need, estimated before it starts
=========================  ============================================================
"""
