"""Quantities: bare SI numbers, or strings with a unit."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from mpmfw import units


@pytest.mark.parametrize(
    ("kind", "given", "si"),
    [
        (units.Length, 0.4, 0.4),
        (units.Length, "2 mm", 2e-3),
        (units.Velocity, "36 km/h", 10.0),
        (units.AngularVelocity, "180 deg/s", 3.141592653589793),
        (units.Angle, "60 deg", 1.0471975511965976),
        (units.Pressure, "6 MPa", 6e6),
        (units.Density, "1.01 g/cm^3", 1010.0),
        (units.Force, "3 kilonewton", 3000.0),
        (units.AngularVelocity, "60 rpm", 6.283185307179586),
        (units.Number, "5 %", 0.05),
    ],
)
def test_quantities_become_si(kind, given, si):
    assert TypeAdapter(kind).validate_python(given) == pytest.approx(si, rel=1e-14)


@pytest.mark.parametrize(
    ("kind", "given", "message"),
    [
        (units.Length, "2 s", "'2 s' is not convertible to m"),
        (units.Length, "2", "'2' has no unit"),
        (units.Length, "two metres", "is not a quantity"),
        (units.Pressure, "3 m/s", "is not convertible to Pa"),
        (units.Length, float("nan"), "finite"),
        (units.Length, [1.0], "valid number"),
        (units.Length, True, "true is a boolean; expected a number or a string such as '1.5 m'"),
        (units.Density, "2.4 ton/m^3", "'ton' is ambiguous: tonne or short_ton?"),
        (units.Density, "9 cwt/m^3", "'cwt' is ambiguous: short_hundredweight or long_hundredweight?"),
        (units.Force, "1 ton_force", "'ton_force' is ambiguous: tf or short_ton_force?"),
        (units.AngularVelocity, "50 Hz", "Hz is ambiguous: turn/s or rad/s?"),
    ],
)
def test_other_input_is_refused_with_a_reason(kind, given, message):
    with pytest.raises(ValidationError, match=message):
        TypeAdapter(kind).validate_python(given)


@pytest.mark.parametrize(
    "text",
    [
        "((((1",
        "1/0 m",
        "1 m^9^9^9",
        "1 __import__('os').getcwd()",
        "m",
        "1 m\0",
        "1 m " * 40,
        "9" * 5000,
        "1" + " " * 5000 + "m",
    ],
)
def test_a_string_is_a_number_and_a_unit_and_nothing_is_evaluated(text):
    with pytest.raises(ValidationError, match="is not a quantity; expected a number or a string such as"):
        TypeAdapter(units.Length).validate_python(text)


@pytest.mark.parametrize("value", [5e-324, -1e-61, 1e308, -1.1e60, "1e300 km", "1e-300 mm"])
def test_a_magnitude_that_cannot_be_computed_with_is_refused(value):
    with pytest.raises(ValidationError, match="is out of range: a magnitude is 0 or from 1e-60 to 1e\\+60"):
        TypeAdapter(units.Length).validate_python(value)


@given(st.floats(-1e6, 1e6).filter(lambda x: x == 0.0 or abs(x) >= 1e-60))
def test_a_bare_number_passes_unchanged(number):
    assert TypeAdapter(units.Length).validate_python(number) == number
