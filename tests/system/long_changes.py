"""Inputs replaced, grown, shrunk and overwritten at random moments of reading: scripts/long-changes.

What must come of each: exit 1 with a sentence and nothing under OUTPUT, or what an undisturbed run
makes of the file as it was.
"""

import collections
import os
import pathlib
import random
import re
import shutil
import signal
import sys
import tempfile
import time

import harness

COMMANDS = ["smooth", "tile", "convert"]
FORMATS = ["las", "ply", "xyz"]
LONG_AGO_NS = 1_000_000_000_123_456_789  # since 1970
# What is written where: convert always writes another format than it reads.
CONVERTED = {"las": "out.ply", "ply": "out.las", "xyz": "out.las"}


def replaced(scan, other, _rng):
    """As editors and rsync do: another file of the same size or nearly takes the name."""
    new = scan.with_name("new" + scan.suffix)
    shutil.copyfile(other, new)
    new.rename(scan)


def grown(scan, other, _rng):
    """As loggers do: more of the same at the end, in a few steps."""
    more = other.read_bytes()[-(200 << 10):]
    with open(scan, "ab", buffering=0) as file:
        for at in range(0, len(more), 64 << 10):
            file.write(more[at : at + (64 << 10)])


def shrunk(scan, _other, rng):
    os.truncate(scan, rng.randrange(scan.stat().st_size))


def overwritten(scan, other, rng):
    """From anywhere on, as cp does it, without emptying the file first; the size stays."""
    size = scan.stat().st_size
    at = rng.randrange(size)
    with open(scan, "r+b", buffering=0) as to, open(other, "rb") as source:
        to.seek(at)
        source.seek(at)
        while piece := source.read(min(64 << 10, size - to.tell())):
            to.write(piece)


CHANGES = {change.__name__: change for change in (replaced, grown, shrunk, overwritten)}


def has_open(process, path):
    """Whether a process has a file open, or one in a folder."""
    folder = pathlib.Path(f"/proc/{process.pid}/fd")
    try:
        links = [os.readlink(entry) for entry in folder.iterdir()]
    except OSError:  # it has just closed one, or ended
        return False
    return any(link == str(path) or link.startswith(f"{path}/") for link in links)


def wait_until_open(process, path):
    while not has_open(process, path) and not harness.ended(process):
        pass


class Changes:
    """Trials of each command on each format, with a fresh copy of a scan each time."""

    def __init__(self, folder, points, seed=8):
        self.folder = folder
        self.points = points
        self.random = random.Random(seed)
        self.outcomes = collections.Counter()
        self.expected = {}
        self.seconds = {}
        for name, number in (("old", 1), ("other", 2)):
            las = folder / f"{name}.las"
            self.run("synth", "torus", "-o", las, "--points", points, "--noise", "0.2", "--seed", number)
            for other in FORMATS[1:]:
                self.run("convert", las, "-o", folder / f"{name}.{other}")

    def run(self, *words):
        run = harness.pss(*words)
        if run.code != harness.DONE:
            sys.exit(f"{words}\n{run.err}")
        return run

    def words(self, command, extension):
        common = [command, self.folder / f"scan.{extension}", "-o", self.output(command, extension)]
        if command == "convert":
            return [*common, "--progress", "none"]
        common += ["--progress", "none", "--threads", self.random.choice([1, 2]), "--memory-limit",
                   self.random.choice(["96M", "1G"])]
        if command == "smooth":
            common += ["--radius", 2.5 * harness.torus_spacing(self.points), "--degree", "1"]
        return common

    def output(self, command, extension):
        name = {"smooth": "out.las", "tile": "out.pss", "convert": CONVERTED[extension]}[command]
        return self.folder / name

    def identity(self, output):
        """What tells one result from another: of a store, the hash of its rows."""
        if output.suffix != ".pss":
            return harness.sha256(output)
        return re.search(r"\b[0-9a-f]{32}\b", self.run("verify", output).out).group()

    def clear(self):
        for path in self.folder.glob("out.*"):
            shutil.rmtree(path) if path.is_dir() else path.unlink()

    def prepare(self, extension):
        """Half of the scans were written just now, the others long ago."""
        self.clear()
        scan = self.folder / f"scan.{extension}"
        shutil.copyfile(self.folder / f"old.{extension}", scan)
        if self.random.random() < 0.5:
            os.utime(scan, ns=(LONG_AGO_NS, LONG_AGO_NS))

    def undisturbed(self, command, extension):
        """The bytes of an undisturbed run, and how long it has its input open now and then."""
        if (command, extension) in self.expected:
            return
        self.prepare(extension)
        scan = self.folder / f"scan.{extension}"
        job = harness.start(*self.words(command, extension))
        wait_until_open(job, scan)
        first = last = time.monotonic()
        while not harness.ended(job):
            if has_open(job, scan):
                last = time.monotonic()
        run = harness.finish(job)
        if run.code != harness.DONE:
            sys.exit(f"{command} {extension}: exit {run.code}: {run.err}")
        self.expected[command, extension] = self.identity(self.output(command, extension))
        self.seconds[command, extension] = last - first

    def one(self, command, change, extension):
        """One run that is disturbed once; half of them stand still meanwhile. How it ended."""
        self.undisturbed(command, extension)
        self.prepare(extension)
        scan = self.folder / f"scan.{extension}"
        job = harness.start(*self.words(command, extension))
        wait_until_open(job, scan)
        time.sleep(1.1 * self.seconds[command, extension] * self.random.random())
        still = self.random.random() < 0.5 and not harness.ended(job)
        if still:
            harness.signal_to(job, signal.SIGSTOP)
        CHANGES[change](scan, self.folder / f"other.{extension}", self.random)
        if still:
            harness.signal_to(job, signal.SIGCONT)
        outcome = self.judged(harness.finish(job), self.output(command, extension), scan,
                              self.expected[command, extension])
        self.outcomes[command, change, outcome] += 1
        return outcome

    def judged(self, run, output, scan, expected):
        if run.code == harness.DONE and self.identity(output) == expected:
            return "old"
        if run.code == harness.FAILED and f"{scan}: changed while it was read" in run.err:
            return "left something" if output.exists() else "refused"
        return f"exit {run.code}: {run.err.strip() or 'other bytes'}"

    def told(self):
        lines = []
        for command in dict.fromkeys(command for command, _, _ in self.outcomes):
            for change in CHANGES:
                ends = {outcome: n for (c, k, outcome), n in sorted(self.outcomes.items())
                        if (c, k) == (command, change)}
                lines.append(f"{command:8} {change:12} {ends.pop('refused', 0):4} exit 1  "
                             f"{ends.pop('old', 0):4} the old file's bytes  {ends or 'none otherwise'}")
        return "\n".join(lines)

    def wrong(self):
        return [outcome for _, _, outcome in self.outcomes if outcome not in ("refused", "old")]


def main(trials, points, commands):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="pss-changes-"))
    try:
        began = time.monotonic()
        changes = Changes(folder, points)
        for command in commands:
            for change in CHANGES:
                for trial in range(trials):
                    changes.one(command, change, FORMATS[trial % len(FORMATS)])
                print(f"{command} {change}: {time.monotonic() - began:.0f} s", flush=True)
        print(changes.told())
        sys.exit(1 if changes.wrong() else 0)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3:] or COMMANDS)
