"""What a transfer's name means."""

from __future__ import annotations

import pytest

from mpmfw.step.transfer import make_transfer


@pytest.mark.parametrize(
    ("name", "flip", "affine", "transported"),
    [
        ("flip", 1.0, None, False),
        ("pic", 0.0, None, False),
        ("apic", 0.0, "moment", False),
        ("tpic", 0.0, "gradient", False),
        ("aflip", 1.0, "least_squares", True),
    ],
)
def test_names(name: str, flip: float, affine: str | None, transported: bool) -> None:
    transfer = make_transfer(name, singular_spread=False)
    assert (transfer.name, transfer.flip, transfer.affine, transfer.transported) == (
        name,
        flip,
        affine,
        transported,
    )


def test_where_the_spread_is_singular_the_gradient_takes_its_place() -> None:
    assert make_transfer("aflip", singular_spread=True).affine == "gradient"
    assert make_transfer("apic", singular_spread=True, transported=True).affine == "gradient"
    # a stored moment needs the inverse at its next use only, where it is regularised
    assert make_transfer("apic", singular_spread=True).affine == "moment"


def test_pic_fraction_blends() -> None:
    assert make_transfer("flip", singular_spread=False, pic_fraction=0.25).flip == 0.75
