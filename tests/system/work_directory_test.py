"""A work directory is pss's own by its record alone: what else lies there is named, never touched."""

import os
import shutil

import harness
from harness import DONE, FAILED
from places import PlacesTest, kinds, tree

INSIDE = ("runs", "input.pss", "normals.pss", "smooth.pss", "replaced.pss", "probe")


class WorkDirectory(PlacesTest):
    def setUp(self):
        super().setUp()
        self.out = self.fresh("here") / "out.las"
        self.work = self.out.parent / "out.las.work"

    def words(self, *more):
        return ["smooth", self.scan, "-o", self.out, *more]

    def refused_unchanged(self, *words, says, codes=(FAILED, harness.BAD_INPUT, harness.USAGE)):
        before = tree(self.folder)
        run = harness.pss(*words)
        self.assertIn(run.code, codes, run.err)
        for word in says:
            self.assertIn(str(word), run.err)
        self.assertEqual(tree(self.folder), before, run.err)
        return run

    def each_way(self):
        for more in ([], ["--restart"], ["--overwrite"], ["--restart", "--overwrite"]):
            yield more

    def another_does(self):
        """The remedy that the refusals name."""
        self.ok(*self.words("--work-dir", self.fresh("elsewhere") / "work"))
        self.out.unlink()

    def test_what_is_no_directory_is_refused(self):
        for kind, put in kinds(self.theirs).items():
            put(self.work)
            if kind == "folder":
                (self.work / "deeper").mkdir()
            for more in self.each_way():
                with self.subTest(f"{kind} {more}"):
                    self.refused_unchanged(*self.words(*more), says=[self.work])
            self.another_does()
            shutil.move(self.work, self.fresh("moved"))
            self.ok(*self.words())
            self.out.unlink()

    def test_a_foreign_record_makes_no_directory_ours(self):
        records = {"theirs": '{"name": "nightly build"}', "empty": "", "list": "[]",
                   "like ours": '{"format": 1, "command": "smooth", "complete": true}',
                   "of a future version": None}
        for what, text in records.items():
            shutil.rmtree(self.work, ignore_errors=True)
            (self.work / "runs").mkdir(parents=True)
            (self.work / "runs" / "run-000000").write_text("somebody's\n")
            (self.work / "runs" / "log").write_text("somebody's\n")
            shutil.copytree(self.store, self.work / "smooth.pss")
            (self.work / "job.json").write_text(text or '{"program": "pss", "version": 99}')
            for more in self.each_way():
                with self.subTest(f"{what} {more}"):
                    self.refused_unchanged(*self.words(*more), says=[self.work / "job.json"])
            self.another_does()

    def test_a_directory_without_a_record_is_refused(self):
        for name in INSIDE + ("lock", "notes.txt"):
            shutil.rmtree(self.work, ignore_errors=True)
            (self.work / name).mkdir(parents=True)
            for more in self.each_way():
                with self.subTest(f"{name} {more}"):
                    self.refused_unchanged(*self.words(*more), says=[self.work, name])
            self.another_does()

    def test_foreign_files_in_a_jobs_own_directory_stay_and_the_job_ends(self):
        self.sorted_only(self.out)
        for name in ("notes.txt", "lock", "job.json.part", "segment-000000", ".hidden"):
            (self.work / name).write_text("somebody's\n")
        (self.work / "data").mkdir()
        self.ok(*self.words())
        self.assertEqual(sorted(os.listdir(self.work)), [".hidden", "data", "job.json.part", "lock",
                                                         "notes.txt", "segment-000000"])

    def test_links_under_the_names_of_what_a_job_keeps_are_refused_and_not_followed(self):
        for name in INSIDE:
            for target in (self.store, self.theirs, self.scan, self.path("nowhere")):
                shutil.rmtree(self.work, ignore_errors=True)
                self.sorted_only(self.out)
                place = self.work / name
                shutil.rmtree(place, ignore_errors=True)
                place.symlink_to(target)
                before = tree(self.store), tree(self.theirs), harness.sha256(self.scan)
                for more in self.each_way():
                    with self.subTest(f"{name} to {target.name} {more}"):
                        run = self.refused(FAILED, *self.words(*more), says=[place])
                        self.assertTrue(place.is_symlink(), run.err)
                place.unlink()
                self.ok(*self.words())
                self.assertEqual((tree(self.store), tree(self.theirs), harness.sha256(self.scan)),
                                 before)
                self.assertEqual(os.listdir(self.out.parent), ["out.las"])
                self.out.unlink()

    def test_foreign_files_in_what_restart_would_remove_are_named_and_kept(self):
        for name in ("runs", "input.pss", "smooth.pss"):
            with self.subTest(name):
                shutil.rmtree(self.work, ignore_errors=True)
                self.sorted_only(self.out)
                theirs = self.work / name / "notes.txt"
                theirs.parent.mkdir(exist_ok=True)
                theirs.write_text("somebody's\n")
                self.refused(FAILED, *self.words("--restart"), says=[self.work / name, "notes.txt"])
                self.assertEqual(theirs.read_text(), "somebody's\n")
                theirs.rename(self.path("moved"))
                self.ok(*self.words("--restart"))
                self.assertEqual(os.listdir(self.out.parent), ["out.las"])
                self.out.unlink()

    def test_a_record_that_is_a_link_is_not_written_through(self):
        for link in (os.symlink, os.link):
            with self.subTest(link.__name__):
                shutil.rmtree(self.work, ignore_errors=True)
                self.sorted_only(self.out)
                theirs = self.path(f"record-{link.__name__}")
                (self.work / "job.json").rename(theirs)
                link(theirs, self.work / "job.json")
                before = harness.sha256(theirs)
                run = harness.pss(*self.words())
                self.assertEqual(harness.sha256(theirs), before)
                if run.code == DONE:
                    self.out.unlink()
                else:
                    self.assertIn("job.json", run.err)

    def test_the_locks_name_in_it_may_be_somebodys(self):
        for kind, put in kinds(self.theirs).items():
            shutil.rmtree(self.work, ignore_errors=True)
            self.sorted_only(self.out)
            lock = self.work / ".job.json.pss-lock"
            put(lock)
            for more in self.each_way():
                with self.subTest(f"{kind} {more}"):
                    self.refused_unchanged(*self.words(*more), says=[lock, "move it elsewhere"])

    def test_somebodys_folder_is_no_work_directory(self):
        (self.theirs / "notes.txt").write_text("somebody's\n")
        for place in (self.theirs, self.store, self.scan, self.out.parent, self.folder,
                      self.store / "work", self.scan / "work", self.out, self.out / "work"):
            for more in self.each_way():
                with self.subTest(f"{place} {more}"):
                    for command in (self.words(), ["smooth", self.store, "-o", self.out]):
                        self.refused_unchanged(*command, "--work-dir", place, *more,
                                               says=[place.parent])

    def test_an_empty_folder_of_the_users_may_be_one_and_outlives_a_refusal(self):
        mine = self.path("mine")
        mine.mkdir()
        bad = self.path("bad.xyz")
        bad.write_text("1 2 3\n1 two 3\n")
        self.refused(harness.BAD_INPUT, "smooth", bad, "-o", self.out, "--work-dir", mine)
        self.assertTrue(mine.is_dir())
        self.ok(*self.words("--work-dir", mine))


if __name__ == "__main__":
    harness.main()
