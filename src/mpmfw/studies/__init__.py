"""Studies: grids of runs with the error and the cost of each combination.

``mpmfw.study`` is the entry point; nothing is imported here, to keep worker processes small.
"""
