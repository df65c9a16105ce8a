"""Writes tests/data/bicubic_reference.json: a 9 x 12 grid and scipy's RectBivariateSpline (not-a-knot, interpolating) on it.

usage: /usr/bin/python3 tests/data/make_bicubic_reference.py > tests/data/bicubic_reference.json
"""
import json

import numpy as np
from scipy.interpolate import RectBivariateSpline

random = np.random.default_rng(3)
rows, columns = 9, 12
z = np.round(random.uniform(0, 10, (rows, columns)), 3)
spline = RectBivariateSpline(np.arange(rows), np.arange(columns), z, s=0)
v = np.concatenate([random.uniform(0, rows - 1, 200), [0, rows - 1, 0, rows - 1]])
u = np.concatenate([random.uniform(0, columns - 1, 200), [0, 0, columns - 1, columns - 1]])
print(
    json.dumps(
        {
            "z": z.tolist(),
            "u": u.tolist(),
            "v": v.tolist(),
            "value": spline.ev(v, u).tolist(),
            "du": spline.ev(v, u, dy=1).tolist(),
            "dv": spline.ev(v, u, dx=1).tolist(),
            "duv": spline.ev(v, u, dx=1, dy=1).tolist(),
        }
    )
)
