"""pss smooth: what it keeps and what it says."""

import collections
import itertools
import json
import shutil
import struct

import harness
from harness import BAD_INPUT, DATA, FAILED, MEMORY_LIMIT, USAGE, Las, SystemTest, needs_data

MIB = 1 << 20


@needs_data
class RealScans(SystemTest):
    def keeps_all_but_coordinates(self, name):
        out, report = self.path("out.las"), self.path("report.json")
        run = self.ok("smooth", DATA / "scans" / name, "-o", out, "--memory-limit", "128M",
                      "--report", report)
        self.assertLess(run.peak_bytes, 128 * MIB)
        before, after = Las(DATA / "scans" / name), Las(out)
        self.assertEqual(after.count, before.count)
        self.assertEqual(after.after_xyz(), before.after_xyz())
        self.assertEqual(after.vlrs, before.vlrs)
        self.assertEqual((after.scale, after.offset), (before.scale, before.offset))
        self.assertEqual((after.version, after.point_format), (before.version, before.point_format))
        self.assertEqual(harness.read_json(report)["points"]["out"], before.count)
        self.assertNotEqual(sorted(after.positions()), sorted(before.positions()))

    def test_las_point_format_0(self):
        self.keeps_all_but_coordinates("haystack_rock_pf0.las")

    def test_las_point_format_3(self):
        self.keeps_all_but_coordinates("autzen_trim.las")

    def test_las_point_format_7(self):
        self.keeps_all_but_coordinates("autzen_trim_pf7.las")

    def test_scans_of_different_coordinate_systems_are_refused(self):
        scans = [DATA / "scans" / name for name in ("autzen_trim.las", "lone_star_pf6.las")]
        for command in ("smooth", "convert"):
            self.refused(BAD_INPUT, command, *scans, "-o", self.path("out.las"),
                         says=["lone_star_pf6.las"])
            self.assertFalse(self.path("out.las").exists())

    def test_ply_keeps_every_property(self):
        for name in ("bunny_ascii.ply", "pond_binary_normals_rgb.ply"):
            with self.subTest(name):
                out = self.path(name)
                self.ok("smooth", DATA / "scans" / name, "-o", out)
                before = harness.Ply(DATA / "scans" / name)
                after = harness.Ply(out)
                self.assertEqual(after.names, before.names)
                self.assertEqual(after.others(), before.others())


class Normals(SystemTest):
    def report_of(self, scan, out, *words):
        report = self.path("report.json")
        self.ok("smooth", scan, "-o", out, "--operator", "apss", "--report", report, *words)
        return harness.read_json(report)

    @needs_data
    def test_of_the_input_are_used_and_kept(self):
        scan, out = DATA / "scans" / "pond_binary_normals_rgb.ply", self.path("out.ply")
        said = self.report_of(scan, out)
        self.assertEqual(said["method"]["normals"], "given")
        self.assertEqual(said["seconds"]["normals"], 0)
        self.assertEqual(harness.Ply(out).others(), harness.Ply(scan).others())

    def test_are_computed_where_there_are_none_and_leave_no_trace(self):
        scan, out = self.synth("scan.ply", "--noise", "0.2"), self.path("out.ply")
        said = self.report_of(scan, out)
        self.assertEqual(said["method"]["normals"], "computed")
        self.assertGreater(said["seconds"]["normals"], 0)
        self.assertEqual(harness.Ply(out).names, harness.Ply(scan).names)

    def test_are_in_the_result_where_they_are_asked_for(self):
        scan, out = self.synth("scan.ply", "--noise", "0.2"), self.path("out.ply")
        self.report_of(scan, out, "--outputs", "normals")
        self.assertEqual(harness.Ply(out).names, harness.Ply(scan).names + ["nx", "ny", "nz"])

    def test_count_in_the_estimate_of_disk(self):
        scan, store = self.synth("scan.las", "--noise", "0.2"), self.path("scan.pss")
        self.ok("tile", scan, "-o", store)
        for source, operator in itertools.product((scan, store), ("levin", "apss")):
            with self.subTest(source=source.name, operator=operator):
                job = ["smooth", source, "-o", self.path("out.las"), "--operator", operator,
                       "--keep-work"]
                dry = self.ok(*job, "--dry-run", "--report", "-")
                estimate = json.loads(dry.out)["disk_bytes"]
                self.ok(*job)
                written = [self.path("out.las"), *self.path("out.las.work").rglob("*")]
                taken = sum(path.stat().st_size for path in written if path.is_file())
                self.path("out.las").unlink()
                shutil.rmtree(self.path("out.las.work"))
                self.assertLess(taken, 1.05 * estimate)
                self.assertLess(estimate, 1.3 * taken)


class Words(SystemTest):
    def setUp(self):
        super().setUp()
        self.scan = self.synth("scan.las", "--noise", "0.2")
        self.out = self.path("out.las")

    def test_project_is_another_name_for_smooth(self):
        self.ok("smooth", self.scan, "-o", self.out)
        self.ok("project", self.scan, "-o", self.path("other.las"))
        self.assertEqual(harness.sha256(self.out), harness.sha256(self.path("other.las")))

    def test_several_scans_are_smoothed_as_one(self):
        las = Las(self.scan)
        half = las.count // 2
        parts = [self.path("a.las"), self.path("b.las")]
        for part, numbers in zip(parts, (range(half), range(half, las.count))):
            harness.write_las(part, [las.record(i) for i in numbers], las.scale[0], las.offset, 1)
        self.ok("smooth", self.scan, "-o", self.out)
        self.ok("smooth", *parts, "-o", self.path("parts.las"))
        self.assertEqual(Las(self.path("parts.las")).records, Las(self.out).records)

    def test_an_input_is_never_replaced(self):
        before = harness.sha256(self.scan)
        for command in ("smooth", "convert"):
            self.refused(USAGE, command, self.scan, "-o", self.scan, "--overwrite",
                         says=["is an input"])
        self.assertEqual(harness.sha256(self.scan), before)

    def test_a_missing_input_is_1(self):
        self.refused(FAILED, "smooth", self.path("missing.las"), "-o", self.out,
                     says=["missing.las"])

    def test_dry_run_prints_and_writes_nothing(self):
        run = self.ok("smooth", self.scan, "-o", self.out, "--dry-run")
        self.assertRegex(run.out, r"tiles +\d")
        self.assertRegex(run.out, r"peak memory +\d")
        self.assertEqual([p.name for p in self.folder.iterdir()], ["scan.las"])

    def test_progress_in_json_is_json_and_never_goes_back(self):
        run = self.ok("smooth", self.scan, "-o", self.out, "--progress", "json")
        points = collections.defaultdict(list)
        for line in map(json.loads, run.err.splitlines()):
            if line["event"] == "progress":
                points[line["stage"]].append(line["points"])
        self.assertGreaterEqual(len(points), 3)
        for counts in points.values():
            self.assertEqual(counts, sorted(counts))
        self.assertEqual(run.out, "")

    def test_the_report_accounts_for_every_point(self):
        report = self.path("report.json")
        self.ok("smooth", self.scan, "-o", self.out, "--report", report)
        points = harness.read_json(report)["points"]
        self.assertEqual((points["in"], points["out"]), (20000, 20000))
        self.assertEqual(sum(points["status"].values()), 20000)

    def test_the_report_says_which_method_was_used(self):
        report = self.path("report.json")
        self.ok("smooth", self.scan, "-o", self.out, "--operator", "fast", "--weight", "wendland",
                "--precision", "double", "--degree", "2", "--report", report)
        said = harness.read_json(report)
        self.assertEqual(said["method"], {"operator": "fast", "weight": "wendland",
                                          "precision": "double", "polynomial_order": 2,
                                          "normals": None})
        self.assertEqual(said["points"]["redone_in_double"], 0)
        self.assertLessEqual(said["points"]["second_sheet"], 20000)

    def test_another_method_is_another_job(self):
        self.ok("smooth", self.scan, "-o", self.out)
        for words in (["--operator", "fast"], ["--weight", "pcl"], ["--precision", "double"]):
            self.refused(FAILED, "smooth", self.scan, "-o", self.out, *words, says=["exists"])

    def test_an_identical_finished_job_is_already_complete(self):
        self.ok("smooth", self.scan, "-o", self.out)
        before = self.out.stat().st_mtime_ns
        run = self.ok("smooth", self.scan, "-o", self.out)
        self.assertIn("already complete", run.err)
        self.assertEqual(self.out.stat().st_mtime_ns, before)

    def test_little_stays_of_the_work_directory(self):
        self.ok("smooth", self.scan, "-o", self.out)
        work = self.path("out.las.work")
        size = sum(p.stat().st_size for p in work.rglob("*")) if work.exists() else 0
        self.assertLess(size, 20000)

    def test_keep_work_keeps_the_stores(self):
        self.ok("smooth", self.scan, "-o", self.out, "--keep-work")
        self.assertTrue(list(self.path("out.las.work").glob("*.pss")))

    def test_an_existing_output_is_refused_until_overwrite(self):
        self.out.write_bytes(b"precious")
        self.refused(FAILED, "smooth", self.scan, "-o", self.out, says=["out.las", "--overwrite"])
        self.assertEqual(self.out.read_bytes(), b"precious")
        self.ok("smooth", self.scan, "-o", self.out, "--overwrite")
        self.assertEqual(Las(self.out).count, 20000)

    def test_a_limit_that_is_too_small_is_4_with_the_one_that_would_do(self):
        run = self.refused(MEMORY_LIMIT, "smooth", self.scan, "-o", self.out, "--memory-limit",
                           "10M")
        self.assertRegex(run.err, r"at least \d+")

    def test_parameters_that_make_no_sense_are_2(self):
        for words in (["--radius", "1", "--h", "2"], ["--radius", "0"], ["--degree", "5"],
                      ["--outputs", "beauty"], ["--knn", "0"], ["--operator", "pcl"],
                      ["--memory-limit", "lots"], ["--radius", "1", "--buffer", "0.5"],
                      ["--weight", "flat"], ["--precision", "half"],
                      ["--operator", "apss", "--polynomial-order", "3"],
                      ["--operator", "rimls", "--degree", "2"]):
            with self.subTest(words):
                self.refused(USAGE, "smooth", self.scan, "-o", self.out, *words)
        self.assertFalse(self.out.exists())

    def test_no_points_give_a_valid_empty_file(self):
        harness.write_las(self.path("none.las"), [])
        self.ok("smooth", self.path("none.las"), "-o", self.out)
        self.assertEqual(Las(self.out).count, 0)

    def test_one_point_and_equal_points_stay_where_they_are(self):
        for count in (1, 1000):
            records = [struct.pack("<3i", 5, 6, 7) + bytes(8)] * count
            harness.write_las(self.path(f"{count}.las"), records)
            out = self.path(f"out{count}.las")
            self.ok("smooth", self.path(f"{count}.las"), "-o", out)
            self.assertEqual(Las(out).records, b"".join(records))


if __name__ == "__main__":
    harness.main()
