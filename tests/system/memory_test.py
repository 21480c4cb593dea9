"""Peak resident memory stays below --memory-limit, by the kernel's count."""

import os

import harness
from harness import SystemTest

POINTS = int(os.environ.get("PSS_MEMORY_POINTS", 1500000))
LIMITS = os.environ.get("PSS_MEMORY_LIMITS", "128M").split()
MIB = 1 << 20


class Memory(SystemTest):
    def stays_below(self, *scan_words):
        scan = self.synth("scan.las", "--noise", "0.2", *scan_words, points=POINTS)
        for limit in LIMITS:
            out, report = self.path(f"{limit}.las"), self.path(f"{limit}.json")
            run = self.ok("smooth", scan, "-o", out, "--memory-limit", limit, "--radius",
                          self.radius(), "--report", report)
            self.assertLess(run.peak_bytes, int(limit[:-1]) * MIB)
            said = harness.read_json(report)["memory"]["peak"]
            self.assertLessEqual(said, run.peak_bytes)
            self.assertGreater(said, run.peak_bytes * 0.9)
            print(f"{POINTS} points, {scan_words}: peak {run.peak_bytes // MIB} MiB of {limit}, "
                  f"{run.seconds:.0f} s")
            out.unlink()

    def radius(self):
        """Three mean spacings of the default torus."""
        return 3 * (4 * 3.14159265**2 * 1.0 * 0.4 / POINTS) ** 0.5

    def test_of_points_in_random_order(self):
        self.stays_below()

    def test_of_a_corner_ten_times_denser(self):
        self.stays_below("--corner-density", "10")

    def test_of_equal_points(self):
        records = harness.random_records(1, 1) * POINTS
        scan = self.path("equal.las")
        harness.write_las(scan, records)
        del records
        run = harness.pss("smooth", scan, "-o", self.path("out.las"), "--memory-limit", "128M",
                          "--radius", "1")
        self.assertLess(run.peak_bytes, 128 * MIB)
        self.assertIn(run.code, (harness.DONE, harness.MEMORY_LIMIT), run.err)


if __name__ == "__main__":
    harness.main()
