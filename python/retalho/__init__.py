"""Smooth surfaces made of polynomial patches, and exact questions about them.

Everything is computed by the C++ library; this package only names what the extension module holds.
"""
from ._retalho import (
    BadInput, Band, Bicubic, CannotRead, CannotWrite, ContourLine, Contours, Curve, Error, ErrorReport, Graph,
    Grid, LevelSet, Mesh, Patch, PatchSet, Points, RayHits, SightLine, Terrain, TetraQuad, TileEntry, TilePlan,
    TiledModel, UsageError, __version__, compare, compare_surfaces, contours, draw_curves, estimate_normals, fit,
    fit_compact, fit_points, from_bytes, intervisibility, line_of_sight, load, map_sheet, read_curves, read_grid,
    read_lines, read_mesh, read_patches, read_points, read_quadrics, render, viewshed, write_curves,
)

__all__ = [
    "BadInput", "Band", "Bicubic", "CannotRead", "CannotWrite", "ContourLine", "Contours", "Curve", "Error",
    "ErrorReport", "Graph", "Grid", "LevelSet", "Mesh", "Patch", "PatchSet", "Points", "RayHits", "SightLine",
    "Terrain", "TetraQuad", "TileEntry", "TilePlan", "TiledModel", "UsageError", "__version__", "compare",
    "compare_surfaces", "contours", "draw_curves", "estimate_normals", "fit", "fit_compact", "fit_points",
    "from_bytes", "intervisibility", "line_of_sight", "load", "map_sheet", "read_curves", "read_grid",
    "read_lines", "read_mesh", "read_patches", "read_points", "read_quadrics", "render", "viewshed",
    "write_curves",
]
