"""Parts that take a page of their own, what they are made of by name, how the drive is built in, used and judged.

Modules in the order data passes:

===============  ============================================================
named_materials  Materials by name: ``materials.disc = "PA12"`` stands for numbers that ship as data, each with its scatter
                 and source
bearings         Bought crank bearings by name: ``crank_bearing.bearing = "K20x26x12"`` stands for races and rollers, a
                 clearance class for ``clearance.bearing``
operation        How the drive is built in and used: the member that is held, load, speed, duty, lubricant, what rubs,
                 and how warm it is
limits           What its results may reach, by the names of the summary, each with its source
judgement        Limits of values, from the drive file or its materials, safety and verdict
verdict_words    Checks as tables and files tell them
crank            Crankshafts: their eccentrics, the circle they stand on, what supports them, and their bearings
pins             Pins of the pin wheel and of the pin shaft: how they sit, loose or under a sleeve, and how they bend
pin_checks       What seats and beams of pins cannot be: fields that do not go together, plays, spans and diameters out of
                 bounds
temperatures     A drive at its temperatures: every length of a part times 1 + α ΔT of its own material, said by the fields
                 there are
duty_checks      What a duty and a lubricant cannot be: shares that do not add up, a film that no speed draws in
===============  ============================================================
"""
