"""Two processes, one OUTPUT: one of them writes it, the other is told who does; never a mix."""

import collections
import os
import random
import re
import signal
import time

import harness
from harness import DONE, FAILED, INTERRUPTED
from places import PlacesTest

# A long form by hand: PSS_TWO_STARTS=50 PSS_TWO_POINTS=200000
STARTS = int(os.environ.get("PSS_TWO_STARTS", 2))
POINTS = int(os.environ.get("PSS_TWO_POINTS", 30000))
HOST = os.uname().nodename


def identity(output):
    """What tells one right result from another: a file's bytes, or a store's rows."""
    if output.suffix != ".pss":
        return harness.sha256(output)
    run = harness.pss("verify", output)
    return re.search(r"rows +([0-9a-f]{32})", run.out)[1] if run.code == DONE else "damaged"


class TwoProcesses(PlacesTest):
    def setUp(self):
        super().setUp()
        self.random = random.Random(7)
        self.one = self.synth("one.las", points=POINTS)
        self.two = self.synth("two.las", "--seed", 2, points=POINTS)
        for name in ("one", "two"):
            self.ok("tile", self.path(f"{name}.las"), "-o", self.path(f"{name}.pss"))

    def pairs(self):
        """Two commands with different results each, and the name that both write."""
        radius = 4 * harness.torus_spacing(POINTS)
        smooth = {name: ["smooth", self.path(f"{name}.las"), "--radius", radius]
                  for name in ("one", "two")}
        tile = {name: ["tile", self.path(f"{name}.las")] for name in ("one", "two")}
        convert = {name: ["convert", self.path(f"{name}.las")] for name in ("one", "two")}
        export = {name: ["export", self.path(f"{name}.pss")] for name in ("one", "two")}
        synth = {name: ["synth", "torus", "--points", POINTS, "--seed", seed]
                 for name, seed in (("one", 3), ("two", 4))}
        yield "smooth", "out.las", smooth["one"], smooth["two"]
        yield "smooth to a store", "out.pss", smooth["one"], smooth["two"]
        yield "tile", "out.pss", tile["one"], tile["two"]
        yield "convert", "out.ply", convert["one"], convert["two"]
        yield "export", "out.ply", export["one"], export["two"]
        yield "synth", "out.las", synth["one"], synth["two"]
        yield "convert and export", "out.las", convert["one"], export["two"]
        yield "smooth and convert", "out.las", smooth["one"], convert["two"]
        yield "tile and smooth", "out.pss", tile["one"], smooth["two"]
        yield "synth and export", "out.ply", synth["one"], export["two"]

    def alone(self, output, words):
        """The result of a command that nobody disturbs, and how long it takes."""
        out = self.fresh("alone") / output
        run = self.ok(*words, "-o", out)
        return identity(out), run.seconds

    def started(self, commands, seconds, more=()):
        """Both commands, begun within the time that one takes, in any order."""
        first, second = self.random.sample(range(2), 2)
        processes = {first: harness.start(*commands[first], *more)}
        time.sleep(self.random.choice([0, self.random.uniform(0, seconds)]))
        processes[second] = harness.start(*commands[second], *more)
        return [processes[0], processes[1]]

    def left(self, out):
        return sorted(path.name for path in out.parent.iterdir())

    def judge_loser(self, run, winner, told):
        """The loser named the winner, or came when the output was there already."""
        self.assertEqual(run.code, FAILED, run.err)
        names = f"process {winner.pid} on {HOST}" in run.err
        self.assertTrue(names or "exists; use --overwrite" in run.err, run.err)
        told["named" if names else "came late"] += 1

    def once(self, out, commands, expected, seconds, told):
        self.fresh("here")
        processes = self.started(commands, seconds)
        runs = [harness.finish(process) for process in processes]
        winners = [i for i in range(2) if runs[i].code == DONE]
        self.assertEqual(len(winners), 1, [run.err for run in runs])
        winner = winners[0]
        self.judge_loser(runs[1 - winner], processes[winner], told)
        self.assertEqual(identity(out), expected[winner])
        self.assertEqual(self.left(out), [out.name])

    def each_pair(self):
        for name, output, *words in self.pairs():
            out = self.path("here") / output
            results = [self.alone(output, w) for w in words]
            self.assertNotEqual(results[0][0], results[1][0])
            commands = [[*w, "-o", out, "--progress", "none"] for w in words]
            yield name, out, commands, [r[0] for r in results], max(r[1] for r in results)

    def test_of_two_starts_one_writes_the_output_and_the_other_says_who_does(self):
        for name, out, commands, expected, seconds in self.each_pair():
            told = collections.Counter()
            with self.subTest(name):
                for _ in range(STARTS):
                    self.once(out, commands, expected, seconds, told)
            print(f"{name}: {STARTS} starts of two, no mix, {dict(told)}", flush=True)

    def test_with_overwrite_the_output_is_one_of_the_two_results(self):
        for name, out, commands, expected, seconds in self.each_pair():
            with self.subTest(name):
                for _ in range(STARTS):
                    self.fresh("here")
                    runs = [harness.finish(process)
                            for process in self.started(commands, seconds, ["--overwrite"])]
                    done = [expected[i] for i in range(2) if runs[i].code == DONE]
                    self.assertTrue(done, [run.err for run in runs])
                    self.assertIn(identity(out), done)
                    self.assertEqual(self.left(out), [out.name])

    def killed(self, out, commands, expected, seconds, number, codes):
        """One of two is ended by a signal at any time; the other goes on, or runs again."""
        self.fresh("here")
        victim = self.random.randrange(2)
        processes = self.started(commands, seconds / 2)
        time.sleep(self.random.uniform(0, seconds))
        if not harness.ended(processes[victim]):
            harness.signal_to(processes[victim], number)
        runs = [harness.finish(process) for process in processes]
        codes[runs[victim].code] += 1
        self.assertIn(runs[victim].code, (DONE, FAILED, INTERRUPTED, -number), runs[victim].err)
        other = runs[1 - victim]
        self.assertIn(other.code, (DONE, FAILED), other.err)
        for i in range(2):
            if runs[i].code == DONE:
                self.assertEqual(identity(out), expected[i])
        if not out.exists():
            self.go_on(commands[1 - victim], commands[victim])
            self.assertIn(identity(out), expected)
        work = out.name + ".work"  # of a job that was ended, from which it would go on
        resumable = runs[victim].code in (INTERRUPTED, -number)
        self.assertLessEqual(set(self.left(out)), {out.name} | ({work} if resumable else set()))

    def go_on(self, command, interrupted):
        """The other command; where the one that was ended left work, a job that goes on."""
        run = harness.pss(*command)
        if run.code == FAILED and "another job" in run.err:
            run = harness.pss(*interrupted)
        self.assertEqual(run.code, DONE, run.err)

    def test_the_end_of_one_harms_nothing_of_the_other(self):
        for name, out, commands, expected, seconds in self.each_pair():
            codes = collections.Counter()
            with self.subTest(name):
                for number in (signal.SIGTERM, signal.SIGKILL):
                    for _ in range(STARTS):
                        self.killed(out, commands, expected, seconds, number, codes)
            print(f"{name}: {2 * STARTS} ended by signals, {dict(codes)}", flush=True)

    def test_a_stopped_process_keeps_its_output_and_is_named(self):
        for name, out, commands, expected, seconds in self.each_pair():
            with self.subTest(name):
                self.fresh("here")
                holder = harness.start(*commands[0])
                while not any(out.parent.iterdir()):
                    time.sleep(0.0005)
                time.sleep(0.002)
                harness.signal_to(holder, signal.SIGSTOP)
                run = harness.pss(*commands[1])
                self.assertEqual(run.code, FAILED, run.err)
                self.assertRegex(run.err, f"process {holder.pid} on {HOST}|exists")
                harness.signal_to(holder, signal.SIGCONT)
                self.assertEqual(harness.finish(holder).code, DONE)
                self.assertEqual(identity(out), expected[0])


if __name__ == "__main__":
    harness.main()
