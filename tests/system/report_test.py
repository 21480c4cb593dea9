"""--report: where it may go, what it may replace, all made sure of before the work begins."""

import fcntl
import json
import os
import shutil

import harness
import places
from harness import FAILED, USAGE
from places import PlacesTest, kinds, tree


class Report(PlacesTest):
    def jobs(self):
        """The commands that report, each into an empty folder."""
        for name, output, words in self.commands():
            if name in ("smooth", "smooth to a store", "tile"):
                out = self.fresh("here") / output
                yield name, out, [*words, "-o", out]

    def refused_unchanged(self, code, *words, says):
        before = tree(self.folder)
        self.refused(code, *words, says=says)
        self.assertEqual(tree(self.folder), before)

    def test_it_is_refused_where_it_would_replace_an_input_or_the_output(self):
        for name, out, words in self.jobs():
            for report in (self.scan, out, f"{out}.work", f"{out}.work/job.json"):
                for more in ([], ["--overwrite"]):
                    with self.subTest(f"{name} {report} {more}"):
                        self.refused_unchanged(USAGE, *words, "--report", report, *more,
                                               says=[report])

    def test_it_is_refused_in_a_store_whoever_owns_it(self):
        stranger = self.path("stranger.pss")
        shutil.copytree(self.store, stranger)
        for name, out, words in self.jobs():
            for file in ("manifest", "segment-000000", "report.json"):
                with self.subTest(f"{name} {file}"):
                    self.refused_unchanged(USAGE, *words, "--report", stranger / file,
                                           "--overwrite", says=[stranger / file, "store"])
        self.ok("verify", stranger)

    def test_it_is_refused_in_the_store_that_is_read(self):
        self.refused_unchanged(USAGE, "smooth", self.store, "-o", self.path("o.las"), "--report",
                               self.store / "manifest", "--overwrite", says=["manifest"])

    def test_an_existing_file_needs_overwrite_and_a_link_is_replaced_itself(self):
        for name, out, words in self.jobs():
            for kind, put in kinds(self.theirs).items():
                with self.subTest(f"{name}, {kind}"):
                    report = self.fresh("reports") / "r.json"
                    put(report)
                    self.refused_unchanged(FAILED, *words, "--report", report, says=[report])
            before = tree(self.theirs)
            report = self.fresh("reports") / "r.json"
            report.symlink_to(self.theirs / "notes.txt")
            self.ok(*words, "--report", report, "--overwrite")
            self.assertEqual(harness.read_json(report)["output"], str(out))
            self.assertFalse(report.is_symlink())
            self.assertEqual(tree(self.theirs), before)

    def test_what_has_its_temporary_names_is_left_alone(self):
        for name, out, words in self.jobs():
            for kind, put in kinds(self.theirs).items():
                with self.subTest(f"{name}, {kind}"):
                    shutil.rmtree(out.parent)
                    reports = self.fresh("reports")
                    out.parent.mkdir()
                    put(reports / "r.json.part")
                    put(reports / ".r.json.pss-lock")
                    self.refused_unchanged(FAILED, *words, "--report", reports / "r.json",
                                           says=[".r.json.pss-lock", "move it elsewhere"])
                    (reports / ".r.json.pss-lock").rename(self.fresh("elsewhere") / "moved")
                    before = tree(reports)
                    self.ok(*words, "--report", reports / "r.json")
                    after = tree(reports)
                    del after["r.json"]
                    self.assertEqual(after, before)

    def test_a_dash_is_stdout_and_all_of_it_is_json(self):
        for name, out, words in self.jobs():
            with self.subTest(name):
                for more in ([], ["--restart", "--overwrite"], []):
                    run = self.ok(*words, "--report", "-", *more)
                    self.assertEqual(json.loads(run.out)["output"], str(out))
                self.assertFalse((out.parent / "-").exists())

    def test_a_dry_run_on_stdout_is_json_too(self):
        run = self.ok("smooth", self.scan, "-o", self.path("o.las"), "--dry-run", "--report", "-")
        json.loads(run.out)

    def test_a_finished_job_run_again_replaces_its_own_report_and_no_other(self):
        report = self.path("r.json")
        for name, out, words in self.jobs():
            with self.subTest(name):
                report.unlink(missing_ok=True)
                self.ok(*words, "--report", report)
                self.ok(*words, "--report", report)
                self.assertTrue(harness.read_json(report)["already_complete"])
                report.write_text(json.dumps({"command": "smooth", "output": "another.las"}))
                self.refused_unchanged(FAILED, *words, "--report", report, says=["--overwrite"])
                report.write_text("[1]")
                self.refused_unchanged(FAILED, *words, "--report", report, says=["--overwrite"])

    def test_a_folder_that_is_missing_or_a_file_is_told_before_the_work(self):
        for name, out, words in self.jobs():
            for report in (self.path("none/r.json"), self.scan / "r.json"):
                with self.subTest(f"{name} {report}"):
                    self.refused_unchanged(FAILED, *words, "--report", report, says=[report])

    def test_a_folder_that_cannot_be_written_is_told_before_the_work(self):
        sealed = self.fresh("sealed")
        if not places.mount("-t", "tmpfs", "-o", "ro,size=1m", "none", sealed):
            self.skipTest("this process may not mount")
        self.addCleanup(places.unmount, sealed)
        for name, out, words in self.jobs():
            with self.subTest(name):
                self.refused_unchanged(FAILED, *words, "--report", sealed / "r.json",
                                       says=[sealed / "r.json"])

    def test_two_runs_with_one_report_are_told_from_each_other(self):
        report = self.path("r.json")
        lock = self.path(".r.json.pss-lock")
        lock.touch()
        with open(lock) as held:
            fcntl.flock(held, fcntl.LOCK_EX)
            self.refused(FAILED, "smooth", self.scan, "-o", self.path("o.las"), "--report", report,
                         says=[report, f"process {os.getpid()} on {os.uname().nodename}"])
        self.assertFalse(self.path("o.las").exists())


if __name__ == "__main__":
    harness.main()
