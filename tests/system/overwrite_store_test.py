"""--overwrite of a store: the name always leads to the whole old store or the whole new one."""

import os
import re
import shutil
import subprocess

import harness
import places
from harness import DONE, FAILED, USAGE
from places import PlacesTest, needs_trace, traced, tree

STRIDE = int(os.environ.get("PSS_OVERWRITE_STRIDE", 2))
# A process killed at a call has not made it: the next call of any kind shows what it did.
CALLS = "rename renameat2 unlink rmdir fsync pwrite64".split()


def rows(store):
    """The hash of a store's rows; None where it is not whole."""
    run = harness.pss("verify", store)
    found = re.search(r"rows +([0-9a-f]{32})", run.out)
    return found[1] if run.code == DONE and found else None


class OverwriteStore(PlacesTest):
    def setUp(self):
        super().setUp()
        self.out = self.path("here/out.pss")
        self.other = self.synth("other.las", "--seed", 2, points=300)
        self.ok("tile", self.other, "-o", self.path("old.pss"))
        self.old = rows(self.path("old.pss"))

    def jobs(self):
        yield "tile", ["tile", self.scan]
        yield "smooth", ["smooth", self.scan, "--radius", 0.5]

    def begin(self):
        """The old store, with nothing beside it."""
        self.fresh("here")
        shutil.copytree(self.path("old.pss"), self.out)

    def words(self, words):
        return [*words, "-o", self.out, "--overwrite", "--progress", "none"]

    def whole(self, words):
        """The rows of the new store."""
        store = self.fresh("whole") / "new.pss"
        self.ok(*words, "-o", store)
        return rows(store)


@needs_trace
class Killed(OverwriteStore):
    def at_every_call(self, words, more=()):
        """Kills at the n-th call of each kind until n is beyond the last. Gives the kills, and what
        the name led to after each: the old store or the new."""
        new, seen = self.whole(words), []
        for call in CALLS:
            n, killed = 1, True
            while killed:
                self.begin()
                run = traced(f"{call}:signal=SIGKILL:when={n}", self.words(words))
                killed = run.returncode != DONE
                with self.subTest(f"{call} {n}"):
                    seen.append(rows(self.out))
                    self.assertIn(seen[-1], (self.old, new))
                    self.ends_with(new, words)
                n += STRIDE
        return seen, new

    def ends_with(self, new, words):
        self.ok(*self.words(words))
        self.assertEqual(rows(self.out), new)
        self.assertEqual(os.listdir(self.out.parent), [self.out.name])

    def test_at_any_call_it_is_the_old_store_or_the_new_one(self):
        for name, words in self.jobs():
            with self.subTest(name):
                seen, new = self.at_every_call(words)
                self.assertIn(self.old, seen)
                self.assertIn(new, seen)
                print(f"{name}: {len(seen)} kills")

    def exchange_refused(self, words, *more):
        """A run on a file system that cannot exchange names."""
        command = ["strace", "-f", "-qq", "-o", os.devnull, "-e", "trace=renameat2,rename,unlink",
                   "-e", "inject=renameat2:error=EINVAL", *more, harness.PSS,
                   *map(str, self.words(words))]
        return subprocess.run(command, capture_output=True, text=True)

    def test_where_names_cannot_be_exchanged_no_store_is_lost(self):
        for name, words in self.jobs():
            new, n, killed = self.whole(words), 0, True
            while killed:
                n += 1
                self.begin()
                run = self.exchange_refused(words, "-e", f"inject=rename:signal=SIGKILL:when={n}")
                killed = run.returncode != DONE
                with self.subTest(f"{name}, rename {n}"):
                    held = [rows(path) for path in [self.out, *self.path("here").glob("*/*.pss")]]
                    self.assertTrue({self.old, new} & set(held), held)
                    self.ends_with(new, words)
            self.assertGreater(n, 4)

    def test_a_rename_that_fails_leaves_the_old_store(self):
        for name, words in self.jobs():
            for error in ("EXDEV", "EIO", "EACCES", "ENOSPC"):
                for n in (1, 2):
                    with self.subTest(f"{name} {error} {n}"):
                        self.begin()
                        run = traced(f"renameat2:error={error}:when={n}", self.words(words))
                        self.assertEqual(run.returncode, FAILED, run.stderr)
                        self.assertIn(str(self.out.parent), run.stderr)
                        self.assertEqual(rows(self.out), self.old)
                        self.ends_with(self.whole(words), words)


class Refused(OverwriteStore):
    """What is no store, or not only one, is refused before any work, and left as it is."""

    def unchanged(self, code=FAILED, says=(), more=()):
        for name, words in self.jobs():
            with self.subTest(name):
                before = tree(self.folder)
                run = self.refused(code, *self.words(words)[:-2], "--progress", "json", *more,
                                   says=[self.out, *says])
                self.assertNotIn("stage", run.err)  # no work was begun
                self.assertEqual(tree(self.folder), before)

    def test_a_folder_with_the_names_of_a_store_and_no_manifest(self):
        self.fresh("here")
        self.out.mkdir()
        (self.out / "segment-000000").write_text("somebody's\n")
        self.unchanged(says=["manifest"])
        (self.out / "manifest").write_text("somebody's\n")
        self.unchanged(says=["manifest"])
        (self.out / "manifest").rename(self.out / "manifest.log")
        self.unchanged(says=["manifest"])

    def test_a_store_that_holds_a_foreign_file(self):
        for name in ("notes.txt", "segment-1", ".hidden", "manifest~"):
            self.begin()
            (self.out / name).write_text("somebody's\n")
            self.unchanged(says=[name])

    def test_a_store_that_holds_a_folder_or_a_file_of_somebodys_under_a_segments_name(self):
        self.begin()
        (self.out / "segment-000077").mkdir()
        (self.out / "segment-000077" / "theirs").write_text("somebody's\n")
        self.unchanged(says=["segment-000077"])
        self.begin()
        (self.out / "segment-000077").write_text("somebody's\n")
        self.unchanged(says=["segment-000077"])

    def test_a_link_to_a_store(self):
        self.fresh("here")
        for target in (self.path("old.pss"), self.path("nowhere")):
            self.out.unlink(missing_ok=True)
            self.out.symlink_to(target)
            self.unchanged(says=["link"])

    def test_a_file_of_that_name(self):
        self.fresh("here")
        self.out.write_text("somebody's\n")
        self.unchanged()

    def test_a_mount_point(self):
        self.begin()
        if not places.mount("--bind", self.path("old.pss"), self.out):
            self.skipTest("this process may not mount")
        self.addCleanup(places.unmount, self.out)
        self.unchanged(says=["mount"])

    def test_a_work_directory_on_another_disk(self):
        self.begin()
        disk = self.fresh("disk")
        if not places.mount("-t", "tmpfs", "-o", "size=10m", "none", disk):
            self.skipTest("this process may not mount")
        self.addCleanup(places.unmount, disk)
        self.unchanged(USAGE, says=["--work-dir"], more=["--work-dir", disk / "work"])

    def test_a_work_directory_behind_another_mount_of_the_same_disk(self):
        self.begin()
        bound = self.fresh("bound")
        if not places.mount("--bind", self.fresh("below"), bound):
            self.skipTest("this process may not mount")
        self.addCleanup(places.unmount, bound)
        self.unchanged(more=["--work-dir", bound / "work"])

    def test_a_work_directory_within_the_store_that_is_replaced(self):
        self.begin()
        self.unchanged(USAGE, says=["--work-dir"], more=["--work-dir", self.out / "work"])


if __name__ == "__main__":
    harness.main()
