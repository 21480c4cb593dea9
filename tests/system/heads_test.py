"""Large heads (LAS header, VLRs and EVLRs; PLY text) stay below the memory limit, or are refused
before anything is made, with a limit that does.
"""

import os
import re
import struct
import time

import harness
from harness import SystemTest

MIB = 1 << 20
THREADS = 2
LEAST = 80 + 8 * THREADS  # MiB: the smallest limit that is printed
SIZES = [int(word) for word in os.environ.get("PSS_HEAD_MIB", "1 12 40 62").split()]
MANY = int(os.environ.get("PSS_HEAD_FILES", 20))
POINTS = 3000


def vlr(length, user=b"someone", number=7):
    return struct.pack("<H16sHH32s", 0, user, number, length, b"") + bytes([length % 251]) * length


def vlrs(mib):
    """Records that have together so many MiB, each as long as one can be but the last."""
    left = mib * MIB
    while left > 0:
        length = min(65535, max(left - 54, 1))
        left -= 54 + length
        yield vlr(length)


def evlr(mib, user=b"someone", number=9):
    """A record of so many MiB, in pieces."""
    yield struct.pack("<H16sHQ32s", 0, user, number, mib * MIB, b"")
    for piece in range(mib):
        yield bytes([65 + piece]) * MIB


def record(index, point_format):
    x, y = index % 60, index // 60
    attributes = bytes({0: 8, 6: 18}[point_format])
    return struct.pack("<3i", 100 * x, 100 * y, (7 * x * y) % 13) + attributes


def write_las(path, head=lambda: (), tail=lambda: (), points=POINTS, point_format=0, first=0):
    """A LAS file with these VLRs and this EVLR: piece by piece, so that this process stays small,
    whose peak the kernel counts for pss too."""
    size = 375 if point_format >= 6 else 227
    sizes = [len(piece) for piece in head()]
    start, tails = size + sum(sizes), 1 if any(tail()) else 0
    records = b"".join(record(first + i, point_format) for i in range(points))
    header = bytearray(size)
    header[0:4] = b"LASF"
    header[24:26] = bytes((1, 4 if point_format >= 6 else 2))
    struct.pack_into("<HII", header, 94, size, start, len(sizes))
    struct.pack_into("<BHI", header, 104, point_format, len(record(0, point_format)),
                     points if point_format < 6 else 0)
    struct.pack_into("<3d", header, 131, 0.01, 0.01, 0.01)
    last = (first + points - 1) // 60
    struct.pack_into("<6d", header, 179, 59.0, 0.0, float(last), 0.0, 0.13, 0.0)
    if point_format >= 6:
        struct.pack_into("<QIQ", header, 235, tails * (start + len(records)), tails, points)
    with open(path, "wb") as file:
        file.write(header)
        file.writelines(head())
        file.write(records)
        file.writelines(tail())


def holds(path, offset, pieces):
    """Whether these bytes lie at `offset` of a file."""
    with open(path, "rb") as file:
        file.seek(offset)
        return all(file.read(len(piece)) == piece for piece in pieces)


def end_of_points(path):
    with open(path, "rb") as file:
        header = file.read(375)
    (offset,), (size,), (count,) = (struct.unpack_from(code, header, at)
                                    for code, at in (("<I", 96), ("<H", 105), ("<Q", 247)))
    return offset + size * count


def named_limit(run):
    return int(re.search(r"use --memory-limit (\d+)M", run.err)[1])


class Heads(SystemTest):
    runs = 0

    def follow(self, command, source, *words, makes="las"):
        """Runs a command with the smallest limit, and where that is refused with the one that is
        named, which must do; what it made, and how."""
        limit = LEAST
        self.runs += 1
        out = self.path(f"out{self.runs}.{makes}")
        words = [command, *source, *(["-o", out] if makes else []), *words, "--threads", THREADS]
        run = harness.pss(*words, "--memory-limit", f"{limit}M")
        if run.code == harness.MEMORY_LIMIT:
            self.assertLess(run.peak_bytes, limit * MIB)
            self.assertEqual(list(self.folder.glob(out.name + "*")), [], "something is left")
            limit = named_limit(run)
            run = self.ok(*words, "--memory-limit", f"{limit}M")
        self.assertEqual(run.code, harness.DONE, run.err)
        self.report(command, run, limit)
        self.assertLess(run.peak_bytes, limit * MIB)
        return out

    def goes_everywhere(self, sources):
        """Every command that takes a limit; the files that smooth and export wrote."""
        smoothed = self.follow("smooth", sources, "--outputs", "status")
        store = self.follow("tile", sources, makes="pss")
        exported = self.follow("export", [store])
        self.follow("verify", [store], makes="")
        self.follow("smooth", [store], "--operator", "apss")
        return smoothed, exported

    def report(self, command, run, limit="no limit"):
        print(f"{self.id().split('.')[-1]}: {command}: peak {run.peak_bytes // MIB} of {limit}")

    def test_vlrs_of_las_1_2(self):
        for mib in SIZES:
            with self.subTest(mib=mib):
                scan = self.path(f"scan{mib}.las")
                write_las(scan, lambda mib=mib: vlrs(mib))
                smoothed, exported = self.goes_everywhere([scan])
                self.assertTrue(holds(exported, 227, vlrs(mib)))
                self.assertTrue(holds(smoothed, 227, vlrs(mib)))

    def test_evlrs_of_las_1_4(self):
        for mib in SIZES:
            with self.subTest(mib=mib):
                scan = self.path(f"scan{mib}.las")
                write_las(scan, tail=lambda mib=mib: evlr(mib), point_format=6)
                for written in self.goes_everywhere([scan]):
                    self.assertTrue(holds(written, end_of_points(written), evlr(mib)))

    def test_head_and_tail_with_a_coordinate_system_of_many_megabytes(self):
        scan = self.path("scan.las")
        write_las(scan, lambda: vlrs(30), lambda: evlr(30, b"LASF_Projection", 2112),
                  point_format=6)
        self.goes_everywhere([scan])

    def test_a_million_empty_vlrs(self):
        scan = self.path("scan.las")
        empty = vlr(0, b"a user of 16 by.")
        write_las(scan, lambda: (empty for _ in range(1000000)))
        self.goes_everywhere([scan])

    def test_the_text_of_a_ply_header(self):
        scan = self.path("scan.ply")
        lines = ["ply", "format ascii 1.0"] + ["comment"] * 125000
        lines += [f"element vertex {POINTS}"] + [f"property float {a}" for a in "xyz"]
        lines += ["end_header"] + [f"{i % 60} {i // 60} 0" for i in range(POINTS)]
        with open(scan, "w") as file:
            file.writelines(line + "\n" for line in lines)
        self.goes_everywhere([scan])

    def test_many_files_with_large_heads_cost_one(self):
        for number in range(MANY):
            write_las(self.path(f"scan{number:03}.las"), lambda: vlrs(10), first=number * POINTS)
        sources = [self.path("scan*.las")]
        self.goes_everywhere(sources)
        run = self.ok("convert", *sources, "-o", self.path("converted.las"))
        self.report("convert", run)
        self.assertLess(run.peak_bytes, LEAST * MIB)

    def test_a_later_file_with_a_larger_head_than_the_first(self):
        first, second = self.path("a.las"), self.path("b.las")
        write_las(first, lambda: vlrs(1))
        write_las(second, lambda: vlrs(50), first=POINTS)
        _, exported = self.goes_everywhere([first, second])
        self.assertTrue(holds(exported, 227, vlrs(1)))

    def test_info_and_convert_hold_a_head_a_few_times(self):
        scan = self.path("scan.las")
        write_las(scan, lambda: vlrs(60))
        run = self.ok("info", scan)
        self.report("info", run)
        self.assertLess(run.peak_bytes, (32 + 70) * MIB)
        run = self.ok("convert", scan, "-o", self.path("out.las"))
        self.report("convert", run)
        self.assertLess(run.peak_bytes, (32 + 2 * 62) * MIB)

    def test_info_of_a_store_holds_no_head(self):
        scan, store = self.path("scan.las"), self.path("scan.pss")
        write_las(scan, lambda: vlrs(60))
        self.ok("tile", scan, "-o", store)
        run = self.ok("info", store)
        self.report("info", run)
        self.assertLess(run.peak_bytes, 32 * MIB)

    def test_going_on_holds_no_more(self):
        """Stopped while it smooths, a job compares its head with what its stores say."""
        scan = self.path("scan.las")
        write_las(scan, lambda: vlrs(30), points=60000)
        words = ["smooth", scan, "-o", self.path("out.las"), "--threads", THREADS,
                 "--tile-points", 500, "--progress", "json"]
        limit = named_limit(self.refused(harness.MEMORY_LIMIT, *words, "--memory-limit",
                                         f"{LEAST}M"))
        process = harness.start(*words, "--memory-limit", f"{limit}M")
        result = self.path("out.las.work/smooth.pss/manifest.log")
        while not result.exists() and not harness.ended(process):
            time.sleep(0.005)
        time.sleep(0.1)
        harness.signal_to(process, 9)
        harness.finish(process)
        run = self.ok(*words, "--memory-limit", f"{limit}M")
        self.assertLess(run.peak_bytes, limit * MIB)


if __name__ == "__main__":
    harness.main()
