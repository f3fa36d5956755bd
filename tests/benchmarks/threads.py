"""What threads gain: steps of two square blocks that meet, 4 points a cell, with one thread and with several.

python tests/benchmarks/threads.py [--cells 112] [--shapes cpdi,bspline] [--threads 2,4,8]
"""

import argparse

from mpmfw.benchmark import measure_threads


def blocks(cells, shape):
    """The scene: blocks of ``cells`` × ``cells`` cells of 1 m, one on the other, which approach slowly."""
    far, gap, margin = 8.0 + cells, 1e-3, 8.0
    places = {"low": [margin, far], "high": [far + gap, far + gap + cells]}
    bodies = {
        name: {
            "geometry": {"type": "rectangle", "lower": [margin, below], "upper": [far, above]},
            "particles": {"size": 0.5},
            "material": "soft",
        }
        for name, (below, above) in places.items()
    }
    bodies["high"]["velocity"] = [0.0, -1e-3]
    upper = [far + margin, places["high"][1] + margin]
    return {
        "grid": {"lower": [0.0, 0.0], "upper": upper, "cell_size": 1.0},
        "time": {"end": 1e6, "output_interval": 1e5},
        "contact": {"method": "penalty"},
        "shape": {"method": shape},
        "output": {"ledger": False, "gap": False, "particles": False, "surface": False},
        "materials": {
            "soft": {"model": "neo_hookean", "density": 1.0, "youngs_modulus": 1.0, "poissons_ratio": 0.3}
        },
        "bodies": bodies,
    }


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=112)
    parser.add_argument("--shapes", default="cpdi,bspline")
    parser.add_argument("--threads", default="2,4,8")
    given = parser.parse_args()
    for shape in given.shapes.split(","):
        for threads in map(int, given.threads.split(",")):
            found = measure_threads(blocks(given.cells, shape), threads, repeats=2)
            print(
                f"{shape}, {found['particles']} points, {threads} threads: {found['ratio']:.2f}", flush=True
            )
