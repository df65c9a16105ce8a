#!/usr/bin/python3
"""Writes spline_reference.json: slopes and values of cubic splines by scipy, for tests/curve/interpolate_test.cpp."""
import json
import pathlib

import numpy as np
import scipy
from scipy.interpolate import BarycentricInterpolator, CubicHermiteSpline, CubicSpline

rng = np.random.default_rng(11)
cases = []
for ends in ("natural", "clamped", "not-a-knot", "periodic"):
    for n in (2, 3, 4, 5, 9, 33):
        if ends == "periodic" and n == 2:
            continue
        x = np.sort(rng.uniform(-2, 5, n))
        y = rng.normal(size=n)
        if ends == "periodic":
            y[-1] = y[0]
        boundary = ((1, 0.3), (1, -0.7)) if ends == "clamped" else ends
        spline = CubicSpline(x, y, bc_type=boundary)
        at = np.linspace(x[0], x[-1], 17)
        cases.append({"ends": ends, "x": x.tolist(), "y": y.tolist(), "slopes": spline(x, 1).tolist(),
                      "at": at.tolist(), "values": spline(at).tolist()})
x = np.sort(rng.uniform(-1, 1, 12))
y = rng.normal(size=12)
at = np.linspace(-1, 1, 17)
lagrange = {"x": x.tolist(), "y": y.tolist(), "at": at.tolist(), "values": BarycentricInterpolator(x, y)(at).tolist()}
x, y, m = np.sort(rng.uniform(0, 3, 6)), rng.normal(size=6), rng.normal(size=6)
at = np.linspace(x[0], x[-1], 17)
hermite = {"x": x.tolist(), "y": y.tolist(), "slopes": m.tolist(), "at": at.tolist(),
           "values": CubicHermiteSpline(x, y, m)(at).tolist()}
out = {"scipy": scipy.__version__, "splines": cases, "lagrange": lagrange, "hermite": hermite}
(pathlib.Path(__file__).parent / "spline_reference.json").write_text(json.dumps(out) + "\n")
