"""The entry point of detection at grid nodes."""

from mpmfw.contact.nodes import Nodes

__all__ = ["Nodes"]
