"""Each source compiles alone. Optimised builds compile the generator's files eight at a time, where one lives of another's `using`,
and read what many files include beforehand; builds with sanitizers do neither, and would not compile.

    alone_test.py ROOT
"""
import pathlib
import re
import sys

# What precompiled headers bring, and which header that is.
BROUGHT = {r"\b(?:TEST|TEST_F|TEST_P|EXPECT_\w+|ASSERT_\w+)\(|\btesting::": "gtest/", r"\bEigen::": "Eigen/", r"\bfmt::": "fmt/"}


def code(path):
    return re.sub(r'//.*|"(\\.|[^"\\])*"', "", path.read_text())


def names_used(text):
    return set(re.findall(r"^\s*using (?:\w+::)+(\w+);", text, flags=re.M))


def lacking_usings(room):
    """(file, what): a name used unqualified that the file neither declares nor imports, as others of the folder do."""
    sources = {path: code(path) for path in sorted(room.rglob("*.cpp"))}
    of_headers = set().union(*(names_used(code(path)) for path in room.rglob("*.hpp")))
    for name in sorted(set().union(*map(names_used, sources.values())) - of_headers):
        own = re.compile(rf"using (?:\w+::)+{name};|using {name} =|(?:struct|class|enum) {name}\b|using namespace")
        used = re.compile(rf"(?<![\w:.>]){name}\b(?!\s*\()")
        for path, text in sources.items():
            if used.search(text) and not own.search(text):
                yield path, f"uses '{name}' and does not say where it is from: write 'using …::{name};' in it"


def lacking_includes(root, folders):
    """(file, what): it uses what a precompiled header brings, and includes that nowhere, nor do the headers that it includes."""
    searched = [root / "generator", root / "runtime" / "include", root / "tests"]
    reached = {}

    def includes(path):
        if path not in reached:
            reached[path] = set()
            for name in re.findall(r'#include ["<]([^">]+)[">]', path.read_text()):
                reached[path].add(name)
                found = next((f for f in (folder / name for folder in [path.parent, *searched]) if f.is_file()), None)
                if found:
                    reached[path] |= includes(found)
        return reached[path]

    for path in sorted(path for folder in folders for path in (root / folder).rglob("*.cpp")):
        for used, header in BROUGHT.items():
            if re.search(used, code(path)) and not any(name.startswith(header) for name in includes(path)):
                yield path, f"uses {re.search(used, code(path))[0]} and includes nothing of <{header}…>"


root = pathlib.Path(sys.argv[1])
found = [x for room in sorted((root / "generator").iterdir()) if room.is_dir() for x in lacking_usings(room)]
found += lacking_includes(root, ["generator", "tests/unit"])
for path, what in found:
    print(f"{path} {what}")
sys.exit(1 if found else 0)
