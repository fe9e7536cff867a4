#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""unite_sources.py OUT BATCH LIST: writes sources, each of which includes up to BATCH of the sources that the file LIST
names, and prints the sources to compile instead. Headers and templates are then compiled once for several sources.

Sources are united if they are in the same folder, and if no private name of one of them (in an anonymous namespace, or
by #define) appears in another or is declared in a header of another. So each name means the same as in a source that is
compiled alone."""
import os
import re
import sys

OUT, BATCH = sys.argv[1], int(sys.argv[2])

COMMENT_OR_TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.S)
TYPE = re.compile(r"(?:template <.*> )?(?:struct|class|enum class|enum|union|using)\s+(\w+)")
VALUE = re.compile(r"(\w+)\s*(?:\[[^\]]*\]\s*)*(?:=|\{|;)")
# The second and later variables that a line declares.
FURTHER = re.compile(r",\s*[*&]?(\w+)\s*(?:\[[^\]]*\]\s*)*(?==|\{|;|,)")
LAST = re.compile(r"(\w+)\s*$")
NAME = re.compile(r"[A-Za-z_]\w*")


INCLUDE = re.compile(r'^#include "([^"]+)"', re.M)
ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "../.."))
headers = {}


def declared(text, everywhere):
    """Returns names that are declared in anonymous namespaces, or in all namespaces, by lines without indentation."""
    names = set(re.findall(r"^[ \t]*#[ \t]*define[ \t]+(\w+)", text, re.M))
    inside = everywhere
    for line in text.split("\n"):
        if line.startswith("namespace") and "=" not in line:
            inside = everywhere or line.startswith("namespace {")
            continue
        if re.match(r'}\s+""$', line):  # the closing brace of a namespace, which a comment follows
            inside = everywhere
        if not line or line[0] in " }#" or not (inside or line.startswith("static ")):
            continue
        found = TYPE.match(line)
        if not found:
            head = line.split("(")[0] if "(" in line else ""
            found = LAST.search(head) if head and not re.search("[={]", head) else VALUE.search(line)
        if found:
            names.add(found.group(1))
            if found.re is VALUE:
                names.update(FURTHER.findall(line))
    return names


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def declared_in_headers(text):
    """Returns names that are declared by the project's headers that a text includes, directly or through other
    headers."""
    names = set()
    for name in INCLUDE.findall(text):
        path = os.path.join(ROOT, name)
        if path not in headers:
            headers[path] = set()  # a header that is being read
            if os.path.exists(path):
                within = read(path)
                headers[path] = declared(COMMENT_OR_TEXT.sub('""', within), True) | declared_in_headers(within)
        names |= headers[path]
    return names


def tests_headers(text, found):
    """Returns the headers in tests/ that a text includes, directly or through others. Two of them may define the same
    name."""
    for name in INCLUDE.findall(text):
        path = os.path.join(ROOT, name)
        if name.startswith("tests/") and name not in found and os.path.exists(path):
            within = read(path)
            found[name] = declared(COMMENT_OR_TEXT.sub('""', within), True)
            tests_headers(within, found)
    return found


class Source:
    def __init__(self, path):
        written = read(path)
        text = COMMENT_OR_TEXT.sub('""', written)
        self.path = path
        self.own = declared(text, False)
        self.tests_headers = tests_headers(written, {})
        # Members (names after a dot or an arrow) do not count, since they cannot mean another source's private name.
        self.said = set(NAME.findall(re.sub(r"(?:\.|->)\s*\w+", " ", text))) | declared_in_headers(written)


def clash(a, b):
    for one, names in a.tests_headers.items():
        if any(one != other and not names.isdisjoint(others) for other, others in b.tests_headers.items()):
            return True
    return not a.own.isdisjoint(b.said) or not b.own.isdisjoint(a.said)


def batches(sources):
    made = []
    for source in sources:
        for batch in made:
            if len(batch) < BATCH and not any(clash(source, other) for other in batch):
                batch.append(source)
                break
        else:
            made.append([source])
    return made


def write_if_changed(path, text):
    if os.path.exists(path) and read(path) == text:
        return
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def main():
    paths = read(sys.argv[3]).split()
    folders = {}
    for path in sorted(paths):
        folders.setdefault(os.path.dirname(path), []).append(path)
    os.makedirs(OUT, exist_ok=True)
    for folder in sorted(folders):
        name = re.sub(r"\W", "_", os.path.relpath(folder, ROOT))
        for number, batch in enumerate(batches([Source(path) for path in folders[folder]])):
            if len(batch) == 1:
                print(batch[0].path)
                continue
            united = os.path.join(OUT, f"{name}_{number}.cpp")
            write_if_changed(united, "".join(f'#include "{source.path}"\n' for source in batch))
            print(united)


main()
