"""Figures of several machines in one page: a section for each kind of machine, of which a run replaces its own alone."""
import re

SECTION = re.compile(r"<!-- machine: (.*?) -->\n(.*?)<!-- /machine -->\n", re.S)


def sections(page):
    """{kind of machine: its section}, in the page's order."""
    return dict(SECTION.findall(page))


def section_text(kind, text):
    if "<!--" in kind or "-->" in kind or "\n" in kind:
        raise ValueError(f"no name of a machine: {kind}")
    return f"<!-- machine: {kind} -->\n{text}<!-- /machine -->\n"


def with_section(page, kind, text):
    """{kind: section} of the page, with this one in its old place, or behind the others."""
    return {**sections(page), kind: text}


def table_rows(text, heading):
    """{first cell: {column: cell}} of the table below the heading; columns of the same name: the first."""
    _, found, rest = text.partition(f"\n{heading}\n")
    lines = re.search(r"(?:^\|.*\n)+", rest, re.M) if found else None
    if not lines:
        return {}
    head, _, *rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in lines[0].splitlines()]
    return {row[0]: dict(reversed(list(zip(head[1:], row[1:])))) for row in rows}


def side_by_side(all_sections, heading, columns):
    """(head, rows): per row name of the tables below the heading, the columns of every machine, which is named as short as may be."""
    names_alone = [kind.split(";")[0] for kind in all_sections]
    shown = {kind: alone if names_alone.count(alone) == 1 else kind for kind, alone in zip(all_sections, names_alone)}
    tables = {kind: table_rows(text, heading) for kind, text in all_sections.items()}
    names = list(dict.fromkeys(name for table in tables.values() for name in table))
    head = [""] + [f"{shown[kind]}: {column}" for kind in tables for column in columns]
    return head, [[name] + [tables[kind].get(name, {}).get(column, "") for kind in tables for column in columns] for name in names]
