"""SIGTERM in any stage ends a job within two seconds, and the same command goes on from there."""

import os
import signal
import time

import harness
from harness import INTERRUPTED, SystemTest

POINTS = int(float(os.environ.get("PSS_INTERRUPT_POINTS", 600000)))
STAGES = ("read", "merge", "spacing", "normals", "smooth", "write")


class Interrupt(SystemTest):
    def job(self, out, *more):
        """Words of a job with every stage: an automatic width, normals that are computed, runs."""
        return ("smooth", self.scan, "-o", out, "--operator", "apss", *more)

    def wait_for(self, stage, process):
        """Until the job says that a stage begins; False where it ends before."""
        begins = f'"stage":"{stage}"'.encode()
        while begins not in os.pread(process.written[1].fileno(), 1 << 20, 0):
            if harness.ended(process):
                return False
            time.sleep(0.002)
        return True

    def interrupt(self, stage):
        process = harness.start(*self.job(self.out, "--progress", "json", "--memory-limit", "96M"))
        self.assertTrue(self.wait_for(stage, process), f"{stage} never began")
        began = time.monotonic()
        harness.signal_to(process, signal.SIGTERM)
        run = harness.finish(process)
        self.assertLess(time.monotonic() - began, 2, stage)
        self.assertEqual(run.code, INTERRUPTED, f"{stage}: {run.err}")
        self.assertFalse(self.out.exists())

    def test_sigterm_in_any_stage_ends_a_job_that_then_goes_on(self):
        self.scan, self.out = self.path("scan.las"), self.path("out.las")
        self.ok("synth", "torus", "-o", self.scan, "--noise", "0.02", "--points", POINTS)
        for stage in STAGES:
            with self.subTest(stage=stage):
                self.interrupt(stage)
        self.ok(*self.job(self.out, "--memory-limit", "96M"))
        self.ok(*self.job(self.path("whole.las"), "--memory-limit", "1G"))
        self.assertEqual(harness.sha256(self.out), harness.sha256(self.path("whole.las")))


if __name__ == "__main__":
    harness.main()
