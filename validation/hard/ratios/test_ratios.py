"""Hard scenes: ratios of mass and stiffness."""

# cost: 100

# Open is what penalty contact with CPDI, plain or in its strongest form (held.py), does not hold today,
# with the reason; it is shown and decides nothing.

from held import held, scenes, scores

from mpmfw.validation import Place, full, together

every = scenes(
    [
        Place(
            "mass-ratio",
            scene="../scenes/mass-ratio.toml",
            open={
                "penetration": {
                    "penalty, cpdi": "the small square is pressed by half of its modulus: 0.69 cells"
                }
            },
            when="full",
        ),
        Place(
            "stiffness-ratio",
            scene="../scenes/stiffness-ratio.toml",
            open={
                "penetration": {
                    "penalty, cpdi": (
                        "springs as soft as the softer square, which is pressed by 10 % of its "
                        "modulus: 0.19 cells"
                    )
                }
            },
            when="full",
        ),
    ]
)


@every
def test_scene(run):
    held(run)


@full
@together(every)
def test_scores(case, runs):
    scores(case, runs)
