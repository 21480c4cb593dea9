"""Killed at, or failed by, the n-th system call that touches the disk: nothing is ever half done."""

import os
import shutil
import signal
import subprocess
import unittest

import harness
from harness import DONE, FAILED, SystemTest

# Every n-th call is tried; 1 is all of them, for a long form by hand.
STRIDE = int(os.environ.get("PSS_CRASH_STRIDE", 6))
CALLS = "pwrite64 fdatasync fsync rename ftruncate mkdir unlink unlinkat rmdir".split()
OFTEN = {"pwrite64"}  # called so often that only every STRIDE-th is tried


def traced(inject, words):
    """Runs pss with a fault injected by strace."""
    command = ["strace", "-f", "-qq", "-o", "/dev/null", "-e", f"trace={inject.split(':')[0]}",
               "-e", f"inject={inject}", harness.PSS, *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True)


def can_trace():
    if not shutil.which("strace"):
        return False
    return subprocess.run(["strace", "-qq", "-o", "/dev/null", "true"]).returncode == 0


@unittest.skipUnless(can_trace(), "strace is missing or may not trace")
class Crash(SystemTest):
    def setUp(self):
        super().setUp()
        self.scan = self.synth("scan.las", "--noise", "0.2", points=3000)
        self.out = self.path("out.las")
        self.ok(*self.words(self.path("whole.las")))
        self.expected = harness.sha256(self.path("whole.las"))

    def words(self, out):
        return ["smooth", self.scan, "-o", out, "--tile-points", 300, "--progress", "none"]

    def clean(self):
        self.out.unlink(missing_ok=True)
        shutil.rmtree(f"{self.out}.work", ignore_errors=True)

    def at_every_call(self, calls, fault, judge):
        """Injects a fault at the n-th call of each kind, until n is beyond the last."""
        tried = 0
        for call in calls:
            n, reached = 1, True
            while reached:
                with self.subTest(f"{call} {n}"):
                    self.clean()
                    run = traced(f"{call}:{fault}:when={n}", self.words(self.out))
                    reached = judge(run, f"{call} {n}: {run.stderr}")
                    if self.out.exists():
                        self.assertEqual(harness.sha256(self.out), self.expected)
                    self.ok(*self.words(self.out))
                    self.assertEqual(harness.sha256(self.out), self.expected)
                tried += reached
                n += STRIDE if call in OFTEN else 1
        return tried

    def test_killed_at_any_call_the_same_command_ends_with_the_same_bytes(self):
        def killed(run, what):
            self.assertIn(run.returncode, (DONE, -signal.SIGKILL, 128 + signal.SIGKILL), what)
            return run.returncode != DONE

        self.assertGreater(self.at_every_call(CALLS, "signal=SIGKILL", killed), 30)

    def failed(self, run, what):
        """Whether the call failed; then the run failed too, and said what it was about."""
        if run.returncode == DONE:
            return False
        self.assertEqual(run.returncode, FAILED, what)
        self.assertIn(str(self.folder), run.stderr)
        return True

    def test_a_full_disk_at_any_call_is_one_message_and_resumable(self):
        calls = ["pwrite64", "ftruncate", "mkdir", "rename"]
        self.assertGreater(self.at_every_call(calls, "error=ENOSPC", self.failed), 10)

    def test_an_io_error_at_any_call_is_one_message_and_resumable(self):
        calls = ["fdatasync", "fsync", "unlink", "unlinkat", "rmdir"]
        self.assertGreater(self.at_every_call(calls, "error=EIO", self.failed), 10)

    def test_interrupted_reads_and_writes_are_tried_again(self):
        for call in ("pwrite64", "pread64"):
            with self.subTest(call):
                self.clean()
                run = traced(f"{call}:error=EINTR:when=3+5", self.words(self.out))
                self.assertEqual(run.returncode, DONE, run.stderr)
                self.assertEqual(harness.sha256(self.out), self.expected)


if __name__ == "__main__":
    harness.main()
