"""A drive of any number of discs by full finite elements, plane or solid: one contact problem of all.

===============  ===============================================================
solution         Solution of a drive at one crank angle with either member held
series           Solutions at one crank angle after the other; condensed pins and rollers are reused
wall_references  Stress along walls on nested meshes against closed forms
nested_meshes    A drive on nested meshes: every figure with observed order, Richardson's value and error bar
error_table      These error bars for ``summary.json``, for print and for the page
verdict          Largest loads, pressures and stresses of a solution, judged by the same limits as the LTCA
solution_files   Files of such a solution: ``summary.json``, ``fem.nc``; of plane bodies one ``.vtu`` for each and ``fem.vtm``
                 over them all
solution_words   Its tables: contacts, facts of discs and drive
solution_page    Its page
===============  ===============================================================
"""
