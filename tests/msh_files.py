"""Writes gmsh's files of version 2.2."""

#: gmsh's numbers of kinds of elements.
KINDS = {"triangle": 2, "quad": 3, "tetra": 4}


def write_msh(path, points, cells):
    """Points (n, 3) and elements by kind, each by its points counted from 0."""
    elements = [(KINDS[kind], one) for kind, block in cells.items() for one in block]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(points))]
    lines += [f"{k + 1} {x!r} {y!r} {z!r}" for k, (x, y, z) in enumerate(map(tuple, map(_floats, points)))]
    lines += ["$EndNodes", "$Elements", str(len(elements))]
    lines += [
        f"{k + 1} {kind} 2 1 1 {' '.join(str(int(node) + 1) for node in nodes)}"
        for k, (kind, nodes) in enumerate(elements)
    ]
    path.write_text("\n".join([*lines, "$EndElements", ""]))
    return path


def _floats(point):
    return [float(x) for x in point]
