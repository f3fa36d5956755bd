"""Puts the modules of the hard suite on the path of its cases."""
