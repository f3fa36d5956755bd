"""CalculiX 2.20: two discs that meet node on node gain energy without end, until ccx hangs or crashes.

    python calculix_discs.py COUNT TURN > discs.inp; ccx discs; python calculix_discs.py discs.dat

writes the input, runs it, and prints the largest speed of a node over that of the discs. A disc has 5 COUNT²
elements and one node on the line of centres. The second is turned by TURN edges: with 0 the nodes meet, with
0.5 the node and the middle of an edge. Contact is explicit, node to surface, without friction or damping: no
node can stay much faster than the discs. Found:

    COUNT   TURN 0                      TURN 0.5
    2       3e14, ccx does not return   2.07
    3       1e17, ccx does not return   1.90
    4       2e26, ccx does not return   2.12

The faces on both sides of a node push what slides from one to the other. Smaller steps gain as well, so that
the step is not the cause. Once coordinates are infinite or NaN, the search for the face of a node loops for
ever, or reads with an index made of a NaN. Then ccx ends by SIGSEGV, as it did on a diagonal with 60 nodes.
"""

import math
import sys

RADIUS, SPEED, END, STEP, BULK, SHEAR = 0.2, 0.1414, 3.0, 0.01, 2500 / 3, 5000 / 13


def disc(count, centre, angle):
    """Return nodes and quadrilaterals of a disc: a square of COUNT², and COUNT² at each side."""
    side = [2 * k / count - 1 for k in range(count + 1)]
    patches = [[[(0.5 * x, 0.5 * y) for y in side] for x in side]]
    for quarter in range(4):
        turn = 0.5 * math.pi * quarter
        patches.append([])
        for k in range(count + 1):
            share, row = k / count, []
            for y in side:
                rim = (math.cos(math.pi / 4 * y), math.sin(math.pi / 4 * y))
                x, y = (
                    0.5 * (1 - share) * one + share * other for one, other in zip((1, y), rim, strict=True)
                )
                row.append((x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn)))
            patches[-1].append(row)
    nodes, cells, outer = {}, [], []
    for patch in patches:
        for k in range(count):
            for j in range(count):
                corners = [patch[k][j], patch[k + 1][j], patch[k + 1][j + 1], patch[k][j + 1]]
                keys = [(round(x, 9), round(y, 9)) for x, y in corners]
                cells.append([nodes.setdefault(key, len(nodes)) for key in keys])
                outer += [len(cells)] if patch is not patches[0] and k == count - 1 else []
    place = [(RADIUS * x, RADIUS * y) for x, y in nodes]
    cos, sin = math.cos(angle), math.sin(angle)
    return [(centre + x * cos - y * sin, x * sin + y * cos) for x, y in place], cells, outer


def written(count, turn):
    """Return the lines of the input: two discs, one element deep."""
    edge = math.pi / 2 / count
    bodies = [disc(count, 0.0, math.pi / 4), disc(count, 2.0153 * RADIUS, math.pi / 4 + turn * edge)]
    size, depth = len(bodies[0][0]), RADIUS * edge
    lines, nodes = ["*NODE, NSET=ALL"], bodies[0][0] + bodies[1][0]
    for layer in (0, 1):
        places = enumerate(nodes, 1 + 2 * layer * size)
        lines += [f"{k},{x:.9g},{y:.9g},{layer * depth:.9g}" for k, (x, y) in places]
    for body, (_, cells, outer) in enumerate(bodies):
        first = 1 + body * size
        lines.append(f"*ELEMENT, TYPE=C3D8, ELSET=E{body}")
        for k, cell in enumerate(cells, 1 + body * len(cells)):
            corners = [first + node for node in cell] + [first + node + 2 * size for node in cell]
            lines.append(",".join(map(str, (k, *corners))))
        lines += [f"*SURFACE, NAME=S{body}, TYPE=ELEMENT", *(f"{body * len(cells) + k},S4" for k in outer)]
        lines += [f"*NSET, NSET=N{body}, GENERATE", f"{first},{first + size - 1}"]
        lines += [f"{first + 2 * size},{first + 3 * size - 1}"]
        lines += [f"*SOLID SECTION, ELSET=E{body}, MATERIAL=RUBBER"]
    stiff = BULK + 4 * SHEAR / 3
    lines += ["*MATERIAL, NAME=RUBBER", "*HYPERELASTIC, NEO HOOKE", f"{SHEAR / 2:.9g},{2 / BULK:.9g}"]
    lines += ["*DENSITY", "1000.", "*INITIAL CONDITIONS, TYPE=VELOCITY", f"N0,1,{SPEED}", f"N1,1,{-SPEED}"]
    lines += ["*SURFACE INTERACTION, NAME=CONTACT", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"]
    lines += [f"{stiff / depth:.9g}", "*CONTACT PAIR, INTERACTION=CONTACT, TYPE=NODE TO SURFACE", "S0,S1"]
    lines += ["*BOUNDARY", "ALL,3,3", "*STEP, NLGEOM, INC=1000000", "*DYNAMIC, EXPLICIT"]
    lines += [f"{STEP},{END},{1e-6 * STEP:.3g},{STEP}", "*NODE PRINT, NSET=ALL", "V", "*END STEP"]
    return lines


if len(sys.argv) == 3:
    print("\n".join(written(int(sys.argv[1]), float(sys.argv[2]))))
else:
    with open(sys.argv[1]) as file:
        rows = [line.split() for line in file]
    speeds = [math.hypot(float(row[1]), float(row[2])) for row in rows if len(row) == 4]
    print(f"{max(speeds) / SPEED:.3g}")
