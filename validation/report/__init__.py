"""The page and files of a validation.

Modules in the order data passes:

========  ============================================================
headline  The few figures to read first, and the files ``validation.json`` and ``rows.csv``
verdict   What full solutions and models reach, judged by the limits of the drive file and its materials
scene     What the report's own script draws: the drive at each position, with every contact's place, direction and
          numbers
page      ``report.html``: one page with everything in it, which opens offline
costs     What a position costs: full finite elements as measured when solved, the LTCA measured here
========  ============================================================
"""
