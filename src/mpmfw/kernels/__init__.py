"""Compiled kernels: short loops over ``range(dim)``, one source for two and three dimensions.

They import numpy and numba alone. The dimension is the length of the tuple ``spacing``, so that numba
specialises by type and the disk cache hits. A plug-in marks its own kernels with :func:`kernel`, what they
call with :func:`device`, and takes scratch memory from :mod:`mpmfw.kernels.scratch`.

- **Files**: the time step in ``particle_grid`` and ``motion``, for products of functions of one axis in
  ``products``, numbers of several points in ``lanes``, tables in ``stencil``, facets and boxes in ``facets``,
  closed ``surfaces`` and their ``sides``, rows of ``contact``, small matrices in ``arithmetic``.
- **Types** of arguments: ``Floats``, ``Ints``, ``Indices`` are arrays of float64, int64 and int32, ``Float``
  a compiled scalar.
- **Structs**: a class derived from :class:`Struct` has arrays that kernels take as one argument,
  ``rows.gap[c]``; :func:`struct` makes one of named arrays.

Kernels check nothing: an index out of range or an array of another shape is not an error but undefined. Those
that can fail return an index, and say so. Arrays are C-contiguous; results are written to the array named for
them, or added to it where the formula has ``+=``.

Arguments of the same name mean the same everywhere. Points are material points or surface nodes, n of them,
with m entries in their table; N nodes of the grid, F velocity fields, B bodies. Extensive quantities are per
metre of thickness in 2D.

=========================== ======================== =========================================================
argument                    shape [unit]             meaning
=========================== ======================== =========================================================
``points``                                           material points, an ``mpmfw.api.Particles``
``table``                                            their interpolation table, an ``mpmfw.api.Stencil``
``factors``                                          factors of products, of an ``mpmfw.api.types.Products``
``grid``                                             nodes and windows of all fields, an ``mpmfw.api.Grid``
``spacing``                 dim numbers [m]          the cell size h, once for each dimension
``dt``                      [s]                      length of the step
``inverse_h``               [1/m]                    inverse of the cell size
``own_nodes``               2 integers               nodes to add to, first and one past the last;
                                                     None for all. With them, the nodes of a row must ascend
``p``, ``k``                                         index of a point, of an entry in the table
``first``                   (F + 1,) or (B + 1,)     points of a field, or body: ``first[f]:first[f + 1]``
``mass``, ``node_mass``     (N,) [kg/m]              m_i
``velocity``                (N, dim) [m/s]           v_i
``momentum``                (N, dim) [kg/s]          (m v)_i
``force``, ``node_force``   (N, dim) [N/m]           f_i
``position``                (n, dim) [m]             x_p; in the geometry surface nodes x_s
``affine``                  (n, dim, dim) [1/s]      C_p, or None
``moment``                  (n, dim, dim) [m^2/s]    B_p
``thickness``               (n,) [m]                 of the points, or None
``lower``, ``upper``        (B, dim) [m]             corners of boxes
``origin``, ``shape``       (dim,) [m], (dim,)       first node of a window, and its number of nodes
``offset``                                           flat index of the first node of a window
``base``                    (dim,)                   first node that a point touches, within its window
``weight``, ``slope``       (dim, width) [1], [1/m]  functions along each axis, and their derivatives
``share``                   (2**dim,) or (dim,)      weights of a domain's corners; barycentric coordinates
``corner``                  (2**dim, dim)            a domain's corners [cells], from the window's first node
``x``                       (dim,) [m]               a point
``surface``                                          facets (``mpmfw.kernels.Facets``)
``m``, ``s``                                         index of a facet, of a surface node
``corners``                 (dim, dim) [m]           corners of a facet, one a row
``normal``                  (dim,)                   e_n
``rows``, ``old``                                    rows of contact (``mpmfw.kernels.contact.Rows``), of this
                                                     and the last step
``count``, ``old_count``                             number of rows in ``rows`` and ``old``
``c``, ``o``                                         a row of this step, a row of the last step
``stiffness``, ``scale``    (n,) [N/m^2], [1]        of a row; a factor
``records``                                          sums of every pair (``mpmfw.kernels.contact.Records``)
``node_sum``, ``out``                                scratch (N,); where the result is written
``pair_of``, ``a``, ``b``                            table of ``mpmfw.kernels.contact.pair_table``, two
                                                     bodies
=========================== ======================== =========================================================
"""

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels._struct import Struct, struct
from mpmfw.kernels.arithmetic import add_scaled_row, determinant, invert, set_scaled_row
from mpmfw.kernels.facets import bounding_boxes, closest_point, squared_distance
from mpmfw.kernels.particle_grid import (
    add_body_force,
    add_internal_force,
    affine_from_moment,
    integrate_momentum,
    project,
    velocity_of_momentum,
)
from mpmfw.kernels.sides import minimum_gap
from mpmfw.kernels.stencil import (
    FULL,
    OUTSIDE,
    entries,
    fill_domain,
    fill_linear,
    fill_tensor_product,
    fits,
    linear_weights,
    read_window,
)
from mpmfw.kernels.surfaces import Facets, signed_distance
from mpmfw.kernels.types import Float, Floats, Indices, Ints

__all__ = [
    "FULL",
    "OUTSIDE",
    "Facets",
    "Float",
    "Floats",
    "Indices",
    "Ints",
    "Struct",
    "add_body_force",
    "add_internal_force",
    "add_scaled_row",
    "affine_from_moment",
    "bounding_boxes",
    "closest_point",
    "determinant",
    "device",
    "entries",
    "fill_domain",
    "fill_linear",
    "fill_tensor_product",
    "fits",
    "integrate_momentum",
    "invert",
    "kernel",
    "linear_weights",
    "minimum_gap",
    "project",
    "read_window",
    "scratch",
    "set_scaled_row",
    "signed_distance",
    "squared_distance",
    "struct",
    "velocity_of_momentum",
]
