"""The memory limit means the whole process: under a control group of the same size a job ends, the
default comes from the group, and the smallest limit that is named works.
"""

import os
import pathlib
import re
import unittest

import harness
from harness import SystemTest

GROUPS = pathlib.Path("/sys/fs/cgroup/memory")
MIB = 1 << 20
POINTS = int(float(os.environ.get("PSS_LIMIT_POINTS", 3000000)))  # ten times what 128 MB hold


class Group:
    """A memory control group (version 1) with a limit, for as long as it is entered."""

    def __init__(self, limit):
        self.limit = limit
        self.path = GROUPS / f"pss-test-{os.getpid()}"

    def __enter__(self):
        self.path.mkdir()
        (self.path / "memory.limit_in_bytes").write_text(str(self.limit))
        swap = self.path / "memory.memsw.limit_in_bytes"
        if swap.exists():
            swap.write_text(str(self.limit))
        return self

    def __exit__(self, *_):
        self.path.rmdir()

    def join(self):
        """For a child process, before it becomes pss."""
        (self.path / "cgroup.procs").write_text(str(os.getpid()))


def groups_can_be_made():
    try:
        with Group(64 * MIB):
            return True
    except OSError:
        return False


needs_groups = unittest.skipUnless(groups_can_be_made(), f"no group can be made in {GROUPS}")


class Limits(SystemTest):
    def smoothed(self, scan, name, *words, **options):
        out = self.path(name)
        spacing = harness.torus_spacing(POINTS)
        self.ok("smooth", scan, "-o", out, "--h", spacing, *words, **options)
        return harness.sha256(out)

    @needs_groups
    def test_holds_under_a_control_group_of_its_size(self):
        scan = self.synth("scan.las", "--noise", "0.2", points=POINTS)
        with Group(128 * MIB) as group:
            limited = self.smoothed(scan, "limited.las", "--memory-limit", "128M",
                                    preexec_fn=group.join)
        self.assertEqual(limited, self.smoothed(scan, "free.las", "--memory-limit", "1G"))

    @needs_groups
    def test_defaults_to_seven_tenths_of_the_control_group(self):
        scan = self.synth("scan.las", points=1000)
        report = self.path("report.json")
        with Group(300 * MIB) as group:
            self.ok("smooth", scan, "-o", self.path("out.las"), "--report", report,
                    preexec_fn=group.join)
        limit = harness.read_json(report)["memory"]["limit"]
        self.assertAlmostEqual(limit / MIB, 210, delta=1)

    def test_names_the_smallest_that_works(self):
        scan = self.synth("scan.las", "--noise", "0.2", points=POINTS)
        run = self.refused(harness.MEMORY_LIMIT, "smooth", scan, "-o", self.path("out.las"),
                           "--memory-limit", "20M")
        least = re.search(r"at least .*\((\d+) MiB\)", run.err)[1]
        report = self.path("report.json")
        self.smoothed(scan, "least.las", "--memory-limit", f"{least}M", "--report", report)
        self.assertLess(harness.read_json(report)["memory"]["peak"], int(least) * MIB)


if __name__ == "__main__":
    harness.main()
