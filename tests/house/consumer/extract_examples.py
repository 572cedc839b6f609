"""Writes the examples of installed headers as one C++ file: extract_examples.py INCLUDE_DIR OUTPUT.cpp [HEADER…]

An example is what stands between `/// @code` and `/// @endcode`. Each becomes the body of a function; its
#include lines go to the top of the file. Fails where a header has a class and no example, but for the named ones,
which a program of examples/ shows.
"""
import pathlib
import re
import sys

include_dir, output = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
shown_elsewhere = {f"wobblebench/{header}" for header in sys.argv[3:]}
includes, functions, without = set(), [], []
for header in sorted(include_dir.glob("wobblebench/**/*.h")):
    text = header.read_text()
    name = header.relative_to(include_dir).as_posix()
    blocks = re.findall(r"^ *///? @code\n(.*?)^ *///? @endcode", text, re.S | re.M)
    if re.search(r"^class \w+[^;]*\{", text, re.M) and not blocks and name not in shown_elsewhere:
        without.append(name)
    for block in blocks:
        lines = [re.sub(r"^ */// ?", "", line) for line in block.splitlines()]
        includes.add(f'#include "{name}"')
        includes.update(line for line in lines if line.startswith("#include"))
        body = "\n".join("  " + line for line in lines if not line.startswith("#include"))
        functions.append(f"// {name}\nvoid example_{len(functions) + 1}() {{\n{body}\n}}\n")
if without:
    sys.exit("no example in: " + ", ".join(without))
output.write_text("\n".join(sorted(includes)) + "\n\nnamespace wobblebench {\n\n" + "\n".join(functions)
    + "\n}  // namespace wobblebench\n")
print(f"{len(functions)} examples")
