"""One file, bit for bit, whatever it was made with; and the one that the library makes in memory."""

import itertools
import os
import random
import re
import signal
import struct
import subprocess
import time

import harness
from harness import DATA, Las, SystemTest, needs_data

IN_MEMORY = os.environ.get("PSS_IN_MEMORY", str(harness.ROOT / "build/release/in_memory"))
# The long form takes every combination, and real scans whole:
# PSS_EXACT_FULL=1 python3 tests/system/exact_test.py
FULL = "PSS_EXACT_FULL" in os.environ

OPERATORS = ("levin", "fast", "apss", "rimls")
WEIGHTS = ("gaussian", "wendland", "pcl")


def simd_targets():
    """Those of this machine, the widest first."""
    said = harness.pss("smooth", "--help").out
    return tuple(re.search(r"--simd (\S+)", said).group(1).split("|"))


def axes():
    """What a result must not depend on."""
    return {"tile_points": (262144, 300, 4000), "threads": (1, 2), "limit": ("112M", "256M", "2G"),
            "simd": simd_targets(), "killed": (False, True),
            "order": ("given", "shuffled", "reversed", "store")}


def combinations(choices, every):
    """All combinations, or so many that any two values of two axes meet in one of them."""
    whole = [dict(zip(choices, values)) for values in itertools.product(*choices.values())]
    if every:
        return whole
    random.Random(5).shuffle(whole)
    pairs = [set(itertools.combinations(combination.items(), 2)) for combination in whole]
    missing = set().union(*pairs)
    taken = []
    while missing:
        best = max(range(len(whole)), key=lambda i: len(pairs[i] & missing))
        missing -= pairs[best]
        taken.append(whole[best])
    return taken


class ExactTest(SystemTest):
    """Runs one scan with one method in many ways."""

    def setUp(self):
        super().setUp()
        self.rng = random.Random(7)
        self.kills = 0

    def vegetation(self):
        """Trees and ground: the whole scan, or a stripe of it."""
        las = Las(DATA / "scans" / "autzen_trim.las")
        records = [las.record(number) for number in range(las.count)]
        if not FULL:
            records = [r for r in records if int.from_bytes(r[:4], "little") < 63630000]
        path = self.path("vegetation.las")
        harness.write_las(path, records, las.scale[0], las.offset, las.point_format)
        return path

    def in_memory(self, scan, *words):
        """The hash of the file that the library alone makes."""
        out = self.path("in_memory.las")
        out.unlink(missing_ok=True)
        subprocess.run([IN_MEMORY, scan, out, *map(str, words)], check=True)
        return harness.sha256(out)

    def in_order(self, scan, order, tile_points):
        """The same points in another order, or as a store."""
        path = self.path(f"{order}-{tile_points}.pss" if order == "store" else f"{order}.las")
        if order == "given" or path.exists():
            return scan if order == "given" else path
        if order == "store":
            self.ok("tile", scan, "-o", path, "--tile-points", tile_points)
            return path
        las = Las(scan)
        records = [las.record(number) for number in range(las.count)]
        records.reverse() if order == "reversed" else random.Random(3).shuffle(records)
        path.write_bytes(las.header + las.vlrs + b"".join(records) + las.tail)
        return path

    def kill_once(self, words):
        """Starts the job and kills it at some moment, unless it was quicker."""
        job = harness.start(*words, "--threads", self.rng.choice((1, 2)))
        time.sleep(self.rng.uniform(0.01, 0.4))
        harness.signal_to(job, signal.SIGKILL)
        self.kills += harness.finish(job).code == -signal.SIGKILL

    def hash_of(self, scan, method, how):
        """Of the file that a run writes."""
        out = self.path("out.las")
        words = ["smooth", self.in_order(scan, how["order"], how["tile_points"]), "-o", out,
                 "--outputs", "all", "--tile-points", how["tile_points"], *method]
        if how["killed"]:
            self.kill_once(words)
        self.ok(*words, "--threads", how["threads"], "--memory-limit", how["limit"], "--simd",
                how["simd"], "--overwrite")
        found = harness.sha256(out)
        out.unlink()
        return found

    def expect_everywhere(self, expected, scan, method, ways):
        for how in ways:
            self.assertEqual(self.hash_of(scan, method, how), expected, how)
        print(f"{scan.name}, {' '.join(map(str, method))}: {len(ways)} ways, one hash")


class Matrix(ExactTest):
    def expect_matrix(self, scan, h):
        expected = self.in_memory(scan, "levin", "h", h)
        self.expect_everywhere(expected, scan, ["--h", h], combinations(axes(), FULL))
        self.assertGreater(self.kills, 0)

    def test_a_synthesised_scan(self):
        points = 60000 if FULL else 15000
        scan = self.synth("scan.las", "--scans", "3", "--noise", "0.2", points=points)
        self.expect_matrix(scan, 2 * harness.torus_spacing(points))

    @needs_data
    def test_vegetation(self):
        self.expect_matrix(self.vegetation(), 5)


class Methods(ExactTest):
    """Every operator, weight and way to choose radii, in some ways each."""

    def setUp(self):
        super().setUp()
        self.ways = combinations(axes(), False)

    def some_ways(self):
        return self.rng.sample(self.ways, 12 if FULL else 2)

    def test_every_operator_equals_memory(self):
        scan = self.synth("scan.las", "--scans", "2", "--noise", "0.2", points=6000)
        h = 2 * harness.torus_spacing(6000)
        for operator in OPERATORS:
            with self.subTest(operator):
                self.expect_everywhere(self.in_memory(scan, operator, "h", h), scan,
                                       ["--operator", operator, "--h", h], self.some_ways())
                self.expect_everywhere(self.in_memory(scan, operator, "knn", 40, 10 * h), scan,
                                       ["--operator", operator, "--knn", 40, "--radius", 10 * h],
                                       self.some_ways())

    @needs_data
    def test_every_operator_equals_memory_on_vegetation(self):
        scan = self.vegetation()
        for operator in OPERATORS[1:]:
            with self.subTest(operator):
                self.expect_everywhere(self.in_memory(scan, operator, "h", 4), scan,
                                       ["--operator", operator, "--h", 4], self.some_ways())

    def expect_one_hash(self, scan, *method):
        hashes = {self.hash_of(scan, method, how) for how in self.some_ways()}
        self.assertEqual(len(hashes), 1, method)

    def test_every_weight_and_precision(self):
        scan = self.synth("scan.las", "--scans", "2", "--noise", "0.2", points=6000)
        radius = 6 * harness.torus_spacing(6000)
        for operator in OPERATORS:
            method = ["--operator", operator, "--radius", radius]
            for weight in WEIGHTS:
                with self.subTest(operator=operator, weight=weight):
                    self.expect_one_hash(scan, *method, "--weight", weight)
            with self.subTest(operator):
                self.expect_one_hash(scan, *method, "--precision", "double")

    def test_a_width_that_is_measured(self):
        scan = self.synth("scan.las", "--scans", "2", "--noise", "0.2", points=6000)
        self.expect_one_hash(scan)

    def with_twins(self, scan):
        """The scan with a second return for every other point, a fiftieth of the spacing below."""
        las = Las(scan)
        below = int(0.02 * harness.torus_spacing(las.count) / las.scale[2])
        records = [las.record(number) for number in range(las.count)]
        for record in records[::2]:
            x, y, z = struct.unpack_from("<3i", record)
            records.append(struct.pack("<3i", x, y, z - below) + record[12:])
        path = self.path("twins.las")
        harness.write_las(path, records, las.scale[0], las.offset, las.point_format)
        return path

    def test_a_spacing_that_is_measured_among_twins(self):
        scan = self.with_twins(self.synth("scan.las", "--noise", "0.2", points=5000))
        self.expect_one_hash(scan)
        self.expect_everywhere(self.in_memory(scan, "levin", "knn", 40, 0), scan, ["--knn", 40],
                               self.some_ways())

    def test_a_spacing_that_is_measured_among_excluded_points(self):
        las = Las(self.synth("scan.las", "--noise", "0.2", points=6000))
        records = [bytearray(las.record(number)) for number in range(las.count)]
        for record in records[::2]:
            record[15] = 7
        scan = self.path("classes.las")
        harness.write_las(scan, records, las.scale[0], las.offset, las.point_format)
        self.expect_one_hash(scan)

    def test_a_result_in_a_store(self):
        points = 20000
        scan = self.synth("scan.las", "--scans", "2", "--noise", "0.2", points=points)
        result, out = self.path("result.pss"), self.path("out.las")
        h = 2 * harness.torus_spacing(points)
        self.ok("smooth", scan, "-o", result, "--outputs", "all", "--h", h, "--tile-points", 700)
        self.ok("verify", result)
        self.ok("export", result, "-o", out)
        self.assertEqual(harness.sha256(out), self.in_memory(scan, "levin", "h", h))


class GivenNormals(SystemTest):
    @needs_data
    def test_are_used_alike(self):
        scan, out = DATA / "scans" / "pond_binary_normals_rgb.ply", self.path("out.ply")
        for operator in ("apss", "rimls"):
            hashes = set()
            for how in (["--threads", 1, "--tile-points", 1000],
                        ["--threads", 2, "--memory-limit", "128M", "--simd", simd_targets()[-1]]):
                self.ok("smooth", scan, "-o", out, "--outputs", "all", "--overwrite", "--restart",
                        "--replace-attributes", "--operator", operator, "--knn", 40, *how)
                hashes.add(harness.sha256(out))
            self.assertEqual(len(hashes), 1, operator)


if __name__ == "__main__":
    harness.main()
