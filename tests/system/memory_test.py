"""Peak resident memory stays below --memory-limit, by the kernel's count."""

import os

import harness
from harness import SystemTest

# A long form by hand:
# PSS_MEMORY_POINTS=12000000 PSS_MEMORY_LIMITS="128M 256M 512M" python3 tests/system/memory_test.py
POINTS = int(os.environ.get("PSS_MEMORY_POINTS", 1500000))
LIMITS = os.environ.get("PSS_MEMORY_LIMITS", "128M").split()
MIB = 1 << 20


class Memory(SystemTest):
    def stays_below(self, *scan_words):
        scan = self.synth("scan.las", "--noise", "0.2", *scan_words, points=POINTS)
        for limit in LIMITS:
            out, report = self.path(f"{limit}.las"), self.path(f"{limit}.json")
            run = self.ok("smooth", scan, "-o", out, "--memory-limit", limit, "--radius",
                          3 * harness.torus_spacing(POINTS), "--report", report)
            self.assertLess(run.peak_bytes, int(limit[:-1]) * MIB)
            said = harness.read_json(report)["memory"]["peak"]
            self.assertLessEqual(said, run.peak_bytes)
            self.assertGreater(said, run.peak_bytes * 0.9)
            print(f"{POINTS} points, {scan_words}: peak {run.peak_bytes // MIB} MiB of {limit}, "
                  f"{run.seconds:.0f} s")
            out.unlink()

    def test_of_points_in_random_order(self):
        self.stays_below()

    def test_of_a_corner_ten_times_denser(self):
        self.stays_below("--corner-density", "10")

    def test_of_equal_points(self):
        scan, out = self.path("equal.las"), self.path("out.las")
        harness.write_las(scan, harness.random_records(1, 1) * POINTS)
        run = self.ok("smooth", scan, "-o", out, "--memory-limit", "128M")
        self.assertLess(run.peak_bytes, 128 * MIB)


if __name__ == "__main__":
    harness.main()
