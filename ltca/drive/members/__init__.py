"""Parts of a drive that fill a module, their named materials, operation and temperatures, and limits with their verdict.

Modules in the order data passes:

===============  ============================================================
named_materials  Materials by name: ``materials.disc = "PA12"`` stands for numbers that ship as data, each with its scatter
                 and source
bearings         Bought crank bearings by name: ``crank_bearing.bearing = "K20x26x12"`` stands for races and rollers, a
                 clearance class for ``clearance.bearing``
operation        Installation and use: the fixed member, load, speed, duty, lubricant, friction and temperatures
preload          Preload of bearings, and the quantities that say how bearings yield
width            Slices along the width of the contacts, inclined axes, and which fields need slices
crank            Crankshafts: their eccentrics, the circle they stand on, their supports and their bearings
first_stage      Teeth of a sun and of the planets on several cranks
pins             Pins of the pin wheel and of the pin shaft: fixed, loose or sleeved, rigid or bending
ring             The ring in which the wheel pins are seated: its size, material, flange and bolts
carrier          Carrier: two flanges, tied by posts, between which shaft pins or cranks stand, and what twists between it
                 and the output
main_bearing     The main bearing: stiffness, clearance or preload, rows of rolling elements
inertia          Inertias of input, output and cranks that are given, and damping
temperatures     A drive at its temperatures: every length multiplied by 1 + α ΔT of its part
limits           ``[limits]`` of a drive file: bounds on results, by the names of the summary, each with its source
judgement        Limits of values, from the drive file or its materials, with safety and verdict
verdict_words    Checks as tables and files print them
===============  ============================================================
"""
