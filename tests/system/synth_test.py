"""pss synth: what every option does to the file that it writes."""

import json
import math
import struct

import harness
from harness import FAILED, USAGE, Las, SystemTest

POINTS = 20000


def rms(values):
    values = list(values)
    return math.sqrt(sum(v * v for v in values) / len(values))


def torus_distance(p, major=1.0, minor=0.4):
    return math.hypot(math.hypot(p[0], p[1]) - major, p[2]) - minor


class Synth(SystemTest):
    def made(self, *words, shape="torus", points=POINTS, name="scan.las"):
        """What is in the file, and the parameters that were printed."""
        path = self.path(name)
        run = self.ok("synth", shape, "-o", path, "--points", points, "--overwrite", *words)
        return Las(path), json.loads(run.out)

    def hash_with(self, *words):
        self.made(*words)
        return harness.sha256(self.path("scan.las"))


class Points(Synth):
    def test_lie_on_the_surface_without_noise(self):
        distances = {
            ("torus", "--size", "2,0.5"): lambda p: torus_distance(p, 2, 0.5),
            ("sphere", "--size", "3"): lambda p: math.dist(p, (0, 0, 0)) - 3,
            ("plane", "--size", "40,20,0.5,-0.25"):
                lambda p: (p[2] - 0.5 * p[0] + 0.25 * p[1]) / math.sqrt(1 + 0.25 + 0.0625),
        }
        for (shape, *words), distance in distances.items():
            with self.subTest(shape):
                las, said = self.made(*words, shape=shape)
                self.assertEqual(las.count, POINTS)
                self.assertEqual(said["shape"], shape)
                rounding = math.sqrt(3) / 2 * las.scale[0]
                self.assertLess(max(abs(distance(p)) for p in las.positions()), 1.01 * rounding)

    def test_have_the_spacing_of_area_and_number(self):
        areas = {"torus": 4 * math.pi**2 * 0.4, "sphere": 4 * math.pi, "plane": 10000}
        for shape, area in areas.items():
            _, said = self.made(shape=shape)
            self.assertAlmostEqual(said["spacing"] / math.sqrt(area / POINTS), 1, places=12)

    def test_have_the_noise_asked_for_along_the_normal(self):
        las, said = self.made("--noise", "0.3")
        found = rms(map(torus_distance, las.positions())) / said["spacing"]
        self.assertAlmostEqual(found, 0.3, delta=5 * 0.3 / math.sqrt(2 * POINTS))

    def test_of_several_scans_are_numbered_and_cover_three_quarters_each(self):
        las, _ = self.made("--scans", "4", shape="plane")
        sources = [struct.unpack_from("<H", las.record(i), 18)[0] for i in range(las.count)]
        self.assertEqual([sources.count(scan) for scan in (1, 2, 3, 4)], [POINTS // 4] * 4)
        first = [p[0] for p, source in zip(las.positions(), sources) if source == 1]
        self.assertAlmostEqual(max(first) - min(first), 75, delta=1)

    def test_are_as_much_denser_in_a_corner_as_asked(self):
        las, _ = self.made("--corner-density", "10", shape="plane")
        within = sum(p[0] < -25 and p[1] < -25 for p in las.positions())
        self.assertAlmostEqual(within / POINTS, 10 / 25, delta=0.01)

    def test_change_their_density_smoothly_when_asked(self):
        las, _ = self.made("--density-gradient", "9", shape="plane")
        positions = list(las.positions())
        dense = sum(abs(p[0]) > 45 and abs(p[1]) > 45 for p in positions)
        sparse = sum(abs(p[0]) < 5 and abs(p[1]) < 5 for p in positions)
        self.assertAlmostEqual(dense / sparse, 9, delta=2.5)

    def test_are_off_their_lattice_by_at_most_the_jitter(self):
        still, said = self.made("--jitter", "0", shape="plane")
        moved, _ = self.made("--jitter", "0.4", shape="plane")
        steps = list(map(math.dist, still.positions(), moved.positions()))
        limit = 0.4 * said["spacing"]
        self.assertLess(max(steps), limit + 2 * still.scale[0])
        self.assertGreater(max(steps), 0.9 * limit)

    def test_follow_one_another_in_a_sweep_and_are_scattered_otherwise(self):
        def mean_step(las):
            x = [p[0] for p in las.positions()]
            return sum(abs(a - b) for a, b in zip(x, x[1:])) / len(x)

        self.assertGreater(mean_step(self.made(shape="plane")[0]), 20)
        self.assertLess(mean_step(self.made("--order", "sweep", shape="plane")[0]), 0.5)

    def test_carry_the_truth_when_asked(self):
        las, _ = self.made("--noise", "0.2", "--truth", "--offset", "1000,2000,-30")
        self.assertEqual(las.record_size, 28 + 4 * 8)
        for number, place in zip(range(500), las.positions()):
            *true, distance = struct.unpack_from("<4d", las.record(number), 28)
            self.assertAlmostEqual(
                torus_distance([a - o for a, o in zip(true, (1000, 2000, -30))]), 0, places=9)
            self.assertAlmostEqual(math.dist(true, place), abs(distance), delta=las.scale[0])


class Files(Synth):
    def test_have_the_same_bytes_on_every_number_of_threads(self):
        words = ["--scans", "3", "--noise", "0.2", "--truth"]
        self.assertEqual(self.hash_with("--threads", 1, *words),
                         self.hash_with("--threads", 2, *words))

    def test_are_others_with_every_option(self):
        variants = ([], ["--seed", 2], ["--noise", "0.1"], ["--scans", 2], ["--jitter", "0.1"],
                    ["--corner-density", 2], ["--density-gradient", 2], ["--order", "sweep"],
                    ["--offset", "1,2,3"], ["--scale", "0.001"], ["--no-time"], ["--truth"],
                    ["--size", "1,0.3"])
        hashes = {self.hash_with(*words) for words in variants}
        self.assertEqual(len(hashes), len(variants))

    def test_have_records_of_20_bytes_without_time_and_lose_nothing_else(self):
        timed, _ = self.made("--noise", "0.1")
        bare, _ = self.made("--noise", "0.1", "--no-time")
        self.assertEqual((timed.record_size, timed.point_format), (28, 1))
        self.assertEqual((bare.record_size, bare.point_format), (20, 0))
        self.assertEqual(bare.records, b"".join(timed.record(i)[:20] for i in range(POINTS)))

    def test_have_the_scale_and_offset_asked_for(self):
        las, said = self.made("--scale", "0.0005", "--offset", "500000,4649776.5,100")
        self.assertEqual(las.scale, (0.0005,) * 3)
        self.assertEqual(las.offset, (500000, 4649776.5, 100))
        self.assertEqual((said["scale"], said["offset"]), (0.0005, [500000, 4649776.5, 100]))

    def test_have_the_format_of_their_name(self):
        self.ok("synth", "sphere", "-o", self.path("s.ply"), "--points", 500)
        self.ok("synth", "sphere", "-o", self.path("s.xyz"), "--points", 500)
        self.assertEqual(harness.Ply(self.path("s.ply")).count, 500)
        rows = [line.split() for line in self.path("s.xyz").read_text().splitlines()]
        places = [tuple(map(float, row[:3])) for row in rows if not row[0][:1].isalpha()
                  and row[0] != "//X"]
        self.assertEqual(len(places), 500)
        for place in places:
            self.assertAlmostEqual(math.dist(place, (0, 0, 0)), 1, delta=1e-4)

    def test_of_no_and_of_one_point_are_valid(self):
        for points in (0, 1):
            self.assertEqual(self.made(points=points)[0].count, points)

    def test_are_replaced_only_when_asked(self):
        path = self.synth("scan.las", points=100)
        before = harness.sha256(path)
        self.refused(FAILED, "synth", "torus", "-o", path, "--seed", 2, says=["--overwrite"])
        self.assertEqual(harness.sha256(path), before)


class Measure(Synth):
    def test_gives_the_noise_of_a_scan(self):
        words = ["torus", "--points", POINTS, "--noise", "0.3", "--scans", "2"]
        self.ok("synth", *words, "-o", self.path("scan.las"))
        said = json.loads(self.ok("synth", *words, "--measure", self.path("scan.las"),
                                  "--json").out)
        found = rms(map(torus_distance, Las(self.path("scan.las")).positions()))
        self.assertAlmostEqual(said["distance"]["rms"] / found, 1, places=6)
        self.assertAlmostEqual(said["distance_in_spacings"]["rms"], 0.3, delta=0.01)


class Refusals(Synth):
    def test_name_what_makes_no_sense(self):
        out = self.path("scan.las")
        for words, named in ((["cube"], "cube"), (["torus", "--size", "1,2"], "radii"),
                             (["sphere", "--size", "1,2"], "sizes"),
                             (["torus", "--noise", "-1"], "noise"),
                             (["torus", "--scans", "0"], "scans"),
                             (["torus", "--jitter", "11"], "jitter"),
                             (["torus", "--corner-density", "0.5"], "corner density"),
                             (["torus", "--density-gradient", "0"], "density gradient"),
                             (["torus", "--scale", "1e-14"], "scale"),
                             (["torus", "--points", "-5"], "points"),
                             (["torus", "--order", "sideways"], "order"),
                             (["torus", "--offset", "1,2"], "offset")):
            with self.subTest(words):
                self.refused(USAGE, "synth", *words, "-o", out, says=[named])
        self.assertFalse(out.exists())

    def test_need_one_thing_to_do(self):
        self.refused(USAGE, "synth", "torus", says=["--measure"])
        self.refused(USAGE, "synth", "torus", "-o", self.path("a.las"), "--measure",
                     self.path("b.las"), says=["--measure"])


if __name__ == "__main__":
    harness.main()
