"""What the benchmarks of whole jobs share: a scan, pss run and watched, its result checked."""

import collections
import hashlib
import json
import math
import os
import pathlib
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
PSS = os.environ.get("PSS_BINARY", str(ROOT / "build/release/pss"))

MAJOR, MINOR, NOISE = 1.0, 0.4, 0.1  # the default torus of pss synth; noise in spacings
RECORD = 20  # bytes of a LAS record without time
POLL = 0.1  # seconds
# What a smoothed point keeps of the noise: C sigma s / h (docs/algorithm.md), C of order 2 and 3.
NOISE_CONSTANT = 0.631

# The names that the program's report gives to what its progress calls stages.
STAGES = {"read": "sort", "merge runs": "sort", "merge": "sort", "spacing": "widths",
          "smooth": "smooth", "write": "write"}
REPORTED = {"sort": "ingest", "widths": "spacing", "smooth": "smooth", "write": "write"}


def build(*targets):
    """The program in release, and other targets, unless PSS_BINARY says which to take."""
    if "PSS_BINARY" in os.environ:
        return
    for words in (["cmake", "--preset", "release"],
                  ["cmake", "--build", "--preset", "release", "-j", str(os.cpu_count()),
                   "--target", "pss", *targets]):
        subprocess.run(words, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)


def spacing(points):
    return math.sqrt(4 * math.pi**2 * MAJOR * MINOR / points)


def count_of(text):
    """10M, 1e9, 500k."""
    factor = {"k": 10**3, "M": 10**6, "G": 10**9}.get(text[-1:], 1)
    return int(float(text[:-1] if factor > 1 else text) * factor)


def count_text(points):
    for factor, unit in ((10**9, "G"), (10**6, "M"), (10**3, "k")):
        if points >= factor:
            return f"{points / factor:g} {unit}"
    return str(points)


def check_disk(folder, points, kept=0):
    """Ends the program where the disk is too small, with so many results kept beside a job.

    A point takes 20 bytes in the scan, about 9 in the sorted input, as many in the runs it is made
    from and 12 in the result; then 20 in the file that is written while the result is there.
    """
    needed = (52 + kept * RECORD) * points + 10**9
    free = shutil.disk_usage(folder).free + sum(
        path.stat().st_size for path in folder.glob("scan-*.las"))
    print(f"{count_text(points)} points: {needed / 1e9:.1f} GB of disk needed, "
          f"{free / 1e9:.1f} GB free in {folder}", flush=True)
    if free < needed:
        sys.exit("the disk is too small: make room, name another folder or ask for fewer points")


def make_scan(folder, points):
    """A noisy torus in random order; what is there whole is taken. Returns path and seconds."""
    path = folder / f"scan-{points}.las"
    if path.exists():
        return path, None
    began = time.monotonic()
    subprocess.run([PSS, "synth", "torus", "--points", str(points), "--noise", str(NOISE),
                    "--no-time", "-o", path, "--progress", "none"], check=True,
                   stdout=subprocess.DEVNULL)
    return path, time.monotonic() - began


def disk_bytes(*paths):
    """What files and folders take on the disk now, while a program writes and removes them."""
    total = 0
    for top in paths:
        for path in [top, *top.rglob("*")] if top.is_dir() else [top]:
            try:
                total += path.stat().st_blocks * 512
            except FileNotFoundError:
                pass
    return total


def status_bytes(pid, name):
    """A line of /proc/PID/status, in bytes; 0 once the process has ended."""
    try:
        for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
            if line.startswith(name + ":"):
                return int(line.split()[1]) * 1024
    except (FileNotFoundError, ProcessLookupError):
        pass
    return 0


class Watch(threading.Thread):
    """Notes the largest memory and disk of every stage of a running job, ten times a second."""

    def __init__(self, process, *paths):
        super().__init__(daemon=True)
        self.process, self.paths = process, paths
        self.stage = "sort"
        self.resident = collections.Counter()
        self.disk = collections.Counter()
        self.ended = threading.Event()

    def run(self):
        while not self.ended.wait(POLL):
            stage = self.stage
            self.resident[stage] = max(self.resident[stage],
                                       status_bytes(self.process.pid, "VmRSS"))
            self.disk[stage] = max(self.disk[stage], disk_bytes(*self.paths))


class Smoothed:
    """A finished job: its report, and the peaks by stage that were seen from outside."""

    def __init__(self, report, watch, seconds, processor_seconds):
        self.report, self.seconds, self.processor_seconds = report, seconds, processor_seconds
        self.resident, self.disk = watch.resident, watch.disk
        self.stage_seconds = {"sort": report["seconds"]["plan"] + report["seconds"]["ingest"],
                              "widths": report["seconds"]["spacing"],
                              "smooth": report["seconds"]["smooth"],
                              "write": report["seconds"]["write"]}


def processor_seconds():
    """Of all programs that were started and have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def smooth(scan, out, *words):
    """Runs pss smooth to its end."""
    report = out.with_suffix(".json")
    began, used = time.monotonic(), processor_seconds()
    process = subprocess.Popen([PSS, "smooth", scan, "-o", out, "--progress", "json", "--report",
                                report, *map(str, words)], stderr=subprocess.PIPE, text=True)
    watch = Watch(process, scan, out, out.with_name(out.name + ".part"),
                  out.with_name(out.name + ".work"))
    watch.start()
    said = []
    for line in process.stderr:
        event = json.loads(line) if line.startswith("{") else {"text": line.strip()}
        watch.stage = STAGES.get(event.get("stage"), watch.stage)
        said.append(event.get("text", ""))
    code = process.wait()
    seconds = time.monotonic() - began
    watch.ended.set()
    watch.join()
    if code != 0:
        sys.exit(f"pss smooth ended with {code}: " + " ".join(said[-3:]))
    return Smoothed(json.loads(report.read_text()), watch, seconds, processor_seconds() - used)


Ended = collections.namedtuple("Ended", "code said peak_bytes seconds")


def pss(*words, patience):
    """Runs any job, for at most so many seconds: its exit code, below 0 for a signal, what it said
    last, and its peak of memory by the kernel's count, of which a bare interpreter's is the least.
    """
    began = time.monotonic()
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen([PSS, *map(str, words), "--progress", "none"],
                                   stdout=subprocess.DEVNULL, stderr=errors)
        alarm = threading.Timer(patience, process.kill)
        alarm.start()
        _, status, usage = os.wait4(process.pid, 0)
        alarm.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        said = errors.read().decode("utf8", "replace").strip().splitlines()
    return Ended(process.returncode, said[-1] if said else "", usage.ru_maxrss * 1024,
                 time.monotonic() - began)


def sha256(path):
    with open(path, "rb") as file:
        digest = hashlib.sha256()
        while chunk := file.read(1 << 20):
            digest.update(chunk)
        return digest.hexdigest()


def remove(out):
    """A result, a file or a store, with all that its job left."""
    for path in (out, out.with_name(out.name + ".part"), out.with_name(out.name + ".work")):
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)


class LasFile:
    """The records of a LAS file, by seeking."""

    def __init__(self, path):
        self.file = open(path, "rb")
        head = self.file.read(375)
        self.data_offset, = struct.unpack_from("<I", head, 96)
        self.record_size, self.count = struct.unpack_from("<HI", head, 105)
        self.scale = struct.unpack_from("<3d", head, 131)
        self.origin = struct.unpack_from("<3d", head, 155)
        self.whole = os.path.getsize(path) >= self.data_offset + self.count * self.record_size

    def positions(self, first, count):
        self.file.seek(self.data_offset + first * self.record_size)
        records = struct.iter_unpack(f"<3i{self.record_size - 12}x",
                                     self.file.read(count * self.record_size))
        for index in records:
            yield [o + s * i for o, s, i in zip(self.origin, self.scale, index)]


def rms_to_torus(path, points):
    """Root mean square distance to the true surface, in spacings: 2,000 ranges of 500 records."""
    las = LasFile(path)
    ranges, length = 2000, 500
    if not las.whole or las.count != points:
        sys.exit(f"{path}: found {las.count} points, expected {points}, all of them in the file")
    total = 0.0
    taken = 0
    for k in range(ranges):
        for x, y, z in las.positions(k * (points - length) // ranges, min(length, points)):
            total += (math.hypot(math.hypot(x, y) - MAJOR, z) - MINOR) ** 2
            taken += 1
    return math.sqrt(total / taken) / spacing(points)
