"""docs/library.md: what it shows is what is compiled, and what it says it prints."""

import pathlib
import re
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/library.md").read_text()
EXAMPLE = None  # the compiled example; the command line says where


def block(title):
    """The code block of the page under the comment with this title."""
    found = re.search(rf"<!-- {re.escape(title)} -->\n```\w*\n(.*?)```\n", PAGE, re.DOTALL)
    return found.group(1) if found else None


class Page(unittest.TestCase):
    def test_it_shows_the_files_that_are_compiled(self):
        for name in ("CMakeLists.txt", "smooth_sphere.cpp"):
            self.assertEqual(block(f"examples/{name}"), (ROOT / "docs/examples" / name).read_text())

    def test_the_headers_that_it_names_exist(self):
        headers = re.findall(r"(?:core|io|stream)/[\w/]+\.h", PAGE)
        self.assertGreater(len(headers), 3)
        for header in headers:
            self.assertTrue((ROOT / header).is_file(), header)


class Example(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        run = subprocess.run([EXAMPLE], capture_output=True, text=True, timeout=120, check=True)
        cls.out = run.stdout
        cls.answers = [
            (line.split(":")[0], [float(number) for number in re.findall(r"-?\d+\.\d+", line)])
            for line in cls.out.splitlines()
            if "normal" in line
        ]

    def test_it_prints_what_the_page_says(self):
        self.assertEqual(self.out, block("output of smooth_sphere"))

    def test_the_noise_falls_by_the_factor_of_the_theory(self):
        ratio, theory = map(float, re.search(r"ratio (\S+), in theory (\S+)", self.out).groups())
        self.assertAlmostEqual(theory, 0.631 / 4, delta=0.001)
        self.assertAlmostEqual(ratio, theory, delta=0.1 * theory)

    def test_queries_near_the_sphere_are_carried_onto_it(self):
        self.assertEqual([status for status, _ in self.answers], ["ok", "ok", "too_few"])
        for _, (x, y, z, nx, ny, nz, mean_curvature) in self.answers[:2]:
            self.assertAlmostEqual((x * x + y * y + z * z) ** 0.5, 1, delta=0.006)
            self.assertAlmostEqual(x * nx + y * ny + z * nz, 1, delta=0.02)
            self.assertAlmostEqual(mean_curvature, -1, delta=0.3)

    def test_a_far_query_stays(self):
        self.assertEqual(self.answers[2][1][:3], [0, 0, 5])


if __name__ == "__main__":
    EXAMPLE = sys.argv.pop(1)
    unittest.main()
