"""What the whole-program tests share: running pss, measuring it, reading LAS without it."""

import atexit
import collections
import hashlib
import json
import math
import os
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PSS = os.environ.get("PSS_BINARY", str(ROOT / "build/release/pss"))
DATA = pathlib.Path(os.environ.get("PSS_TEST_DATA", ROOT / "../shared/data")).resolve()

DONE, FAILED, USAGE, BAD_INPUT, MEMORY_LIMIT, INTERRUPTED = 0, 1, 2, 3, 4, 130
SKIPPED = 77  # what ctest takes as skipped

def own_state_folder():
    """A state folder for this process and the pss that it starts: the user's is left alone."""
    folder = tempfile.mkdtemp(prefix="pss-state-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


os.environ["XDG_STATE_HOME"] = own_state_folder()

needs_data = unittest.skipUnless(DATA.is_dir(), f"no test data at {DATA}")


Run = collections.namedtuple("Run", "code out err peak_bytes seconds")


def start(*words, **options):
    """A running pss; its data on stdout and words on stderr go to files without a name."""
    out, err = tempfile.TemporaryFile(), tempfile.TemporaryFile()
    process = subprocess.Popen([PSS, *map(str, words)], stdout=out, stderr=err, **options)
    process.written = out, err
    process.began = time.monotonic()
    return process


def signal_to(process, number):
    """Sends a signal without reaping, as Popen.send_signal may: finish() does that."""
    os.kill(process.pid, number)


def ended(process):
    """Whether a started pss has ended; finish() still finds it."""
    return os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None


def finish(process):
    """Waits for a started pss.

    The peak is what the kernel counted (ru_maxrss). It is never below the true one: the child
    inherits the peak of this process at its start, which is small.
    """
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    seconds = time.monotonic() - process.began
    texts = []
    for file in process.written:
        file.seek(0)
        texts.append(file.read().decode("utf8", "replace"))
        file.close()
    return Run(process.returncode, *texts, usage.ru_maxrss * 1024, seconds)


def pss(*words, **options):
    """Runs pss to its end."""
    return finish(start(*words, **options))


def sha256(path):
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while chunk := file.read(1 << 20):
            digest.update(chunk)
    return digest.hexdigest()


def torus_spacing(points):
    """The mean spacing of a synthesised torus of the default size: root of area / points."""
    return (4 * math.pi**2 * 1.0 * 0.4 / points) ** 0.5


class SystemTest(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="pss-system-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return self.folder / name

    def ok(self, *words, **options):
        """Runs pss and asserts that it succeeded."""
        run = pss(*words, **options)
        self.assertEqual(run.code, DONE, f"{words}\n{run.err}")
        return run

    def refused(self, code, *words, says=(), **options):
        """Runs pss and asserts how it failed: exit code, and words of its one message."""
        run = pss(*words, **options)
        self.assertEqual(run.code, code, f"{words}\n{run.out}\n{run.err}")
        for word in says:
            self.assertIn(str(word), run.err)
        return run

    def synth(self, name, *words, shape="torus", points=20000):
        """The path of a synthesised scan."""
        path = self.path(name)
        self.ok("synth", shape, "-o", path, "--points", points, *words)
        return path


class Las:
    """A LAS file as bytes: header, VLRs, records, what follows them."""

    def __init__(self, path):
        data = pathlib.Path(path).read_bytes()
        self.header_size, self.data_offset, self.vlr_count = struct.unpack_from("<HII", data, 94)
        self.version = data[24], data[25]
        self.point_format = data[104] & 0x3F
        self.record_size, self.count = struct.unpack_from("<HI", data, 105)
        if self.version >= (1, 4):
            self.count = struct.unpack_from("<Q", data, 247)[0] or self.count
        self.scale = struct.unpack_from("<3d", data, 131)
        self.offset = struct.unpack_from("<3d", data, 155)
        self.header = data[: self.header_size]
        self.vlrs = data[self.header_size : self.data_offset]
        end = self.data_offset + self.count * self.record_size
        self.records = data[self.data_offset : end]
        self.tail = data[end:]

    def record(self, number):
        return self.records[number * self.record_size : (number + 1) * self.record_size]

    def after_xyz(self, size=None):
        """Every record's bytes after x, y, z, counted; at most `size` bytes of them."""
        return collections.Counter(self.record(i)[12:][:size] for i in range(self.count))

    def positions(self):
        """World coordinates, in file order."""
        for number in range(self.count):
            raw = struct.unpack_from("<3i", self.records, number * self.record_size)
            yield tuple(o + s * v for o, s, v in zip(self.offset, self.scale, raw))


class Ply:
    """The vertices of a PLY file without lists in them."""

    CODES = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h",
             "ushort": "H", "uint16": "H", "int": "i", "int32": "i", "uint": "I", "uint32": "I",
             "float": "f", "float32": "f", "double": "d", "float64": "d"}

    def __init__(self, path):
        head, _, body = pathlib.Path(path).read_bytes().partition(b"end_header")
        body = body.split(b"\n", 1)[1]
        lines = [line.split() for line in head.decode("latin1").splitlines()]
        at = next(i for i, words in enumerate(lines) if words[:2] == ["element", "vertex"])
        self.count = int(lines[at][2])
        ends = [i for i, words in enumerate(lines) if words[:1] == ["element"] and i > at]
        fields = [words for words in lines[at : (ends or [None])[0]] if words[:1] == ["property"]]
        self.names = [words[2] for words in fields]
        codes = "".join(self.CODES[words[1]] for words in fields)
        encoding = next(words[1] for words in lines if words[:1] == ["format"])
        if encoding == "ascii":
            rows = [map(float, line.split()) for line in body.split(b"\n")[: self.count]]
            narrow = [struct.Struct("<" + code) for code in codes]
            self.rows = [tuple(n.unpack(n.pack(v if n.format[-1] in "fd" else int(v)))[0]
                               for n, v in zip(narrow, row)) for row in rows]
        else:
            row = struct.Struct(("<" if "little" in encoding else ">") + codes)
            self.rows = [row.unpack_from(body, i * row.size) for i in range(self.count)]

    def others(self):
        """The values besides x, y, z of every vertex, counted."""
        keep = [i for i, name in enumerate(self.names) if name not in ("x", "y", "z")]
        return collections.Counter(tuple(row[i] for i in keep) for row in self.rows)


def write_las(path, records, scale=0.001, offset=(0.0, 0.0, 0.0), point_format=0):
    """A LAS 1.2 file of raw records, each with its x, y, z as integers in front."""
    size = {0: 20, 1: 28, 2: 26, 3: 34}[point_format]
    header = bytearray(227)
    header[0:4] = b"LASF"
    header[24:26] = bytes((1, 2))
    header[58:61] = b"pss"  # generating software
    struct.pack_into("<HHHII", header, 90, 1, 2020, 227, 227, 0)
    struct.pack_into("<BHI", header, 104, point_format, size, len(records))
    struct.pack_into("<3d3d", header, 131, *[scale] * 3, *offset)
    for axis in range(3 if records else 0):
        low = min(struct.unpack_from("<i", record, 4 * axis)[0] for record in records)
        high = max(struct.unpack_from("<i", record, 4 * axis)[0] for record in records)
        struct.pack_into("<2d", header, 179 + 16 * axis,
                         high * scale + offset[axis], low * scale + offset[axis])
    with open(path, "wb") as file:
        file.write(header)
        file.writelines(records)


def random_records(count, seed, point_format=0, span=100000):
    """Records with random positions and random bytes after them."""
    rng = random.Random(seed)
    size = {0: 20, 1: 28, 2: 26, 3: 34}[point_format]
    return [struct.pack("<3i", *(rng.randrange(span) for _ in range(3))) + rng.randbytes(size - 12)
            for _ in range(count)]


def read_json(path):
    return json.loads(pathlib.Path(path).read_text())


def main():
    """Runs the tests of the calling file; skipped ones are told to ctest."""
    program = unittest.main(exit=False, verbosity=2)
    if not program.result.wasSuccessful():
        sys.exit(1)
    sys.exit(SKIPPED if program.result.skipped else 0)
