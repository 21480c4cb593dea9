"""A result in the work directory that is another job's, or damaged: told before anything is sorted."""

import re
import shutil

import harness
from harness import BAD_INPUT, DONE, FAILED, USAGE
from places import PlacesTest, needs_trace, traced, tree


class OtherResult(PlacesTest):
    def setUp(self):
        super().setUp()
        self.other = self.synth("other.las", "--seed", 2, points=300)
        self.out = self.fresh("here") / "out.las"
        self.work = self.out.parent / "out.las.work"

    def words(self, *more, scan=None, out=None):
        return ["smooth", scan or self.scan, "-o", out or self.out, "--radius", 0.5, *more]

    def stages(self, run):
        return set(re.findall(r'"stage":"(\w+)"', run.err))

    def kept(self, *words):
        """The result of a job that kept its work."""
        work = self.fresh("kept")
        self.ok(*words, "--work-dir", work, "--keep-work")
        return work / "smooth.pss"

    def unfinished(self, output):
        """A job that was killed when it had sorted and computed all, before it wrote any output."""
        self.out = self.fresh("here") / output
        self.work = self.out.parent / f"{output}.work"
        log = self.path("calls")
        traced("renameat2:delay_enter=0", self.words(), log)
        last = len(log.read_text().splitlines())
        self.fresh("here")
        run = traced(f"renameat2:signal=SIGKILL:when={last}", self.words("--restart"))
        self.assertNotEqual(run.returncode, DONE)
        self.assertTrue((self.work / "smooth.pss/manifest").exists())

    def told_at_once(self, code, says):
        """Refused before any stage of work, with the work as it was."""
        result = self.work / "smooth.pss"
        before = tree(result)
        run = self.refused(code, *self.words("--progress", "json"), says=says)
        self.assertEqual(self.stages(run) - {"check"}, set())
        self.assertFalse(self.out.exists())
        self.assertEqual(tree(result), before)

    def ends_right(self, whole):
        self.ok(*self.words("--restart", "--progress", "none"))
        self.assertEqual(self.result(), whole)

    def result(self):
        if self.out.is_dir():
            return re.search(r"rows +(\w+)", self.ok("verify", self.out).out)[1]
        return harness.sha256(self.out)

    @needs_trace
    def test_the_result_of_another_job_is_refused_before_anything_is_sorted(self):
        others = {"of other inputs": self.words(scan=self.other, out=self.path("a.las")),
                  "of other parameters": self.words("--degree", 1, out=self.path("b.las"))}
        for output in ("out.las", "out.pss"):
            for what, words in others.items():
                with self.subTest(f"{output} {what}"):
                    foreign = self.kept(*words)
                    self.unfinished(output)
                    shutil.rmtree(self.work / "smooth.pss")
                    shutil.copytree(foreign, self.work / "smooth.pss")
                    self.told_at_once(FAILED, [self.work / "smooth.pss", "--restart"])
                    self.ends_right(self.whole(output))
                self.path("a.las").unlink(missing_ok=True)
                self.path("b.las").unlink(missing_ok=True)

    def whole(self, output):
        here, self.out = self.out, self.fresh("whole") / output
        self.ok(*self.words())
        result, self.out = self.result(), here
        return result

    @needs_trace
    def test_a_damaged_result_is_refused_before_anything_is_sorted(self):
        def flip(path, place):
            data = bytearray(path.read_bytes())
            data[int(place * (len(data) - 1))] ^= 1
            path.write_bytes(data)

        for output in ("out.las", "out.pss"):
            for name, place in (("manifest", 0), ("manifest", 0.5), ("manifest", 1)):
                with self.subTest(f"{output} {name} {place}"):
                    self.unfinished(output)
                    flip(self.work / "smooth.pss" / name, place)
                    self.told_at_once(BAD_INPUT, [self.work / "smooth.pss" / name])
                    self.ends_right(self.whole(output))
            with self.subTest(f"{output} segment"):
                self.unfinished(output)
                (self.work / "smooth.pss/segment-000000").unlink()
                self.told_at_once(BAD_INPUT, [self.work / "smooth.pss/segment-000000"])
                self.ends_right(self.whole(output))

    @needs_trace
    def test_a_flipped_bit_in_a_results_rows_reaches_no_output(self):
        for output in ("out.las", "out.pss"):
            self.unfinished(output)
            segment = self.work / "smooth.pss/segment-000000"
            good = segment.read_bytes()
            for place in (0, len(good) // 3, len(good) - 1):
                with self.subTest(f"{output} {place}"):
                    segment.write_bytes(good[:place] + bytes([good[place] ^ 4]) + good[place + 1:])
                    run = harness.pss(*self.words("--progress", "none"))
                    self.assertEqual(run.code, BAD_INPUT, run.err)
                    self.assertIn(str(segment), run.err)
                    self.assertFalse(self.out.exists())

    @needs_trace
    def test_a_flipped_bit_in_the_store_of_a_killed_tile_job_reaches_no_output(self):
        out = self.fresh("here") / "out.pss"
        words = ["tile", self.scan, "-o", out, "--progress", "none"]
        run = traced("renameat2:signal=SIGKILL:when=2", words)  # the first is a trial
        self.assertNotEqual(run.returncode, DONE)
        segment = out.parent / "out.pss.work/input.pss/segment-000000"
        data = bytearray(segment.read_bytes())
        data[100] ^= 1
        segment.write_bytes(data)
        self.refused(BAD_INPUT, *words, says=[segment, "offset"])
        self.assertFalse(out.exists())
        self.ok(*words, "--restart")
        self.ok("verify", out)

    def test_a_sorted_input_of_other_files_is_not_taken(self):
        self.ok("tile", self.other, "-o", self.path("other.pss"))
        self.refused(USAGE, "smooth", self.scan, "-o", self.out, "--buffer", 0.001)
        shutil.rmtree(self.work / "input.pss")
        shutil.copytree(self.path("other.pss"), self.work / "input.pss")
        self.refused(FAILED, "smooth", self.scan, "-o", self.out, says=[self.work / "input.pss"])
        self.assertFalse(self.out.exists())
        self.ok("smooth", self.scan, "-o", self.out, "--restart")


if __name__ == "__main__":
    harness.main()
