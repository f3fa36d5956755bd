"""A rigid wheel, driven over soft clay: sinkage, pull and torque against the finest run."""
# cost: 260

from mpmfw.validation import CLASSICAL, Place, Runs, methods

#: Means over the last third with cells of R/15, per metre: sinkage [mm], pull [N], torque [N m].
FINEST = {"sinkage": 24.59, "pull": 862.0, "torque": 1254.0}

coarse = Runs(
    "wheel",
    "wheel",
    methods() + methods([CLASSICAL[1], "lcp"], when="full"),
    [
        Place("R/h = 5", within={"sinkage": (-10.0, 10.0), "torque": (-25.0, 25.0)}),
        Place(
            "R/h = 10",
            set={"grid.cell_size": 0.05},
            within={"sinkage": (-10.0, 10.0), "torque": (-6.0, 6.0)},
            when="full",
        ),
    ],
    set={"output.particles": False},
)
finest = Runs(
    "finest",
    "wheel",
    places=[Place("R/h = 15", set={"grid.cell_size": 1.0 / 30.0}, when="full")],
    set={"output.particles": False},
)


def means(tree):
    """Return sinkage [mm], pull [N] and torque [N m] per metre, means over the last third."""
    series = tree["series"].to_dataset().sel(body="wheel")
    late = slice(2 * len(series["time"]) // 3, None)
    return {
        "sinkage": 1e3 * (0.5 - series["centre_of_mass"].sel(axis="y").values[late].mean()),
        "pull": series["reaction"].sel(axis="x").values[late].mean(),
        "torque": series["reaction_moment"].values[late].mean(),
    }


@coarse
def test_wheel(run):
    for key, exact in FINEST.items():
        error = 100.0 * (run.of(means, key) / exact - 1.0)
        run.gate(f"{key}, error, {run.place.at}", error, 0.0, None, "%", key=key)


@finest
def test_finest(run):
    for key, exact in FINEST.items():
        run.gate(
            key,
            run.of(means, key),
            exact,
            (0.98 * exact, 1.02 * exact),
            "mm" if key == "sinkage" else "N",
            binds=True,
        )
