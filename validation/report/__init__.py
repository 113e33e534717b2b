"""The page and files of a validation.

Modules in the order data passes:

========  ============================================================
headline  The main figures, and the files ``validation.json`` and ``rows.csv``
verdict   Largest loads and pressures by full solutions and models, judged by the limits of the drive file and its
          materials
scene     Data for the script of the report: the drive at each position, with place, direction and numbers of every
          contact
page      ``report.html``: one page with everything in it, which opens offline
costs     Time of one position: full finite elements as measured when solved, the LTCA measured here
========  ============================================================
"""
