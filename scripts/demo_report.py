#!/usr/bin/env python3
"""What the demo shows: demo_report.py SCAN RESULT [BEFORE.json AFTER.json]; reads RESULT.json."""

import json
import os
import sys


def line(what, text):
    print(f"  {what:<12} {text}")


def load(path):
    with open(path) as file:
        return json.load(file)


def megabytes(size):
    return f"{size / 2**20:.0f} MiB"


def distances(before, after):
    """Rms distance to the true surface, in spacings of the scan."""
    was, now = (load(path)["distance_in_spacings"]["rms"] for path in (before, after))
    line("before", f"{was:.3f} spacings rms from the true surface")
    line("after", f"{now:.3f} spacings: {was / now:.1f} times nearer")


def main(scan, result, *measured):
    report = load(result + ".json")
    points, seconds, memory = report["points"], report["seconds"], report["memory"]
    print("\npss demo: moving least squares, out of core")
    line("scan", f"{scan}: {points['in']:,} points, {megabytes(os.path.getsize(scan))}")
    if measured:
        distances(*measured)
    moved = report["displacement"]
    line("moved", f"{moved['rms']:.3g} rms, {moved['largest']:.3g} at most (the scan's units)")
    line("widths", report["widths"]["why"])
    line("neighbours", f"{report['neighbours']['mean']:.0f} a point")
    line("status", ", ".join(f"{word} {n:,}" for word, n in points["status"].items() if n))
    line("speed", f"{points['out'] / seconds['total']:,.0f} points/s end to end on "
                  f"{report['threads']} threads ({seconds['total']:.0f} s: sort "
                  f"{seconds['ingest']:.0f}, smooth {seconds['smooth']:.0f}, write "
                  f"{seconds['write']:.0f})")
    line("memory", f"peak {megabytes(memory['peak'])} of {megabytes(memory['limit'])} allowed")
    line("tiles", f"{report['tiles']}, halo {report['schedule']['halo_share']:.0%} of the points")
    line("result", f"{result} (report: {result}.json)")


if __name__ == "__main__":
    main(*sys.argv[1:])
