"""Names that are not UTF-8, very long, or full of odd characters: jobs resume and are known again."""

import json
import os
import pathlib

import harness
from harness import DONE, FAILED, USAGE
from places import PlacesTest

ODD = [b"100%.las", b"%s%n.las", b"a b .las", b"new\nline.las", b"tab\t.las", b"quo'te\".las",
       b"back\\slash.las", b"{}.las", b"$HOME.las", b"`x`.las", b";x.las", "\u00e9\u4e2d.las".encode(),
       b"\xff\xfe.las", b"caf\xe9.las", b"x\x01.las", b"...las", b"a[1]?*.las", b"@at.las"]


def path(folder, name):
    return pathlib.Path(os.fsdecode(os.fsencode(folder) + b"/" + name))


class Names(PlacesTest):
    def job(self, scan, out, *more):
        return ["smooth", scan, "-o", out, *more]

    def left(self, folder):
        return sorted(os.listdir(os.fsencode(folder)))

    def goes_on(self, scan, out, *more):
        """A job that stops after sorting goes on, and is known again when it is done."""
        self.refused(USAGE, *self.job(scan, out, "--buffer", 0.001, *more))
        run = self.ok(*self.job(scan, out, "--progress", "json", *more))
        self.assertNotIn('"stage":"read"', run.err)
        self.assertIn("already complete", self.ok(*self.job(scan, out, *more)).err)

    def test_odd_names_of_input_and_output_go_on_and_are_known_again(self):
        for name in ODD:
            with self.subTest(name):
                here = self.fresh("here")
                scan, out = path(self.fresh("in"), name), path(here, name)
                scan.write_bytes(self.scan.read_bytes())
                self.goes_on(scan, out)
                self.assertEqual(self.left(here), [name])

    def test_odd_names_of_folders_and_work_directories(self):
        for name in ODD:
            with self.subTest(name):
                here = path(self.fresh("here"), name)
                here.mkdir()
                scan, out, work = here / "in.las", here / "out.las", path(self.path("here"), b"w" + name)
                scan.write_bytes(self.scan.read_bytes())
                self.goes_on(scan, out, "--work-dir", work)
                json.loads((work / "job.json").read_bytes())  # is UTF-8
                self.ok("info", work)

    def test_two_names_that_differ_in_bytes_that_are_not_utf8_are_two_files(self):
        scans = [path(self.fresh("here"), b"\xff.las"), path(self.path("here"), b"\xfe.las")]
        for scan in scans:
            scan.write_bytes(self.scan.read_bytes())
            os.utime(scan, ns=(5, 5))
        out = self.path("out.las")
        self.refused(USAGE, *self.job(scans[0], out, "--buffer", 0.001))
        self.refused(FAILED, *self.job(scans[1], out), says=["another job", "input"])
        self.ok(*self.job(scans[0], out))
        self.refused(FAILED, *self.job(scans[1], out), says=["--overwrite"])

    def test_every_command_writes_names_that_are_not_utf8(self):
        for name, output, words in self.commands():
            with self.subTest(name):
                here = self.fresh("here")
                out = path(here, b"\xff\n%" + output.encode())
                self.ok(*words, "-o", out, "--progress", "none")
                self.assertEqual(len(self.left(here)), 1)

    def test_reports_of_odd_names_are_json(self):
        for name in ODD:
            with self.subTest(name):
                out = path(self.fresh("here"), name)
                report = path(self.fresh("reports"), name)
                for _ in range(2):
                    self.ok(*self.job(self.scan, out, "--report", report))
                    json.loads(report.read_bytes())

    def test_names_up_to_the_longest_work_or_are_refused_before_the_work(self):
        for length in (200, 201, 229, 230, 245, 246, 249, 250, 251, 254, 255, 256):
            for command, output, words in self.commands():
                with self.subTest(f"{command} {length}"):
                    here = self.fresh("here")
                    name = "n" * (length - len(output)) + output
                    words = [*words, "-o", here / name]
                    run = harness.pss(*words, "--progress", "json")
                    if run.code != DONE:
                        self.assertGreater(length, 250 if words[0] in ("smooth", "tile") else 255)
                        self.assertEqual(run.code, FAILED, run.err)
                        self.assertNotIn('"stage"', run.err)
                        self.assertIn(name, run.err)
                        self.assertEqual(self.left(here), [])
                        if words[0] in ("smooth", "tile") and length <= 255:
                            self.ok(*words, "--work-dir", here / "w")
                            self.assertEqual(len(self.left(here)), 2)
                    else:
                        self.assertEqual(self.left(here), [os.fsencode(name)])

    def test_two_long_names_that_begin_alike_do_not_share_a_lock(self):
        here = self.fresh("here")
        names = ["n" * 240 + end + ".las" for end in "ab"]
        locks = set()
        for name in names:
            run = harness.pss("synth", "torus", "--points", 300, "-o", here / name)
            self.assertEqual(run.code, DONE, run.err)
        jobs = [harness.start("synth", "torus", "--points", 300000, "--overwrite", "-o", here / name)
                for name in names]
        while not all(harness.ended(job) for job in jobs):
            locks |= {name for name in os.listdir(here) if name.endswith(".pss-lock")}
        self.assertEqual([harness.finish(job).code for job in jobs], [DONE, DONE])
        self.assertEqual(len(locks), 2)

    def test_a_leading_dash_needs_no_more_than_a_folder_before_it(self):
        here = self.fresh("here")
        (here / "-s.las").write_bytes(self.scan.read_bytes())
        self.ok("smooth", "./-s.las", "-o", "./-x.las", cwd=here)
        self.ok("smooth", "./-s.las", "-o", "./-x.las", cwd=here)
        self.ok("convert", "./-s.las", "-o", "./-y.ply", cwd=here)
        self.assertEqual(self.left(here), [b"-s.las", b"-x.las", b"-y.ply"])


if __name__ == "__main__":
    harness.main()
