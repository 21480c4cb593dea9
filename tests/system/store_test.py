"""pss tile, verify and export: a store made once, checked, damaged, written as a file."""

import random
import signal
import time

import harness
from harness import BAD_INPUT, FAILED, USAGE, Las, SystemTest


class Store(SystemTest):
    def setUp(self):
        super().setUp()
        self.scan, self.store = self.path("scan.las"), self.path("scan.pss")
        harness.write_las(self.scan, harness.random_records(50000, 5, 3), point_format=3)

    def rows(self, store):
        """The hash that verify prints."""
        return self.ok("verify", store).out.split()[-1]

    def test_a_store_holds_every_record_and_writes_it_back(self):
        out = self.path("out.las")
        self.ok("tile", self.scan, "-o", self.store)
        self.ok("export", self.store, "-o", out)
        before, after = Las(self.scan), Las(out)
        self.assertEqual(sorted(after.record(i) for i in range(after.count)),
                         sorted(before.record(i) for i in range(before.count)))
        self.assertEqual((after.scale, after.offset), (before.scale, before.offset))

    def test_equal_rows_have_equal_hashes_whatever_the_tiles_and_the_order(self):
        records = harness.random_records(50000, 5, 3)
        random.Random(1).shuffle(records)
        shuffled = self.path("shuffled.las")
        harness.write_las(shuffled, records, point_format=3)
        self.ok("tile", self.scan, "-o", self.store)
        self.ok("tile", self.scan, "-o", self.path("small.pss"), "--tile-points", 1000)
        self.ok("tile", shuffled, "-o", self.path("shuffled.pss"), "--threads", 1)
        expected = self.rows(self.store)
        self.assertEqual(self.rows(self.path("small.pss")), expected)
        self.assertEqual(self.rows(self.path("shuffled.pss")), expected)

    def test_other_rows_have_another_hash(self):
        self.ok("tile", self.scan, "-o", self.store)
        records = harness.random_records(50000, 5, 3)
        records[777] = records[777][:-1] + bytes([records[777][-1] ^ 1])
        harness.write_las(self.path("other.las"), records, point_format=3)
        self.ok("tile", self.path("other.las"), "-o", self.path("other.pss"))
        self.assertNotEqual(self.rows(self.path("other.pss")), self.rows(self.store))

    def test_a_store_is_found_complete_kept_and_replaced(self):
        self.ok("tile", self.scan, "-o", self.store)
        self.assertIn("already complete", self.ok("tile", self.scan, "-o", self.store).err)
        self.refused(FAILED, "tile", self.scan, "-o", self.store, "--tile-points", 1000,
                     says=["scan.pss"])
        self.ok("tile", self.scan, "-o", self.store, "--tile-points", 1000, "--overwrite")
        self.assertIn("1,000", self.ok("info", self.store).out)

    def test_killed_at_any_moment_it_ends_with_the_same_rows(self):
        self.ok("tile", self.scan, "-o", self.path("whole.pss"), "--tile-points", 500)
        rng = random.Random(2)
        for _ in range(10):
            job = harness.start("tile", self.scan, "-o", self.store, "--tile-points", 500)
            time.sleep(rng.uniform(0, 0.2))
            harness.signal_to(job, signal.SIGKILL)
            harness.finish(job)
        self.ok("tile", self.scan, "-o", self.store, "--tile-points", 500)
        self.assertEqual(self.rows(self.store), self.rows(self.path("whole.pss")))

    def test_a_flipped_bit_anywhere_is_found(self):
        self.ok("tile", self.scan, "-o", self.store, "--tile-points", 5000)
        rng = random.Random(3)
        for file in sorted(p for p in self.store.rglob("*") if p.is_file()):
            whole = file.read_bytes()
            for at in [0, len(whole) - 1, *(rng.randrange(len(whole)) for _ in range(20))]:
                damaged = bytearray(whole)
                damaged[at] ^= 1 << rng.randrange(8)
                file.write_bytes(damaged)
                self.refused(BAD_INPUT, "verify", self.store, says=[file.name])
            file.write_bytes(whole)
        self.ok("verify", self.store)

    def test_a_flipped_bit_anywhere_is_found_by_every_command_that_reads_it(self):
        harness.write_las(self.scan, harness.random_records(2000, 5, 3), point_format=3)
        self.ok("tile", self.scan, "-o", self.store, "--tile-points", 500)
        out = self.path("out.las")
        sound = self.ok("info", self.store, "--json").out
        commands = {"verify": [], "export": ["-o", out],
                    "smooth": ["-o", out, "--radius", 3, "--h", 1, "--restart"]}
        rng = random.Random(4)
        for file in sorted(p for p in self.store.rglob("*") if p.is_file()):
            whole = file.read_bytes()
            for at in [0, len(whole) - 1, *(rng.randrange(len(whole)) for _ in range(30))]:
                damaged = bytearray(whole)
                damaged[at] ^= 1 << rng.randrange(8)
                file.write_bytes(damaged)
                place = f"{file.name}: damaged at offset "
                for command, words in commands.items():
                    self.refused(BAD_INPUT, command, self.store, *words, says=[place])
                    self.assertFalse(out.exists())
                info = harness.pss("info", self.store, "--json")
                if info.code == BAD_INPUT:  # it reads no points, and no head of an input
                    self.assertIn(file.name, ("manifest", "inputs"))
                    self.assertIn(place, info.err)
                else:
                    self.assertNotEqual(file.name, "manifest")
                    self.assertEqual(info.out, sound)
            file.write_bytes(whole)

    def test_a_damaged_store_is_not_written_as_a_file(self):
        self.ok("tile", self.scan, "-o", self.store)
        segment = max(self.store.rglob("*"), key=lambda p: p.stat().st_size)
        damaged = bytearray(segment.read_bytes())
        damaged[len(damaged) // 2] ^= 1
        segment.write_bytes(damaged)
        self.refused(BAD_INPUT, "export", self.store, "-o", self.path("out.las"),
                     says=[segment.name])
        self.assertFalse(self.path("out.las").exists())

    def test_points_of_scans_that_share_no_grid_move_at_most_half_a_step(self):
        other = self.path("other.las")
        harness.write_las(other, harness.random_records(1000, 6, 3), offset=(0.0004, 0, 0),
                          point_format=3)
        run = self.ok("tile", self.scan, other, "-o", self.store)
        self.assertIn("other.las", run.err)
        self.assertIn("1,000 points onto the common lattice", run.err)

    def test_what_is_no_store_name_or_no_store_is_refused(self):
        self.refused(USAGE, "tile", self.scan, "-o", self.path("scan.las2"))
        self.refused(FAILED, "verify", self.path("nowhere.pss"), says=["nowhere.pss"])
        self.path("empty.pss").mkdir()
        run = harness.pss("verify", self.path("empty.pss"))
        self.assertIn(run.code, (FAILED, BAD_INPUT))
        self.assertIn("empty.pss", run.err)


if __name__ == "__main__":
    harness.main()
