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
    at = run.place.at
    quantity = f"Q / (μ P) at the output nearest to a half, {at}"
    run.gate(quantity, run.of(tractions.partial_slip_by_stress, "share"))
    if run.method.matches("penalty*"):
        for quantity, key, reference, tolerance, unit in (
            (f"c / a by the shear, error, {at}", "stick", 0.0, 0.05, ""),
            (f"shear, error in L2 of μ p, {at}", "shear", 0.0, (0.0, 10.0), "%"),
            (f"pressure, error in L2, {at}", "pressure", 0.0, (0.0, 5.0), "%"),
            (f"largest |T| / (μ N) of a node, {at}", "cone", 1.0, (0.0, 1.05), ""),
        ):
            run.gate(quantity, run.of(tractions.partial_slip, key), reference, tolerance, unit)
    run.gate(f"Q over μ P when it slides, less one, {at}", run.of(tractions.sliding), 0.0, 1.0, "%")
    if run.method.matches("penalty*"):
        run.gate(f"c / a when it slides, {at}", run.of(tractions.stick_when_sliding), 0.0)
        run.gate(f"shear that pressing leaves, of μ p, {at}", run.of(tractions.shear_before), 0.0, unit="%")
    for quantity, key, tolerance, unit in (
        (f"c / a by the points' shear, error, {at}", "stick", 0.05, ""),
        (f"points' shear, error in L2 of μ p, {at}", "shear", (0.0, 10.0), "%"),
        (f"points' pressure, error in L2, {at}", "pressure", (0.0, 5.0), "%"),
    ):
        run.gate(quantity, run.of(tractions.partial_slip_by_stress, key), 0.0, tolerance, unit, binds=False)


@full
@together(scene)
def test_figure(case, runs):
    case.figure("", drawn.draw(runs))
