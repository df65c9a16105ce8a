"""Tiled models by Dask distributed: plan, map tiles, gather the index.

  python3 -m retalho.dask country.vrt -o country --tiles 2048 --max-error 1 --workers 4
  python3 -m retalho.dask /shared/country.vrt -o /shared/country --max-error 1 --scheduler tcp://head:8786

Workers read the grid and write the tiles themselves: both must lie where all of them see it, under the same name.
Without --scheduler a cluster on this machine is started and stopped. Stopped and run again, it makes what is missing.
Nothing is computed here; Dask moves names and lets a task run again where its worker was lost (docs/tiles.md).
"""
from __future__ import annotations

import argparse
import importlib
import os
import pathlib
import sys
from collections.abc import Sequence
from typing import Any

from . import Error, TileEntry, TilePlan

RETRIES = 3  # of a task that raised; a lost worker's tasks run elsewhere without counting


def look(plan: TilePlan, row: int, column: int) -> tuple[bool, int, float, float]:
    return plan.look(row, column)


def count(plan: TilePlan, row: int, column: int, max_error: float, areas: list[bool]) -> int:
    return plan.count(row, column, max_error, areas)


def tin_name(plan: TilePlan, row: int, column: int) -> str:
    return plan.tin_name(row, column)


def make_tin(plan: TilePlan, row: int, column: int, name: str, folder: str) -> None:
    plan.make_tin(row, column, name, folder)


def make_tile(plan: TilePlan, row: int, column: int, tins: list[str], folder: str) -> TileEntry:
    return plan.make_tile(row, column, tins, folder)


def make_tiles(plan: TilePlan, folder: str, client: Any, *, overwrite: bool = False) -> list[TileEntry]:
    """What TilePlan.make does, by the workers of a distributed.Client. The bytes are the same."""
    plan.check(folder, overwrite=overwrite)
    os.makedirs(folder, exist_ok=True)
    rows, columns = plan.tiles
    places = [(row, column) for row in range(rows) for column in range(columns)]
    # A plan is a few hundred bytes: it goes along with every task, so that none depends on another one's result.
    sent = {"pure": False, "retries": RETRIES}

    def gather(function: Any, *arguments: list[Any]) -> list[Any]:
        plans = [plan] * len(arguments[0])
        return list(client.gather(client.map(function, plans, *arguments, **sent)))

    def split(chosen: list[tuple[int, int]]) -> tuple[list[int], list[int]]:
        return [row for row, _ in chosen], [column for _, column in chosen]

    if not plan.settled:
        looks: list[tuple[bool, int, float, float]] = gather(look, *split(places))
        areas = [plan.areas(looks, row, column) for row, column in places]
        plan = plan.settle(looks, lambda max_error: sum(
            gather(count, *split(places), [max_error] * len(places), areas)))
        plan.check(folder, overwrite=overwrite)
    tins: list[str] = gather(tin_name, *split(places))
    flat, _ = plan.missing(tins, folder)
    if flat:
        wanted = [places[k] for k in flat]
        gather(make_tin, *split(wanted), [tins[k] for k in flat], [folder] * len(flat))
    around = [plan.around(tins, row, column) for row, column in places]
    entries: list[TileEntry] = gather(make_tile, *split(places), around, [folder] * len(places))
    plan.finish(entries, tins, folder, overwrite=overwrite)
    return entries


def connect(scheduler: str | None, workers: int) -> Any:
    """A client of that scheduler, or of a cluster of its own on this machine (loopback, one thread a worker)."""
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError:
        sys.exit("retalho.dask: the package distributed is missing (Debian: python3-distributed); "
                 "on one machine, retalho fit --tiles --jobs does the same without it")
    if scheduler:
        return distributed.Client(scheduler)
    cluster = distributed.LocalCluster(n_workers=workers, threads_per_worker=1, host="127.0.0.1", dashboard_address=None)
    return distributed.Client(cluster)


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python3 -m retalho.dask", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dem", help="elevation grid: a file or VRT that GDAL reads by windows")
    parser.add_argument("-o", "--output", required=True, help="folder of the tiled model")
    parser.add_argument("--tiles", type=int, default=1024, metavar="N", help="cells from seam to seam (default 1024)")
    budget = parser.add_mutually_exclusive_group(required=True)
    budget.add_argument("--max-error", type=float, metavar="E", help="height units")
    budget.add_argument("--vertices", type=int, metavar="N", help="of the whole model, at most")
    budget.add_argument("--ratio", type=float, metavar="R", help="vertices as a share of the valid cells: 0.01")
    parser.add_argument("--surface", default="clough-tocher", choices=["linear", "powell-sabin", "clough-tocher"])
    parser.add_argument("--fit", default="interpolate", choices=["interpolate", "least-squares"])
    parser.add_argument("--band", type=int, default=1)
    parser.add_argument("--nodata", type=float)
    parser.add_argument("--scheduler", metavar="ADDRESS", help="of a running cluster: tcp://head:8786")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, metavar="N",
                        help="without --scheduler: how many processes (default: all cores)")
    parser.add_argument("--overwrite", action="store_true", help="replace the index of another tiled model")
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    options = parse(arguments)
    if options.workers < 1:
        print(f"retalho.dask: --workers must be 1 or more, not {options.workers}", file=sys.stderr)
        return 2
    try:
        plan = TilePlan(options.dem, size=options.tiles, max_error=options.max_error, vertices=options.vertices,
                        ratio=options.ratio, surface=options.surface, fit=options.fit, band=options.band, nodata=options.nodata)
        plan.check(options.output, overwrite=options.overwrite)
        client = connect(options.scheduler, options.workers)
        try:
            entries = make_tiles(plan, str(pathlib.Path(options.output).resolve()), client,
                                 overwrite=options.overwrite)
        finally:
            cluster = client.cluster
            client.close()
            if cluster is not None:
                cluster.close()
    except Error as error:
        print(f"retalho.dask: {error}", file=sys.stderr)
        return {"usage": 2, "bad_input": 3, "cannot_read": 4, "cannot_write": 5}.get(error.kind, 1)
    print(f"{options.output}: {len(entries)} tiles, {sum(e.bytes for e in entries)} bytes", file=sys.stderr)
    return 0


if __name__ == "__main__":
    # Workers find the tasks by this module's own name, not by __main__.
    from retalho.dask import main as run

    sys.exit(run())
