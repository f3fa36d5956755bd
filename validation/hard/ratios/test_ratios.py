"""Hard scenes: ratios of mass and stiffness."""

# cost: 100

from held import held, scenes, scored, shared

PRESSED = "the small square is pressed by half of its modulus: 0.69 cells"
SOFT = "springs as soft as the softer square, which is pressed by 10 % of its modulus: 0.19 cells"
every = scenes(
    [
        shared("mass-ratio", misses={"penetration": PRESSED}),
        shared("stiffness-ratio", misses={"penetration": SOFT}),
    ]
)


@every
def test_scene(run):
    held(run)


test_scores = scored(every)
