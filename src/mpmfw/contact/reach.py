"""Whether a detection finds the gaps that a law acts across."""

from __future__ import annotations

from mpmfw.contact.detection import Detection
from mpmfw.contact.law import ContactLaw
from mpmfw.errors import SceneError

#: Share by which the widest gaps of both may differ: what rounding leaves.
ROUNDING = 1e-9


def refuse_short_reach(detection: Detection, law: ContactLaw, owner: str, cell_size: float) -> None:
    """Refuse a law that acts across wider gaps than the detection finds: its force would end short of its reach.

    Parameters
    ----------
    detection, law
        Both prepared.
    owner
        The contact that they make, ``DETECTION+LAW`` or a name of its own.
    cell_size
        h [m].

    Raises
    ------
    SceneError
        They do not go together with these options.
    """
    found, needed = detection.widest_gap(cell_size), law.widest_gap()
    if found is None or needed <= found * (1.0 + ROUNDING):
        return
    across = f"and law '{law.name}' acts across gaps of up to {needed:.4g} m"
    option = detection.gap_option
    if option is None:
        raise SceneError(
            f"contact '{owner}': detection '{detection.name}' finds gaps of up to {found:.4g} m, {across}; expected another "
            "detection, or a law that acts across none so wide"
        )
    given = getattr(detection.options, option)
    own = owner.partition("+")[0]  # in a scene a joined detection has a table of its own
    raise SceneError(
        f"contact.{own}.{option} = {given:g} finds gaps of up to {found:.4g} m, {across}; expected at least "
        f"{given * needed / found:.4g}, or a law that acts across none so wide"
    )
