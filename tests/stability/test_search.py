"""Random admissible scenes: whatever bodies meet however, the invariants hold."""

import pytest
from hard_cases import MUST_HOLD, MUST_STAY_BOUNDED
from hard_scenes import FULL, C, block, disc, placed, scene, solid, wave_speed
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mpmfw.stability import probe

pytestmark = pytest.mark.stability

#: Bounds of the largest energy over the start: of one that must hold, with dissipation, and of one that must
#: stay bounded, without; the same as those of the hard cases.
HOLDS, BOUNDED = 1.005, 1.05
#: Deepest penetration [cells]: blocks meet with their corners first, at up to 0.3 of the softer one's wave
#: speed.
DEPTH = 0.5
STEPS = 300
#: The same scenes each time; ``MPMFW_FULL_STABILITY=1`` draws others, and more.
EXAMPLES, DERANDOMIZED = (400, False) if FULL else (20, True)


@st.composite
def materials(draw):
    """A solid up to a hundred times as soft or as stiff, ten times as light or as heavy, as the usual one."""
    return solid(
        stiffness=10.0 ** draw(st.floats(-2.0, 2.0)),
        density=10.0 ** draw(st.floats(-1.0, 1.0)),
        poisson=draw(st.floats(0.0, 0.49)),
    )


@st.composite
def scenes(draw):
    """A square or a disc that meets a square, and perhaps a third square that comes down on both, of any
    material.

    Bodies are at least two cells wide: one of a single cell has modes that the transfer does not carry, and
    its energy swings by several per cent whether it touches anything or not."""
    size, other = draw(st.floats(1.0, 2.0)), draw(st.floats(1.0, 2.0))
    material = draw(materials())
    slowest = min(1.0, wave_speed(material) / C)
    velocity = slowest * draw(st.floats(0.005, 0.3)), slowest * draw(st.floats(-0.1, 0.1))
    gap, aside = draw(st.floats(0.0, 0.9)), draw(st.floats(-1.0, 1.0))
    if draw(st.booleans()):
        left = disc((-0.1 - size, aside), size, velocity)
    else:
        left = block((-2.0 * size - 0.1, aside - size), (-0.1, aside + size), velocity)
    right = block((gap - 0.1, -other), (gap - 0.1 + 2.0 * other, other), kind="other")
    bodies = {"left": left, "right": right}
    if draw(st.booleans()):
        low = max(aside + size, other) + draw(st.floats(0.0, 0.9))
        bodies["top"] = block((-1.5, low), (1.5, low + 3.0), (0.0, -slowest * draw(st.floats(0.005, 0.1))))
    made = scene(
        bodies,
        extent=80.0,  # light bodies fly far
        friction=draw(st.sampled_from([0.0, 0.2, 0.6, 1.5])),
        materials={"other": material},
    )
    shift = draw(st.floats(0.0, 1.0)), draw(st.floats(0.0, 1.0))
    return placed(made, shift, draw(st.floats(0.0, 90.0)))


def wrong(found, *, strict):
    """What of a run breaks an invariant."""
    said = [] if found.status == "ok" else [f"{found.status}: {found.message}"]
    if not found.momentum < 1e-10:
        said.append(f"linear momentum drifts by {found.momentum:.2g}")
    if found.lost:
        said.append(f"{found.lost} surface nodes lost")
    if strict and not found.energy <= HOLDS:
        said.append(f"energy up to {found.energy:.4g} of the start")
    if strict and not found.penetration <= DEPTH:
        said.append(f"penetration of {found.penetration:.3g} cells")
    if not strict and not found.stored <= BOUNDED:
        said.append(f"energy up to {found.stored:.4g} of the start")
    return said


def _in_range(value):
    """The mapping with magnitudes below those that a scene takes as 0."""
    if isinstance(value, dict):
        return {key: _in_range(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_in_range(each) for each in value]
    return 0.0 if isinstance(value, float) and abs(value) < 1e-60 else value


@settings(max_examples=EXAMPLES, derandomize=DERANDOMIZED, suppress_health_check=list(HealthCheck))
@given(mapping=scenes(), method=st.sampled_from(MUST_HOLD + MUST_STAY_BOUNDED))
def test_invariants_hold(mapping, method):
    contact, shape = method
    mapping = _in_range({**mapping, "contact": {**mapping["contact"], "method": contact}})
    assert not wrong(probe(mapping, shape=shape, steps=STEPS), strict=method in MUST_HOLD)


#: Scenes that the search found: shape, friction, density [kg/m³], K and G [Pa] of the body at rest, the
#: moving body, its velocity [m/s], and the body at rest. A surface node came in by the side of a corner and
#: met a spring loaded to its whole depth: the energy grew by 5 %, 1.5 % and 0.9 %.
FOUND = {
    "square-on-soft-square": (
        *("cpdi2", 0.0, (3582.73, 12776.0, 19164.0)),
        block((-0.833569, 0.445115), (0.201809, 1.48049), angle=0.387039),
        [0.464717, 0.542622],
        block((0.929444, 0.311513), (2.31544, 1.6975), angle=0.387039),
    ),
    "disc-on-soft-square": (
        *("cpdi", 0.6, (1580.3, 14744.5, 10324.5)),
        disc((0.664077, -1.10593), 1.42971, ()),
        [0.141381, 0.73404],
        block((-0.581206, 0.717357), (0.73964, 2.0382), angle=1.50573),
    ),
    "small-disc-at-a-corner": (
        *("cpdi2", 0.0, (262.224, 12776.0, 19164.0)),
        disc((-0.208826, -0.569936), 0.517689, ()),
        [1.71775, 2.00571],
        block((0.411756, 0.311513), (1.79775, 1.6975), angle=0.387039),
    ),
}
STILL = "0.504 % with what springs lose as they change; without it the energy never exceeds the start"


@pytest.mark.parametrize("name", FOUND)
def test_what_was_found_holds_now(name):
    shape, friction, (density, bulk, shear), left, velocity, right = FOUND[name]
    other = {"model": "neo_hookean", "density": density, "bulk_modulus": bulk, "shear_modulus": shear}
    bodies = {"left": {**left, "velocity": velocity}, "right": {**right, "material": "other"}}
    found = probe(scene(bodies, friction=friction, materials={"other": other}), shape=shape, steps=STEPS)
    if name == "square-on-soft-square":
        assert not wrong(found, strict=False)
        assert HOLDS < found.energy < 1.0055
        pytest.xfail(STILL)
    assert not wrong(found, strict=True)
    assert found.energy < 1.0001  # 1.0004 and 1.003 where springs are loaded to twice their depth at once
