"""However the points lie, a job ends below its memory limit in time that its work explains, or is
refused at once with numbers.

PSS_ODD_SCAN is the program that writes the scans (tests/system/odd_scan.cpp). The long form is
scripts/bench-skew.
"""

import os
import re
import subprocess
import sys

import harness
from harness import SystemTest

ODD_SCAN = os.environ.get("PSS_ODD_SCAN", str(harness.ROOT / "build/release/odd_scan"))
POINTS = int(float(os.environ.get("PSS_SKEW_POINTS", 400000)))
LIMITS = os.environ.get("PSS_SKEW_LIMITS", "128M").split()
UNITS = {"M": 1 << 20, "G": 1 << 30}
NAMED_LIMIT = re.compile(r"--memory-limit (\d+M)")


def in_bytes(limit):
    return int(limit[:-1]) * UNITS[limit[-1]]


def table(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |")
    sys.stdout.flush()


class Skew(SystemTest):
    def scan(self, shape, points=POINTS):
        path = self.path(f"{shape}.ply")
        subprocess.run([ODD_SCAN, shape, str(points), str(path)], check=True)
        return path

    def run_at(self, limit, scan, *words):
        return harness.pss("smooth", scan, "-o", self.path("out.ply"), "--memory-limit", limit,
                           "--report", self.path("report.json"), "--overwrite", "--restart", *words)

    def limit_that_does(self, refusal, scan, *words):
        """What a refusal names: it must do."""
        limit = NAMED_LIMIT.search(refusal)[1]
        run = self.run_at(limit, scan, *words)
        self.assertEqual(run.code, harness.DONE, f"{refusal}\n{run.err}")
        self.assertLess(run.peak_bytes, in_bytes(limit))
        return harness.sha256(self.path("out.ply"))

    def stays_below(self, shape, *words, may_refuse=False, points=POINTS):
        """Runs the job at every limit; the outcome must be one of the two that are promised."""
        scan = self.scan(shape, points)
        out, report = self.path("out.ply"), self.path("report.json")
        hashes = set()
        for limit in LIMITS:
            run = self.run_at(limit, scan, *words)
            with self.subTest(shape=shape, words=words, limit=limit):
                self.tell(shape, words, limit, run, report)
                self.assertLess(run.peak_bytes, in_bytes(limit))
                if run.code == harness.DONE:
                    hashes.add(harness.sha256(out))
                else:
                    self.assertTrue(may_refuse, run.err)
                    self.assertEqual(run.code, harness.MEMORY_LIMIT, run.err)
                    hashes.add(self.limit_that_does(run.err, scan, *words))
        self.assertLessEqual(len(hashes), 1)
        scan.unlink()

    def tell(self, shape, words, limit, run, report):
        """A line of a table: what happened, in which time, with which peak."""
        what, speed = "done", ""
        if run.code == harness.DONE:
            said = harness.read_json(report)
            points, seconds = said["points"]["out"], said["seconds"]
            computed = said["schedule"]["compute_seconds"]
            each = said["neighbours"]["mean"]
            speed = (f"ingest {seconds['ingest']:.1f} smooth {seconds['smooth']:.1f} s, "
                     f"{each:.1f} neighbours, {points * each / max(computed, 1e-9) / 1e6:.0f} M/s, "
                     f"{said['schedule']['parts']} parts, {said['schedule']['reloaded_parts']} "
                     f"again, halo {said['schedule']['halo_share']:.2f}")
        else:
            what = f"exit {run.code}: {run.err.strip().splitlines()[-1]}"
        # The kernel's count includes what this interpreter held when it started pss.
        peak = said["memory"]["peak"] if run.code == harness.DONE else run.peak_bytes
        table(shape, POINTS, " ".join(map(str, words)), limit, what, f"{run.seconds:.1f} s",
              f"{peak >> 20} MiB", speed)

    def test_even(self):
        self.stays_below("sheet")
        self.stays_below("sheet", "--knn", "20")

    def test_of_a_scanner_on_a_tripod(self):
        self.stays_below("terrestrial")
        self.stays_below("terrestrial", "--knn", "20")

    def test_of_everything_in_one_corner(self):
        self.stays_below("corner")
        self.stays_below("corner", "--knn", "20")

    def test_of_far_outliers(self):
        self.stays_below("outliers")
        self.stays_below("outliers", "--knn", "20")
        self.stays_below("outliers", "--h", 2 / POINTS**0.5)

    def test_of_one_place(self):
        self.stays_below("equal")
        self.stays_below("equal", "--knn", "20")
        self.stays_below("equal", "--radius", "0.1", may_refuse=True)

    def test_of_few_places(self):
        self.stays_below("copies", may_refuse=True)
        self.stays_below("copies", "--knn", "20", may_refuse=True)
        self.stays_below("copies", "--radius", "0.1", may_refuse=True)

    def test_of_a_pile_in_a_sheet(self):
        self.stays_below("pile", may_refuse=True)
        self.stays_below("pile", "--knn", "20", may_refuse=True)

    def test_of_a_plane(self):
        self.stays_below("plane")
        self.stays_below("plane", "--knn", "20")

    def test_of_a_line(self):
        self.stays_below("line")
        self.stays_below("line", "--knn", "20")
        self.stays_below("line", "--h", 2 / POINTS)

    def test_of_a_volume(self):
        self.stays_below("volume")
        self.stays_below("volume", "--knn", "20")

    def test_of_a_radius_that_holds_everything(self):
        run = self.run_at("128M", self.scan("sheet"), "--radius", "2")
        self.assertEqual(run.code, harness.MEMORY_LIMIT, run.err)
        self.assertRegex(run.err, NAMED_LIMIT)
        self.assertLess(run.peak_bytes, in_bytes("128M"))


if __name__ == "__main__":
    harness.main()
