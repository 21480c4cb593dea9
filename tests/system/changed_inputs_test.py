"""Inputs that change while they are read: exit 1 with a sentence, or the old file's bytes."""

import os
import shutil
import signal

import harness
import long_changes
from harness import FAILED, SystemTest


class ChangedInputs(SystemTest):
    def test_no_change_at_a_random_moment_gives_other_bytes(self):
        changes = long_changes.Changes(self.folder, 60000)
        for command in long_changes.COMMANDS:
            for change in long_changes.CHANGES:
                for extension in long_changes.FORMATS:
                    changes.one(command, change, extension)
        print(changes.told())
        self.assertEqual(changes.wrong(), [])

    def stopped_while_reading(self, *words):
        """A job that stands still with its input open."""
        job = harness.start(*words)
        long_changes.wait_until_open(job, self.path("scan.xyz"))
        harness.signal_to(job, signal.SIGSTOP)
        return job

    def test_a_refused_job_leaves_no_output_and_restarts_with_the_new_file(self):
        las, other = self.synth("scan.las", points=50000), self.synth("other.las", points=40000)
        scan = self.path("scan.xyz")
        self.ok("convert", las, "-o", scan)
        for command, out in (("smooth", "out.las"), ("tile", "out.pss")):
            words = [command, scan, "-o", self.path(out), "--progress", "none"]
            words += ["--h", "0.1"] if command == "smooth" else []
            job = self.stopped_while_reading(*words)
            self.ok("convert", other, "-o", scan, "--overwrite")
            harness.signal_to(job, signal.SIGCONT)
            run = harness.finish(job)
            self.assertEqual(run.code, FAILED, run.err)
            self.assertIn(f"{scan}: changed while it was read", run.err)
            self.assertFalse(self.path(out).exists())
            self.ok(*words, "--restart")
            self.assertIn("40000", self.ok("info", self.path(out)).out.replace(",", ""))
            self.ok("convert", las, "-o", scan, "--overwrite")

    def test_a_store_that_is_replaced_gives_the_old_bytes_or_an_error(self):
        for name, seed in (("old", 1), ("other", 2)):
            scan = self.synth(f"{name}.las", "--seed", seed, points=50000)
            self.ok("tile", scan, "-o", self.path(f"{name}.pss"))
        store, other, out = (self.path(name) for name in ("scan.pss", "new.pss", "out.las"))
        for command in (["export"], ["smooth", "--h", "0.1"]):
            words = [*command, store, "-o", out, "--progress", "none"]
            shutil.copytree(self.path("old.pss"), store)
            self.ok(*words)
            expected = harness.sha256(out)
            for _ in range(5):
                self.clean(store, other, out, self.path("out.las.work"))
                shutil.copytree(self.path("old.pss"), store)
                shutil.copytree(self.path("other.pss"), other)
                job = harness.start(*words)
                long_changes.wait_until_open(job, store)
                store.rename(self.path("away.pss"))
                other.rename(store)
                run = harness.finish(job)
                self.assertIn(run.code, (harness.DONE, FAILED), run.err)
                if run.code == harness.DONE:
                    self.assertEqual(harness.sha256(out), expected)
                self.clean(self.path("away.pss"))
            self.clean(store, other, out, self.path("out.las.work"))

    def clean(self, *paths):
        for path in paths:
            if path.is_dir():
                shutil.rmtree(path)
            elif path.exists():
                path.unlink()

    def test_a_pipe_is_refused_as_it_ever_was(self):
        pipe = self.path("scan.xyz")
        os.mkfifo(pipe)
        self.refused(FAILED, "convert", pipe, "-o", self.path("out.las"), says=["no regular file"])


if __name__ == "__main__":
    harness.main()
