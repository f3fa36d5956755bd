"""The long form of the fuzzing: ``python tests/fuzz/long_form.py --count 100000``.

Prints each mutant that ends otherwise than it may, and how many ended how; ``--number N`` shows one mutant
and its end."""

from __future__ import annotations

import argparse
import collections
import sys
import tempfile
from pathlib import Path

from mutants import mutant
from trial import attempt


def main() -> int:
    """Try the mutants; the exit status is 1 if one ended otherwise than it may."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--number", type=int)
    parser.add_argument("--memory", action="store_true", help="measure memory as well")
    parser.add_argument(
        "--failed", action="store_true", help="print those as well that failed with a message"
    )
    asked = parser.parse_args()
    numbers = range(asked.first, asked.first + asked.count) if asked.number is None else [asked.number]
    ends: collections.Counter[str] = collections.Counter()
    slowest = (0.0, -1)
    for number in numbers:
        made = mutant(number)
        with tempfile.TemporaryDirectory() as folder:
            trial = attempt(made, Path(folder), memory=asked.memory)
        ends[trial.outcome] += 1
        slowest = max(slowest, (trial.seconds, number))
        if asked.number is not None:
            print(made.text)
        if (
            trial.outcome == "wrong"
            or (asked.failed and trial.outcome == "failed")
            or asked.number is not None
        ):
            print(
                f"-- mutant {number} of {made.seed}: {trial.outcome} after {trial.seconds:.2f} "
                f"s\n{trial.said}",
                flush=True,
            )
    print(f"{dict(ends)}; the slowest, {slowest[1]}, took {slowest[0]:.1f} s")
    return 1 if ends["wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())
