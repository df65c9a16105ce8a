"""Times scipy's CloughTocher2DInterpolator for bench_terrain, and hands over the very triangulation that it used.

usage: /usr/bin/python3 scipy_clough_tocher.py POINTS SIDE FOLDER

Writes FOLDER/points.bin (x, y, z doubles) and FOLDER/triangles.bin (three uint32, counter-clockwise), and prints one
JSON object: nanoseconds of CPU a point for SIDE x SIDE grid points (the best of three calls; construction, that is
triangulation and gradients, not counted).
"""
import json
import sys
import time

import numpy as np
from scipy.interpolate import CloughTocher2DInterpolator
from scipy.spatial import Delaunay


def franke(x, y):
    return (
        0.75 * np.exp(-((9 * x - 2) ** 2 + (9 * y - 2) ** 2) / 4)
        + 0.75 * np.exp(-((9 * x + 1) ** 2) / 49 - (9 * y + 1) / 10)
        + 0.5 * np.exp(-((9 * x - 7) ** 2 + (9 * y - 3) ** 2) / 4)
        - 0.2 * np.exp(-((9 * x - 4) ** 2) - (9 * y - 7) ** 2)
    )


def main():
    count, side, folder = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
    random = np.random.default_rng(1)
    border = 4 * int(count**0.5)
    points = random.random((count, 2))
    for k, (axis, value) in enumerate(((0, 0), (0, 1), (1, 0), (1, 1))):
        points[k:border:4, axis] = value
    points[:4] = [[0, 0], [1, 0], [0, 1], [1, 1]]
    heights = franke(points[:, 0], points[:, 1])
    triangulation = Delaunay(points)
    triangles = triangulation.simplices.astype(np.uint32)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    triangles[area < 0] = triangles[area < 0][:, [0, 2, 1]]
    triangles = triangles[area != 0]
    np.c_[points, heights].tofile(folder + "/points.bin")
    triangles.tofile(folder + "/triangles.bin")
    interpolator = CloughTocher2DInterpolator(triangulation, heights)
    x, y = np.meshgrid((np.arange(side) + 0.5) / side, 1 - (np.arange(side) + 0.5) / side)
    best = None
    for _ in range(3):
        start = time.process_time()
        z = interpolator(x, y)
        seconds = time.process_time() - start
        best = seconds if best is None else min(best, seconds)
    error = (z - franke(x, y))[np.isfinite(z)]
    rmse = float(np.sqrt(np.mean(error**2)))
    print(json.dumps({"ns_per_point": best / side**2 * 1e9, "rmse": rmse}))


main()
