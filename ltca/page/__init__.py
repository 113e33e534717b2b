"""Pages that open offline: one file with everything in it.

Modules in the order data passes:

==============  ============================================================
packing         Arrays of numbers as text that a page opens: float32, gzipped, in base64
tables          Tables: what each cell says, and the number behind it for who copies or downloads the table
scene           What a page draws a drive from: outlines, radii and places of its parts
run_arrays      The numbers behind the moving drive of a run: poses, loads and pressures of every contact at both torques
derived         What follows from the inputs of a drive: geometry, installation, walls, as names and texts
verdict_tables  The verdict of a design: one sentence, then tables, worst first
run_tables      Tables of a run: loads, pressures, transmission error and its orders, losses, inputs
compared        A second run, or a measured transmission error, beside the first
writing         A page from templates, style and scripts of this package
study_page      ``report.html`` of other commands: tables and curves in sections
run_sections    Torque curve and life beside the positions of a run
run_page        ``report.html`` of a run
studies         What each of these commands puts there
==============  ============================================================

``templates`` holds markup and style, ``scripts`` what a browser runs: plain scripts, joined into the page in the order that
`writing` gives them. Plots are drawn as SVG by ``plots.js``: figures are to be taken along as SVG, to print sharp and to follow
light and dark, which libraries that paint on a canvas (uPlot) cannot do without a second renderer that would be this one.
"""
