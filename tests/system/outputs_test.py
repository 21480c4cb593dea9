"""--outputs over scans that have attributes of these names already."""

import random
import struct

import harness
from harness import BAD_INPUT, FAILED, USAGE, Las, Ply, SystemTest

# The attributes of every output, as README and docs/jobs.md name them.
ATTRIBUTES = {
    "normals": ["NormalX", "NormalY", "NormalZ", "nx", "ny", "nz"],
    "curvature": ["MeanCurvature", "GaussianCurvature"],
    "principal": ["PrincipalCurvature1", "PrincipalCurvature2", "PrincipalDirection1X",
                  "PrincipalDirection1Y", "PrincipalDirection1Z"],
    "displacement": ["Displacement"], "residual": ["Residual"], "neighbors": ["Neighbors"],
    "boundary": ["Boundary"], "status": ["Status"],
}
PLY_NAME = ("NormalX", "NormalY", "NormalZ")
MARK = 12345.0  # no output has this value


def write_ply(path, properties, count=600, seed=7):
    """A noisy plane; `properties` are (type, name, value of a point by its number)."""
    rng = random.Random(seed)
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {count}",
             *(f"property double {axis}" for axis in "xyz"),
             *(f"property {kind} {name}" for kind, name, _ in properties), "end_header\n"]
    row = struct.Struct("<3d" + "".join(Ply.CODES[kind] for kind, _, _ in properties))
    with open(path, "wb") as file:
        file.write("\n".join(lines).encode())
        for i in range(count):
            place = rng.uniform(0, 1), rng.uniform(0, 1), rng.gauss(0, 0.01)
            file.write(row.pack(*place, *(value(i) for _, _, value in properties)))


def mark(_):
    return MARK


def number(i):
    return i


class Clashes(SystemTest):
    def scan(self, name, kind="double", path="scan.ply"):
        """A scan with one attribute of this name between two others."""
        write_ply(self.path(path), [("ushort", "id", number), (kind, name, mark),
                                    ("uchar", "Classification", lambda i: 7 if i % 9 == 0 else 2)])
        return self.path(path)

    def words(self, scan, out, outputs):
        return ["smooth", scan, "-o", out, "--h", 0.1, "--outputs", outputs]

    def untouched(self, out):
        """Whether nothing was sorted and nothing written."""
        self.assertFalse(out.exists())
        for name in ("runs", "input.pss", "smooth.pss"):
            self.assertFalse((out.parent / f"{out.name}.work" / name).exists(), name)

    def test_every_output_is_refused_before_the_work_where_an_input_has_its_attribute(self):
        for word, names in ATTRIBUTES.items():
            for name in [*names, names[0].lower(), names[-1].upper()]:
                for outputs in (word, "all"):
                    scan = self.scan(name)
                    for extension in ("ply", "las", "csv", "pss"):
                        out = self.path(f"out.{extension}")
                        words = [*self.words(scan, out, outputs)]
                        with self.subTest(name=name, out=out.name, outputs=outputs):
                            self.refused(USAGE, *words, says=[
                                f"{scan}: ", f"attribute {name} ", f"leave {word} out of --outputs",
                                "--replace-attributes"])
                            self.untouched(out)

    def test_what_is_no_output_of_the_job_clashes_with_nothing(self):
        scan = self.scan("Displacement")
        self.ok(*self.words(scan, self.path("out.ply"), "normals,status"))
        self.assertEqual({row[4] for row in Ply(self.path("out.ply")).rows}, {MARK})

    def test_the_input_that_has_the_attribute_is_named(self):
        first = self.path("first.ply")
        write_ply(first, [("ushort", "id", number)], seed=1)
        second = self.scan("residual", path="second.ply")
        run = self.refused(USAGE, "smooth", first, second, "-o", self.path("out.ply"),
                           "--outputs", "residual", says=[second, "residual"])
        self.assertNotIn(str(first), run.err)

    def test_a_store_is_refused_as_its_files_are(self):
        store = self.path("store.pss")
        self.ok("tile", self.scan("Status"), "-o", store)
        self.refused(USAGE, *self.words(store, self.path("out.ply"), "status"),
                     says=[store, "Status"])
        self.untouched(self.path("out.ply"))

    def test_a_dry_run_refuses_the_same(self):
        scan, store = self.scan("Status"), self.path("store.pss")
        self.ok("tile", scan, "-o", store)
        for source in (scan, store):
            self.refused(USAGE, *self.words(source, self.path("out.ply"), "status"), "--dry-run",
                         says=["--replace-attributes"])

    def test_replaced_attributes_have_the_outputs_values_in_their_place_and_others_stay(self):
        """The same scan without the attribute tells the values; ids tell the points."""
        write_ply(self.path("plain.ply"), [
            ("ushort", "id", number), ("uchar", "Classification", lambda i: 7 if i % 9 == 0 else 2)])
        for word, names in ATTRIBUTES.items():
            plain = self.path(f"plain_{word}.ply")
            self.ok(*self.words(self.path("plain.ply"), plain, word))
            expected = Ply(plain)
            for name in names:
                for kind in ("double", "char", "float") if name == names[0] else ("double",):
                    if kind == "char":
                        write_ply(self.path("scan.ply"), [
                            ("ushort", "id", number), (kind, name, lambda i: 99),
                            ("uchar", "Classification", lambda i: 7 if i % 9 == 0 else 2)])
                        scan = self.path("scan.ply")
                    else:
                        scan = self.scan(name, kind)
                    out = self.path(f"{word}_{name}_{kind}.ply")
                    with self.subTest(name=name, kind=kind):
                        self.ok(*self.words(scan, out, word), "--replace-attributes")
                        found = Ply(out)
                        if name not in PLY_NAME:  # which PLY writes by another name
                            self.assertEqual(found.names[4], name)
                        self.assertEqual(sorted(found.names), sorted(expected.names))
                        order = [found.names.index(n) for n in expected.names]
                        self.assertEqual([tuple(row[i] for i in order) for row in found.rows],
                                         expected.rows)

    def test_both_spellings_of_normals_become_one(self):
        write_ply(self.path("scan.ply"), [("float", n, mark) for n in ("nx", "ny", "nz")] +
                  [("float", n, mark) for n in ("NormalX", "NormalY", "NormalZ")])
        out = self.path("out.ply")
        self.ok(*self.words(self.path("scan.ply"), out, "normals"), "--replace-attributes")
        self.assertEqual(Ply(out).names, ["x", "y", "z", "nx", "ny", "nz"])
        for row in Ply(out).rows:
            self.assertAlmostEqual(sum(v * v for v in row[3:]), 1, places=5)

    def test_a_smoothed_file_is_smoothed_again_with_the_same_outputs(self):
        scan = self.synth("scan.las", "--noise", "0.3", points=5000)
        for extension in ("las", "ply", "txt", "pss"):
            once, twice = self.path(f"once.{extension}"), self.path(f"twice.{extension}")
            self.ok("smooth", scan, "-o", once, "--outputs", "all", "--h", 0.1)
            words = ["smooth", once, "-o", twice, "--outputs", "all", "--h", 0.1]
            self.refused(USAGE, *words, says=["--replace-attributes"])
            self.ok(*words, "--replace-attributes")
        las = Las(self.path("twice.las"))
        self.assertEqual(las.record_size, Las(self.path("once.las")).record_size)
        self.assertEqual(las.vlrs, Las(self.path("once.las")).vlrs)
        self.assertEqual(Ply(self.path("twice.ply")).names, Ply(self.path("once.ply")).names)

    def test_the_flag_is_a_part_of_the_job(self):
        scan, out = self.synth("scan.las", points=5000), self.path("out.las")
        words = ["smooth", scan, "-o", out, "--outputs", "normals"]
        self.ok(*words)
        self.assertIn("already complete", self.ok(*words).err)
        self.refused(FAILED, *words, "--replace-attributes", says=["exists"])


class TooMuch(SystemTest):
    def test_more_attributes_than_las_can_describe_are_refused_before_the_work(self):
        """A LAS file describes 341 attributes; the scan's 330 do, with all outputs they do not."""
        write_ply(self.path("scan.ply"), [("uchar", f"a{i}", lambda i: 1) for i in range(330)],
                  count=300)
        out = self.path("out.las")
        words = ["smooth", self.path("scan.ply"), "-o", out, "--h", 0.2]
        run = self.refused(BAD_INPUT, *words, "--outputs", "all", says=["345 attributes", "341"])
        self.assertNotIn("neighbours", run.err)
        self.assertFalse((self.path("out.las.work") / "input.pss").exists())
        self.ok(*words, "--outputs", "status")


if __name__ == "__main__":
    harness.main()
