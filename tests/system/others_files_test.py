"""Somebody's file, link, folder or pipe under a name that pss would use: never changed, always named."""

import os
import shutil

import harness
from harness import DONE, FAILED
from places import PlacesTest, kinds, tree


class OthersFiles(PlacesTest):
    def each(self):
        """Every command with every kind of thing, in an empty folder each time."""
        for name, output, words in self.commands():
            for kind, put in kinds(self.theirs).items():
                yield f"{name}, {kind}", self.fresh("here") / output, words, put

    def test_what_has_the_old_temporary_name_is_left_alone(self):
        for what, out, words, put in self.each():
            with self.subTest(what):
                for name in (out.name + ".part", out.name + ".new", "." + out.name + ".swp"):
                    put(out.parent / name)
                before = tree(out.parent) | tree(self.theirs)
                self.ok(*words, "-o", out)
                after = tree(out.parent) | tree(self.theirs)
                self.assertEqual({k: v for k, v in after.items() if k in before}, before)
                self.assertTrue(self.sound(out))

    def test_what_has_the_name_of_the_lock_is_named_and_the_remedy_works(self):
        for what, out, words, put in self.each():
            with self.subTest(what):
                lock = out.parent / f".{out.name}.pss-lock"
                put(lock)
                before = tree(out.parent), tree(self.theirs)
                self.refused(FAILED, *words, "-o", out, says=[lock, "move it elsewhere"])
                self.assertEqual((tree(out.parent), tree(self.theirs)), before)
                lock.rename(self.fresh("elsewhere") / "lock")
                self.ok(*words, "-o", out)
                self.assertEqual([path.name for path in out.parent.iterdir()], [out.name])

    def test_what_a_left_temporary_name_leads_to_is_left_alone(self):
        for what, out, words, put in self.each():
            with self.subTest(what):
                lock = out.parent / f".{out.name}.pss-lock"
                lock.touch()  # as a process that was killed leaves it
                part = out.parent / f".{out.name}.{lock.stat().st_ino}.pss-part"
                put(part)
                before = tree(self.theirs)
                run = harness.pss(*words, "-o", out)
                self.assertEqual(tree(self.theirs), before)
                if (part / "inside").exists():  # a full folder is nothing that pss leaves
                    self.assertEqual(run.code, FAILED, run.err)
                    self.assertIn(str(part), run.err)
                else:
                    self.assertEqual(run.code, DONE, run.err)
                    self.assertTrue(self.sound(out))

    def test_a_foreign_file_under_the_very_temporary_name_is_not_emptied(self):
        for name, output, words in self.commands():
            with self.subTest(name):
                here = self.fresh("here")
                guess = here / "guess"
                theirs = here / "theirs"
                theirs.write_text("somebody's\n")
                guess.touch()  # many file systems give the next file the number of the last removed
                part = here / f".{output}.{guess.stat().st_ino}.pss-part"
                guess.unlink()
                theirs.rename(part)
                run = harness.pss(*words, "-o", here / output)
                self.assertEqual(part.read_text(), "somebody's\n")
                if run.code != DONE:
                    self.assertEqual(run.code, FAILED)
                    self.assertIn(str(part), run.err)

    def test_an_input_that_is_named_like_a_temporary_file_is_kept(self):
        for suffix in (".part", ".new", ".tmp"):
            for command in ("smooth", "convert"):
                with self.subTest(command + suffix):
                    here = self.fresh("here")
                    scan = here / f"s.las{suffix}"
                    shutil.copy(self.scan, scan)
                    before = tree(here)
                    run = harness.pss(command, scan, "-o", here / "s.las")
                    self.assertEqual(run.code, DONE, run.err)
                    self.assertEqual(harness.sha256(scan), before[scan.name][1])

    def test_an_output_that_is_there_is_refused_whatever_it_is(self):
        for what, out, words, put in self.each():
            with self.subTest(what):
                put(out)
                before = tree(out.parent), tree(self.theirs)
                self.refused(FAILED, *words, "-o", out, says=[out])
                self.assertEqual((tree(out.parent), tree(self.theirs)), before)

    def test_overwrite_replaces_a_link_and_not_what_it_leads_to(self):
        for what, out, words, put in self.each():
            with self.subTest(what):
                put(out)
                before = tree(out.parent), tree(self.theirs)
                run = harness.pss(*words, "-o", out, "--overwrite")
                self.assertEqual(tree(self.theirs), before[1])
                if run.code != DONE:
                    self.assertEqual(tree(out.parent), before[0], run.err)
                    self.assertIn(str(out), run.err)
                if out.suffix == ".pss":  # nothing here is a store
                    self.assertEqual(run.code, FAILED)

    def test_an_input_is_never_the_output_under_any_name(self):
        here = self.fresh("here")
        names = {"link.las": os.symlink, "hard.las": os.link}
        for name, link in names.items():
            link(self.scan, here / name)
        before = harness.sha256(self.scan)
        for name in names:
            for command in ("smooth", "convert"):
                with self.subTest(f"{command} {name}"):
                    self.refused(harness.USAGE, command, self.scan, "-o", here / name,
                                 "--overwrite", says=[here / name, "is an input"])
        self.assertEqual(harness.sha256(self.scan), before)

    def test_a_list_of_inputs_is_an_input(self):
        listed = self.path("list.txt")
        listed.write_text(f"{self.scan}\n")
        for words in (["convert", f"@{listed}", "-o", listed],
                      ["smooth", f"@{listed}", "-o", listed],
                      ["smooth", f"@{listed}", "-o", self.path("o.las"), "--report", listed]):
            with self.subTest(words[0]):
                self.refused(harness.USAGE, *words, "--overwrite", says=[listed, "input"])
                self.assertEqual(listed.read_text(), f"{self.scan}\n")


if __name__ == "__main__":
    harness.main()
