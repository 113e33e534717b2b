"""The edge: files that are whole or not there, folders of one run, processes that end with ours, progress.

Modules in the order data passes:

===========  ====================================================="""
