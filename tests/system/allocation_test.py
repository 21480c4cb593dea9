"""Every n-th allocation of a small job fails: one sentence, and the job goes on with the same bytes."""

import os
import shutil

import harness
from harness import DONE, FAILED, SystemTest

LIBRARY = os.environ["PSS_FAILING_ALLOCATION"]
# How many allocations are tried; 0 is every one, for a long form by hand.
SAMPLES = int(os.environ.get("PSS_ALLOCATION_SAMPLES", 80))
SENTENCE = "pss: the system gave no more memory"
REFUSED = "Cannot allocate memory"  # by a system call, which is said with its path


class Allocations(SystemTest):
    def setUp(self):
        super().setUp()
        self.scan = self.synth("scan.ply", "--noise", "0.2", points=300)
        self.out = self.path("out.ply")

    def run_with(self, words, **variables):
        return harness.pss(*words, env={**os.environ, "LD_PRELOAD": LIBRARY, **variables})

    def sampled(self, words):
        """Numbers of allocations, dense among the first, up to the last of an undisturbed run."""
        file = self.path("count")
        self.assertEqual(self.run_with(words, PSS_COUNT_ALLOCATIONS=str(file)).code, DONE)
        count = int(file.read_text())
        self.assertGreater(count, 1000)
        numbers = range(1, count + 1)
        return numbers if SAMPLES == 0 else sorted(
            {round(1 + i * (count - 1) / (SAMPLES - 1)) for i in range(SAMPLES)})

    def check_refusal(self, run, what):
        """Exit 1 and one sentence, after what was noted before."""
        self.assertEqual(run.code, FAILED, f"{what}\n{run.err}")
        *notes, last = run.err.splitlines()
        self.assertTrue(last.startswith(SENTENCE) or last.startswith("pss: ") and REFUSED in last,
                        f"{what}\n{run.err}")
        for note in notes:
            self.assertTrue(note.startswith("pss: ") and SENTENCE not in note, f"{what}\n{run.err}")

    def fail_each(self, words, ever_after):
        self.run_with(words)
        expected = harness.sha256(self.out)
        self.out.unlink()
        numbers = self.sampled(words)
        refused = 0
        for number in numbers:
            self.out.unlink(missing_ok=True)
            shutil.rmtree(f"{self.out}.work", ignore_errors=True)
            run = self.run_with(words, PSS_FAIL_ALLOCATION=f"{number}{ever_after}")
            if run.code != DONE:
                refused += 1
                self.check_refusal(run, f"allocation {number}{ever_after} of {words}")
            if self.out.exists():
                self.assertEqual(harness.sha256(self.out), expected, number)
            if run.code != DONE:
                self.ok(*words)
                self.assertEqual(harness.sha256(self.out), expected, number)
        # Few are the C library's, which does without: buffers of files, for instance.
        self.assertGreater(refused, 0.9 * len(numbers))

    def words(self, threads):
        return ["smooth", self.scan, "-o", self.out, "--tile-points", 100, "--operator", "apss",
                "--threads", threads, "--progress", "none"]

    def test_of_a_job_failing_once_is_a_sentence_and_resumable(self):
        self.fail_each(self.words(1), "")

    def test_of_a_job_in_two_threads_failing_from_then_on_is_a_sentence_and_resumable(self):
        self.fail_each(self.words(2), "+")


if __name__ == "__main__":
    harness.main()
