"""A limit that a refusal names does: the chain of refusals is followed until the job runs.

One step is enough where headers tell what the work takes. How dense the points are is known only
once they are sorted, so a dense scan may be refused a second time, then.
"""

import re
import struct

import harness
import heads_test
from harness import SystemTest

MIB = 1 << 20
THREADS = 2
LEAST = 80 + 8 * THREADS


def write_wide(path, count, extra):
    """LAS 1.2 of format 0 whose records have so many bytes that no VLR describes."""
    records = harness.random_records(count, 3, span=3000)
    harness.write_las(path, records)
    with open(path, "r+b") as file:  # piece by piece: the kernel counts this process' peak too
        file.seek(105)
        file.write(struct.pack("<H", 20 + extra))
        file.seek(227)
        for record in records:
            file.write(record + bytes(extra))


class NamedLimits(SystemTest):
    def follow(self, *words, most_steps=1):
        """Runs a command with the smallest limit, then with those that refusals name."""
        limit, named = LEAST, []
        for _ in range(most_steps + 1):
            run = harness.pss(*words, "--threads", THREADS, "--memory-limit", f"{limit}M")
            self.assertLess(run.peak_bytes, limit * MIB, run.err)
            if run.code == harness.DONE:
                break
            self.assertEqual(run.code, harness.MEMORY_LIMIT, run.err)
            limit = int(re.search(r"use --memory-limit (\d+)M", run.err)[1])
            named.append(limit)
        print(f"{words[0]}: {named}, peak {run.peak_bytes // MIB}")
        self.assertEqual(run.code, harness.DONE, f"{named}\n{run.err}")
        return named

    def test_of_wide_rows(self):
        for extra in (2000, 40000):
            scan = self.path(f"wide{extra}.las")
            write_wide(scan, 5000, extra)
            self.follow("smooth", scan, "-o", self.path(f"smooth{extra}.las"))
            store = self.path(f"{extra}.pss")
            self.follow("tile", scan, "-o", store)
            self.follow("export", store, "-o", self.path(f"export{extra}.las"))
            self.follow("verify", store)

    def test_of_rows_that_only_a_later_input_makes_wide(self):
        harness.write_las(self.path("a.las"), harness.random_records(100, 1))
        write_wide(self.path("b.las"), 5000, 20000)
        self.follow("smooth", self.path("?.las"), "-o", self.path("out.las"))

    def test_of_many_inputs(self):
        scan, names = self.path("0.las"), self.path("names.txt")
        harness.write_las(scan, harness.random_records(1, 1))
        one = scan.read_bytes()
        for number in range(1, 40000):
            self.path(f"{number}.las").write_bytes(one)
        names.write_text("".join(f"{self.folder}/{number}.las\n" for number in range(40000)))
        named = self.follow("tile", f"@{names}", "-o", self.path("out.pss"))
        self.assertEqual(len(named), 1)

    def test_of_a_dense_scan_with_a_wide_radius(self):
        scan = self.synth("scan.las", points=40000)
        named = self.follow("smooth", scan, "-o", self.path("out.las"), "--radius", "5",
                            "--operator", "fast", "--polynomial-order", 0, most_steps=2)
        self.assertGreater(len(named), 0)

    def test_of_a_dense_scan_with_a_large_head(self):
        scan = self.path("scan.las")
        heads_test.write_las(scan, lambda: heads_test.vlrs(20), points=30000)
        named = self.follow("smooth", scan, "-o", self.path("out.las"), "--radius", "1000",
                            "--operator", "fast", "--polynomial-order", 0, most_steps=2)
        self.assertGreater(len(named), 0)

    def test_of_wide_rows_with_a_wide_radius(self):
        scan = self.path("wide.las")
        write_wide(scan, 9000, 12000)
        self.follow("smooth", scan, "-o", self.path("out.las"), "--radius", "2", "--operator",
                    "fast", most_steps=2)


if __name__ == "__main__":
    harness.main()
