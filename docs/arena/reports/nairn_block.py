"""NairnMPM 19.0: a block slides down 30° if its face lies on a line of the grid, and sticks beside one.

    python nairn_block.py OFFSET NORMALS > block.fmcmd; NairnMPM block.fmcmd; tail -1 Results/block.global

writes the input, runs it, and prints the time and the block's velocity along the plane. A rigid block with
friction 0.3 has g (sin 30° - 0.3 cos 30°) t = 2.40 m/s after 1 s. OFFSET is the height of the face over a
line of the grid in cells, NORMALS the number of MultiMaterialMode. Found [m/s]:

    OFFSET   2 (AVGG)   6 (LOGR)
    0         2.285     2.414
    0.13     -0.003     2.379
    0.25     -0.001     2.410

Both bodies deform, points are squares of half a cell. Contact is found by positions, 0.8, as in the example
TwoDisks. On a rigid plane the block slides with both.
"""

import sys

CELL, SIZE = 0.1, 0.05


def points(number, left, bottom, right, top):
    """Return squares of half a cell that fill a rectangle."""
    columns, rows = round((right - left) / SIZE), round((top - bottom) / SIZE)
    return "\n".join(
        f'<mp mat="{number}" thick="1" lpx="0.5" lpy="0.5">'
        f'<pt x="{left + (i + 0.5) * SIZE:.6g}" y="{bottom + (j + 0.5) * SIZE:.6g}"/></mp>'
        for i in range(columns)
        for j in range(rows)
    )


offset, normals = float(sys.argv[1]) * CELL, int(sys.argv[2])
print(f"""<?xml version='1.0'?>
<JANFEAInput version='3'>
<Header><ConsistentUnits length="m" mass="kg" time="s"/><Analysis>10</Analysis></Header>
<MPMHeader>
<Timing CFL="0.5" max="1.0"/>
<ArchiveGroup time="1.0"/>
<ArchiveRoot>Results/block</ArchiveRoot>
<GlobalArchiveTime units="s">0.1</GlobalArchiveTime>
<GlobalArchive type="velx" matname="block"/>
<MultiMaterialMode Normals="{normals}">
<Friction>0.3</Friction><ContactPosition>0.8</ContactPosition>
</MultiMaterialMode>
<GIMP type="lCPDI"/>
</MPMHeader>
<Mesh output="file">
<Grid xmin="-0.8" xmax="3.6" ymin="-0.6" ymax="1.2"><Horiz nx="44"/><Vert ny="18"/></Grid>
</Mesh>
<MaterialPoints><PointList>
{points(1, 0.0, offset, 0.6, 0.3 + offset)}
{points(2, -0.4, offset - 0.3, 3.2, offset)}
</PointList></MaterialPoints>
<Material Type="8" Name="block"><rho>1000</rho><K>12000000</K><G1>6000000</G1></Material>
<Material Type="8" Name="plane"><rho>1000</rho><K>24000000</K><G1>12000000</G1></Material>
<GridBCs>
<LdRect xmin="-0.7" xmax="3.5" ymin="-0.5" ymax="-0.19">
<DisBC dir="1" disp="0"/><DisBC dir="2" disp="0"/>
</LdRect>
</GridBCs>
<Gravity><BodyXForce>5.0</BodyXForce><BodyYForce>-8.660254</BodyYForce></Gravity>
</JANFEAInput>""")
