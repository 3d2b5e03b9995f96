"""No expression leaves to the compiler which of its nodes is made first: where two operands, or two arguments of a call, make
nodes of a graph, one is named beforehand (generator/passes/symbolic.hpp). Else generated code depends on the compiler that built
the generator: g++ begins at the right, clang++ at the left. Read from clang++'s syntax tree; without clang++ exits with 77.

    order_test.py ROOT EIGEN
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys

# What makes nodes, roles or sweeps: calls that give such values, and those that are handed what makes them.
VALUES = re.compile(r"\b(Sym|Sym6|Vec3|Mat3|NodeId|Twist|Pose|Sums|BodyConstants|JointPosition|Motion|Force)\b")
MAKERS = re.compile(r"\b(SweepBuilder|Builder|Graph|Copy)\b")
# Of these, the ones that make none.
FREE = set("operator[] at front back column transpose full from_columns entry operator= operator-> begin end size empty find contains "
           "is_constant has tree scene base_coordinates own_name graph options joints any_spring any_quaternion".split())
# Calls whose operands have an order.
ORDERED = {"operator=", "operator+=", "operator-=", "operator*=", "operator<<", "operator>>", "operator,", "operator[]", "operator&&",
           "operator||"}
CALLS = {"CallExpr", "CXXMemberCallExpr", "CXXOperatorCallExpr"}
CONSTRUCTORS = {"CXXConstructExpr", "CXXTemporaryObjectExpr"}


def type_of(node):
    return (node.get("type") or {}).get("qualType", "")


def name_of(node):
    """Of what a call calls."""
    while node:
        if node.get("kind") == "DeclRefExpr":
            return node.get("referencedDecl", {}).get("name", "")
        if node.get("kind") == "MemberExpr":
            return node.get("name", "")
        node = (node.get("inner") or [None])[0]
    return ""


class Reader:
    """clang names a file and a line where they are others than those it named before."""

    def __init__(self):
        self.file, self.line, self.found = "", 0, set()

    def locate(self, place):
        for name in ("spellingLoc", "expansionLoc"):
            if name in place:
                self.locate(place[name])
        self.file, self.line = place.get("file", self.file), place.get("line", self.line)

    def makes(self, node):
        """Whether evaluating it makes nodes."""
        self.locate(node.get("loc") or {})
        self.locate(node.get("range", {}).get("begin") or {})
        here = f"{self.file}:{self.line}"
        self.locate(node.get("range", {}).get("end") or {})
        parts = [child for child in node.get("inner", []) if child]
        made = [self.makes(child) for child in parts]
        kind = node.get("kind")
        if kind == "LambdaExpr":
            return False
        if kind in CALLS:
            name = name_of(parts[0])
            if sum(made[1:]) > 1 and name not in ORDERED:
                self.found.add((here, f"two operands or arguments of {name} make nodes: name the right one beforehand"))
            handed = [*parts, *parts[0].get("inner", [])]
            own = VALUES.search(type_of(node)) or any(MAKERS.search(type_of(x)) for x in handed)
            return any(made) or bool(own and name not in FREE)
        if kind in CONSTRUCTORS and not node.get("list") and sum(made) > 1:
            self.found.add((here, "two arguments of a constructor make nodes: name the right one beforehand"))
        return any(made)


def read(root, sources):
    """Several at once, as optimised builds compile them, for most of it is headers; where they do not go together, one by one."""
    generator = root / "generator"
    command = ["clang++", "-std=c++20", "-fsyntax-only", "-Xclang", "-ast-dump=json", "-Xclang", "-ast-dump-filter=dalembert::passes",
               f"-I{generator}", f"-I{root / 'runtime' / 'include'}", "-isystem", sys.argv[2], "-x", "c++", "-"]
    together = "".join(f'#include "{source}"\n' for source in sources)
    run = subprocess.run(command, input=together, capture_output=True, text=True)
    if run.returncode != 0 and len(sources) > 1:
        return set().union(*(read(root, [source]) for source in sources))
    if run.returncode != 0:
        return {(str(sources[0]), "clang++: " + run.stderr[:500])}
    found, at, decoder = set(), 0, json.JSONDecoder()
    while begin := re.compile(r"\S").search(run.stdout, at):
        if run.stdout[begin.start()] != "{":  # "Dumping …:"
            at = run.stdout.index("\n", begin.start())
            continue
        tree, at = decoder.raw_decode(run.stdout, begin.start())
        reader = Reader()
        reader.makes(tree)
        found |= {x for x in reader.found if str(generator) in x[0]}
    return found


def main():
    if not shutil.which("clang++"):
        return 77
    sys.setrecursionlimit(10000)
    root = pathlib.Path(sys.argv[1]).resolve()
    sources = [path for path in sorted((root / "generator" / "passes").rglob("*.cpp"))
               if re.search(r"\b(SweepBuilder|Sym|Vec3|Twist)\b", path.read_text())]
    together = 8
    found = set().union(*(read(root, sources[i:i + together]) for i in range(0, len(sources), together)))
    for place, what in sorted(found):
        print(f"{place}: {what}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
