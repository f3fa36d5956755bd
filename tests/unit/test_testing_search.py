"""The search for the smallest counterexample: simplest first, the same in every run, errors and refusals
kept.
"""

from __future__ import annotations

import pytest

from mpmfw_testing import Inapplicable, Violation, ladder, search, try_all


def search_too_much():
    """Two numbers of a ladder each, whose sum is beyond a bound."""

    def trial(a, b):
        if a + b > 0.75:
            raise Violation("too much", {"sum": a + b}, measured=a + b, bound=0.75)

    search({"a": ladder(0.0, 1.0, 5), "b": ladder(0.0, 1.0, 5)}, trial, examples=30, names={"a": "a [m]"})


def test_the_counterexample_is_the_smallest_and_the_same_in_every_run():
    with pytest.raises(Violation) as first:
        search_too_much()
    with pytest.raises(Violation) as second:
        search_too_much()
    assert first.value.counterexample == {"a [m]": 0.0, "b": 1.0, "sum": 1.0}
    assert second.value.counterexample == first.value.counterexample
    assert (first.value.measured, first.value.bound) == (1.0, 0.75)


def test_an_error_of_the_plugin_is_a_violation_with_its_case():
    def trial(a):
        if a > 0:
            raise ZeroDivisionError("no gap")

    with pytest.raises(Violation, match="ZeroDivisionError: no gap") as caught:
        search({"a": ladder(0.0, 4.0, 5)}, trial, examples=20)
    assert caught.value.counterexample == {"a": 1.0}
    assert isinstance(caught.value.__cause__, ZeroDivisionError)


def test_a_later_case_that_cannot_be_asked_hides_no_violation():
    def trial(a):
        if a > 0.6:
            raise Violation("beyond 0.6")
        if a > 0.3:
            raise Inapplicable("the middle cannot be asked")

    with pytest.raises(Violation, match=r"beyond 0\.6"):
        try_all({"a": (0.0, 0.5, 1.0)}, trial)
    with pytest.raises(Inapplicable, match="middle"):
        try_all({"a": (0.5, 1.0)}, trial)
