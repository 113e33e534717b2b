"""Figures of results, by matplotlib.

Modules in the order data passes:

=================  ============================================================
house_style        One look for every picture: colours, maps, fonts, proper symbols, and files that are the same for the
                   same input
field_scale        Units in which values of fields of a drive are drawn: small angles in minutes or degrees
free_labels        Words beside points where nothing else stands
shared_axes        Range and ticks of what figures and pages both draw
curve_panels       Curves in panels of their own, the others grey behind; discs and cranks as cases of their own
mesh_range         Which pin is shown over its mesh, and over which crank angles
crank_figures      Figures of several cranks: moment and deflection of each, and the loads of its rollers
width_figures      Figure of contacts in slices: line load and pressure along the width of the most loaded pin and roller
run_figures        Figures of a run, corresponding to the paper's Fig. 23–26, 28–30 and 34–36: a panel for each case
drive_picture      Picture of a drive at one crank angle: its parts with their numbers, contact normals, loads as arrows
curve_figures      Figures of `cyclo curves`: torque against wind-up, orders of the transmission error, flank pressure
                   and its limit
vibration_figures  Figures of `cyclo dynamics`: Campbell diagram, and response over speed
time_figures       Figure of `cyclo dynamics --time`: transmission error, torque and loads over time, orders
pressure_figures   Pictures of contact pressure, corresponding to the paper's Fig. 27 and 31–33
study_figures      Figures of a study: distribution of every quantity, what they come from, and responses of a sweep
optimum_figures    Figures of an optimisation: the search in one aim over every variable, or the Pareto front of two
=================  ============================================================
"""
