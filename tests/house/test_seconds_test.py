#!/usr/bin/env python3
"""script/test-seconds against known runs, in a folder of its own."""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "script/test-seconds"


class Seconds(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for name in ("script", "tests"):
            (self.root / name).mkdir()
        shutil.copy(SCRIPT, self.root / "script")
        self.kept = self.root / "tests/seconds.txt"

    def after(self, run, *arguments, code=0):
        """What it says of a run of {test: seconds}, or (seconds, status)."""
        cases = [(test, took if isinstance(took, tuple) else (took, "run")) for test, took in run.items()]
        junit = self.root / "run.xml"
        junit.write_text("<testsuite>" + "".join(
            f'<testcase name="{test}" classname="{test}" time="{seconds}" status="{status}"><system-out/></testcase>'
            for test, (seconds, status) in cases) + "</testsuite>", "utf-8")
        done = subprocess.run([self.root / "script/test-seconds", junit, self.root / "measured.txt", *arguments],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8")
        self.assertEqual((done.returncode, done.stdout), (code, ""), done.stderr)
        return done.stderr.splitlines()

    @staticmethod
    def rows(path):
        return [line for line in path.read_text("utf-8").splitlines() if not line.startswith("#")]

    def test_measured_are_those_of_a_second_or_more_by_name(self):
        self.after({"b_test.B": 136.4, "a_test.Weeks/A": 1.04, "a_test.Quick": 0.99, "C": 9.96, "failed": (50, "fail"),
                    "skipped": (3, "notrun")})
        self.assertEqual(self.rows(self.root / "measured.txt"), ["C 10", "a_test.Weeks/A 1", "b_test.B 140"])
        self.assertLessEqual((self.root / "measured.txt").read_text("utf-8").count("#"), 3)
        self.assertFalse(self.kept.exists(), "not saved")

    def test_longer_and_new_ones_are_said(self):
        self.kept.write_text("# comment\nlonger 10\ntwice 20\nshort 2\nless 30\nfailed 2\n", "utf-8")
        said = self.after({"longer": 31, "twice": 40, "short": 6, "less": 3, "new": 1.26, "quick": 0.9,
                           "failed": (900, "fail")})
        self.assertEqual(said, ["test: longer took 31 s, 10 s in tests/seconds.txt",
                                "test: new took 1.3 s and is not in tests/seconds.txt"])

    def test_at_most_five_lines_are_said(self):
        self.assertEqual(len(self.after({f"t{i}": i for i in range(1, 6)})), 5)
        said = self.after({f"t{i}": i for i in range(1, 9)})
        self.assertEqual(said[0], "test: t8 took 8 s and is not in tests/seconds.txt")
        self.assertEqual(said[4:], ["test: and 4 more"])

    def test_saved_after_a_part_other_lines_stay(self):
        self.kept.write_text("a 5\nelsewhere 7\nfailed 2\nnow_quick 3\n", "utf-8")
        self.after({"a": 6.11, "failed": (90, "fail"), "now_quick": 0.4, "new": 8}, "--save")
        self.assertEqual(self.rows(self.kept), ["a 6.1", "elsewhere 7", "failed 2", "new 8"])

    def test_saved_after_all_only_those_that_ran_stay(self):
        self.kept.write_text("a 5\ngone 7\nfailed 2\nskipped 4\n", "utf-8")
        self.after({"a": 6, "failed": (90, "fail"), "skipped": (0.1, "notrun")}, "--save-all")
        self.assertEqual(self.rows(self.kept), ["a 6", "failed 2", "skipped 4"])

    def test_bad_arguments(self):
        self.assertEqual(self.after({}, "--all", code=1), ["test-seconds: must be JUNIT MEASURED [--save | --save-all]"])


if __name__ == "__main__":
    unittest.main()
