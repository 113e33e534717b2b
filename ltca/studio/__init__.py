"""``cyclo studio``: a drive file in a browser, its answer beside it while it is changed.

Modules in the order data passes:

===========  ==========================================================================
sections     The fields of a drive file as a page shows them, and a text with one changed
entries      Limits, tolerances, cases and bearings, whose entries have names, as rows of the page
answers      What is answered of a text: the page of a run in parts, or derivatives
warm         What every worker needs, imported and built once
workers      Processes that answer, ended by the next question
jobs         Commands in the background: exports, finite elements, tolerance studies
connections  Connections of the server: how many, how long until a request is there
server       Addresses, who may ask, and the page
===========  ==========================================================================

``templates`` holds markup and style, ``scripts`` what the browser runs beside the scripts of `ltca.page`. All that a page has of
a drive is its text; the server keeps nothing of it but running jobs, so tabs do not know of each other.
"""
