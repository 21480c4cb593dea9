"""Damaged, odd and hostile files: read, or refused in one sentence; nothing in between."""

import re
import struct
import unittest

import harness
from harness import BAD_INPUT, DATA, DONE, SystemTest, needs_data

PLY_ASCII = b"""ply
format ascii 1.0
comment three points
element vertex 3
property float x
property float y
property double z
property uchar red
end_header
0 0 0.5 1
1 0 0.25 2
0 1 0.125 3
"""
PLY_BINARY = (PLY_ASCII[: PLY_ASCII.index(b"0 0 0.5")].replace(b"ascii", b"binary_little_endian")
              + b"".join(struct.pack("<ffdB", x, y, z, r)
                         for x, y, z, r in ((0, 0, .5, 1), (1, 0, .25, 2), (0, 1, .125, 3))))


class DamagedFiles(SystemTest):
    """Runs a command on hostile files; `words` are those between the input and the end."""

    def judge(self, source, command, out, *words):
        """Exit 0 with an output, or 3 with one sentence and none; never anything else."""
        run = harness.pss(command, source, "-o", out, "--progress", "none", *words)
        if run.code == DONE:
            self.assertTrue(out.exists(), run.err)
        else:
            self.assertEqual(run.code, BAD_INPUT, f"{source}: {run.err}")
            self.assertIn(source.name, run.err)
            self.assertFalse(out.exists())
        self.assertFalse(out.with_name(out.name + ".part").exists())
        self.assertLess(run.peak_bytes, 128 << 20, source)
        self.assertLess(run.seconds, 20, source)
        out.unlink(missing_ok=True)
        return run


@needs_data
class BrokenFolder(DamagedFiles):
    def broken(self):
        return sorted(p for p in DATA.glob("broken/*") if p.suffix in (".las", ".ply"))

    def test_convert_reads_or_refuses_each(self):
        self.assertGreater(len(self.broken()), 15)
        for source in self.broken():
            with self.subTest(source.name):
                self.judge(source, "convert", self.path("out" + source.suffix))

    def test_unsupported_formats_are_refused_by_name(self):
        for source in sorted(p for p in DATA.glob("broken/*") if p.suffix in (".laz", ".e57")):
            with self.subTest(source.name):
                run = harness.pss("convert", source, "-o", self.path("out.las"))
                self.assertEqual(run.code, BAD_INPUT, run.err)
                self.assertIn(source.name, run.err)


class EveryTruncation(DamagedFiles):
    def truncations(self, data, name):
        for size in range(len(data)):
            cut = self.path(f"{size}_{name}")
            cut.write_bytes(data[:size])
            yield size, cut
            cut.unlink()

    def test_of_a_las_file_is_refused_with_found_and_expected(self):
        whole = self.path("whole.las")
        harness.write_las(whole, harness.random_records(3, 1))
        for size, cut in self.truncations(whole.read_bytes(), "a.las"):
            run = self.judge(cut, "convert", self.path("out.las"))
            self.assertEqual(run.code, BAD_INPUT, f"{size}: {run.err}")
            if size >= 227:
                self.assertRegex(run.err, r"\d")

    def test_of_a_binary_ply_file_is_refused(self):
        for size, cut in self.truncations(PLY_BINARY, "a.ply"):
            run = self.judge(cut, "convert", self.path("out.ply"))
            self.assertEqual(run.code, BAD_INPUT, f"{size}: {run.err}")

    def test_of_an_ascii_ply_file_is_refused_until_the_last_value(self):
        complete = len(PLY_ASCII) - 2  # all but the last value's digit and the newline
        for size, cut in self.truncations(PLY_ASCII, "a.ply"):
            run = self.judge(cut, "convert", self.path("out.ply"))
            self.assertEqual(run.code, BAD_INPUT if size <= complete else DONE, f"{size}: {run.err}")


class HostileLas(DamagedFiles):
    def las(self, patches=(), count=10):
        path = self.path("hostile.las")
        harness.write_las(path, harness.random_records(count, 1))
        data = bytearray(path.read_bytes())
        for offset, layout, value in patches:
            struct.pack_into(layout, data, offset, value)
        path.write_bytes(data)
        return path

    def test_a_promise_of_4_billion_points_allocates_nothing(self):
        source = self.las([(107, "<I", 0xFFFFFFFF)])
        run = self.judge(source, "convert", self.path("out.las"))
        self.assertEqual(run.code, BAD_INPUT)

    def test_hostile_header_fields_are_refused(self):
        for offset, layout, value in ((94, "<H", 0), (94, "<H", 65535), (96, "<I", 0),
                                      (96, "<I", 0xFFFFFFFF), (100, "<I", 0xFFFFFFFF),
                                      (104, "<B", 11), (105, "<H", 0), (105, "<H", 19),
                                      (24, "<B", 9)):
            with self.subTest((offset, value)):
                run = self.judge(self.las([(offset, layout, value)]), "convert",
                                 self.path("out.las"))
                self.assertEqual(run.code, BAD_INPUT, run.err)

    def test_scales_that_make_no_position_are_refused(self):
        for value in (0.0, float("nan"), float("inf")):
            with self.subTest(value):
                run = self.judge(self.las([(131, "<d", value)]), "convert", self.path("out.las"))
                self.assertEqual(run.code, BAD_INPUT, run.err)


if __name__ == "__main__":
    harness.main()
