"""Blocks turned against the grid."""
# cost: 500

# Contact patch test in space, two and three blocks turned by (20, 35, 50) degrees against the grid.
# Triangles and points of the upper block do not match those of the lower one. At this stiffness the
# usual residual force shows.

import normals

from mpmfw.validation import Place, Runs, methods

two = Runs(
    "two",
    methods=[
        *methods(),
        *methods(
            ["bardenhagen"],
            settings={
                "": {},
                "normal given": {
                    "contact.bardenhagen.normal": "specified",
                    "contact.bardenhagen.direction": [0.60845586, 0.193040571, 0.769751131],
                },
            },
            when="full",
        ),
        *methods(["none"], when="full"),
    ],
    places=[
        Place("4 cells", set={"grid.cell_size": 0.25}),
        Place("8 cells", set={"grid.cell_size": 0.125}, when="full"),
    ],
    set={"output.surface": False},
)


@two
def test_two(run):
    at = run.place.at
    for quantity, key, tolerance in (
        (f"two blocks, {at}: mean stress beside the interface, error", "mean", 1.0),
        (f"two blocks, {at}: largest departure beside the interface", "beside", (0.0, 1.0)),
        (f"two blocks, {at}: largest departure of all points", "largest", (0.0, 1.0)),
    ):
        run.gate(
            quantity, run.of(normals.stress, key), 0.0, tolerance, "%", binds=run.method.matches("penalty, *")
        )


three = Runs(
    "three",
    scene="three.toml",
    methods=methods(["penalty", "bardenhagen"]),
    set={"output.surface": False},
    when="full",
)


@three
def test_three(run):
    run.gate(
        "three blocks, 4 cells: mean stress beside the interfaces, error",
        run.of(normals.stress, "mean"),
        0.0,
        1.0,
        "%",
        binds=run.method.matches("penalty, *"),
    )
    run.gate(
        "three blocks, 4 cells: largest departure of all points",
        run.of(normals.stress, "largest"),
        0.0,
        (0.0, 1.0),
        "%",
        binds=run.method.matches("penalty, *"),
    )


other_triangles = Runs(
    "other triangles",
    methods=methods(
        settings={
            "": {},
            "kappa 16": {"contact.penalty.kappa": 16.0},
            "kappa 100": {"contact.penalty.kappa": 100.0, "settle.tolerance": 0.0002},
        }
    ),
    places=[Place("4 cells", set={"grid.cell_size": 0.25}), Place("8 cells", set={"grid.cell_size": 0.125})],
    set={
        "output.surface": False,
        "bodies.upper.particles.size": "0.4 cells",
        "bodies.upper.segment": "0.4 cells",
    },
    binds=["penalty, *", "penalty, cpdi, kappa 100"],
    when="full",
)


@other_triangles
def test_other_triangles(run):
    at = run.place.at
    run.gate(
        f"other triangles, {at}: mean stress beside the interface, error",
        run.of(normals.stress, "mean"),
        0.0,
        1.0,
        "%",
        binds=run.method.matches("penalty, *"),
    )
    run.gate(
        f"other triangles, {at}: largest departure beside the interface",
        run.of(normals.stress, "beside"),
        0.0,
        (0.0, 1.0),
        "%",
        binds=run.method.matches("penalty, cpdi, kappa 100"),
    )
    run.gate(
        f"other triangles, {at}: root of the mean square of all points",
        run.of(normals.stress, "l2"),
        0.0,
        unit="%",
    )
