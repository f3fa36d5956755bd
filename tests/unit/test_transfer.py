"""What a transfer's name means."""

from __future__ import annotations

import pytest

from mpmfw.step.transfer import TRANSFERS, make_transfer


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


def test_there_are_five() -> None:
    assert list(TRANSFERS) == ["flip", "pic", "apic", "tpic", "aflip"]


def test_where_the_spread_is_singular_the_gradient_takes_its_place() -> None:
    assert make_transfer("aflip", singular_spread=True).affine == "gradient"
    assert make_transfer("apic", singular_spread=True, transported=True).affine == "gradient"
    # a stored moment needs the inverse at its next use only, where it is regularised
    assert make_transfer("apic", singular_spread=True).affine == "moment"


def test_a_transported_moment_becomes_a_gradient_at_once() -> None:
    transfer = make_transfer("apic", singular_spread=False, transported=True)
    assert (transfer.affine, transfer.transported, transfer.flip) == ("least_squares", True, 0.0)


def test_transport_can_be_turned_off_and_on() -> None:
    off = make_transfer("aflip", singular_spread=False, transported=False)
    assert (off.affine, off.transported) == ("least_squares", False)
    assert make_transfer("tpic", singular_spread=False, transported=True).transported


def test_pic_fraction_blends() -> None:
    assert make_transfer("flip", singular_spread=False, pic_fraction=0.25).flip == 0.75


def test_the_table_is_not_changed() -> None:
    make_transfer("flip", singular_spread=True, pic_fraction=0.5)
    make_transfer("aflip", singular_spread=True, transported=False)
    assert TRANSFERS["flip"].flip == 1.0
    assert (TRANSFERS["aflip"].affine, TRANSFERS["aflip"].transported) == ("least_squares", True)


def test_an_unknown_name() -> None:
    with pytest.raises(KeyError, match="xpic"):
        make_transfer("xpic", singular_spread=False)
