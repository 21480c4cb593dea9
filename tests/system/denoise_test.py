"""pss denoise: the same outliers as by the definition, the same bytes whatever it ran with."""

import json
import math
import random
import signal
import statistics
import struct
import time

import harness
from harness import INTERRUPTED, Las, SystemTest, USAGE, read_json, write_las

SCALE = 0.001
STEP = 100  # spacing of the surface in steps: 0.1


def record(x, y, z, classification=0):
    return struct.pack("<3iHBBbBH", x, y, z, 7, 9, classification, 0, 0, 1)


def class_of(las, number):
    return las.record(number)[15] & 0x1F


class DenoiseTest(SystemTest):
    """A gentle wave with outliers of known places above and below it."""

    side = 45
    outliers = 100

    def setUp(self):
        super().setUp()
        rng = random.Random(3)
        self.surface = []
        for i in range(self.side):
            for k in range(self.side):
                x, y = (STEP * v + rng.randrange(-20, 21) for v in (i, k))
                self.surface.append((x, y, round(150 * math.sin(x / 1500)) + rng.randrange(-5, 6)))
        span = STEP * self.side
        self.far = []
        for n in range(self.outliers):
            x, y = rng.randrange(span), rng.randrange(span)
            side = 1 if n % 2 else -1
            self.far.append((x, y, side * (600 + 211 * n)))
        self.twins = self.surface[::50]  # a second return at the same place
        points = [record(*p) for p in self.surface + self.far + self.twins]
        rng.shuffle(points)
        self.scan = self.path("scan.las")
        write_las(self.scan, points)

    def denoise(self, name, *words):
        out = self.path(name)
        self.ok("denoise", self.scan, "-o", out, "--progress", "none", *words)
        return out

    @staticmethod
    def places(las):
        return [struct.unpack_from("<3i", las.record(i)) for i in range(las.count)]


class Rules(DenoiseTest):
    side, outliers = 25, 30

    def distances(self, points):
        """Of each point to all others, ascending."""
        for i, p in enumerate(points):
            yield p, sorted(math.dist(p, q) for j, q in enumerate(points) if j != i)

    def test_statistical_is_mean_plus_sigmas_of_the_mean_distances(self):
        points = self.surface + self.far + self.twins
        k, cap, sigmas = 5, 2.0, 1.5
        means, alone = [], []
        for p, near in self.distances(points):
            if near[k - 1] * SCALE > cap:
                alone.append(p)
            else:
                means.append((sum(near[:k]) / k, p))
        values = [value for value, _ in means]
        threshold = statistics.mean(values) + sigmas * statistics.stdev(values)
        expected = sorted(p for value, p in means if value <= threshold)

        report = self.path("r.json")
        out = self.denoise("out.las", "--knn", k, "--radius", cap, "--multiplier", sigmas,
                           "--report", report)

        self.assertEqual(sorted(self.places(Las(out))), expected)
        found = read_json(report)
        self.assertAlmostEqual(found["method"]["threshold"], threshold * SCALE, 6)
        self.assertEqual(found["points"]["outliers"]["without_value"], len(alone))
        self.assertEqual(found["points"]["out"], len(expected))
        self.assertEqual(found["points"]["in"],
                         found["points"]["out"] + found["points"]["dropped"]["outliers"])

    def test_radius_is_fewer_than_k_within_the_radius(self):
        points = self.surface + self.far + self.twins
        k, radius = 4, 0.25
        expected = sorted(p for p, near in self.distances(points) if near[k - 1] * SCALE < radius)

        out = self.denoise("out.las", "--method", "radius", "--knn", k, "--radius", radius)

        self.assertEqual(sorted(self.places(Las(out))), expected)


class Field(DenoiseTest):
    def test_each_method_finds_far_points_and_leaves_the_surface(self):
        for words in (("--method", "statistical", "--multiplier", 3), ("--method", "radius"),
                      ("--method", "residual", "--degree", 1)):
            with self.subTest(words):
                found = set(self.places(Las(self.denoise("out.las", *words, "--overwrite"))))
                self.assertEqual(found & set(self.far), set(), "recall")
                lost = len(set(self.surface) - found)
                self.assertLess(lost, 0.02 * len(self.surface), "precision")

    def test_classify_keeps_all_points_and_tells_above_from_below(self):
        classes = {(2000, 2100, 2500): 18, (700, 900, -1900): 7}
        write_las(self.scan, [record(*p) for p in self.surface + list(classes)])

        out = self.denoise("out.las", "--radius", 100, "--multiplier", 4, "--classify", "--high",
                           "--outputs", "measured")

        las = Las(out)
        self.assertEqual(las.count, Las(self.scan).count)
        for number, place in enumerate(self.places(las)):
            self.assertEqual(class_of(las, number), classes.get(place, 0), place)
            mean, = struct.unpack_from("<f", las.record(number), las.record_size - 4)
            self.assertEqual(mean > 1, place in classes, place)

    def test_noise_of_the_input_is_no_neighbour_and_stays(self):
        extra = [record(0, 0, 9000 + i, 7) for i in range(20)] + [record(5, 5, 9010)]
        write_las(self.scan, [record(*p) for p in self.surface] + extra)
        report = self.path("r.json")

        las = Las(self.denoise("out.las", "--method", "radius", "--report", report))

        places = self.places(las)
        self.assertEqual(sum(class_of(las, i) == 7 for i in range(las.count)), 20)
        self.assertNotIn((5, 5, 9010), places, "its only neighbours are noise")
        self.assertEqual(read_json(report)["points"]["excluded"], 20)

    def test_the_same_bytes_whatever_it_ran_with(self):
        for method in ("statistical", "radius", "residual"):
            words = ("--method", method, "--outputs", "measured", "--classify", "--overwrite")
            expected = harness.sha256(self.denoise("out.las", *words))
            store = self.path("scan.pss")
            self.ok("tile", self.scan, "-o", store, "--tile-points", 500, "--overwrite")
            for run in (("--tile-points", 100, "--threads", 1), ("--tile-points", 3000),
                        ("--memory-limit", "112M", "--tile-points", 700)):
                self.assertEqual(harness.sha256(self.denoise("out.las", *words, *run)), expected)
            self.ok("denoise", store, "-o", self.path("s.las"), *words)
            self.assertEqual(harness.sha256(self.path("s.las")), expected)

    def test_a_dry_run_makes_nothing_and_tells_what_it_would_take(self):
        store = self.path("scan.pss")
        self.ok("tile", self.scan, "-o", store)
        for scan, known in ((self.scan, "the headers"), (store, "the store")):
            before = sorted(self.folder.rglob("*"))
            said = self.ok("denoise", scan, "-o", self.path("o.las"), "--dry-run").out
            self.assertEqual(sorted(self.folder.rglob("*")), before)
            self.assertIn(known, said)
            self.assertRegex(said, f"points +{len(self.surface + self.far + self.twins):,}")


class Stores(DenoiseTest):
    def test_a_result_knows_the_inputs_of_its_source_and_their_head(self):
        expected = harness.sha256(self.denoise("out.las"))
        store, exported = self.path("out.pss"), self.path("exported.las")
        self.denoise("out.pss")

        facts = json.loads(self.ok("info", store, "--json").out)
        self.ok("verify", store)
        self.ok("export", store, "-o", exported)

        self.assertEqual(facts["inputs"], [str(self.scan)])
        self.assertEqual(facts["source_format"], "LAS")
        self.assertEqual(harness.sha256(exported), expected)


class Odd(SystemTest):
    def test_few_and_equal_points_give_a_valid_output(self):
        for name, points in (("none", []), ("one", [record(1, 2, 3)]),
                             ("equal", [record(1, 2, 3)] * 5000)):
            for method in ("statistical", "radius", "residual"):
                with self.subTest(f"{name} {method}"):
                    scan, out = self.path(name + ".las"), self.path("out.las")
                    write_las(scan, points)
                    self.ok("denoise", scan, "-o", out, "--method", method, "--overwrite",
                            "--progress", "none")
                    kept = name == "equal" and method != "residual"
                    self.assertEqual(Las(out).count, len(points) if kept else 0)

    def test_words_without_a_meaning_are_refused_by_name(self):
        scan = self.synth("scan.las", points=1000)
        for words, says in (
                (("--multiplier", 2, "--method", "radius"), "--multiplier"),
                (("--knn", 5, "--method", "residual"), "--knn"),
                (("--h", 1), "--h"), (("--high",), "--classify"), (("--knn", 0), "--knn"),
                (("--surface-gate", 0.1), "--surface-gate"),
                (("--outputs", "all"), "measured")):
            self.refused(USAGE, "denoise", scan, "-o", self.path("out.las"), *words, says=[says])
        self.assertFalse(self.path("out.las").exists())


class Resume(SystemTest):
    points = 200000

    def test_killed_and_interrupted_it_ends_with_the_same_bytes(self):
        scan = self.synth("scan.las", "--noise", "0.3", points=self.points)
        out, whole = self.path("out.las"), self.path("whole.las")
        words = ["denoise", scan, "--progress", "none", "--tile-points", 4000, "--outputs",
                 "measured", "-o"]
        seconds = self.ok(*words, whole).seconds
        expected = harness.sha256(whole)
        rng = random.Random(9)
        stopped = completed = 0
        while stopped < 12 or not completed:
            job = harness.start(*words, out)
            number = rng.choice([signal.SIGKILL, signal.SIGTERM])
            if stopped < 12:
                time.sleep(rng.uniform(0, seconds))
                harness.signal_to(job, number)
            run = harness.finish(job)
            if run.code in (-signal.SIGKILL, INTERRUPTED, -signal.SIGTERM):
                stopped += 1
                continue
            self.assertEqual(run.code, 0, run.err)
            self.assertEqual(harness.sha256(out), expected)
            completed += 1
            out.unlink()
        again = self.ok(*words, out)
        self.assertIn("already complete", self.ok(*words, out).err, again.err)


if __name__ == "__main__":
    harness.main()
