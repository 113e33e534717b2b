"""The work of commands after their options are checked.

A command of this name beside this folder adds its options, checks them and then imports its module here, which takes a second.

=============  ============================================================================================
run            Solve the cases of ``cyclo run``; dataset, summary, verdicts, page and figures
run_table      The table of ``cyclo run``: what decides, in the order in which it is read
check          Verdicts of ``cyclo check``: judge every case and tell what drives and would mend what fails
curves         Solve the cases of ``cyclo curves``; curves.json, page and figures
dynamics       Solve the cases of ``cyclo dynamics``; dynamics.json, page and figures
reduced_model  Reduce a drive for ``cyclo export --for``, write its files, print how good it is
time_run       Runs of ``cyclo dynamics --time``; time.nc, time.json, page and figures
study          Run of a study (``cyclo tolerance``, ``cyclo sweep``): solved, written, drawn and printed
optimise       Search of ``cyclo optimise``, and its outcome solved finely
=============  ============================================================================================
"""
