"""Rolling sphere."""
# cost: 1000

# Rolling sphere in three dimensions, with slip and without, on a plane along the grid and on a turned
# one, and on a long plane. 0.5 % of the acceleration is what is asked for; the other limits are what is
# reached, see the README. Everything but the grid, about the plane's centre by (20°, 35°, 50°) about x,
# then y, then z. The dimensions of the rolling sphere in Uintah's manual: 12 m long, 4.8 m high, cells
# of 0.2 m, 2.2 s. On 30 degrees the sphere stays on the plane so long. Nearer to the rigid sphere: less
# creep, and cells so small that rolling over them does not make the sphere bounce. Nearer to the rigid
# sphere: less creep, and cells so small that rolling over them does not make the sphere bounce.

import rigid

from mpmfw.validation import Runs, known_red, methods

no_slip = Runs(
    "no slip",
    scene="rolling-sphere-no-slip",
    methods=[
        *methods(),
        *methods(["bardenhagen"], when="full"),
        *methods(["bardenhagen(criterion=position, normal=master)"]),
    ],
    set={"output.particles": False, "output.surface": False, "output.ledger": False},
)


@known_red(
    "penalty, cpdi",
    "no slip: fitted angular acceleration, error",
    "-1.9 %; -1.1 % before kappa went from 1 to 4 and settling changed; the cause was not separated",
)
@no_slip
def test_no_slip(run):
    for quantity, key, tolerance in (
        ("no slip: displacement, error", "displacement", 0.5),
        ("no slip: fitted acceleration, error", "fitted acceleration", 0.5),
        ("no slip: fitted angular acceleration, error", "fitted angular acceleration", 1.5),
    ):
        run.gate(
            quantity,
            run.of(rigid.errors, key, scene="rolling-sphere-no-slip"),
            0.0,
            tolerance,
            "%",
            binds=run.method.matches("penalty, *"),
        )
    run.gate(
        "no slip: deepest penetration",
        run.of(rigid.errors, "penetration", scene="rolling-sphere-no-slip"),
        unit="h",
    )


slip = Runs(
    "slip",
    scene="rolling-sphere-slip",
    methods=[
        *methods(),
        *methods(["bardenhagen"], when="full"),
        *methods(["bardenhagen(criterion=position, normal=master)"]),
    ],
    set={"output.particles": False, "output.surface": False, "output.ledger": False},
    when="full",
)


@slip
def test_slip(run):
    for quantity, key, tolerance in (
        ("slip: displacement, error", "displacement", 1.0),
        ("slip: fitted acceleration, error", "fitted acceleration", 0.5),
        ("slip: fitted angular acceleration, error", "fitted angular acceleration", 2.0),
    ):
        run.gate(
            quantity,
            run.of(rigid.errors, key, scene="rolling-sphere-slip"),
            0.0,
            tolerance,
            "%",
            binds=run.method.matches("penalty, *"),
        )
    run.gate(
        "slip: deepest penetration",
        run.of(rigid.errors, "penetration", scene="rolling-sphere-slip"),
        unit="h",
    )


turned = Runs(
    "turned",
    scene="rolling-sphere-no-slip",
    set={
        "output.particles": False,
        "output.surface": False,
        "output.ledger": False,
        "grid.lower": [-2.0, -4.8, -5.2],
        "grid.upper": [8.4, 5.6, 5.2],
        "bodies.plane.geometry.angles": [0.34906585, 0.610865238, 0.872664626],
        "bodies.sphere.geometry.centre": [0.959423137, 0.653588874, 1.70748587],
        "gravity.vector": [7.92163546, -0.89657206, -6.03687418],
        "settle.gravity.vector": [4.19842987, -5.33371569, -1.98107631],
    },
    when="full",
)


@turned
def test_turned(run):
    for quantity, key, tolerance in (
        ("no slip, turned plane: displacement, error", "displacement", 0.5),
        ("no slip, turned plane: fitted acceleration, error", "fitted acceleration", 0.5),
        ("no slip, turned plane: fitted angular acceleration, error", "fitted angular acceleration", 1.5),
    ):
        run.gate(
            quantity,
            run.of(rigid.errors, key, scene="rolling-sphere-no-slip", angles=[20.0, 35.0, 50.0]),
            0.0,
            tolerance,
            "%",
            binds=run.method.matches("penalty, *"),
        )
    run.gate(
        "no slip, turned plane: deepest penetration",
        run.of(rigid.errors, "penetration", scene="rolling-sphere-no-slip", angles=[20.0, 35.0, 50.0]),
        unit="h",
    )


long = Runs(
    "long",
    scene="rolling-sphere-no-slip",
    set={
        "output.particles": False,
        "output.surface": False,
        "output.ledger": False,
        "time.end": 2.2,
        "grid.cell_size": 0.2,
        "grid.lower": [-0.4, -0.4, -2.0],
        "grid.upper": [12.4, 4.8, 2.0],
        "bodies.plane.geometry.lower": [0.0, 0.0, -0.8],
        "bodies.plane.geometry.upper": [12.0, 0.4, 0.8],
        "bodies.sphere.geometry.centre": [1.6, 2.0, 0.0],
        "gravity.vector": [5.0, -8.660254, 0.0],
        "settle.gravity.vector": [0.0, -8.660254, 0.0],
    },
    when="full",
)


@long
def test_long(run):
    for quantity, key, tolerance in (
        ("no slip, 12 m: displacement, error", "displacement", 0.5),
        ("no slip, 12 m: fitted acceleration, error", "fitted acceleration", 0.5),
        ("no slip, 12 m: fitted angular acceleration, error", "fitted angular acceleration", 1.0),
    ):
        run.gate(
            quantity, run.of(rigid.errors, key), 0.0, tolerance, "%", binds=run.method.matches("penalty, *")
        )
    run.gate("no slip, 12 m: deepest penetration", run.of(rigid.errors, "penetration"), unit="h")


no_slip_ten_times_the_moduli_cells_of_0_2_m = Runs(
    "no slip, ten times the moduli, cells of 0.2 m",
    scene="rolling-sphere-no-slip",
    set={
        "output.particles": False,
        "output.surface": False,
        "output.ledger": False,
        "grid.cell_size": 0.2,
        "materials.stiff.bulk_modulus": "600 MPa",
        "materials.stiff.shear_modulus": "300 MPa",
    },
    when="full",
)


@no_slip_ten_times_the_moduli_cells_of_0_2_m
def test_no_slip_ten_times_the_moduli_cells_of_0_2_m(run):
    for quantity, key in (
        ("no slip, ten times the moduli: displacement, error", "displacement"),
        ("no slip, ten times the moduli: fitted acceleration, error", "fitted acceleration"),
        ("no slip, ten times the moduli: fitted angular acceleration, error", "fitted angular acceleration"),
    ):
        run.gate(
            quantity,
            run.of(rigid.errors, key, scene="rolling-sphere-no-slip"),
            0.0,
            0.5,
            "%",
            binds=run.method.matches("penalty, *"),
        )


slip_ten_times_the_moduli_cells_of_0_2_m = Runs(
    "slip, ten times the moduli, cells of 0.2 m",
    scene="rolling-sphere-slip",
    set={
        "output.particles": False,
        "output.surface": False,
        "output.ledger": False,
        "grid.cell_size": 0.2,
        "materials.stiff.bulk_modulus": "600 MPa",
        "materials.stiff.shear_modulus": "300 MPa",
    },
    when="full",
)


@slip_ten_times_the_moduli_cells_of_0_2_m
def test_slip_ten_times_the_moduli_cells_of_0_2_m(run):
    for quantity, key, tolerance in (
        ("slip, ten times the moduli: displacement, error", "displacement", 0.5),
        ("slip, ten times the moduli: fitted acceleration, error", "fitted acceleration", 0.5),
        (
            "slip, ten times the moduli: fitted angular acceleration, error",
            "fitted angular acceleration",
            1.0,
        ),
    ):
        run.gate(
            quantity,
            run.of(rigid.errors, key, scene="rolling-sphere-slip"),
            0.0,
            tolerance,
            "%",
            binds=run.method.matches("penalty, *"),
        )
