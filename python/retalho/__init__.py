"""Smooth surfaces made of polynomial patches, and exact questions about them.

Everything is computed by the C++ library; this package only names what the extension module holds.
"""
from ._retalho import (
    BadInput, Band, Bicubic, CannotRead, CannotWrite, ContourLine, Contours, Curve, Error, ErrorReport, Grid, Mesh,
    Patch, PatchSet, RayHits, SightLine, Terrain, TetraQuad, TileEntry, TiledModel, TilePlan, UsageError, __version__, contours,
    fit, fit_compact, fit_points, from_bytes, intervisibility, line_of_sight, load, map_sheet, read_curves, read_grid, read_mesh,
    read_patches, render, viewshed, write_curves,
)

__all__ = [
    "BadInput", "Band", "Bicubic", "CannotRead", "CannotWrite", "ContourLine", "Contours", "Curve", "Error",
    "ErrorReport", "Grid", "Mesh", "Patch", "PatchSet", "RayHits", "SightLine", "Terrain", "TetraQuad", "TileEntry",
    "TiledModel", "TilePlan", "UsageError", "__version__", "contours", "fit", "fit_compact", "fit_points", "from_bytes", "intervisibility",
    "line_of_sight", "load", "map_sheet", "read_curves", "read_grid", "read_mesh", "read_patches", "render", "viewshed",
    "write_curves",
]
