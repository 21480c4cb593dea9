"""What the tests of names and places share: whole trees compared, every writing command, calls traced."""

import os
import pathlib
import shutil
import stat
import subprocess
import unittest

import harness
from harness import SystemTest


def content(path):
    """What one name is: its kind, and its bytes, target or inode."""
    status = path.lstat()
    if stat.S_ISLNK(status.st_mode):
        return "link", os.readlink(path)
    if stat.S_ISREG(status.st_mode):
        return "file", harness.sha256(path), status.st_mtime_ns
    return stat.S_IFMT(status.st_mode), status.st_ino


def tree(folder):
    """Every name below a folder with what it is."""
    return {str(path.relative_to(folder)): content(path) for path in pathlib.Path(folder).rglob("*")}


def named(folder):
    return sorted(path.name for path in folder.iterdir())


def kinds(theirs):
    """Ways in which somebody's thing can have a name, each as a function that puts it there; what
    links lead to lies in the folder `theirs`."""
    target = theirs / "notes.txt"
    target.write_text("somebody's notes\n")

    def folder(at):
        at.mkdir()
        (at / "inside").write_text("inside\n")

    return {
        "file": lambda at: at.write_text("somebody's\n"),
        "link": lambda at: at.symlink_to(target),
        "link to nothing": lambda at: at.symlink_to(theirs / "nothing"),
        "link to a folder": lambda at: at.symlink_to(theirs),
        "hard link": lambda at: os.link(target, at),
        "folder": folder,
        "pipe": os.mkfifo,
    }


class PlacesTest(SystemTest):
    """A scan, a store of it, and every command that writes, on them."""

    def setUp(self):
        super().setUp()
        self.scan = self.synth("scan.las", points=300)
        self.store = self.path("scan.pss")
        self.ok("tile", self.scan, "-o", self.store)
        self.theirs = self.path("theirs")
        self.theirs.mkdir()

    def commands(self):
        """Each command's name, the name of its output, its words without that."""
        return [
            ("smooth", "out.las", ["smooth", self.scan, "--radius", 0.5]),
            ("smooth to a store", "out.pss", ["smooth", self.scan, "--radius", 0.5]),
            ("tile", "out.pss", ["tile", self.scan]),
            ("convert", "out.ply", ["convert", self.scan]),
            ("export", "out.las", ["export", self.store]),
            ("synth", "out.las", ["synth", "torus", "--points", 300]),
        ]

    def fresh(self, name):
        """An empty folder."""
        folder = self.path(name)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        return folder

    def sound(self, output):
        """Whether an output is there and whole: a store, or a file of 300 points."""
        if output.suffix == ".pss":
            return harness.pss("verify", output).code == harness.DONE
        reader = harness.Las if output.suffix == ".las" else harness.Ply
        return reader(output).count == 300

    def sorted_only(self, out, *more):
        """Leaves a job that has sorted its input, and found only then that it cannot go on."""
        self.refused(harness.USAGE, "smooth", self.scan, "-o", out, "--buffer", 0.001, *more,
                     says=["--buffer"])


class Leaves(PlacesTest):
    """Jobs with a state folder of their own."""

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


def traced(inject, words, log=os.devnull):
    """Runs pss with a fault injected by strace."""
    command = ["strace", "-f", "-qq", "-o", log, "-e", f"trace={inject.split(':')[0]}",
               "-e", f"inject={inject}", harness.PSS, *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True)


def can_trace():
    if not shutil.which("strace"):
        return False
    return subprocess.run(["strace", "-qq", "-o", os.devnull, "true"]).returncode == 0


needs_trace = unittest.skipUnless(can_trace(), "strace is missing or may not trace")


def mount(*words):
    """Whether the system lets this process mount so."""
    return subprocess.run(["mount", *map(str, words)], capture_output=True).returncode == 0


def unmount(folder):
    subprocess.run(["umount", str(folder)], check=False)
