"""Damaged, odd and hostile files: read, or refused in one sentence; nothing in between."""

import shutil
import struct

import harness
from harness import BAD_INPUT, DATA, DONE, SystemTest, needs_data

COMMANDS = ("convert", "smooth")

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
    def judge(self, source, command="convert"):
        """Exit 0 with an output, or 3 with one sentence and none; never anything else."""
        out = self.path("out" + (".ply" if source.suffix == ".ply" else ".las"))
        limit = ["--memory-limit", "128M"] if command == "smooth" else []
        run = harness.pss(command, source, "-o", out, "--progress", "none", *limit)
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
        shutil.rmtree(str(out) + ".work", ignore_errors=True)
        return run


@needs_data
class BrokenFolder(DamagedFiles):
    def test_each_las_and_ply_file_is_read_or_refused(self):
        broken = sorted(p for p in DATA.glob("broken/*") if p.suffix in (".las", ".ply"))
        self.assertGreater(len(broken), 15)
        for source in broken:
            for command in COMMANDS:
                with self.subTest((command, source.name)):
                    self.judge(source, command)

    def test_unsupported_formats_are_refused_by_name(self):
        for source in sorted(p for p in DATA.glob("broken/*") if p.suffix in (".laz", ".e57")):
            with self.subTest(source.name):
                run = harness.pss("convert", source, "-o", self.path("out.las"))
                self.assertEqual(run.code, BAD_INPUT, run.err)
                self.assertIn(source.name, run.err)


class EveryTruncation(DamagedFiles):
    def check(self, data, name, complete):
        """Every file shorter than `complete` bytes is bad input, whatever the command."""
        for size in range(len(data)):
            cut = self.path(f"{size}_{name}")
            cut.write_bytes(data[:size])
            for command in COMMANDS:
                run = self.judge(cut, command)
                self.assertEqual(run.code, BAD_INPUT if size < complete else DONE,
                                 f"{command} {cut.name}: {run.err}")
            cut.unlink()

    def test_of_a_las_file_is_refused(self):
        whole = self.path("whole.las")
        harness.write_las(whole, harness.random_records(3, 1))
        data = whole.read_bytes()
        self.check(data, "a.las", complete=len(data))

    def test_of_a_binary_ply_file_is_refused(self):
        self.check(PLY_BINARY, "a.ply", complete=len(PLY_BINARY))

    def test_of_an_ascii_ply_file_is_refused_until_the_last_value(self):
        self.check(PLY_ASCII, "a.ply", complete=len(PLY_ASCII) - 1)  # but for the newline

    def test_is_told_with_what_was_found_and_expected(self):
        whole, cut = self.path("whole.las"), self.path("cut.las")
        harness.write_las(whole, harness.random_records(100, 1))
        cut.write_bytes(whole.read_bytes()[:1227])  # 1000 of 2000 bytes of records
        err = self.judge(cut).err
        for number in ("50", "100"):
            self.assertIn(number, err)


class HostileLas(DamagedFiles):
    def refused_with(self, offset, layout, value):
        path = self.path("hostile.las")
        harness.write_las(path, harness.random_records(10, 1))
        data = bytearray(path.read_bytes())
        struct.pack_into(layout, data, offset, value)
        path.write_bytes(data)
        for command in COMMANDS:
            with self.subTest((command, offset, value)):
                run = self.judge(path, command)
                self.assertEqual(run.code, BAD_INPUT, run.err)

    def test_a_promise_of_4_billion_points_is_refused_and_allocates_nothing(self):
        self.refused_with(107, "<I", 0xFFFFFFFF)

    def test_header_fields_that_make_no_sense_are_refused(self):
        for offset, layout, value in ((94, "<H", 0), (94, "<H", 65535),  # header size
                                      (96, "<I", 0), (96, "<I", 0xFFFFFFFF),  # offset to points
                                      (104, "<B", 11),  # point format
                                      (105, "<H", 0), (105, "<H", 19),  # record size
                                      (24, "<B", 9)):  # major version
            self.refused_with(offset, layout, value)

    def test_a_wrong_number_of_vlrs_is_told_and_the_points_are_read(self):
        path = self.path("hostile.las")
        harness.write_las(path, harness.random_records(10, 1))
        data = bytearray(path.read_bytes())
        struct.pack_into("<I", data, 100, 0xFFFFFFFF)
        path.write_bytes(data)
        for command in COMMANDS:
            run = self.judge(path, command)
            self.assertEqual(run.code, DONE, run.err)
            self.assertIn("4294967295", run.err)

    def test_scales_that_make_no_position_are_refused(self):
        for value in (0.0, float("nan"), float("inf")):
            self.refused_with(131, "<d", value)


if __name__ == "__main__":
    harness.main()
