"""Options of classical contact, and of [H17]'s, that several cases try."""

from typing import Any

POSITION = {"contact.bardenhagen.criterion": "position"}
#: The normal of the stiffer body.
MASTER = {"contact.bardenhagen.normal": "master"}
#: Friction increments of [H17] to the letter, which nothing keeps below Coulomb's cap.
LITERAL = {"contact.hamad2017.friction_law": "literal"}


def specified(*direction: float) -> dict[str, Any]:
    """Return a normal that is given."""
    return {"contact.bardenhagen.normal": "specified", "contact.bardenhagen.direction": list(direction)}


def over(key: str, label: str, values: Any) -> dict[str, dict[str, Any]]:
    """Return the settings of methods for each value of one key; ``label`` names it, as ``kappa {:.3g}``."""
    return {label.format(value): {key: value} for value in values}
