"""What the cells came to, as a table in Markdown."""
import collections
import datetime
import pathlib
import re

import design
import toolchain

MARK = re.compile(r"<!-- matrix -->.*<!-- /matrix -->", re.DOTALL)


def entry(counts):
    """`12 + 3` are 12 right and 3 that were only compiled; wrong ones stand out."""
    parts = [str(counts["right"])] if counts["right"] or not counts["compiled"] else []
    if counts["compiled"]:
        parts.append(f"({counts['compiled']})")
    return " + ".join(parts) + (f" **{counts['wrong']} wrong**" if counts["wrong"] else "") if sum(counts.values()) else ""


def crossed(verdicts, title, row_of, column_of):
    counts = collections.defaultdict(collections.Counter)
    rows, columns = {}, {}
    for (program, tools), (verdict, _) in verdicts.items():
        if verdict in ("absent", "not visited"):
            continue
        row, column = row_of(program, tools), column_of(program, tools)
        rows[row] = columns[column] = None
        counts[row, column][verdict] += 1
    heads = sorted(columns, key=order)
    lines = [f"| {title} | " + " | ".join(map(str, heads)) + " |", "| --- |" + " ---: |" * len(heads)]
    lines += [f"| {row} | " + " | ".join(entry(counts[row, column]) for column in heads) + " |" for row in sorted(rows, key=order)]
    return "\n".join(lines)


def order(name):
    known = [*design.COMPILERS, design.AARCH64, *design.LEVELS, *design.TARGETS, "aarch64", *design.ROBOTS, *map(str, design.LANES)]
    return known.index(str(name)) if str(name) in known else len(known)


def written(verdicts, remembered, machine):
    total = collections.Counter(verdict for verdict, _ in verdicts.values())
    used = sorted({tools[0] for (_, tools), (verdict, _) in verdicts.items() if verdict in ("right", "wrong", "compiled")}, key=order)
    short = {c: c for c in design.COMPILERS} | {design.AARCH64: "aarch64"}
    lines = [
        f"{len(verdicts)} cells: {total['right']} right, {total['wrong']} wrong, {total['compiled']} compiled and not run, "
        f"{total['absent']} left out for want of the compiler"
        f"{', ' + str(remembered) + ' of them known from runs before' if remembered else ''}"
        f"{', ' + str(total['not visited']) + ' not visited for want of time' if total['not visited'] else ''}. "
        f"{machine}, {datetime.date.today()}.",
        "",
        crossed(verdicts, "", lambda p, t: t[2], lambda p, t: short.get(t[0], t[0])),
        "",
        crossed(verdicts, "lanes", lambda p, t: t[3], lambda p, t: t[1]),
        "",
        crossed(verdicts, "robot", lambda p, t: p[0], lambda p, t: p[1]),
        "",
        *(f"- {compiler}: {toolchain.version(compiler)}" for compiler in used),
    ]
    lines += [f"- **wrong**: {' '.join(map(str, tools))}, {' '.join(program)}: {details}"
              for (program, tools), (verdict, details) in verdicts.items() if verdict == "wrong"]
    return "\n".join(lines)


def insert(page, text):
    whole = page.read_text()
    page.write_text(MARK.sub(lambda _: f"<!-- matrix -->\n{text}\n<!-- /matrix -->", whole))
