"""What is left beside OUTPUT: nothing after success or a refusal, else what the same command needs."""

import json
import os
import shutil
import struct

import harness
from harness import BAD_INPUT, DONE, FAILED, MEMORY_LIMIT, USAGE
from places import PlacesTest, needs_trace, traced, tree


def named(folder):
    return sorted(path.name for path in folder.iterdir())


class Leaves(PlacesTest):
    def setUp(self):
        super().setUp()
        self.out = self.fresh("here") / "out.las"
        self.state = self.fresh("state")
        self.environment = {**os.environ, "XDG_STATE_HOME": str(self.state)}

    def words(self, *more, scan=None, out=None):
        return ["smooth", scan or self.scan, "-o", out or self.out, "--radius", 0.5, *more]

    def run_ok(self, *words):
        return self.ok(*words, env=self.environment)

    def complete(self, *words):
        """Whether a job finds that all is done."""
        run = self.run_ok(*words)
        return "already complete" in run.err

    def refused_here(self, code, *words, says=()):
        """Refused with nothing changed beside OUTPUT."""
        before = tree(self.out.parent)
        self.refused(code, *words, says=says, env=self.environment)
        self.assertEqual(tree(self.out.parent), before)


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
        self.assertEqual(record["version"], 1)
        for part in ("sorting", "parameters"):
            for key, value in record[part].items():
                self.assertNotEqual(key, "why")
                self.assertNotIn(" ", str(value) if isinstance(value, str) else "")


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


@needs_trace
class KilledAtTheEnd(Leaves):
    CALLS = "rename renameat2 unlink rmdir openat fsync".split()

    def last_calls(self, words, call):
        """The numbers of the calls of one kind from the renaming of OUTPUT's record on."""
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
            count = self.last_calls(self.words("--progress", "none"), call)
            for n in range(max(1, count - 14), count + 1):
                with self.subTest(f"{call} {n} of {count}"):
                    self.fresh("here")
                    self.fresh("state")
                    run = traced(f"{call}:signal=SIGKILL:when={n}", self.words("--progress", "none"))
                    kills += run.returncode != DONE
                    self.ok(*self.words("--progress", "none"))
                    self.assertEqual(harness.sha256(self.out), harness.sha256(whole))
                    self.assertEqual(named(self.out.parent), ["out.las"])
                    self.assertEqual(len(list(self.state.rglob("*"))), 2)
            self.fresh("here")
            self.fresh("state")
        self.assertGreater(kills, 30)
        print(f"{kills} kills at the end of a job")


if __name__ == "__main__":
    harness.main()
