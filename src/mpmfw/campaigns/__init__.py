"""A campaign: points of a grid, the runs that they need, and one dataset of their results.

``mpmfw.campaign`` is the entry point; ``compare``, ``study``, ``stability`` and ``validate`` evaluate its
results. Nothing is imported here, so that worker processes load no more than they need.
"""
