"""Search for drives that meet requirements: ``cyclo design`` without its command line.

Modules in the order data passes:

=================  ==================================================================================================
requirements       What is asked: ratio, torque, room, life, stiffness, backlash, efficiency, materials, and what a shop has
stock              Diameters and lengths that pins and rollers come in, eccentricities that grinders offer
surroundings       Ring, carrier, main bearing, first stage and forces from outside, as far as they do not follow what is searched
sizes              Sizes of many candidates at once, and the drive of one
requirement_file   A requirement file (TOML), read and checked
requirement_words  What is told of requirements before the search: materials left open, numbers in another unit
closed_forms       What candidates reach by closed forms: pressures, loads, life, stiffness, play, losses
demands            What is demanded of a candidate, each as a margin: by the requirements, by the parts, by limits and materials
enumeration        All combinations of counts, stock sizes and coarse sizes, and the best of them by closed forms
solution           What the loaded drive of a candidate reaches, judged as `cyclo check` judges it
refinement         Continuous sizes by scipy, closed forms corrected by what the solution said
search             From requirements to designs; where none fits, what stands in the way and how much it would have to give
designs            What is told of the designs found: drive files, tables
=================  ==================================================================================================
"""
