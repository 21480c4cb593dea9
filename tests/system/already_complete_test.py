"""A finished job is known again by what is remembered of it, and never taken for complete falsely."""

import os
import shutil

import harness
from harness import BAD_INPUT, FAILED
from places import Leaves, named, tree


class Complete(Leaves):
    """Only OUTPUT stays; what is remembered of it is never a false "already complete"."""

    def outputs(self):
        for name in ("out.las", "out.pss"):
            self.out = self.fresh("here") / name
            self.run_ok(*self.words())
            self.assertEqual(named(self.out.parent), [name])
            yield name

    def record(self):
        return max(self.state.glob("pss/*.json"), key=lambda path: path.stat().st_mtime_ns)

    def test_after_success_only_the_output_stays_and_is_known_again(self):
        for name in self.outputs():
            with self.subTest(name):
                before = tree(self.out.parent)
                self.assertTrue(self.complete(*self.words()))
                self.assertTrue(self.complete(*self.words("--overwrite")))
                link = self.path(f"link-{name}")
                link.symlink_to(self.out.parent)
                self.assertEqual(tree(self.out.parent), before)

    def test_a_record_that_is_lost_damaged_or_of_another_output_means_refusal(self):
        for name in self.outputs():
            good = self.record().read_bytes()
            other = self.fresh("there") / name
            self.run_ok(*self.words(out=other))
            foreign = self.record().read_bytes()
            place = next(p for p in self.state.glob("pss/*.json") if p.read_bytes() == good)
            damages = {"lost": None, "empty": b"", "of another output": foreign, "text": b"{}",
                       "deep": b"[" * 1000, "bit": good.replace(b'"size"', b'"sizE"'),
                       "short": good[:-3]}
            for what, data in damages.items():
                with self.subTest(f"{name} {what}"):
                    place.unlink()
                    if data is not None:
                        place.write_bytes(data)
                    self.refused_here(FAILED, *self.words(), says=[self.out, "--overwrite"])
                    place.write_bytes(good)
                    self.assertTrue(self.complete(*self.words()))

    def test_without_a_home_it_is_refused(self):
        bare = {k: v for k, v in os.environ.items() if k not in ("HOME", "XDG_STATE_HOME")}
        for environment in (bare, {**bare, "XDG_STATE_HOME": "relative"}, {**bare, "HOME": ""}):
            for name in self.outputs():
                with self.subTest(f"{name} {environment.get('XDG_STATE_HOME')}"):
                    self.refused(FAILED, *self.words(), says=[self.out, "--overwrite"],
                                 env=environment)
                    self.ok(*self.words("--overwrite"), env=environment)
                    self.refused(FAILED, *self.words(), env=environment)
                    self.assertEqual(named(self.out.parent), [name])

    def test_a_state_folder_that_cannot_be_written_is_told_and_harms_nothing(self):
        self.state = self.path("state-file")
        self.state.write_text("somebody's\n")
        self.environment["XDG_STATE_HOME"] = str(self.state)
        run = self.run_ok(*self.words())
        self.assertIn(str(self.state), run.err)
        self.assertEqual(named(self.out.parent), ["out.las"])
        self.refused_here(FAILED, *self.words(), says=["--overwrite"])
        self.assertEqual(self.state.read_text(), "somebody's\n")

    def files(self):
        return [self.out] if self.out.is_file() else sorted(self.out.iterdir())

    def test_one_changed_bit_is_noticed_though_size_and_time_are_the_same(self):
        for name in self.outputs():
            for file in self.files():
                data = file.read_bytes()
                times = file.stat().st_atime_ns, file.stat().st_mtime_ns
                for place in (0, len(data) // 2, len(data) - 1):
                    with self.subTest(f"{file.name} {place}"):
                        file.write_bytes(data[:place] + bytes([data[place] ^ 1]) + data[place + 1:])
                        os.utime(file, ns=times)
                        run = harness.pss(*self.words(), env=self.environment)
                        self.assertEqual(run.code, FAILED, run.err)
                        self.assertIn(str(self.out), run.err)
                file.write_bytes(data)
            self.assertTrue(self.complete(*self.words()))

    def test_a_store_without_one_of_its_files_is_not_complete(self):
        for command in (["tile", self.scan], ["smooth", self.scan, "--radius", 0.5]):
            for file in ("manifest", "segment-000000"):
                with self.subTest(f"{command[0]} {file}"):
                    self.out = self.fresh("here") / "out.pss"
                    self.run_ok(*command, "-o", self.out)
                    (self.out / file).unlink()
                    run = harness.pss(*command, "-o", self.out, env=self.environment)
                    self.assertEqual(run.code, FAILED, run.err)
                    self.assertIn(str(self.out), run.err)

    def test_other_inputs_or_parameters_are_another_job(self):
        for name in self.outputs():
            with self.subTest(name):
                self.refused_here(FAILED, *self.words("--degree", 1), says=["--overwrite"])
                scan = self.path("changed.las")
                shutil.copy(self.scan, scan)
                self.refused_here(FAILED, *self.words(scan=scan), says=["--overwrite"])
                os.utime(self.scan, ns=(1, 1 + self.scan.stat().st_mtime_ns))
                self.refused_here(FAILED, *self.words(), says=["--overwrite"])
                self.run_ok(*self.words("--overwrite"))
                self.assertTrue(self.complete(*self.words()))

    def test_with_a_work_directory_of_its_own_the_record_stays_there(self):
        work = self.path("work")
        self.run_ok(*self.words("--work-dir", work))
        self.assertEqual(named(work), ["job.json"])
        self.assertEqual(list(self.state.rglob("*.json")), [])
        self.assertTrue(self.complete(*self.words("--work-dir", work)))
        self.refused_here(FAILED, *self.words(), says=["--overwrite"])
        (work / "job.json").unlink()
        self.refused_here(FAILED, *self.words("--work-dir", work), says=["--overwrite"])

    def test_a_damaged_record_of_a_work_directory_is_named_and_another_one_does(self):
        work = self.path("work")
        self.run_ok(*self.words("--work-dir", work))
        record = work / "job.json"
        record.write_text(record.read_text().replace('"complete": true', '"complete": false'))
        self.refused_here(BAD_INPUT, *self.words("--work-dir", work, "--restart", "--overwrite"),
                          says=[record, "--work-dir"])
        self.run_ok(*self.words("--work-dir", self.path("other"), "--overwrite"))


if __name__ == "__main__":
    harness.main()
