"""The bundled loads: forces at a point, body forces, drag."""
