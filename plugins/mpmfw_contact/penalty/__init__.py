"""Penalty contact between tracked surfaces (Hamad, Giridharan & Moormann 2017, [H17])."""

from mpmfw_contact.penalty.law import Penalty

__all__ = ["Penalty"]
