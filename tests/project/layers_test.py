"""The layers core <- io <- stream <- apps, the rooms within them, the few files that name each
library, and the one door to the disk."""

import pathlib
import re
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
LAYERS = ["core", "io", "stream", "apps"]
# The rooms of a layer, from the lowest floor; "." is the layer's own folder. A file knows its own
# room and those of the floors below: rooms of one floor do not know each other.
FLOORS = {
    "io": ["file", "points", "formats/las formats/ply formats/text", "formats", ". synth"],
    "stream": ["limit", "store", "sort passes", "operators", "widths", "jobs"],
}
# (layer, room): how high it lies.
ROOMS = {(layer, room): height for layer, floors in FLOORS.items()
         for height, rooms in enumerate(floors) for room in rooms.split()}
# A library's headers, the folder it lives in, and in how many files it may be named.
LIBRARIES = {
    r"tbb/": ("core", 1),
    r"oneapi/": ("core", 0),
    r"flann/": ("core", 1),
    r"lz4": ("stream", 1),
    r"xxhash": ("io", 1),
    r"CLI/": ("apps", 2),
}
# Headers and words by which a program reaches the disk, and the files that may use them.
DISK_HEADER = re.compile(
    r"fcntl\.h|glob\.h|dirent\.h|filesystem|fstream|sys/(stat|statvfs|file|uio|sendfile)\.h")
DISK_WORD = re.compile(
    r"std::filesystem|\bstd::(fopen|remove|rename|tmpfile)\b|\b(fopen|fdopen|freopen|mkstemp|mkdtemp)\(|"
    r"(?<![\w.>:])::(open|creat|read|write|pread|pwrite|rename|unlink|mkdir|rmdir|stat|fsync|fdatasync|"
    r"ftruncate|truncate|close)\(")
DISK_FILES = {
    "io/file/disk_posix.cpp",
    # What the kernel says of this process in /proc and /sys: no disk.
    "stream/limit/cgroup.cpp",
    "stream/limit/memory.cpp",
    "stream/limit/transfer.cpp",
}
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)


def includes(root):
    """Pairs of (source file, what it includes), paths relative to the root."""
    for layer in LAYERS:
        for path in sorted((root / layer).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                for name in INCLUDE.findall(path.read_text()):
                    yield path.relative_to(root), name


def upward(root):
    """Includes that point from a layer to one above it, or to the tests."""
    above = {layer: LAYERS[at + 1 :] + ["tests", "bench"] for at, layer in enumerate(LAYERS)}
    return [
        f"{path} includes {name}"
        for path, name in includes(root)
        if name.split("/")[0] in above[path.parts[0]]
    ]


def room(name):
    """(layer, room) of a path."""
    layer, _, rest = str(name).partition("/")
    return layer, rest.rpartition("/")[0] or "."


def homeless(root):
    """Files of layers with rooms that lie in none of them."""
    paths = [path for layer in FLOORS for path in sorted((root / layer).rglob("*"))]
    names = [str(path.relative_to(root)) for path in paths if path.suffix in (".h", ".cpp")]
    return [name for name in names if room(name) not in ROOMS]


def upstairs(root):
    """Includes that point to a room of the layer that is above, or beside on the same floor."""
    found = []
    for path, name in includes(root):
        here, there = room(path), room(name)
        inner = here in ROOMS and there in ROOMS and here[0] == there[0] and here != there
        if inner and ROOMS[there] >= ROOMS[here]:
            found.append(f"{path} includes {name}")
    return found


def relative(root):
    """Includes that do not start at the root."""
    return [f"{path} includes {name}" for path, name in includes(root) if name.startswith(".")]


def spread(root):
    """Libraries that are named in a wrong folder, or in too many files."""
    found = []
    for library, (folder, most) in LIBRARIES.items():
        named = {path for path, name in includes(root) if re.match(library, name)}
        found += [f"{path} names {library}" for path in named if path.parts[0] != folder]
        if len(named) > most:
            found.append(f"{library} in {len(named)} files, at most {most}: {sorted(map(str, named))}")
    return found


def doors(root):
    """Files beside io/file/disk_posix.cpp that reach the disk themselves."""
    found = [f"{path} includes {name}" for path, name in includes(root)
             if str(path) not in DISK_FILES and DISK_HEADER.fullmatch(name)]
    for layer in LAYERS:
        for path in sorted((root / layer).rglob("*")):
            name = str(path.relative_to(root))
            if path.suffix in (".h", ".cpp") and name not in DISK_FILES:
                found += [f"{name} says {word.group()}" for word in DISK_WORD.finditer(path.read_text())]
    return found


class Layers(unittest.TestCase):
    def test_no_layer_includes_one_above_it(self):
        self.assertEqual(upward(ROOT), [])

    def test_every_file_has_a_room(self):
        self.assertEqual(homeless(ROOT), [])

    def test_no_room_includes_one_above_or_beside_it(self):
        self.assertEqual(upstairs(ROOT), [])

    def test_includes_start_at_the_root(self):
        self.assertEqual(relative(ROOT), [])

    def test_each_library_is_named_in_few_files(self):
        self.assertEqual(spread(ROOT), [])

    def test_one_file_is_the_door_to_the_disk(self):
        self.assertEqual(doors(ROOT), [])

    def test_the_real_tree_is_what_is_looked_at(self):
        self.assertGreater(len(list(includes(ROOT))), 100)


class LayersOfABadTree(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        for layer in LAYERS:
            (self.root / layer).mkdir()

    def write(self, path, text):
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text)

    def test_an_upward_include_is_found(self):
        self.write("core/a.h", '#include "io/file/file.h"\n')
        self.assertEqual(upward(self.root), ["core/a.h includes io/file/file.h"])

    def test_an_include_of_a_room_above_is_found(self):
        self.write("stream/limit/a.h", '#include "stream/jobs/b.h"\n')
        self.write("stream/jobs/b.h", '#include "stream/limit/c.h"\n#include "stream/jobs/d.h"\n')
        self.write("io/points/a.h", '#include "io/b.h"\n')
        self.write("io/b.h", '#include "io/points/a.h"\n')
        found = ["io/points/a.h includes io/b.h", "stream/limit/a.h includes stream/jobs/b.h"]
        self.assertEqual(upstairs(self.root), found)

    def test_an_include_of_a_room_beside_it_is_found(self):
        self.write("stream/sort/a.h", '#include "stream/passes/b.h"\n')
        self.write("io/formats/las/a.h", '#include "io/formats/ply/b.h"\n')
        self.write("io/formats/ply/a.h", '#include "io/formats/table.h"\n')
        self.write("io/formats/table.h", '#include "io/formats/las/a.h"\n')
        found = ["io/formats/las/a.h includes io/formats/ply/b.h",
                 "io/formats/ply/a.h includes io/formats/table.h",
                 "stream/sort/a.h includes stream/passes/b.h"]
        self.assertEqual(upstairs(self.root), found)

    def test_a_file_without_a_room_is_found(self):
        self.write("stream/a.h", "")
        self.write("io/formats/new/b.cpp", "")
        self.assertEqual(homeless(self.root), ["io/formats/new/b.cpp", "stream/a.h"])

    def test_a_library_in_a_wrong_folder_is_found(self):
        self.write("io/a.cpp", "#include <tbb/parallel_for.h>\n")
        self.assertEqual(spread(self.root), ["io/a.cpp names tbb/"])

    def test_a_second_door_to_the_disk_is_found(self):
        self.write("stream/a.cpp", "#include <fstream>\n")
        self.write("io/b.cpp", "int f = ::open(path, 0);\n")
        self.write("io/file/disk_posix.cpp", "#include <fcntl.h>\nint f = ::open(path, 0);\n")
        self.assertEqual(doors(self.root), ["stream/a.cpp includes fstream", "io/b.cpp says ::open("])

    def test_a_library_in_too_many_files_is_found(self):
        for name in "ab":
            self.write(f"stream/{name}.cpp", "#  include <lz4.h>\n")
        self.assertEqual(len(spread(self.root)), 1)


if __name__ == "__main__":
    unittest.main()
