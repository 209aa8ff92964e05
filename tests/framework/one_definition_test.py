#!/usr/bin/env python3
"""No two types of the project share a name.

C++ lets a program hold one definition of a name. Two headers that both define `tomlin::Reference`
compile, link without a word, and then share the members of `std::vector<Reference>`, laid out for
one of them. Neither the compiler nor the linker says so, and what optimises hides it.

Looks at types in named namespaces, as clang-format lays them out.

usage: one_definition_test.py FOLDER...
"""
import collections
import pathlib
import re
import sys

OPENS = re.compile(r"(?:inline )?namespace(?: ([\w:]+))? *\{")
CLOSES = re.compile(r"\}  // (?:inline )?(?:anonymous )?namespace")
DEFINES = re.compile(r"(?:template *<.*> *)?(?:struct|class|enum class|enum|union) "
                     r"(?:alignas\(\w+\) )?(\w+)(?: final)?(?: *:[^:].*)? *(?:\{.*)?$")
FEWEST = 300  # types that there are, or the pattern reads nothing


def definitions(text):
    """Names of the types that a file defines for the whole program."""
    found, inside = [], []
    for line in text.splitlines():
        if opened := OPENS.match(line):
            inside.append(opened.group(1))
        elif CLOSES.match(line):
            inside.pop()
        elif (defined := DEFINES.match(line)) and (not line.endswith(";") or "{" in line):
            if None not in inside:
                found.append("::".join([*inside, defined.group(1)]))
    return found


def shared(files):
    """Names defined in more than one of the files (texts by name), with the files."""
    places = collections.defaultdict(list)
    for name, text in files.items():
        for one in definitions(text):
            if name not in places[one]:  # alternatives of the preprocessor stand in one file
                places[one].append(name)
    return {name: where for name, where in places.items() if len(where) > 1}, len(places)


def check_that_it_sees():
    """The pattern finds what it has to, and accuses nothing else."""
    one = "namespace tomlin {\nstruct Work {\n};\n}  // namespace tomlin\n"
    short = "namespace tomlin {\nclass Work final : public Base {};\n}  // namespace tomlin\n"
    private = "namespace tomlin {\nnamespace {\nstruct Work {\n};\n}  // namespace\n}  // namespace tomlin\n"
    other = "namespace tomlin {\nstruct Work;\nstruct Inner::Work {\n};\n}  // namespace tomlin\n"
    seen, _ = shared({"one": one, "short": short, "private": private, "other": other})
    assert seen == {"tomlin::Work": ["one", "short"]}, seen


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    check_that_it_sees()
    files = {str(path): path.read_text() for folder in sys.argv[1:]
             for path in sorted(pathlib.Path(folder).rglob("*")) if path.suffix in (".hpp", ".cpp")}
    faults, count = shared(files)
    for name, where in sorted(faults.items()):
        print(f"{name} is defined in {' and in '.join(where)}")
    if count < FEWEST:
        print(f"{count} types in {len(files)} files: the pattern of this test reads too little")
    print(f"{count} types in {len(files)} files, {len(faults)} names shared")
    sys.exit(1 if faults or count < FEWEST else 0)


if __name__ == "__main__":
    main()
