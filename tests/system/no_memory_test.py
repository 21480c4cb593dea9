"""The system gives less memory than pss was told it may use: one sentence, and the job goes on."""

import os
import resource

import harness
from harness import DONE, FAILED, SystemTest

MIB = 1 << 20
STEP = float(os.environ.get("PSS_NO_MEMORY_STEP", 3))  # MiB from one limit to the next
SENTENCE = "pss: the system gave no more memory"
NOT_LOADED = 127  # by the loader, before pss


class NoMemory(SystemTest):
    def limited(self, words, limit):
        """pss with so many bytes of address space."""
        def limit_it():
            resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        return harness.pss(*words, preexec_fn=limit_it)

    def words(self, out):
        return ["smooth", self.scan, "-o", out, "--tile-points", 3000, "--operator", "apss",
                "--threads", 2, "--progress", "none", "--memory-limit", "1G"]

    def test_less_than_it_needs_is_a_sentence_and_the_job_goes_on_with_the_same_bytes(self):
        self.scan = self.synth("scan.las", "--noise", "0.2", points=20000)
        whole, out = self.path("whole.las"), self.path("out.las")
        self.ok(*self.words(whole))
        expected = harness.sha256(whole)
        refused, limit, code = 0, 8.0, FAILED
        while code != DONE:
            run = self.limited(self.words(out), int(limit * MIB))
            code = run.code
            if code == FAILED:
                refused += 1
                said = [SENTENCE in line for line in run.err.splitlines()]
                self.assertEqual(said, [False] * (len(said) - 1) + [True],
                                 f"{limit} MiB\n{run.err}")
                self.assertFalse(out.exists())
            else:
                self.assertIn(code, (DONE, NOT_LOADED), f"{limit} MiB\n{run.err}")
            if code != DONE and os.path.exists(f"{out}.work"):
                self.ok(*self.words(out))
            if out.exists():
                self.assertEqual(harness.sha256(out), expected)
                out.unlink()
            limit += STEP
            self.assertLess(limit, 4096)
        self.assertGreater(refused, 10)


if __name__ == "__main__":
    harness.main()
