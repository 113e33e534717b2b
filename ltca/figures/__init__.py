"""Pictures of results, by matplotlib and pyvista.

Modules in the order data passes:

================  ============================================================
labelled_curves   Curves with their names at their right ends, in the style of the house; discs and cranks as cases
                  of their own
crank_figures     Figures of several cranks: moment and deflection of each, and the loads of its rollers
run_figures       Figures of a run, corresponding to the paper's Fig. 23–26, 28–30 and 34–36: six cases per axes,
                  labelled directly
drive_picture     Picture of a drive at one crank angle: its parts, contact normals, and loads as arrows
curve_figures     Figures of `cyclo curves`: torque against wind-up, orders of the transmission error, flank pressure
                  and its limit
pressure_figures  Pictures of contact pressure, corresponding to the paper's Fig. 27 and 31–33
study_figures     Figures of a study: distribution of every quantity, what they come from, and responses of a sweep
optimum_figures   Figures of an optimisation: the search in one aim over every variable, or the Pareto front of two
design_page       The page of `cyclo design`: designs beside each other, the outline of each, what stands in the way
================  ============================================================
"""
