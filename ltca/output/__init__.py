"""The edge: files that are whole or not there, progress on a terminal.

Modules in the order data passes:

========  ============================================================
files     Files that are either whole or not there: written beside their place, then moved into it
progress  Progress on a terminal; nothing in a pipe
terminal  Streams that take every message: any encoding, no stream at all
========  ============================================================
"""
