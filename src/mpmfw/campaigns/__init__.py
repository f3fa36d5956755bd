"""A campaign: points of a grid, the runs that they need, and one dataset of their results.

``mpmfw.campaign`` is the entry point; ``compare``, ``study``, ``stability`` and ``validate`` evaluate it.
Nothing is imported here, to keep worker processes small."""
