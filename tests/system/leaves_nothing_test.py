"""What is left beside OUTPUT: nothing after success or a refusal, or what the same command needs."""

import json
import os
import struct

import harness
from harness import BAD_INPUT, DONE, FAILED, MEMORY_LIMIT, USAGE
from places import Leaves, named, needs_trace, traced, tree


class RefusedInput(Leaves):
    def with_crs(self, name, code):
        """A scan with a coordinate system of this EPSG code."""
        las = harness.Las(self.scan)
        keys = struct.pack("<4H4H", 1, 1, 0, 1, 3072, 0, 1, code)
        vlr = struct.pack("<H16sHH32s", 0, b"LASF_Projection", 34735, len(keys), b"") + keys
        header = bytearray(las.header)
        struct.pack_into("<II", header, 96, las.header_size + len(vlr), 1)
        path = self.path(name)
        path.write_bytes(header + vlr + las.records)
        return path

    def laz(self):
        data = bytearray(self.scan.read_bytes())
        data[104] |= 0x80
        path = self.path("scan.laz")
        path.write_bytes(data)
        return path

    def text(self):
        path = self.path("bad.xyz")
        path.write_text("1 2 3\n" * 100 + "1 two 3\n")
        return path

    def inputs(self):
        yield "LAZ", BAD_INPUT, [self.laz()]
        yield "CRS", BAD_INPUT, [self.with_crs("a.las", 25832), self.with_crs("b.las", 25833)]
        yield "text", BAD_INPUT, [self.text()]

    def test_a_refused_input_leaves_nothing_and_the_corrected_command_runs(self):
        for command, output, more in (("smooth", "out.las", ["--radius", 0.5]),
                                      ("smooth", "out.pss", ["--radius", 0.5]),
                                      ("tile", "out.pss", []), ("convert", "out.ply", [])):
            for name, code, inputs in self.inputs():
                with self.subTest(f"{command} {output} {name}"):
                    self.out = self.fresh("here") / output
                    self.refused_here(code, command, *inputs, "-o", self.out, *more)
                    self.run_ok(command, self.scan, "-o", self.out, *more)
                    self.assertTrue(self.sound(self.out))
                    self.assertEqual(named(self.out.parent), [output])

    def test_a_buffer_that_is_told_too_small_at_once_leaves_nothing(self):
        self.refused_here(USAGE, *self.words("--buffer", 0.001), says=["--buffer"])
        self.run_ok(*self.words())

    def test_a_limit_that_is_too_small_leaves_nothing(self):
        self.refused_here(MEMORY_LIMIT, *self.words("--memory-limit", "10M"))
        self.run_ok(*self.words())

    def test_a_limit_found_too_small_after_sorting_keeps_the_sorted_input(self):
        scan = self.synth("dense.las", points=60000)
        words = ["smooth", scan, "-o", self.out, "--radius", 30, "--threads", 1]
        self.refused(MEMORY_LIMIT, *words, "--memory-limit", "88M", says=["--memory-limit"],
                     env=self.environment)
        run = self.run_ok("smooth", scan, "-o", self.out, "--radius", 0.05, "--progress", "json")
        self.assertNotIn('"stage":"read"', run.err)
        self.assertEqual(named(self.out.parent), ["out.las"])

    def test_a_buffer_found_too_small_after_sorting_keeps_the_sorted_input(self):
        automatic = ["smooth", self.scan, "-o", self.out, "--progress", "json"]
        self.refused(USAGE, *automatic, "--buffer", 0.001, env=self.environment)
        self.assertTrue((self.out.parent / "out.las.work/input.pss/manifest").exists())
        run = self.run_ok(*automatic)
        self.assertNotIn('"stage":"read"', run.err)
        self.assertEqual(named(self.out.parent), ["out.las"])
        self.run_ok(*automatic[:3], self.path("whole.las"))
        self.assertEqual(harness.sha256(self.out), harness.sha256(self.path("whole.las")))

    def test_no_sentence_is_part_of_what_is_compared(self):
        self.refused(USAGE, "smooth", self.scan, "-o", self.out, "--buffer", 0.001)
        record = json.loads((self.out.parent / "out.las.work/job.json").read_text())
        self.assertEqual(record["version"], 2)
        for part in ("sorting", "parameters"):
            for key, value in record[part].items():
                self.assertNotEqual(key, "why")
                self.assertNotIn(" ", str(value) if isinstance(value, str) else "")


@needs_trace
class KilledAtTheEnd(Leaves):
    CALLS = "rename renameat2 unlink rmdir openat fsync".split()

    def count_calls(self, words, call):
        """How many calls of one kind a whole job makes."""
        log = self.path("calls")
        self.assertEqual(traced(f"{call}:delay_enter=0", words, log).returncode, DONE)
        return len(log.read_text().splitlines())

    def test_between_any_two_steps_the_same_command_ends_with_only_the_output(self):
        os.environ["XDG_STATE_HOME"], before = str(self.state), os.environ["XDG_STATE_HOME"]
        self.addCleanup(os.environ.__setitem__, "XDG_STATE_HOME", before)
        whole = self.path("whole.las")
        self.ok(*self.words(out=whole))
        kills = 0
        for call in self.CALLS:
            count = self.count_calls(self.words("--progress", "none"), call)
            for n in range(max(1, count - 14), count + 1):
                with self.subTest(f"{call} {n} of {count}"):
                    self.fresh("here")
                    self.fresh("state")
                    run = traced(f"{call}:signal=SIGKILL:when={n}",
                                 self.words("--progress", "none"))
                    kills += run.returncode != DONE
                    self.ok(*self.words("--progress", "none"))
                    self.assertEqual(harness.sha256(self.out), harness.sha256(whole))
                    self.assertEqual(named(self.out.parent), ["out.las"])
                    self.assertEqual(len(list(self.state.rglob("*"))), 2)
            self.fresh("here")
            self.fresh("state")
        self.assertGreater(kills, 30)
        print(f"{kills} kills at the end of a job")


@needs_trace
class Failed(Leaves):
    def test_a_call_that_fails_leaves_nothing_that_success_does_not_take_away(self):
        failed = 0
        for call in ("pwrite64", "rename", "fsync", "mkdir", "renameat2"):
            for n in range(1, 8):
                with self.subTest(f"{call} {n}"):
                    out = self.fresh("here") / ("out.pss" if call == "renameat2" else "out.las")
                    words = self.words("--progress", "none", out=out)
                    run = traced(f"{call}:error=EIO:when={n}", words)
                    failed += run.returncode == FAILED
                    if run.returncode == FAILED:
                        self.assertNotIn(".pss-part", " ".join(map(str, tree(out.parent))))
                    self.ok(*words)
                    self.assertEqual(named(out.parent), [out.name])
        self.assertGreater(failed, 15)

    def test_a_signal_at_any_call_of_the_beginning_leaves_no_lock(self):
        words = self.words("--report", self.out.parent / "r.json", "--progress", "none")
        interrupted = 0
        for n in range(1, 60, 2):
            self.fresh("here")
            run = traced(f"openat:signal=SIGTERM:when={n}", words)
            interrupted += run.returncode == harness.INTERRUPTED
            with self.subTest(f"openat {n}"):
                self.assertNotIn("pss-lock", " ".join(named(self.out.parent)))
        self.assertGreater(interrupted, 5)


if __name__ == "__main__":
    harness.main()
