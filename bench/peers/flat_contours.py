"""Times gdal_contour's and contourpy's level lines of the flat surface for bench_contour.

usage: /usr/bin/python3 flat_contours.py RAW SIDE FIRST STEP COUNT

RAW: SIDE x SIDE float32 heights, row-major. Prints one JSON object: CPU seconds and segments of both.
"""
import json
import os
import subprocess
import sys
import tempfile
import time

import contourpy
import numpy as np


def children_seconds():
    return sum(os.times()[2:4])


def main():
    path, side = sys.argv[1], int(sys.argv[2])
    first, step, count = float(sys.argv[3]), float(sys.argv[4]), int(sys.argv[5])
    z = np.fromfile(path, dtype=np.float32).reshape(side, side)
    levels = first + step * np.arange(count)

    begin = time.process_time()
    generator = contourpy.contour_generator(z=z, name="serial", line_type="Separate")
    segments = 0
    for level in levels:
        segments += sum(len(line) - 1 for line in generator.lines(level))
    contourpy_seconds = time.process_time() - begin

    with tempfile.TemporaryDirectory() as folder:
        header = os.path.join(folder, "z.vrt")
        with open(header, "w") as vrt:
            vrt.write(
                f'<VRTDataset rasterXSize="{side}" rasterYSize="{side}"><VRTRasterBand dataType="Float32" band="1" '
                f'subClass="VRTRawRasterBand"><SourceFilename relativeToVRT="0">{path}</SourceFilename>'
                f"<ByteOrder>LSB</ByteOrder></VRTRasterBand></VRTDataset>"
            )
        out = os.path.join(folder, "lines.shp")
        # Against a run without levels in reach: what reading costs.
        before = children_seconds()
        subprocess.run(["gdal_contour", "-q", "-fl", "1e9", header, os.path.join(folder, "none.shp")], check=True)
        middle = children_seconds()
        subprocess.run(["gdal_contour", "-q", "-i", str(step), "-off", str(first), header, out], check=True)
        gdal_seconds = children_seconds() - middle
        gdal_reading = middle - before
    print(
        json.dumps(
            {
                "segments": segments,
                "contourpy_seconds": contourpy_seconds,
                "gdal_seconds": gdal_seconds,
                "gdal_reading_seconds": gdal_reading,
            }
        )
    )


if __name__ == "__main__":
    main()
