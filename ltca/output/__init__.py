"""The edge: files that are whole or not there, folders of one run, processes that end with ours, progress.

Modules in the order data passes:

=============  =====================================================
resources      memory and disc a run will need, before it starts
run_folder     one process at a time, files of one run
files          files that are whole or not there
netcdf         netCDF files that survive a full disc
provenance     which code made a result
terminal       streams that take every message
progress       a bar on a terminal, a line now and then without one
processes      programs that end with ours, signals
process_pools  pools of workers that end with ours
supervisor     what ends a program when nobody is left to do it
=============  =====================================================
"""
