#!/usr/bin/env python3
"""Makes assets/terrain/N36W085.hgt from the elevation model that the matplotlib wheel carries.

Run `.ci/assets/make`, which provides numpy and the pinned wheel.

The source's grid is that of SRTM (3 arc seconds, samples on multiples of 1/1200 degree). Its longitudes are
right; its latitudes are not: `ymax` is the northern edge of the grid, but `ymin` was computed by *adding*
the height of the grid instead of subtracting it. Checked on places whose elevation is known: with the
northern edge at `ymax`, LaFollette, Caryville, Jacksboro and Cross Mountain (1077 m, the highest) all fit.
"""

import sys
import zipfile
from io import BytesIO

import numpy as np

MEMBER = "matplotlib/mpl-data/sample_data/jacksboro_fault_dem.npz"
SIDE = 1201
SOUTH, WEST = 36, -85
VOID = -32768


def main(wheel: str, output: str) -> None:
    source = np.load(BytesIO(zipfile.ZipFile(wheel).read(MEMBER)))
    elevation = source["elevation"]
    rows, columns = elevation.shape
    # edges are half a sample outside the outermost samples
    north = float(source["ymax"]) - float(source["dy"]) / 2
    west = float(source["xmin"]) + float(source["dx"]) / 2
    top = (SOUTH + 1 - north) * (SIDE - 1)
    left = (west - WEST) * (SIDE - 1)
    if abs(top - round(top)) > 1e-3 or abs(left - round(left)) > 1e-3:
        sys.exit(f"the source is not on the tile's grid: row {top}, column {left}")
    tile = np.full((SIDE, SIDE), VOID, dtype=">i2")
    tile[round(top) : round(top) + rows, round(left) : round(left) + columns] = elevation
    with open(output, "wb") as file:
        file.write(tile.tobytes())
    print(f"{output}: rows {round(top)}+{rows}, columns {round(left)}+{columns}, {elevation.min()}..{elevation.max()} m")


main(*sys.argv[1:])
