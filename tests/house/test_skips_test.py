#!/usr/bin/env python3
"""script/test-skips against the words of each test runner, in a folder of its own."""
import pathlib
import shutil
import subprocess
import tempfile
import unittest
from xml.sax.saxutils import escape, quoteattr

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "script/test-skips"
GOOGLETEST = """[ RUN      ] Fifo.CanBeRead
/a/fifo_test.cpp:220: Skipped
root may read everything

[  SKIPPED ] Fifo.CanBeRead (0 ms)
[ RUN      ] Fifo.SkipsWhatIsOld
[       OK ] Fifo.SkipsWhatIsOld (0 ms)
[ RUN      ] All/Fifo.Is/0
[  SKIPPED ] All/Fifo.Is/0, where GetParam() = "egl" (0 ms)
[  SKIPPED ] 2 tests, listed below:
[  SKIPPED ] Fifo.CanBeRead
[  SKIPPED ] All/Fifo.Is/0, where GetParam() = "egl"
"""
UNITTEST = """test_a (__main__.Ball.test_a)
A ball. ... ok
test_b (__main__.Ball.test_b) ... skipped 'no plastimatch'
test_c (__main__.Ball.test_c)
A ball away from all axes. ... skipped "VTK's reader is absent"
OK (skipped=2)
"""
NODE = """ok 1 - a page fits
ok 2 - a page is read # SKIP no screen reader
not ok 3 - later # TODO
# pass 1
# skipped 1
# todo 1
"""


class Skips(unittest.TestCase):
    def after(self, allowed="", code=1, **run):
        """What it says of a run of {test: output}, or of tests that did not run."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name in ("script", "tests"):
                (root / name).mkdir()
            shutil.copy(SCRIPT, root / "script")
            (root / "tests/skips.txt").write_text("# PATTERN REASON\n" + allowed, "utf-8")
            (root / "run.xml").write_text("<testsuite>" + "".join(
                f"<testcase name={quoteattr(test)} status={quoteattr('run' if output else 'notrun')}>"
                f"<system-out>{escape(output)}</system-out></testcase>" for test, output in run.items()) +
                "</testsuite>", "utf-8")
            done = subprocess.run([root / "script/test-skips", root / "run.xml"], capture_output=True, encoding="utf-8")
        self.assertEqual((done.returncode, done.stdout), (code, ""), done.stderr)
        return done.stderr.splitlines()

    def test_each_runner_s_cases_are_named_with_their_reasons(self):
        said = self.after(**{"hw_test.Fifo": GOOGLETEST, "exchange_export": UNITTEST, "pages_test.run": NODE})
        self.assertEqual(said, ["test: skipped hw_test.Fifo.CanBeRead: root may read everything",
            'test: skipped hw_test.All/Fifo.Is/0: where GetParam() = "egl"',
            "test: skipped exchange_export.test_b: no plastimatch",
            "test: skipped exchange_export.test_c: VTK's reader is absent",
            "test: skipped pages_test.a_page_is_read: no screen reader",
            "test: skipped pages_test.later: no reason given",
            "test: 6 of 6 skipped are not in tests/skips.txt: hw_test.Fifo.CanBeRead, hw_test.All/Fifo.Is/0, "
            "exchange_export.test_b, exchange_export.test_c, pages_test.a_page_is_read, pages_test.later"])

    def test_what_a_test_in_the_place_of_an_absent_one_says(self):
        said = self.after(python_module="[  SKIPPED ] python_module: built without the Python module (0 ms)\n")
        self.assertEqual(said[0], "test: skipped python_module: built without the Python module")

    def test_what_has_no_name_is_counted(self):
        for output in ("Ran 9 tests in 2 s\n\nOK (skipped=3)\n", "FAILED (failures=1, skipped=3)\n", "ℹ skipped 3\n",
                       "[  PASSED  ] 4 tests.\n\n  YOU HAVE 3 DISABLED TESTS\n"):
            self.assertEqual(self.after(a=output)[0], "test: skipped a: cases without names: 3")
        self.assertEqual(self.after(a="")[0], "test: skipped a: CTest did not run it")

    def test_allowed_ones_are_named_and_fail_nothing(self):
        run = {"hw_test.Fifo": GOOGLETEST, "exchange_export": "OK\n"}
        self.assertEqual(len(self.after("hw_test.*Fifo.* root\n", 0, **run)), 2)
        said = self.after("hw_test.Fifo.* root\n", **run)
        self.assertEqual(said[2:], ["test: 1 of 2 skipped are not in tests/skips.txt: hw_test.All/Fifo.Is/0"])
        self.assertEqual(self.after(code=0, exchange_export="OK\n"), [])


if __name__ == "__main__":
    unittest.main()
