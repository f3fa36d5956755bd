"""The yardstick measures what it says: the plain loops take the very steps that the stepper takes."""

import numpy as np
import pytest

from yardstick.block import make_block
from yardstick.plain import ENTRIES, PlainLoop, compilers

#: Dimensions, compiler, and whether the step is the one without a table.
LOOPS = [(dim, compiler, dim == 3) for dim in (2, 3) for compiler in compilers()]


@pytest.mark.parametrize(("dim", "compiler", "whole"), LOOPS)
@pytest.mark.parametrize("shape", ENTRIES)
def test_plain_loop_takes_the_same_steps(shape, dim, compiler, whole):
    block = make_block(shape, 100, dim)
    plain = PlainLoop(shape, block, compiler=compiler)
    start = block.state.particles.position.copy()
    for _ in range(20):
        block.step()
        (plain.whole if whole else plain.step)()
    ours, theirs = block.state.particles, plain.problem
    moved = np.abs(ours.position - start).max()
    assert moved > 1e-5
    np.testing.assert_allclose(theirs.position, ours.position, atol=1e-9 * moved)
    np.testing.assert_allclose(theirs.deformation, ours.deformation_gradient, atol=1e-12)
    np.testing.assert_allclose(theirs.stress, ours.stress, atol=1e-12)
    np.testing.assert_allclose(theirs.affine, ours.affine, atol=1e-12)
