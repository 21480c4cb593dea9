"""stdin, stdout and stderr that are closed, full or given up, and files that may not grow: the bytes
of the files stay right, and the exit code says what was delivered."""

import itertools
import os
import resource
import signal
import subprocess

import harness
from harness import BAD_INPUT, DONE, FAILED, USAGE, SystemTest

CANNOT_PRINT = "cannot write to stdout"


def run_with(words, closed=(), out=None, err=None, setup=lambda: None):
    """(exit code, stdout, stderr) of a pss that starts with some descriptors closed."""
    def before():
        # As a shell starts programs; Python itself ignores both signals.
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
        setup()
        for descriptor in closed:
            os.close(descriptor)

    pipe = subprocess.PIPE
    with subprocess.Popen([harness.PSS, *map(str, words)], stdin=subprocess.DEVNULL,
                          stdout=pipe if out is None else out, stderr=pipe if err is None else err,
                          preexec_fn=before) as process:
        texts = process.communicate()
    return process.returncode, *((text or b"").decode() for text in texts)


def combinations():
    """Every set of the three descriptors."""
    return (some for count in range(4) for some in itertools.combinations(range(3), count))


def pipe_without_reader():
    """The writing end of a pipe that nobody reads."""
    reader, writer = os.pipe()
    os.close(reader)
    return writer


class Streams(SystemTest):
    def setUp(self):
        super().setUp()
        self.scan = self.synth("scan.las", points=5000)
        self.store = self.path("store.pss")
        self.ok("tile", self.scan, "-o", self.store)

    def writers(self, name):
        """A command line that writes a file or store of this name, by command."""
        return {
            "smooth": (["smooth", self.scan, "-o", self.path(f"{name}.las"), "--h", 0.05],
                       f"{name}.las"),
            "tile": (["tile", self.scan, "-o", self.path(f"{name}.pss")], f"{name}.pss"),
            "convert": (["convert", self.scan, "-o", self.path(f"{name}.ply")], f"{name}.ply"),
            "export": (["export", self.store, "-o", self.path(f"{name}.xyz")], f"{name}.xyz"),
            "synth": (["synth", "sphere", "--points", 2000, "-o", self.path(f"{name}.csv")],
                      f"{name}.csv"),
        }

    def bytes_of(self, name):
        """The hash of a file, or of every file of a store."""
        path = self.path(name)
        files = sorted(path.iterdir()) if path.is_dir() else [path]
        return [harness.sha256(file) for file in files]

    def printers(self):
        """Command lines that print data."""
        return {
            "info": ["info", self.scan], "json": ["info", self.scan, "--json"],
            "verify": ["verify", self.store],
            "measure": ["synth", "torus", "--points", 5000, "--measure", self.scan],
            "dry run": ["smooth", self.scan, "-o", self.path("dry.las"), "--dry-run"],
            "help": ["--help"], "help of a command": ["tile", "--help"], "version": ["--version"],
        }

    def test_closed_descriptors_change_no_byte_of_a_file(self):
        for command, (words, name) in self.writers("whole").items():
            self.assertEqual(run_with(words)[0], DONE, command)
            expected = self.bytes_of(name)
            for number, closed in enumerate(combinations()):
                words, name = self.writers(f"closed{number}")[command]
                code, _, err = run_with(words, closed)
                with self.subTest(command=command, closed=closed):
                    # synth prints the true surface's parameters: data that are lost.
                    lost = command == "synth" and 1 in closed
                    self.assertEqual(code, FAILED if lost else DONE, err)
                    self.assertEqual(self.bytes_of(name), expected)

    def test_data_for_a_closed_stdout_are_a_failure_and_nothing_else_is(self):
        for command, words in self.printers().items():
            code, expected, _ = run_with(words)
            self.assertEqual(code, DONE)
            for closed in combinations():
                code, out, err = run_with(words, closed)
                with self.subTest(command=command, closed=closed):
                    self.assertEqual(code, FAILED if 1 in closed else DONE, err)
                    if 1 in closed and 2 not in closed:
                        self.assertIn(CANNOT_PRINT, err)
                    if 1 not in closed and command != "dry run":  # whose time is measured
                        self.assertEqual(out, expected)

    def test_data_that_a_full_disk_or_a_left_pipe_does_not_take_are_a_failure(self):
        for command, words in self.printers().items():
            for out, reason in ((open("/dev/full", "wb"), "No space left on device"),
                                (os.fdopen(pipe_without_reader(), "wb"), "Broken pipe")):
                with self.subTest(command=command, reason=reason), out:
                    code, _, err = run_with(words, out=out)
                    self.assertEqual(code, FAILED, err)
                    self.assertRegex(err.splitlines()[-1], f"^pss: {CANNOT_PRINT}: {reason}")

    def test_more_data_than_a_buffer_holds_fail_the_same_way(self):
        paths = [self.scan] * 300
        with open("/dev/full", "wb") as full:
            code, _, err = run_with(["info", *paths], out=full)
        self.assertEqual(code, FAILED)
        self.assertIn(CANNOT_PRINT, err)
        self.assertEqual(len(err.splitlines()), 1, err)

    def test_words_that_cannot_be_said_change_no_exit_code(self):
        lines = {
            DONE: ["convert", self.scan, "-o", self.path("out.las"), "--overwrite"],
            FAILED: ["convert", self.path("missing.las"), "-o", self.path("no.las")],
            USAGE: ["convert", self.scan, "-o", self.path("no.las"), "--scale", "none"],
            BAD_INPUT: ["info", harness.__file__],
        }
        for style in ("bar", "plain", "json", "none"):
            for code, words in lines.items():
                progress = [] if words[0] == "info" else ["--progress", style]
                for err in (open("/dev/full", "wb"), os.fdopen(pipe_without_reader(), "wb")):
                    with self.subTest(style=style, code=code, err=err.name), err:
                        self.assertEqual(run_with([*words, *progress], err=err)[0], code)

    def test_an_interruption_that_cannot_be_told_is_one(self):
        """A job stopped by a signal whose stderr has no reader ends with 130."""
        scan = self.synth("large.las", points=300000)
        words = ["smooth", scan, "-o", self.path("slow.las"), "--h", 0.2, "--progress", "plain"]
        process = subprocess.Popen([harness.PSS, *map(str, words)], stderr=pipe_without_reader())
        while not self.path("slow.las.work/runs").exists() and process.poll() is None:
            if self.path("slow.las.work/input.pss").exists():
                break
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(), harness.INTERRUPTED)


class FileSizeLimit(SystemTest):
    """ulimit -f: a sentence and exit code 1, and what is a job goes on."""

    LIMITS = (1 << 10, 20 << 10, 100 << 10, 300 << 10, 700 << 10, 1200 << 10)

    def limited(self, words, limit):
        def limit_it():
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        return run_with(words, setup=limit_it)

    def check(self, words, output, resumes):
        """At every limit: done, or refused in one sentence; afterwards the right bytes.

        Returns the refusals.
        """
        whole = self.path("whole" + output.suffix)
        self.ok(*words, "-o", whole)
        expected = harness.sha256(whole / "manifest" if whole.is_dir() else whole)
        refusals = []
        for limit in self.LIMITS:
            code, _, err = self.limited([*words, "-o", output], limit)
            with self.subTest(limit=limit):
                if code == FAILED:
                    refusals.append(err.splitlines()[-1])
                    self.assertRegex(refusals[-1], "^pss: .*File too large")
                    self.assertFalse(output.exists())
                else:
                    self.assertEqual(code, DONE, err)
                    break
        self.assertGreater(len(refusals), 2)
        if not output.exists():
            run = self.ok(*words, "-o", output)
            if resumes:
                self.assertNotIn("discard", run.err)
        self.assertEqual(harness.sha256(output / "manifest" if output.is_dir() else output),
                         expected)
        return refusals

    def test_smooth_says_which_file_in_every_stage_and_goes_on(self):
        scan = self.synth("scan.las", points=40000)
        for name in ("out.las", "out.pss"):
            refusals = self.check(["smooth", scan, "--h", 0.02, "--tile-points", 5000,
                                   "--outputs", "normals"], self.path(name), resumes=True)
            for file in ("/input.pss/", "/smooth.pss/"):
                self.assertTrue(any(file in refusal for refusal in refusals), refusals)
            if name == "out.las":
                self.assertNotIn(".work", refusals[-1])

    def test_tile_says_which_file_and_goes_on(self):
        self.check(["tile", self.synth("scan.las", points=60000)], self.path("out.pss"), True)

    def test_convert_export_and_synth_say_which_file(self):
        scan = self.synth("scan.las", points=40000)
        store = self.path("store.pss")
        self.ok("tile", scan, "-o", store)
        self.check(["convert", scan], self.path("out.ply"), False)
        self.check(["export", store], self.path("out.las"), False)
        self.check(["synth", "torus", "--points", 40000], self.path("out.xyz"), False)


if __name__ == "__main__":
    harness.main()
