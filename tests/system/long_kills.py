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
ESTIMATE = 0.6  # seconds a kill takes, by those of an undisturbed run with two threads
LIMITS = ["128M", "192M", "1G"]
STAGES = ["start", "sort", "merge", "spacing", "normals", "smooth", "write", "end"]


def stage_of(work):
    """In which stage a job was killed, by what it left."""
    try:
        complete = json.loads((work / "job.json").read_text())["complete"]
    except FileNotFoundError:
        return "end" if (work.parent / "out.las").exists() else "start"
    if complete:
        return "end" if (work.parent / "out.las").exists() else "start"
    if any(work.parent.glob(".out.las.*.pss-part")):
        return "write"
    for name, stage in (("smooth.pss", "smooth"), ("normals.pss", "normals")):
        if (work / name / "manifest").exists():
            return "write" if stage == "smooth" else "smooth"
        if (work / name / "manifest.log").exists():
            return stage
    if (work / "input.pss" / "manifest").exists():
        return "spacing"
    return "merge" if (work / "input.pss").exists() else "sort"


class Kills:
    """Every job is killed up to three times, then it runs to its end: half of the kills fall at any
    time, half into any stage, so that short ones have their share; or into `stages`."""

    def __init__(self, folder, points, stages):
        self.random = random.Random(2026)
        self.folder = folder
        self.targets = stages
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

    def start(self):
        return harness.start(*self.words(
            self.out, "--threads", self.random.choice(THREADS),
            "--memory-limit", self.random.choice(LIMITS)))

    def one(self):
        """Starts the job and kills it after a while, unless it is done before."""
        job = self.start()
        self.wait(job)
        if not harness.ended(job):
            harness.signal_to(job, signal.SIGKILL)
        self.judge(harness.finish(job))

    def judge(self, run):
        """Whether the job came to its end."""
        if run.code == -signal.SIGKILL:
            self.stages[stage_of(self.work)] += 1
        elif run.code == harness.DONE:
            self.complete()
        else:
            sys.exit(f"after {sum(self.stages.values())} kills: exit {run.code}: {run.err}")
        return run.code == harness.DONE

    def wait(self, job):
        """Until a random time of the whole job, or a random moment of a stage."""
        if not self.targets and self.random.random() < 0.5:
            time.sleep(self.seconds * self.random.random())
            return
        target = self.random.choice(self.targets or STAGES)
        while not harness.ended(job) and STAGES.index(stage_of(self.work)) < STAGES.index(target):
            time.sleep(0.0005)
        time.sleep(self.seconds / 8 * 10 ** -self.random.uniform(0, 3))

    def complete(self):
        found = harness.sha256(self.out)
        if found != self.expected:
            sys.exit(f"other bytes after {sum(self.stages.values())} kills: {found}")
        self.completions += 1
        self.out.unlink()
        # The next job starts from nothing: what this one left belongs to a lost output.

    def finish(self):
        """Lets the job end, with threads and a limit of chance."""
        if not self.judge(harness.finish(self.start())):
            sys.exit("killed by somebody else")

    def run_all(self, kills):
        """Jobs with a few kills each until there were enough."""
        while (done := sum(self.stages.values())) < kills:
            before = self.completions
            for _ in range(self.random.randint(1, 3)):
                if self.completions == before and sum(self.stages.values()) < kills:
                    self.one()
            if self.completions == before:
                self.finish()
            if sum(self.stages.values()) // 50 > done // 50:
                print(f"{sum(self.stages.values())} kills, {self.completions} completions",
                      flush=True)

    def told(self):
        return ", ".join(f"{self.stages[stage]} in {stage}" for stage in STAGES)


def main(kills, points, stages):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="pss-kills-"))
    try:
        job = Kills(folder, points, stages)
        print(f"{points} points, {job.seconds:.1f} s undisturbed, SHA-256 {job.expected[:16]}; "
              f"about {kills * job.seconds * ESTIMATE / 60:.0f} minutes", flush=True)
        began = time.monotonic()
        job.run_all(kills)
        print(f"{kills} kills ({job.told()}), {job.completions} results, "
              f"all with the same SHA-256, in {time.monotonic() - began:.0f} s")
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3:])
