"""What is installed: the headers that docs/library.md names, and what these include; no more."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
LAYERS = ["core", "io", "stream"]


def listed(name):
    """The headers of a list of pss_add_library() over all layers."""
    found = set()
    for layer in LAYERS:
        text = (ROOT / layer / "CMakeLists.txt").read_text()
        words = re.search(rf"^  {name}\b(.*?)^  [A-Z_]+\b", text, re.DOTALL | re.MULTILINE)
        found |= {f"{layer}/{word}" for word in words.group(1).split()}
    return found


def named():
    """The headers in the table of docs/library.md."""
    text = (ROOT / "docs/library.md").read_text()
    table = re.search(r"^\| header \| for \|$(.*?)^$", text, re.DOTALL | re.MULTILINE)
    return set(re.findall(r"`([a-z_/]+\.h)`", table.group(1)))


def with_included(headers):
    """The headers, what they include of pss, and so on."""
    found, left = set(), list(headers)
    while left:
        header = left.pop()
        if header in found:
            continue
        found.add(header)
        left += re.findall(r'^#include "([^"]+)"', (ROOT / header).read_text(), re.MULTILINE)
    return found


class PublicHeaders(unittest.TestCase):
    def test_are_those_that_the_documentation_names_and_what_they_include(self):
        self.assertGreater(len(named()), 8)
        self.assertEqual(sorted(listed("PUBLIC_HEADERS")), sorted(with_included(named())))


if __name__ == "__main__":
    unittest.main()
