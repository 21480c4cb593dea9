"""pss convert and pss info: what goes in comes out."""

import json
import os
import re
import struct
import subprocess
import unittest

import harness
from harness import BAD_INPUT, DATA, FAILED, USAGE, Las, SystemTest, needs_data


@needs_data
class RealLas(SystemTest):
    def same(self, name):
        out = self.path("out.las")
        self.ok("convert", DATA / name, "-o", out)
        before, after = Las(DATA / name), Las(out)
        self.assertEqual(after.records, before.records)
        self.assertEqual(after.vlrs, before.vlrs)
        self.assertEqual((after.version, after.point_format), (before.version, before.point_format))
        self.assertEqual((after.scale, after.offset), (before.scale, before.offset))
        self.assertEqual(after.header[:94], before.header[:94])  # identifiers, dates, software
        self.assertEqual(after.tail, before.tail)

    def test_las_to_las_is_the_identity(self):
        for path in sorted(DATA.glob("scans/*.las")) + sorted(DATA.glob("pairs/*.las")):
            with self.subTest(path.name):
                self.same(path.relative_to(DATA))
                os.remove(self.path("out.las"))

    def test_las_to_ply_keeps_positions_and_attributes(self):
        source, out = DATA / "pairs/pf3_1.2_n1065_80e25a.las", self.path("a.ply")
        self.ok("convert", source, "-o", out)
        las, ply = Las(source), harness.Ply(out)
        columns = dict(zip(ply.names, zip(*ply.rows)))
        self.assertEqual(list(zip(columns["x"], columns["y"], columns["z"])),
                         list(las.positions()))
        raw = [struct.unpack("<3iHBBbBHd3H", las.record(i)) for i in range(las.count)]
        expected = list(zip(*raw))
        self.assertEqual(columns["Intensity"], expected[3])
        self.assertEqual(columns["ReturnNumber"], tuple(b & 7 for b in expected[4]))
        self.assertEqual(columns["Classification"], tuple(b & 31 for b in expected[5]))
        self.assertEqual(columns["ScanAngleRank"], expected[6])
        self.assertEqual(columns["GpsTime"], expected[9])
        self.assertEqual(columns["Blue"], expected[12])

    def test_las_to_ply_and_back_keeps_positions(self):
        source = DATA / "pairs/pf3_1.2_n1065_80e25a.las"
        ply, back = self.path("a.ply"), self.path("b.las")
        self.ok("convert", source, "-o", ply)
        self.ok("convert", ply, "-o", back, "--scale", "0.01", "--offset", "0,0,0")
        self.assertEqual(list(Las(back).positions()), list(Las(source).positions()))


@needs_data
class RealPly(SystemTest):
    def test_ply_to_ply_keeps_every_property_and_value(self):
        for name in ("bunny_ascii.ply", "pond_binary_normals_rgb.ply"):
            with self.subTest(name):
                out = self.path("out.ply")
                self.ok("convert", DATA / "scans" / name, "-o", out)
                before, after = harness.Ply(DATA / "scans" / name), harness.Ply(out)
                self.assertEqual(after.names, before.names)
                self.assertEqual(after.rows, before.rows)
                os.remove(out)

    def test_ply_through_text_keeps_positions(self):
        source, text, back = DATA / "scans/bunny_ascii.ply", self.path("a.xyz"), self.path("b.ply")
        self.ok("convert", source, "-o", text)
        self.ok("convert", text, "-o", back)
        self.assertEqual([row[:3] for row in harness.Ply(back).rows],
                         [row[:3] for row in harness.Ply(source).rows])


class Synthetic(SystemTest):
    def test_any_bytes_after_the_coordinates_survive(self):
        for point_format in (0, 1, 2, 3):
            source, out = self.path(f"{point_format}.las"), self.path(f"out{point_format}.las")
            harness.write_las(source, harness.random_records(500, 7, point_format),
                              point_format=point_format)
            self.ok("convert", source, "-o", out)
            self.assertEqual(Las(out).records, Las(source).records)

    def test_several_inputs_are_written_one_after_the_other(self):
        for number in range(3):
            harness.write_las(self.path(f"{number}.las"), harness.random_records(100, number))
        (self.path("list.txt")).write_text("".join(f"{self.path(f'{n}.las')}\n" for n in range(3)))
        expected = b"".join(Las(self.path(f"{n}.las")).records for n in range(3))
        for words in (["0.las", "1.las", "2.las"], ["[012].las"], ["@list.txt"]):
            with self.subTest(words):
                self.ok("convert", *(f"@{self.path(w[1:])}" if w[0] == "@" else self.path(w)
                                     for w in words), "-o", self.path("all.las"), "--overwrite")
                self.assertEqual(Las(self.path("all.las")).records, expected)

    def test_no_points_give_a_valid_empty_file(self):
        harness.write_las(self.path("none.las"), [])
        self.ok("convert", self.path("none.las"), "-o", self.path("out.las"))
        self.assertEqual(Las(self.path("out.las")).count, 0)

    def test_names_with_spaces_and_umlauts_work(self):
        folder = self.path("Größe und Maß")
        folder.mkdir()
        harness.write_las(folder / "ein scan.las", harness.random_records(10, 1))
        self.ok("convert", folder / "ein scan.las", "-o", folder / ".." / "noch einer.las")
        self.assertEqual(Las(self.path("noch einer.las")).count, 10)

    def test_a_link_is_followed(self):
        harness.write_las(self.path("a.las"), harness.random_records(10, 1))
        self.path("link.las").symlink_to(self.path("a.las"))
        self.ok("convert", self.path("link.las"), "-o", self.path("out.las"))
        self.assertEqual(Las(self.path("out.las")).count, 10)


class Refusals(SystemTest):
    def setUp(self):
        super().setUp()
        self.scan, self.out = self.path("a.las"), self.path("out.las")
        harness.write_las(self.scan, harness.random_records(100, 1))

    def test_a_missing_file_is_1_and_named(self):
        self.refused(FAILED, "convert", self.path("missing.las"), "-o", self.out,
                     says=["missing.las"])

    def test_an_existing_output_is_kept_unless_overwrite_is_given(self):
        self.out.write_bytes(b"precious")
        self.refused(FAILED, "convert", self.scan, "-o", self.out, says=["out.las", "--overwrite"])
        self.assertEqual(self.out.read_bytes(), b"precious")
        self.ok("convert", self.scan, "-o", self.out, "--overwrite")
        self.assertEqual(Las(self.out).records, Las(self.scan).records)

    def test_a_file_of_no_known_format_is_3(self):
        self.path("noise.bin").write_bytes(bytes(range(256)) * 10)
        self.refused(BAD_INPUT, "convert", self.path("noise.bin"), "-o", self.out,
                     says=["noise.bin"])
        self.assertFalse(self.out.exists())

    def test_an_unknown_extension_of_the_output_is_refused_with_the_known_ones(self):
        run = harness.pss("convert", self.scan, "-o", self.path("out.docx"))
        self.assertIn(run.code, (USAGE, BAD_INPUT))
        self.assertIn("las", run.err)
        self.assertIn("ply", run.err)

    def test_usage_errors_are_2(self):
        for words in ([], ["frobnicate"], ["convert"], ["convert", self.scan],
                      ["convert", self.scan, "-o", self.out, "--nonsense"],
                      ["convert", self.scan, "-o", self.out, "--progress", "loud"],
                      ["convert", self.scan, "-o", self.out, "--scale", "1,2"]):
            with self.subTest(words):
                self.refused(USAGE, *words)
        self.assertFalse(self.out.exists())

    def test_a_directory_that_is_missing_or_read_only_is_1(self):
        self.refused(FAILED, "convert", self.scan, "-o", self.path("nowhere/out.las"),
                     says=["nowhere"])

    def test_a_full_disk_is_1_and_leaves_nothing(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full")
        limited = ["bash", "-c", 'ulimit -f 4; trap "" XFSZ; exec "$0" "$@"', harness.PSS]
        harness.write_las(self.scan, harness.random_records(5000, 1))
        run = subprocess.run([*limited, "convert", self.scan, "-o", self.out],
                             capture_output=True, text=True)
        self.assertEqual(run.returncode, FAILED, run.stderr)
        self.assertIn("out.las", run.stderr)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["a.las"])

    def test_a_failed_write_to_stdout_is_1(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full")
        with open("/dev/full", "wb") as full:
            run = subprocess.run([harness.PSS, "info", self.scan], stdout=full,
                                 stderr=subprocess.PIPE)
        self.assertEqual(run.returncode, FAILED)


class Info(SystemTest):
    def setUp(self):
        super().setUp()
        self.scan = self.path("a.las")
        harness.write_las(self.scan, harness.random_records(100, 1, 3), point_format=3)

    def test_json_has_the_facts_of_the_header(self):
        facts = json.loads(self.ok("info", self.scan, "--json").out)
        self.assertEqual(facts["points"], 100)
        self.assertEqual(facts["format"], "LAS")
        self.assertEqual(facts["scale"], [0.001] * 3)
        names = [attribute["name"] for attribute in facts["attributes"]]
        for name in ("Intensity", "GpsTime", "Red", "Green", "Blue", "Classification"):
            self.assertIn(name, names)

    def test_scan_counts_and_measures_the_points_themselves(self):
        facts = json.loads(self.ok("info", self.scan, "--json", "--scan").out)
        positions = list(Las(self.scan).positions())
        self.assertEqual(facts["points_read"], 100)
        for axis in range(3):
            self.assertEqual(facts["bounds_read"]["min"][axis], min(p[axis] for p in positions))
            self.assertEqual(facts["bounds_read"]["max"][axis], max(p[axis] for p in positions))

    def test_the_table_is_for_people(self):
        table = self.ok("info", self.scan).out
        self.assertRegex(table, r"points +100")
        self.assertRegex(table, r"Intensity +uint16")

    def test_help_of_every_command_has_examples(self):
        commands = re.findall(r"^  (\w+) ", self.ok("--help").out.split("Subcommands:")[1], re.M)
        self.assertIn("convert", commands)
        for command in commands:
            with self.subTest(command):
                self.assertIn("Example", self.ok(command, "--help").out)


if __name__ == "__main__":
    harness.main()
