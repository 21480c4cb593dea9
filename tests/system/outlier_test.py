"""Stray points far away, and scales by hand: what would make points collapse or could not hold them
is refused before the work, by name, and the remedy that the message names does.
"""

import array
import collections
import math
import random
import re
import struct

import harness
from harness import BAD_INPUT, USAGE, SystemTest

FLT_MAX = struct.unpack("<f", b"\xff\xff\x7f\x7f")[0]
COUNT = 20000
# Points are as far apart as cells of the area that each has of the unit sphere.
SPACING = math.sqrt(4 * math.pi / COUNT)


def sphere(count=COUNT, seed=1, middle=(0, 0, 0)):
    """Random points on a unit sphere, as 32-bit floats."""
    rng = random.Random(seed)
    points = []
    while len(points) < count:
        p = [rng.gauss(0, 1) for _ in range(3)]
        length = math.hypot(*p)
        point = [m + v / length for m, v in zip(middle, p)]
        points.append(tuple(array.array("f", point)))
    return points


def with_far(points, far, at):
    """The points, and one far away as record `at`."""
    return points[:at] + [(0.0, far, 0.0)] + points[at:]


def write_ply(path, points, code="f"):
    name = {"f": "float", "d": "double"}[code]
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}",
            *(f"property {name} {axis}" for axis in "xyz"), "end_header", ""]
    values = array.array(code, [v for point in points for v in point])
    path.write_bytes("\n".join(head).encode() + values.tobytes())
    return path


def write_text(path, points):
    path.write_text("".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in points))
    return path


def las_of(path, points, scale=0.0001, offset=(0.0, 0.0, 0.0)):
    rows = [struct.pack("<3i8x", *(round((v - o) / scale) for v, o in zip(point, offset)))
            for point in points]
    harness.write_las(path, rows, scale=scale, offset=offset)
    return path


def remedy(run, *options):
    """The options of these names as the message has them."""
    return [re.search(rf"{option}=\S+", run.err)[0].rstrip(";,.") for option in options]


class Outlier(SystemTest):
    def setUp(self):
        super().setUp()
        self.points = sphere()

    def refused_far(self, *words, says=()):
        return self.refused(BAD_INPUT, *words, says=["--drop-outside=", *says])

    def assert_nothing_sorted(self, output):
        work = self.path(output + ".work")
        self.assertFalse(self.path(output).exists())
        self.assertFalse((work / "runs").exists() or (work / "input.pss").exists())

    def test_a_far_point_in_any_record_is_named_with_file_and_coordinate(self):
        for at in (0, COUNT // 2, COUNT):
            for far in (FLT_MAX, -1e30, 1e12, 1e9):
                scan = write_text(self.path("scan.xyz"), with_far(self.points, far, at))
                run = self.refused_far("smooth", scan, "-o", self.path("out.ply"),
                                       says=[f"{scan}: record {at}: y = "])
                found = float(re.search(r"y = (\S+)", run.err)[1])
                self.assertAlmostEqual(found / far, 1, places=6)
                self.assert_nothing_sorted("out.ply")

    def test_every_command_refuses_it_in_floats_and_doubles(self):
        for code in "fd":
            scan = write_ply(self.path("scan.ply"), with_far(self.points, 1e12, 7), code)
            for command, name in (("smooth", "out.ply"), ("smooth", "out.las"), ("tile", "s.pss"),
                                  ("convert", "out.las")):
                self.refused_far(command, scan, "-o", self.path(name),
                                 says=[f"{scan}: record 7: y = "])
                self.assert_nothing_sorted(name)

    def test_the_box_of_the_message_leaves_it_out_and_counts_it(self):
        clean = write_ply(self.path("clean.ply"), self.points)
        self.ok("smooth", clean, "-o", self.path("expected.ply"))
        expected = collections.Counter(harness.Ply(self.path("expected.ply")).rows)
        for far in (FLT_MAX, 1e30, 1e12, 1e9):
            scan = write_ply(self.path("scan.ply"), with_far(self.points, far, 9))
            output, report = self.path(f"{far}.ply"), self.path(f"{far}.json")
            refusal = self.refused_far("smooth", scan, "-o", output)
            run = self.ok("smooth", scan, "-o", output, "--report", report,
                          *remedy(refusal, "--drop-outside"))
            self.assertEqual(collections.Counter(harness.Ply(output).rows), expected)
            points = harness.read_json(report)["points"]
            self.assertEqual(points["in"], COUNT + 1)
            self.assertEqual(points["out"], COUNT)
            self.assertEqual(points["dropped"], {"not_finite": 0, "outside": 1})
            self.assertIn("dropped 1 points outside", run.err)

    def test_the_remedy_does_for_tile_and_for_las(self):
        scan = write_ply(self.path("scan.ply"), with_far(self.points, FLT_MAX, 9))
        for command, name in (("tile", "s.pss"), ("smooth", "out.las"), ("convert", "all.las")):
            refusal = self.refused_far(command, scan, "-o", self.path(name))
            run = self.ok(command, scan, "-o", self.path(name),
                          *remedy(refusal, "--drop-outside"))
            self.assertIn("dropped 1 points", run.err)
        for name in ("out.las", "all.las"):
            distinct = set(harness.Las(self.path(name)).positions())
            self.assertEqual(len(distinct), COUNT)

    def test_a_hundred_far_points_are_left_out_by_one_box(self):
        rng = random.Random(3)
        points = self.points + [tuple(rng.uniform(-1, 1) * FLT_MAX for _ in range(3))
                                for _ in range(100)]
        rng.shuffle(points)
        scan = write_ply(self.path("scan.ply"), points)
        refusal = self.refused_far("smooth", scan, "-o", self.path("out.ply"))
        report = self.path("report.json")
        self.ok("smooth", scan, "-o", self.path("out.ply"), "--report", report,
                *remedy(refusal, "--drop-outside"))
        self.assertEqual(harness.read_json(report)["points"]["dropped"]["outside"], 100)

    def test_the_one_of_several_files_that_has_it_is_named(self):
        files = [write_ply(self.path(f"{i}.ply"), self.points[i::3]) for i in range(3)]
        write_ply(files[1], with_far(self.points[1::3], 1e30, 100))
        self.refused_far("tile", *files, "-o", self.path("s.pss"),
                         says=[f"{files[1]}: record 100: y = 1"])

    def test_a_far_point_beside_a_las_scan_is_no_danger_to_it(self):
        las = las_of(self.path("scan.las"), self.points)
        ply = write_ply(self.path("far.ply"), [(0.0, 0.5, 0.0), (0.0, 1e30, 0.0)])
        refusal = self.refused_far("smooth", las, ply, "-o", self.path("out.las"),
                                   says=[f"{ply}: record 1: y = 1"])
        self.ok("smooth", las, ply, "-o", self.path("out.las"),
                *remedy(refusal, "--drop-outside"))
        out = harness.Las(self.path("out.las"))
        self.assertEqual(out.count, COUNT + 1)
        self.assertGreater(len(set(out.positions())), 0.99 * COUNT)

    def test_what_a_store_holds_and_las_does_not_is_refused_at_the_export(self):
        # 42 bits are enough for a side of 10^7 in steps of a ten-thousandth of the spacing, 32 are
        # not.
        scan = write_ply(self.path("scan.ply"), with_far(self.points, 1e7, 5))
        self.ok("tile", scan, "-o", self.path("s.pss"))
        refusal = self.refused_far("export", self.path("s.pss"), "-o", self.path("out.las"),
                                   says=["y = 10000000 ", "pss tile"])
        self.refused_far("smooth", self.path("s.pss"), "-o", self.path("out.las"))
        self.refused_far("smooth", scan, "-o", self.path("out2.las"), says=["record 5"])
        self.refused_far("convert", scan, "-o", self.path("out.las"), says=["record 5"])
        self.ok("export", self.path("s.pss"), "-o", self.path("out.ply"))
        self.ok("tile", scan, "-o", self.path("s2.pss"), *remedy(refusal, "--drop-outside"))
        self.ok("export", self.path("s2.pss"), "-o", self.path("out.las"))
        self.assertEqual(len(set(harness.Las(self.path("out.las")).positions())), COUNT)

    def test_a_store_takes_no_box(self):
        scan = write_ply(self.path("scan.ply"), self.points)
        self.ok("tile", scan, "-o", self.path("s.pss"))
        self.refused(USAGE, "smooth", self.path("s.pss"), "-o", self.path("out.ply"),
                     "--drop-outside", "0,0,0,1,1,1", says=["--drop-outside", "pss tile"])

    def test_a_scale_by_hand_is_taken_and_what_it_does_is_said(self):
        scan = write_ply(self.path("scan.ply"), self.points)
        for words in (("convert", scan, "-o", self.path("a.las")),
                      ("tile", scan, "-o", self.path("a.pss")),
                      ("smooth", scan, "-o", self.path("b.las"))):
            run = self.ok(*words, "--scale", "0.5")
            self.assertIn("more than a tenth of the points' spacing", run.err)
            measured = float(re.search(r"points' spacing of ([\d.e-]+\d)", run.err)[1])
            self.assertAlmostEqual(measured / SPACING, 1, delta=0.1)

    def test_the_summary_says_how_many_points_were_rounded_and_by_how_much(self):
        doubles = [tuple(v + 1 / 3 for v in point) for point in self.points]
        scan = write_ply(self.path("scan.ply"), doubles, "d")
        run = self.ok("smooth", scan, "-o", self.path("out.ply"))
        self.assertRegex(run.err, r"moved [\d,]+ points onto the common lattice, by .* at most; "
                                  r"their spacing is about 0\.02")
        a = las_of(self.path("a.las"), self.points[::2], offset=(0.0, 0.0, 0.0))
        b = las_of(self.path("b.las"), self.points[1::2], offset=(0.00003, 0.0, 0.0))
        run = self.ok("smooth", a, b, "-o", self.path("out.las"))
        self.assertIn(f"moved {COUNT // 2:,} points onto the common lattice", run.err)


class Grid(SystemTest):
    def setUp(self):
        super().setUp()
        self.points = [tuple(1000 * v for v in point) for point in sphere()]

    def refused_grid(self, *words):
        """Refused before anything was sorted or projected."""
        run = self.refused(BAD_INPUT, *words, "--progress", "plain", says=["do not fit into 32-bit integers"])
        for stage in ("merge ", "smooth ", "write ", "convert "):
            self.assertNotIn("\n" + stage, "\n" + run.err)
        return run

    def test_a_scale_that_holds_no_point_is_refused_before_the_work(self):
        las = las_of(self.path("scan.las"), self.points)
        ply = write_ply(self.path("scan.ply"), self.points)
        for scan in (las, ply):
            for command in ("smooth", "convert"):
                out = self.path(f"{scan.suffix[1:]}-{command}.las")
                run = self.refused_grid(command, scan, "-o", out, "--scale", "1e-8")
                self.assertFalse((self.path(out.name + ".work") / "input.pss").exists())
                self.ok(command, scan, "-o", out, *remedy(run, "--scale", "--offset"))

    def test_an_offset_that_is_too_far_is_refused_with_one_that_does(self):
        scan = las_of(self.path("scan.las"), self.points)
        for command in ("smooth", "convert"):
            out = self.path(command + ".las")
            run = self.refused_grid(command, scan, "-o", out, "--offset", "1e9,0,0")
            self.ok(command, scan, "-o", out, *remedy(run, "--offset"))
            self.assertEqual(harness.Las(out).scale, (0.0001,) * 3)

    def test_a_store_is_checked_before_the_first_pass(self):
        self.ok("tile", las_of(self.path("scan.las"), self.points), "-o", self.path("s.pss"))
        for command in ("smooth", "export"):
            out = self.path(command + ".las")
            run = self.refused_grid(command, self.path("s.pss"), "-o", out, "--offset", "1e9,0,0")
            self.ok(command, self.path("s.pss"), "-o", out, *remedy(run, "--offset"))

    def test_files_that_no_common_grid_of_32_bits_holds_are_refused_before_sorting(self):
        a = las_of(self.path("a.las"), self.points)
        far = [(x + 4e5, y, z) for x, y, z in self.points]
        b = las_of(self.path("b.las"), far, offset=(4e5, 0.0, 0.0))
        out = self.path("out.las")
        run = self.refused_grid("smooth", a, b, "-o", out)
        self.ok("smooth", a, b, "-o", out, *remedy(run, "--offset"))

    def test_a_header_that_promises_too_much_is_not_believed(self):
        scan = las_of(self.path("scan.las"), self.points)
        data = bytearray(scan.read_bytes())
        struct.pack_into("<d", data, 179, 1e9)  # the largest x
        scan.write_bytes(data)
        for command in ("smooth", "convert"):
            out = self.path(command + ".las")
            self.ok(command, scan, "-o", out, "--scale", "0.001")
        other = las_of(self.path("other.las"), self.points, offset=(0.5, 0.0, 0.0))
        self.ok("convert", other, scan, "-o", self.path("both.las"))
        self.assertEqual(harness.Las(self.path("both.las")).scale, (0.0001,) * 3)


if __name__ == "__main__":
    harness.main()
