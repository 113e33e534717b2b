"""A drive of any number of discs by full finite elements: each disc a problem of its own, one wheel angle between them.

==============  ===============================================================
shares          Which part of the wheel's moment each disc carries: rounds of moments until the angles agree
solution        Solution of a drive at one crank angle with either member held
series          Solutions at one crank angle after the other, what they share made once
verdict         What a solution reaches, judged by the same limits as the LTCA
solution_files  Files of such a solution: ``summary.json``, ``fem.nc``, one ``.vtu`` for each body and ``fem.vtm`` over
                them all
solution_page   Its page
==============  ===============================================================
"""
