"""Withheld points and classes 7 and 18: they change nothing of what others get, and stay."""

import random
import struct

import harness
from harness import SystemTest

SIDE = 50  # points along the square of kept ones, a metre apart
SCALE = 0.001
CLASS_2 = {"Classification": 2, "Withheld": 0}
WAYS = ({"Classification": 7}, {"Classification": 18}, {"Withheld": 1})


def wave():
    """(x, y, z in millimetres, excluded): a noisy square, and as many excluded points within it."""
    rng = random.Random(3)
    points = []
    for x in range(SIDE):
        for y in range(SIDE):
            z = int(rng.gauss(0, 100))
            points.append((1000 * x + rng.randrange(-200, 200), 1000 * y + rng.randrange(-200, 200),
                           z, False))
            if x + 1 < SIDE and y + 1 < SIDE:
                points.append((1000 * x + 500, 1000 * y + 500, z // 2, True))
    for x, y, z in ((-300, -300, -5000), (1000 * SIDE, 1000 * SIDE, 5000)):  # the same bounds
        points.append((x, y, z, False))
    return points


def write_legacy(path, points, way):
    records = []
    for x, y, z, excluded in points:
        said = {**CLASS_2, **(way if excluded else {})}
        flags = said["Classification"] | said["Withheld"] << 7 | (x & 1) << 5 | (y & 1) << 6
        records.append(struct.pack("<3iHBBbBH", x, y, z, 0, 9, flags, 0, 0, 0))
    harness.write_las(path, records, SCALE)


def write_extended(path, points, way):
    """LAS 1.4, point format 6: the class is a byte of its own, withheld is the third of the flags."""
    header = bytearray(375)
    header[0:4], header[24:26], header[104] = b"LASF", bytes((1, 4)), 6
    struct.pack_into("<H", header, 6, 16)  # the coordinate system, which is none, is WKT
    struct.pack_into("<HII", header, 94, 375, 375, 0)
    struct.pack_into("<HI", header, 105, 30, 0)
    struct.pack_into("<3d3d", header, 131, *[SCALE] * 3, 0, 0, 0)
    for axis in range(3):
        values = [point[axis] * SCALE for point in points]
        struct.pack_into("<2d", header, 179 + 16 * axis, max(values), min(values))
    struct.pack_into("<QQ", header, 247, len(points), len(points))
    with open(path, "wb") as file:
        file.write(header)
        for x, y, z, excluded in points:
            said = {**CLASS_2, **(way if excluded else {})}
            flags = said["Withheld"] << 2 | (x & 1) | (y & 1) << 1 | (z & 3) << 4
            file.write(struct.pack("<3iHBBBBhHd", x, y, z, 0, 0x11, flags, said["Classification"],
                                   0, 0, 0, 0))


def rows(points, way):
    for x, y, z, excluded in points:
        said = {**CLASS_2, **(way if excluded else {})}
        yield f"{x / 1000} {y / 1000} {z / 1000} {said['Classification']} {said['Withheld']}\n"


def write_ply(path, points, way):
    head = ["ply", "format ascii 1.0", f"element vertex {len(points)}"]
    head += [f"property double {axis}" for axis in "xyz"]
    head += ["property float Classification", "property uchar Withheld", "end_header"]
    path.write_text("\n".join(head) + "\n" + "".join(rows(points, way)))


def write_text(path, points, way):
    path.write_text("x y z Classification Withheld\n" + "".join(rows(points, way)))


class Excluded(SystemTest):
    def smoothed(self, name, write, points, way):
        """The widths of a job, how many points it left out, and its output."""
        scan, out, report = self.path(name), self.path("out-" + name), self.path("report.json")
        write(scan, points, way)
        self.ok("smooth", scan, "-o", out, "--report", report, "--overwrite")
        said = harness.read_json(report)
        return said["widths"], said["points"]["status"].get("excluded", 0), out

    def expect_no_influence(self, name, write):
        points = wave()
        kept = [point for point in points if not point[3]]
        for way in WAYS:
            with self.subTest(name, **way):
                widths, excluded, _ = self.smoothed("with-" + name, write, points, way)
                expected, none, _ = self.smoothed("without-" + name, write, kept, way)
                self.assertEqual(widths, expected)
                self.assertAlmostEqual(widths["spacing"]["spacing"], 1, delta=0.05)
                self.assertAlmostEqual(widths["noise"]["sigma"], 0.1, delta=0.02)
                self.assertEqual((excluded, none), (len(points) - len(kept), 0))
                self.remove_files()

    def remove_files(self):
        for path in self.folder.glob("*.*"):
            if path.is_file():
                path.unlink()

    def test_las_with_five_bits_of_class(self):
        self.expect_no_influence("scan.las", write_legacy)

    def test_las_with_a_byte_of_class(self):
        self.expect_no_influence("scan.las", write_extended)

    def test_ply_with_these_attributes(self):
        self.expect_no_influence("scan.ply", write_ply)

    def test_text_with_these_columns(self):
        self.expect_no_influence("scan.txt", write_text)

    def test_las_outputs_hold_what_they_would_without(self):
        points = wave()
        kept = [point for point in points if not point[3]]
        for write, class_byte in ((write_legacy, 15), (write_extended, 16)):
            with self.subTest(write.__name__):
                _, _, found = self.smoothed("with.las", write, points, WAYS[1])
                _, _, expected = self.smoothed("without.las", write, kept, WAYS[1])
                found, expected = harness.Las(found), harness.Las(expected)
                records = [found.record(number) for number in range(found.count)]
                high = [r for r in records if r[class_byte] & 31 == 18]
                others = [r for r in records if r[class_byte] & 31 != 18]
                self.assertEqual(others, [expected.record(n) for n in range(expected.count)])
                self.assertEqual(sorted(struct.unpack_from("<3i", r) for r in high),
                                 sorted(point[:3] for point in points if point[3]))
                self.remove_files()


if __name__ == "__main__":
    harness.main()
