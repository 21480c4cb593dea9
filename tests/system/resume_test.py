"""Killed, interrupted, changed, run twice: the same command ends with the same bytes."""

import os
import random
import re
import signal
import time

import harness
from harness import FAILED, INTERRUPTED, SystemTest

# A long form by hand: PSS_RESUME_POINTS=3000000 python3 tests/system/resume_test.py Kills
KILLED_POINTS = int(os.environ.get("PSS_RESUME_POINTS", 300000))
KILLS = int(os.environ.get("PSS_RESUME_KILLS", 20))


class ResumeTest(SystemTest):
    points = 100000

    def setUp(self):
        super().setUp()
        self.scan = self.synth("scan.las", "--scans", "3", "--noise", "0.2", points=self.points)
        self.out = self.path("out.las")

    def words(self, out, *more, spacings=4):
        return ["smooth", self.scan, "-o", out, "--tile-points", self.points // 100, "--radius",
                spacings * harness.torus_spacing(self.points), "--progress", "none", "--memory-limit",
                "192M", *more]

    def start_and_wait_for_tiles(self, words=None, store="smooth.pss"):
        """A job that has begun to write its result, or another store."""
        work = self.path("out.las.work")
        self.assertFalse(work.exists())
        process = harness.start(*(words or self.words(self.out)))
        deadline = time.monotonic() + 120
        while not any((work / store).glob("segment-*")):
            self.assertFalse(harness.ended(process), "ended before it could be interrupted")
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        return process


class Kills(ResumeTest):
    points = KILLED_POINTS

    def test_kill_at_any_moment(self):
        whole = self.ok(*self.words(self.path("whole.las")))
        expected = harness.sha256(self.path("whole.las"))
        rng = random.Random(11)
        kills = completions = 0
        while kills < KILLS or completions == 0:
            job = harness.start(*self.words(self.out, "--threads", rng.choice([1, 2])))
            if kills < KILLS:
                time.sleep(rng.uniform(0, whole.seconds / 2))
                harness.signal_to(job, signal.SIGKILL)
            run = harness.finish(job)
            if run.code == -signal.SIGKILL:
                kills += 1
                continue
            self.assertEqual(run.code, 0, run.err)
            self.assertEqual(harness.sha256(self.out), expected)
            completions += 1
            self.out.unlink()
        print(f"{kills} kills, {completions} completions, same SHA-256")


class Resume(ResumeTest):
    def interrupted(self, number):
        whole = self.path("whole.las")
        self.ok(*self.words(whole))
        job = self.start_and_wait_for_tiles()
        harness.signal_to(job, number)
        began = time.monotonic()
        run = harness.finish(job)
        self.assertLess(time.monotonic() - began, 2)
        self.assertEqual(run.code, INTERRUPTED, run.err)
        self.assertIn(f"smooth {self.scan} -o {self.out}", run.err)
        self.assertFalse(self.out.exists())
        self.ok(*self.words(self.out, "--threads", 1))
        self.assertEqual(harness.sha256(self.out), harness.sha256(whole))

    def test_sigint_ends_it_within_seconds_and_it_goes_on(self):
        self.interrupted(signal.SIGINT)

    def test_sigterm_ends_it_within_seconds_and_it_goes_on(self):
        self.interrupted(signal.SIGTERM)

    def test_a_second_process_is_refused_and_a_dead_holder_is_not_in_the_way(self):
        job = self.start_and_wait_for_tiles()
        harness.signal_to(job, signal.SIGSTOP)
        self.refused(FAILED, *self.words(self.out), says=[job.pid])
        harness.signal_to(job, signal.SIGKILL)
        harness.finish(job)
        self.ok(*self.words(self.out))

    def slow(self, *more):
        """One thread and many neighbours: the job is in its tiles for seconds."""
        return self.words(self.out, "--threads", 1, *more, spacings=25)

    def interrupt_with_tiles(self):
        """A job that has computed tiles: before the first one any other parameters would do."""
        job, work = self.start_and_wait_for_tiles(self.slow()), self.path("out.las.work")
        for _ in range(20):
            time.sleep(0.1)
            harness.signal_to(job, signal.SIGTERM)
            self.assertEqual(harness.finish(job).code, INTERRUPTED)
            if not re.search(r"tiles_done +0\n", self.ok("info", work).out):
                return
            job = harness.start(*self.slow())
        self.fail("no tile was computed")

    def test_other_parameters_or_inputs_are_refused_by_name_until_restart(self):
        self.interrupt_with_tiles()
        self.refused(FAILED, *self.slow("--degree", "1"), says=["polynomial-order", "--restart"])
        os.utime(self.scan, ns=(1, 1))
        self.refused(FAILED, *self.slow(), says=["scan.las", "--restart"])
        self.ok(*self.words(self.out, "--degree", "1", "--restart"))

    def test_a_job_killed_while_it_computes_normals_goes_on_with_the_same_bytes(self):
        def words(out, *more):  # many neighbours: the pass shall take a while
            return self.words(out, "--operator", "apss", "--outputs", "all", *more, spacings=15)

        whole = self.path("whole.las")
        self.ok(*words(whole))
        job = self.start_and_wait_for_tiles(words(self.out, "--threads", 1), "normals.pss")
        harness.signal_to(job, signal.SIGKILL)
        self.assertEqual(harness.finish(job).code, -signal.SIGKILL)
        self.assertRegex(self.ok("info", self.path("out.las.work")).out, r"stage +normals")
        self.ok(*words(self.out))
        self.assertEqual(harness.sha256(self.out), harness.sha256(whole))

    def test_info_tells_how_far_a_job_is(self):
        job = self.start_and_wait_for_tiles()
        harness.signal_to(job, signal.SIGKILL)
        harness.finish(job)
        table = self.ok("info", self.path("out.las.work")).out
        self.assertRegex(table, r"stage +smooth")
        self.assertRegex(table, r"tiles_done +\d+")


if __name__ == "__main__":
    harness.main()
