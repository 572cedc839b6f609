#!/usr/bin/env python3
"""script/lines against known answers, in a repository of its own."""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "script/lines"

# Name, text, and the lines of it that count.
FILES = [("a.cpp", '// comment\n\nint a;  // code and comment\n/* two\nlines */\n/* comment */ int b;\n', 2),
    ("a.h", '#pragma once\n// comment \\\n   which goes on\nint a;\n', 2),
    ("strings.cpp", 'auto url = "https://a/*";\nauto raw = R"x(\n// text\n/* text)"\n)x";\nint big = 1\'000;  // comment\n'
                    "char quote = '\"';  // comment\n/* comment */\n", 7),
    ("a.glsl", "#version 450\n// comment\n/* comment\n\n*/ void main() {}\n", 2),
    ("a.js", "// comment\nconst a = 'https://a';\n/* comment */\n", 1),
    ("strings.js", "const r = /https?:\\/\\/[/*\"]/;\nconst t = `\n// text ${a ? `// b` : '`'}\n\n/* text */`;\nf(a / b);  // c\n"
                   "// comment\n", 5),
    ("a.css", "/* comment\n// comment */\na { background: url(//a/b); }\nb { content: '/*'; }\n", 2),
    ("a.html", "<!-- comment\n-->\n<p>\n", 1),
    ("a.py", '#!/usr/bin/python3\n"""Docstring."""\nimport b  # comment\n\n\ndef f():\n    """Docstring\n    of lines."""\n'
             '    # comment\n    return "#"\n', 3),
    ("strings.py", 'TEXT = """\n# text\n\n"""\nf(\n    """argument\n    of lines""")\n', 6),
    ("a.sh", '#!/bin/sh\n# comment\necho "${x#y}" $# a#b  # comment\necho "a\n# text"\n\t# comment\n', 3),
    ("document.sh", "cat <<'END'\n# text\n\nIt's text.\nEND\n# comment\ncat <<<word\n# comment\n", 5),
    ("within.sh", 'a="$(f "b # c" \'"\')"\n# comment\n', 1),
    ("CMakeLists.txt", '# comment\nproject(a)  # comment\nset(b "\n# text")\nset(c [=[\n# text\n]=])\n#[[ comment\ncomment ]]\n', 6),
    ("a.cmake", 'set(a "\\"# text")\n# comment\n', 1), ("Snakefile", "# comment\nrule all:\n    input: 'a'\n", 2),
    ("python", '#!/usr/bin/env python3\n"""Docstring."""\na = 1\n', 1),
    ("shell", "#!/usr/bin/env bash\ncd a  # comment\n", 1)]
OF_NO_LANGUAGE = [("a.toml", "a = 1\n"), ("a.md", "words\n"), ("text", "words\n"), ("empty", "")]


class Lines(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        subprocess.run(["git", "init", "--quiet", self.root], check=True)
        self.write(".gitignore", "/script/\n/ignored/\n")
        self.write("script/lines.txt", "")
        shutil.copy(SCRIPT, self.root / "script/lines")

    def write(self, path, text):
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text, "utf-8")

    def numbers(self, text):
        self.write("script/lines.txt", text)

    def lines(self, *arguments, code=0):
        """What it prints."""
        done = subprocess.run([self.root / "script/lines", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              encoding="utf-8")
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertEqual(done.stderr if code == 0 else done.stdout, "")
        return done.stdout if code == 0 else done.stderr

    def table(self):
        """{room: [lines, number, left]}"""
        rows = [row.rsplit(maxsplit=3) for row in self.lines().splitlines()[1:]]
        return {room: [int(word) for word in words] for room, *words in rows}

    def listed(self, room):
        rows = [row.split() for row in self.lines("--files", room).splitlines()]
        return [(path, int(count)) for count, path in rows]

    def test_each_language(self):
        for name, text, _ in FILES:
            self.write(f"sim/{name}", text)
        for name, text in OF_NO_LANGUAGE:
            self.write(f"sim/{name}", text)
        expected = sorted(((f"sim/{name}", count) for name, _, count in FILES), key=lambda file: (-file[1], file[0]))
        self.assertEqual(self.listed("sim"), expected)

    def test_python_that_cannot_be_read(self):
        self.write("sim/a.py", "f(")
        self.assertTrue(self.lines(code=1).startswith("lines: sim/a.py: cannot be read as Python: "))

    def test_files_of_git(self):
        for path in ("sim/tracked.h", "sim/new.h", "sim/gone.h", "ignored/a.h"):
            self.write(path, "int a;\n")
        subprocess.run(["git", "add", "sim/tracked.h", "sim/gone.h"], cwd=self.root, check=True)
        (self.root / "sim/gone.h").unlink()
        (self.root / "sim/link.h").symlink_to("new.h")
        self.assertEqual(self.listed("sim"), [("sim/new.h", 1), ("sim/tracked.h", 1)])

    def test_rooms(self):
        files = {"base": ["base/text/a.h"], "bench": ["bench/CMakeLists.txt"], "bench/cli": ["bench/cli/run/a.h"],
                 "script": [".ci/run.sh", "CMakeLists.txt", "cmake/a.cmake"], "tests": ["tests/bench/CMakeLists.txt"]}
        for path in (path for paths in files.values() for path in paths):
            self.write(path, "a\n")
        self.write("bench/python/wobblebench/__init__.pyi", "a = 1\n")
        self.numbers("".join(f"{room} 5\n" for room in files))
        expected = {room: [len(paths), 5, 5 - len(paths)] for room, paths in files.items()}
        self.assertEqual(self.table(), {**expected, "all": [7, 25, 18]})

    def test_words_of_docs(self):
        self.write("README.md", "# Two words\n")
        self.write("CHANGELOG.md", "not counted\n")
        self.write("docs/page.md", "| a | table — |\n| --- | ---: |\n\n## Three more words\n")
        self.write("docs/results/accuracy/accuracy.md", "# Title\n\nFour words by hand.\n\n| 1 | 2 |\n\n## Measured\n\nMuch.\n")
        self.assertEqual(self.listed("docs"), [("docs/page.md", 5), ("docs/results/accuracy/accuracy.md", 5), ("README.md", 2)])
        self.numbers("docs 20\n")
        self.assertEqual(self.table(), {"all": [0, 0, 0], "docs, words": [12, 20, 8]})

    def test_below_at_and_above_the_number(self):
        self.write("sim/a.h", "int a;\nint b;\n")
        self.write("hw/a.h", "int a;\n")
        self.numbers("# comment\nhw 2\nsim 2\n")
        self.assertEqual(self.table(), {"hw": [1, 2, 1], "sim": [2, 2, 0], "all": [3, 4, 1]})
        self.write("sim/new.h", "int c;\n")
        fault, rule = self.lines(code=1).splitlines()
        self.assertEqual(fault, "lines: sim: 3 lines, number 2: 1 above")
        self.assertIn("script/lines --lower", rule)
        self.assertIn("what users get", rule)

    def test_a_new_room_and_one_that_is_gone(self):
        self.write("sim/a.h", "int a;\n")
        self.numbers("gone 7\n")
        gone, new, _ = self.lines(code=1).splitlines()
        self.assertEqual(gone, "lines: gone: no such room, number 7: take it out of script/lines.txt, as --lower does")
        self.assertEqual(new, "lines: sim: 1 lines, no number: add a row `sim 1` to script/lines.txt")

    def test_lower(self):
        for room in ("hw", "render", "sim"):
            self.write(f"{room}/a.h", "int a;\n")
        self.numbers("# comment\ngone 7\nsim 5\nrender 1\nhw 2\n")
        self.assertTrue(self.lines("--lower").startswith("gone: 7, gone\nsim: 5 to 1\nhw: 2 to 1\nroom "))
        self.assertEqual((self.root / "script/lines.txt").read_text(), "# comment\nsim 1\nrender 1\nhw 1\n")

    def test_lower_raises_nothing(self):
        self.write("sim/a.h", "int a;\nint b;\n")
        self.write("hw/a.h", "int a;\n")
        self.numbers("sim 1\n")
        self.assertIn("lines: sim: 2 lines, number 1: 1 above\n", self.lines("--lower", code=1))
        self.assertEqual((self.root / "script/lines.txt").read_text(), "sim 1\n")

    def test_bad_arguments(self):
        self.write("sim/a.h", "int a;\n")
        usage = "must be --lower, --files ROOM or nothing\n"
        for arguments in (["--raise"], ["--files"], ["sim"], ["--lower", "sim"]):
            self.assertEqual(self.lines(*arguments, code=2), f"lines: {' '.join(arguments)}: {usage}")
        self.assertEqual(self.lines("--files", "hw", code=2), "lines: --files hw: must be one of sim\n")

    def test_bad_numbers(self):
        for row in ("sim", "sim -1", "sim 1 2", "sim many", "hw 1"):
            self.numbers(f"hw 1\n{row}\n")
            self.assertEqual(self.lines(code=2),
                             f"lines: script/lines.txt:2: {row}: must be a room and its number, each room once\n")


if __name__ == "__main__":
    unittest.main()
