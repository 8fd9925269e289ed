"""Checks that #include lines follow the arrows: the link lists of the CMake targets.

A file in src/FOLDER may include its own folder, kernels/ and every folder that its target's link list reaches; a test may
include what its own link list reaches; kernels/ includes nothing outside itself. The arrows form no circle.

usage: structure.py ROOT      (exit code 1 and one line a fault)
"""

import re
import sys
from pathlib import Path

SOURCES = (".h", ".cpp", ".inl")
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
CALL = re.compile(r"\b(kadr_folder|kadr_test|target_link_libraries)\s*\(([^)]*)\)")


def without_comments(cmake):
    return re.sub(r"#.*", "", cmake)


def link_lists(cmake_file):
    """Target name -> linked names, from the calls of one CMakeLists.txt."""
    lists = {}
    for function, body in CALL.findall(without_comments(cmake_file.read_text())):
        words = body.split()
        if not words:
            continue
        if function == "target_link_libraries":
            linked = [word for word in words[1:] if word not in ("PUBLIC", "PRIVATE", "INTERFACE")]
        else:
            linked = words[words.index("LINK") + 1:] if "LINK" in words else []
        lists.setdefault(words[0], []).extend(linked)
    return lists


def folder_links(root):
    """Folder of src/ -> the folders in the link lists of its targets."""
    folders = sorted(path.parent.name for path in root.glob("src/*/CMakeLists.txt"))
    links = {}
    for folder in folders:
        targets = link_lists(root / "src" / folder / "CMakeLists.txt").values()
        links[folder] = {name for linked in targets for name in linked if name in folders} - {folder}
    return links


def reachable(links, start):
    seen, todo = set(), list(start)
    while todo:
        folder = todo.pop()
        if folder not in seen:
            seen.add(folder)
            todo.extend(links.get(folder, ()))
    return seen


def files_of(folder):
    return [path for path in sorted(folder.rglob("*")) if path.suffix in SOURCES]


def includes(path):
    return INCLUDE.findall(path.read_text(errors="replace"))


def faults_of_file(root, path, allowed, known):
    for include in includes(path):
        top = include.split("/")[0]
        if "/" in include and top in known and top not in allowed:
            yield f'{path.relative_to(root)}: includes "{include}", but its link list does not reach {top}'
        elif ".." in include.split("/"):
            yield f'{path.relative_to(root)}: includes "{include}"; write the path from src/ instead'


def faults_of_sources(root, links):
    known = set(links) | {"kernels"}
    for folder in links:
        allowed = {folder, "kernels"} | reachable(links, links[folder])
        for path in files_of(root / "src" / folder):
            yield from faults_of_file(root, path, allowed, known)


def faults_of_tests(root, links):
    known = set(links) | {"kernels"}
    for cmake_file in sorted(root.glob("tests/*/CMakeLists.txt")):
        folder = cmake_file.parent
        linked = {name for names in link_lists(cmake_file).values() for name in names if name in links}
        own = {path.name for path in folder.iterdir() if path.is_dir()}
        allowed = {"kernels"} | reachable(links, linked) | own
        for path in files_of(folder):
            yield from faults_of_file(root, path, allowed, known)


def faults_of_kernels(root):
    for path in files_of(root / "kernels"):
        for include in includes(path):
            if not include.startswith("kernels/") and not (path.parent / include).exists():
                yield f'{path.relative_to(root)}: includes "{include}"; kernels/ includes nothing outside itself'


def faults_of_arrows(links):
    for folder in links:
        if folder in reachable(links, links[folder]):
            yield f"src/{folder}: its arrows lead back to itself"


def faults(root):
    links = folder_links(root)
    if not links:
        return [f"{root}: no src/*/CMakeLists.txt"]
    return [*faults_of_arrows(links), *faults_of_sources(root, links), *faults_of_tests(root, links),
            *faults_of_kernels(root)]


if __name__ == "__main__":
    found = faults(Path(sys.argv[1]).resolve())
    print("\n".join(found) if found else "every include follows an arrow")
    sys.exit(1 if found else 0)
