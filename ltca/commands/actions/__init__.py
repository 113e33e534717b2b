"""What commands do once their options are checked: modules that import whatever they need.

A command of this name beside this folder adds its options, checks them and then imports its module here, which takes a second.

========  ============================================================
run       Solve the cases of ``cyclo run``; dataset, summary, verdicts, page and figures
curves    Solve the cases of ``cyclo curves``; curves.json, page and figures
========  ============================================================
"""
