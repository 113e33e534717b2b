"""The edge: files that are whole or not there, folders of one run, processes that end with ours, progress.

Modules in the order data passes:

==============  ============================================================
terminal        Streams that take every message: any encoding, no stream at all
resources       Memory and disc a run will need, against what the machine has, before it starts
regular_files   Files that are named to the program or found in its folders: regular ones of sane size are read, nothing else
locks           Locks on the folder or file that a run writes: one process at a time, until it ends, however that is
run_folder      The folder of a run: one process at a time writes to it, and what it holds comes from one run
processes       Programs that end with the process that started them, and signals that end a command cleanly
process_pools   Pools of worker processes that end with the process that started them, whatever ends it
threads         Linear algebra on one thread where results are made
supervisor      Run a program that ends with whoever asked for it, together with its folder of temporary files
progress        Progress: a bar on a terminal, a line every few seconds without one
provenance      Which code made a result: version and a hash of its sources, the same on every machine that has the same code
derived_files   Where files are kept that are derived once: in the cache of the user, or in a folder of this run
case_texts      Texts about several cases, each once with the names of its cases
file_names      Names of drives and cases as they stand in names of files
files           Files that are either whole or not there: written beside their place, then moved into it
checked_arrays  Arrays with a checksum, with which interrupted work goes on
labelled        Labelled arrays without xarray, whose import with pandas takes half a second
netcdf          netCDF files: read without trust, written so that they survive a full disc
==============  ============================================================
"""
