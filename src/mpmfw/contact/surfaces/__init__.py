"""Detection between tracked surfaces: nodes of one body against facets of another."""

from mpmfw.contact.surfaces.detection import Surfaces
from mpmfw.contact.surfaces.options import FacetOptions, SurfacesOptions

__all__ = ["FacetOptions", "Surfaces", "SurfacesOptions"]
