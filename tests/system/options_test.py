"""What cannot be done, or has no meaning, is refused before any work, and says what to do."""

import os

import harness
from harness import BAD_INPUT, FAILED, USAGE, SystemTest


class Refusals(SystemTest):
    def setUp(self):
        super().setUp()
        self.scan = self.synth("scan.las", points=3000)
        self.store = self.path("store.pss")
        self.ok("tile", self.scan, "-o", self.store)

    def early(self, code, *words, says=()):
        """Refused in one sentence, and nothing new lies in the folder."""
        before = sorted(self.folder.rglob("*"))
        run = self.refused(code, *words, says=says)
        self.assertEqual(sorted(self.folder.rglob("*")), before)
        self.assertNotIn("neighbours", run.err)
        return run

    def writers(self, out):
        """Command lines that write this file."""
        return (["smooth", self.scan, "-o", out], ["smooth", self.store, "-o", out],
                ["convert", self.scan, "-o", out], ["export", self.store, "-o", out])

    def test_a_scale_or_an_offset_for_a_format_without_a_grid(self):
        for option in (["--scale", 0.01], ["--scale", "1,1,2"], ["--offset", "1,2,3"]):
            for name in ("out.ply", "out.csv"):
                for words in self.writers(self.path(name)):
                    with self.subTest(words=words, option=option):
                        self.early(USAGE, *words, *option, says=[option[0], name, "LAS"])
        for words in (["smooth", self.scan, "-o", self.path("out.pss")],
                      ["smooth", self.store, "-o", self.path("out.csv")],
                      ["export", self.store, "-o", self.path("out.ply")]):
            self.early(USAGE, *words, "--scale", "auto", says=["--scale"])

    def test_a_grid_that_cannot_hold_the_points_is_refused_before_they_are_smoothed(self):
        for option in (["--scale", "1e-12"], ["--offset", "1e300,0,0"]):
            for source in (self.scan, self.store):
                words = ["smooth", source, "-o", self.path("out.las"), *option]
                run = self.refused(BAD_INPUT, *words, says=["positions from (-1.3", option[0]])
                self.assertNotIn("neighbours", run.err)
                self.assertFalse(self.path("out.las.work/smooth.pss").exists())
            self.early(BAD_INPUT, "export", self.store, "-o", self.path("out.las"), *option,
                       says=["positions from (-1.3"])

    def test_a_grid_that_holds_the_points_is_taken(self):
        for words in self.writers(self.path("out.las")):
            self.ok(*words, "--scale", "0.001", "--offset", "0.5,0,0", "--overwrite", "--progress",
                    "none")

    def test_a_file_that_is_named_twice_by_any_name(self):
        """Every point twice is no scan: distances of zero, and twice the neighbours."""
        (self.path("link.las")).symlink_to(self.scan)
        os.link(self.scan, self.path("hard.las"))
        twice = self.path("list.txt")
        twice.write_text(f"{self.scan}\n{self.scan}\n")
        for again in (self.scan, self.path("link.las"), self.path("hard.las"),
                      f"{self.folder}/./scan.las", f"{self.folder}/s*.las", f"@{twice}"):
            for command, out in (("smooth", "out.las"), ("tile", "out.pss"), ("convert", "out.ply")):
                with self.subTest(command=command, again=again):
                    self.early(USAGE, command, self.scan, again, "-o", self.path(out),
                               says=[self.scan, "same file", "once"])
        self.early(USAGE, "convert", self.folder, "-o", self.path("out.ply"), says=["same file"])

    def test_equal_files_with_names_of_their_own_are_different_inputs(self):
        self.path("copy.las").write_bytes(self.scan.read_bytes())
        self.ok("convert", self.scan, self.path("copy.las"), "-o", self.path("out.las"))
        self.assertEqual(harness.Las(self.path("out.las")).count, 6000)

    def test_a_store_where_only_files_are_read(self):
        for words in (["tile", self.store, "-o", self.path("out.pss")],
                      ["tile", self.scan, self.store, "-o", self.path("out.pss")],
                      ["convert", self.store, "-o", self.path("out.las")]):
            self.early(USAGE, *words, says=[self.store, "pss export"])

    def test_a_directory_as_the_file_to_write(self):
        self.path("folder.las").mkdir()
        for words in self.writers(self.path("folder.las")):
            for more in ([], ["--overwrite"]):
                self.early(FAILED, *words, *more, says=["folder.las", "is a directory"])

    def test_a_file_within_a_store_that_is_read(self):
        for command in ("smooth", "export"):
            for out in (self.store / "out.las", f"{self.folder}/./store.pss/../store.pss/out.las"):
                self.early(USAGE, command, self.store, "-o", out, says=["lies in", self.store])

    def test_a_missing_folder(self):
        for words in self.writers(self.path("nowhere/out.las")):
            self.early(FAILED, *words, says=["folder is missing"])

    def test_an_inexact_buffer_without_a_buffer(self):
        self.early(USAGE, "smooth", self.scan, "-o", self.path("out.las"), "--allow-inexact",
                   says=["--allow-inexact", "--buffer"])

    def test_a_report_of_a_measurement_without_one(self):
        self.early(USAGE, "synth", "sphere", "-o", self.path("out.las"), "--json",
                   says=["--json", "--measure"])

    def test_words_that_are_wrong_are_told_once_and_as_all_others(self):
        run = self.early(USAGE, "smooth", self.scan, "-o", self.path("out.las"), "--outputs",
                         "normal", says=['pss: --outputs: unknown word "normal"'])
        self.assertEqual(run.err.count("--outputs"), 1)


if __name__ == "__main__":
    harness.main()
