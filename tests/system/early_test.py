"""Signals before there is a job: pss listens to them from its first instruction on."""

import os
import shutil
import signal
import subprocess
import time
import unittest

import harness
from harness import DONE, INTERRUPTED, SystemTest

STEPS = int(os.environ.get("PSS_EARLY_STEPS", 30))  # moments from 0 to 30 ms


def can_trace():
    if not shutil.which("strace"):
        return False
    return subprocess.run(["strace", "-qq", "-o", "/dev/null", "true"]).returncode == 0


@unittest.skipUnless(can_trace(), "strace is missing or may not trace")
class EarlySignals(SystemTest):
    def traced(self, words, *options):
        log = self.path("calls")
        run = subprocess.run(["strace", "-qq", "-o", log, *options, harness.PSS, *map(str, words)],
                             capture_output=True, text=True)
        return run, log.read_text().splitlines()

    def interrupted_at_every_call(self, number, words, last):
        """A signal after each call of the main thread, from the one that installs its handler to
        the first that is `last`. What comes before is the loader's."""
        _, calls = self.traced(words)
        installed = next(i for i, call in enumerate(calls)
                         if call.startswith(f"rt_sigaction({number}, {{sa_handler=0x"))
        end = next(i for i, call in enumerate(calls) if i > installed and call.startswith(last))
        self.assertGreater(end - installed, 10)
        for n in range(installed, end):
            name = calls[n].split("(")[0]
            nth = sum(call.startswith(name + "(") for call in calls[: n + 1])
            run, _ = self.traced(words, "-e", f"inject={name}:signal={number}:when={nth}")
            self.assertEqual(run.returncode, INTERRUPTED, f"{calls[n]}\n{run.stderr}")

    def test_sigterm_and_sigint_end_it_in_order_before_a_job_exists(self):
        scan = self.synth("scan.las", points=1000)
        out = self.path("out.las")
        for number in ("SIGTERM", "SIGINT"):
            with self.subTest(number):
                self.interrupted_at_every_call(number, ["info", scan], "exit_group")
                self.interrupted_at_every_call(number, ["smooth", scan, "-o", out, "--dry-run"], "clone")
        self.assertFalse(out.exists())


class FirstMilliseconds(SystemTest):
    """From exec on, before main has its handlers too: there the signal ends the process as the
    system does, and nothing has been begun."""

    def test_sigterm_at_any_time_leaves_a_job_that_goes_on(self):
        scan, out = self.synth("scan.las", points=2000), self.path("out.las")
        words = ["smooth", scan, "-o", out, "--tile-points", 300, "--progress", "none"]
        self.ok(*words)
        expected = harness.sha256(out)
        codes = set()
        for step in range(STEPS):
            out.unlink(missing_ok=True)
            shutil.rmtree(f"{out}.work", ignore_errors=True)
            job = harness.start(*words)
            time.sleep(0.030 * step / STEPS)
            harness.signal_to(job, signal.SIGTERM)
            run = harness.finish(job)
            codes.add(run.code)
            self.assertIn(run.code, (DONE, INTERRUPTED, -signal.SIGTERM), run.err)
            if run.code == -signal.SIGTERM:  # before main: there is nothing yet
                self.assertFalse(os.path.exists(f"{out}.work"))
            self.ok(*words)
            self.assertEqual(harness.sha256(out), expected)
        self.assertIn(INTERRUPTED, codes)


if __name__ == "__main__":
    harness.main()
