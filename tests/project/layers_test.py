"""The layers core <- io <- stream <- apps, the few files that name each library, and the one door
to the disk."""

import pathlib
import re
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
LAYERS = ["core", "io", "stream", "apps"]
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
    "io/disk_posix.cpp",
    # What the kernel says of this process in /proc and /sys: no disk.
    "stream/cgroup.cpp", "stream/memory.cpp", "stream/transfer.cpp",
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
    """Files beside io/disk_posix.cpp that reach the disk themselves."""
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
        (self.root / path).write_text(text)

    def test_an_upward_include_is_found(self):
        self.write("core/a.h", '#include "io/file.h"\n')
        self.assertEqual(upward(self.root), ["core/a.h includes io/file.h"])

    def test_a_library_in_a_wrong_folder_is_found(self):
        self.write("io/a.cpp", "#include <tbb/parallel_for.h>\n")
        self.assertEqual(spread(self.root), ["io/a.cpp names tbb/"])

    def test_a_second_door_to_the_disk_is_found(self):
        self.write("stream/a.cpp", "#include <fstream>\n")
        self.write("io/b.cpp", "int f = ::open(path, 0);\n")
        self.write("io/disk_posix.cpp", "#include <fcntl.h>\nint f = ::open(path, 0);\n")
        self.assertEqual(doors(self.root), ["stream/a.cpp includes fstream", "io/b.cpp says ::open("])

    def test_a_library_in_too_many_files_is_found(self):
        for name in "ab":
            self.write(f"stream/{name}.cpp", "#  include <lz4.h>\n")
        self.assertEqual(len(spread(self.root)), 1)


if __name__ == "__main__":
    unittest.main()
