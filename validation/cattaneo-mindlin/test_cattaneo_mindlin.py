"""Cattaneo and Mindlin's partial slip."""
# cost: 600

# Partial slip of a cylinder on a block: shear along the contact at half of the load that slides, and
# sliding, with two cell sizes. What every method has decides nothing.

import drawn
import pressed
import tractions

from mpmfw.validation import Place, Runs, full, methods, together

scene = Runs(
    "",
    scene=pressed.scene,
    methods=[
        *methods(),
        *methods(
            ["penalty(kappa=16)", "bardenhagen", "bardenhagen(criterion=position, normal=master)", "nairn"],
            when="full",
        ),
    ],
    places=[
        Place("a/h = 5", set={"grid.cell_size": 0.2}),
        Place("a/h = 10", set={"grid.cell_size": 0.1}, when="full"),
    ],
)


@scene
def test_scene(run):
    by_stress, forces = tractions.partial_slip_by_stress, run.method.matches("penalty*")
    run.gates(by_stress, ("Q / (μ P) at the output nearest to a half, {at}", "share"))
    if forces:
        run.gates(
            tractions.partial_slip,
            ("c / a by the shear, error, {at}", "stick", 0.0, 0.05),
            ("shear, error in L2 of μ p, {at}", "shear", 0.0, (0.0, 10.0), "%"),
            ("pressure, error in L2, {at}", "pressure", 0.0, (0.0, 5.0), "%"),
            ("largest |T| / (μ N) of a node, {at}", "cone", 1.0, (0.0, 1.05)),
        )
    run.gates(tractions.sliding, ("Q over μ P when it slides, less one, {at}", None, 0.0, 1.0, "%"))
    if forces:
        run.gates(tractions.stick_when_sliding, ("c / a when it slides, {at}", None, 0.0))
        run.gates(tractions.shear_before, ("shear that pressing leaves, of μ p, {at}", None, 0.0, None, "%"))
    run.gates(
        by_stress,
        ("c / a by the points' shear, error, {at}", "stick", 0.0, 0.05),
        ("points' shear, error in L2 of μ p, {at}", "shear", 0.0, (0.0, 10.0), "%"),
        ("points' pressure, error in L2, {at}", "pressure", 0.0, (0.0, 5.0), "%"),
        binds=False,
    )


@full
@together(scene)
def test_figure(case, runs):
    case.figure("", drawn.draw(runs))
