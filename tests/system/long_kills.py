"""Random SIGKILLs at any time and in any stage of a job, until it has survived: scripts/long-kills."""

import collections
import json
import pathlib
import random
import shutil
import signal
import sys
import tempfile
import time

import harness

THREADS = [1, 2]
LIMITS = ["128M", "192M", "1G"]
STAGES = ["start", "ingest", "merge", "widths", "normals", "smooth", "export", "end"]


def stage_of(work):
    """In which stage a job was killed, by what it left."""
    try:
        complete = json.loads((work / "job.json").read_text())["complete"]
    except FileNotFoundError:
        return "start"
    if complete:
        return "end" if (work.parent / "out.las").exists() else "start"
    for name, stage in (("result.pss", "smooth"), ("normals.pss", "normals")):
        if (work / name / "manifest").exists():
            return "export" if stage == "smooth" else "smooth"
        if (work / name / "manifest.log").exists():
            return stage
    if (work / "input.pss" / "manifest").exists():
        return "widths"
    return "merge" if (work / "input.pss").exists() else "ingest"


class Kills:
    def __init__(self, folder, points):
        self.random = random.Random(2026)
        self.folder = folder
        self.scan = folder / "scan.las"
        self.out = folder / "out.las"
        self.work = folder / "out.las.work"
        self.stages = collections.Counter()
        self.completions = 0
        self.run("synth", "torus", "-o", self.scan, "--noise", "0.2", "--points", points)
        self.tile_points = max(300, points // 60)
        whole = self.run(*self.words(folder / "whole.las", "--threads", 2))
        self.seconds = whole.seconds
        self.expected = harness.sha256(folder / "whole.las")

    def run(self, *words):
        run = harness.pss(*words)
        if run.code != harness.DONE:
            sys.exit(f"{words}\n{run.err}")
        return run

    def words(self, out, *more):
        return ["smooth", self.scan, "-o", out, "--operator", "apss", "--tile-points",
                self.tile_points, "--progress", "none", *more]

    def one(self):
        """Starts the job and kills it after a while, unless it is done before."""
        job = harness.start(*self.words(
            self.out, "--threads", self.random.choice(THREADS),
            "--memory-limit", self.random.choice(LIMITS)))
        self.wait(job)
        if not harness.ended(job):
            harness.signal_to(job, signal.SIGKILL)
        run = harness.finish(job)
        if run.code == -signal.SIGKILL:
            self.stages[stage_of(self.work)] += 1
        elif run.code == harness.DONE:
            self.complete()
        else:
            sys.exit(f"after {sum(self.stages.values())} kills: exit {run.code}: {run.err}")

    def wait(self, job):
        """Until a random time, or a random moment of a random stage that is still to come."""
        if self.random.random() < 0.5:
            time.sleep(self.seconds * self.random.choice([0.05, 0.2, 0.6]) * self.random.random())
            return
        target = self.random.choice(STAGES)
        while not harness.ended(job) and STAGES.index(stage_of(self.work)) < STAGES.index(target):
            time.sleep(0.0005)
        time.sleep(self.random.random() * 0.02)

    def complete(self):
        found = harness.sha256(self.out)
        if found != self.expected:
            sys.exit(f"other bytes after {sum(self.stages.values())} kills: {found}")
        self.completions += 1
        self.out.unlink()
        # The next job starts from nothing: what this one left belongs to a lost output.

    def finish(self):
        run = harness.pss(*self.words(self.out))
        if run.code != harness.DONE:
            sys.exit(run.err)
        self.complete()


def main(kills, points):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="pss-kills-"))
    try:
        job = Kills(folder, points)
        print(f"{points} points, {job.seconds:.1f} s undisturbed, SHA-256 {job.expected[:16]}",
              flush=True)
        began = time.monotonic()
        while sum(job.stages.values()) < kills:
            job.one()
            done = sum(job.stages.values())
            if done and done % 50 == 0 and time.monotonic() - began > 20:
                print(f"{done} kills, {job.completions} completions", flush=True)
        job.finish()
        where = ", ".join(f"{n} in {stage}" for stage, n in job.stages.most_common())
        print(f"{kills} kills ({where}), {job.completions} completions, "
              f"all with the same SHA-256, in {time.monotonic() - began:.0f} s")
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
