"""Each file of the generator says `using` itself of what it uses: optimised builds compile eight files at a time, where one lives
of another's, and builds with sanitizers, which compile them one by one, would not compile.

    usings_test.py GENERATOR
"""
import pathlib
import re
import sys


def names_used(text):
    return set(re.findall(r"^\s*using (?:\w+::)+(\w+);", text, flags=re.M))


def code(path):
    return re.sub(r'//.*|"(\\.|[^"\\])*"', "", path.read_text())


def lacking(room):
    """(name, file): used unqualified in a source of the folder that neither declares nor imports it, as others there do."""
    sources = {path: code(path) for path in sorted(room.rglob("*.cpp"))}
    of_headers = set().union(*(names_used(code(path)) for path in room.rglob("*.hpp")))
    for name in sorted(set().union(*map(names_used, sources.values())) - of_headers):
        own = re.compile(rf"using (?:\w+::)+{name};|using {name} =|(?:struct|class|enum) {name}\b|using namespace")
        used = re.compile(rf"(?<![\w:.>]){name}\b(?!\s*\()")
        for path, text in sources.items():
            if used.search(text) and not own.search(text):
                yield name, path


found = [(name, path) for room in sorted(pathlib.Path(sys.argv[1]).iterdir()) if room.is_dir() for name, path in lacking(room)]
for name, path in found:
    print(f"{path} uses '{name}' and does not say where it is from: write 'using …::{name};' in it")
sys.exit(1 if found else 0)
