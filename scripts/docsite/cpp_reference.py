"""Writes one page for each public C++ header, from its comments and declarations.

Public are `robocell/robocell.h`, the bridge to KDL, and the headers that these include, as
cmake/RobocellHeaders.cmake installs them. A page has the header's first comment, then each
declaration with the comment above it and its examples from cpp_examples.cc. Private members and the
bodies of functions are left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

SRC = Path(__file__).resolve().parents[2] / "src"
EXAMPLES = Path(__file__).with_name("cpp_examples.cc")
START = ("robocell/robocell.h", "robocell/kinematics/kdl_bridge.h")
INCLUDE = re.compile(r'^#include "(robocell/[^"]+)"', re.MULTILINE)
TYPE = re.compile(
    r"^(?:template <[^;{]*?>\s*)?(class|struct|enum class|enum|union|concept)\s+(\w+(?:::\w+)*)"
)
ALIAS = re.compile(r"^(?:template <[^;{]*?>\s*)?(?:using|concept)\s+(\w+)\s*=")
FUNCTION = re.compile(r"([\w~]+|operator\s*[^\s(]+|operator\(\))\s*\(")
CONSTANT = re.compile(r"(\w+)\s*(?:\[[^\]]*\])?\s*[={;]")
EXAMPLE = re.compile(
    r"^// (?P<names>\w+(?:,(?: |\n// )\w+)*):(?P<about>[^\n]*(?:\n// [^\n]*)*)\n"
    r"EXAMPLE\((?P<title>\w+)\) \{\n(?P<body>.*?)^\}",
    re.DOTALL | re.MULTILINE,
)
SCOPE = re.compile(r"^(?:inline )?namespace ([\w:]+) \{$")


@dataclass
class Declaration:
    """One or several declarations that share a comment."""

    comment: list[str]
    code: list[str] = field(default_factory=list)

    @property
    def names(self) -> list[str]:
        """What is declared, each name once, types with their keyword."""
        found = [name_of(code) for code in self.code]
        return list(dict.fromkeys(name for name in found if name and not name.startswith("__")))


@dataclass(frozen=True)
class Example:
    """A few lines that compile and run, and the names that they are an example of."""

    title: str
    names: tuple[str, ...]
    about: str
    code: str

    def uses(self, name: str) -> bool:
        """Whether it is an example of a name, such as 'Scene' or 'Scene::Step'."""
        owner, _, member = name.rpartition("::")
        if not owner:
            return name in self.names
        return owner in self.names and bool(re.search(rf"(?:\.|->|::){member}\b", self.code))


@cache
def examples() -> list[Example]:
    """The examples of the reference."""
    return [
        Example(
            found["title"],
            tuple(re.findall(r"\w+", found["names"])),
            found["about"].replace("\n// ", " ").strip(),
            re.sub(r"^  ", "", found["body"], flags=re.MULTILINE).rstrip(),
        )
        for found in EXAMPLE.finditer(EXAMPLES.read_text())
    ]


def examples_start() -> str:
    """The lines that all examples continue."""
    text = EXAMPLES.read_text()
    includes = re.findall(r"^#include <(?:mujoco|robocell)/.*", text, re.MULTILINE)
    shown = text[text.index("// begin:") : text.index("\n// end")].partition("\n")[2]
    return "\n".join([*includes, "", "using namespace robocell;", "using std::cout;", "", shown])


def public_headers() -> list[str]:
    """Paths below src, by folder and name."""
    waiting, public = list(START), []
    while waiting:
        header = waiting.pop()
        if header not in public:
            public.append(header)
            waiting += INCLUDE.findall((SRC / header).read_text())
    return sorted(public)


def name_of(code: str) -> str:
    """The name that a declaration declares; empty for what has none."""
    code = re.sub(r"\[\[\w+\]\]\s*", "", code)
    if found := ALIAS.match(code):
        return found[1]
    if found := TYPE.match(code):
        return f"{found[1]} {found[2]}"
    if found := re.match(r"#define (\w+)", code):
        return found[1]
    without_template = re.sub(r"^template <.*?>\n", "", code, flags=re.DOTALL)
    if found := FUNCTION.search(without_template):
        return re.sub(r"\s+", "", found[1])
    found = CONSTANT.search(without_template)
    return found[1] if found else ""


def code_only(line: str) -> str:
    """The line without comments and the contents of strings."""
    return re.sub(r"//.*", "", re.sub(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\'', '""', line))


def head_comment(lines: list[str]) -> list[str]:
    """The comment that the header begins with."""
    comment = []
    for line in lines:
        if not line.startswith("//"):
            break
        comment.append(line)
    return comment


def declarations(lines: list[str]) -> Iterator[Declaration]:
    """Declarations in the namespaces of a header; nested namespaces are entered."""
    group: Declaration | None = None
    comment: list[str] = []
    inside = False
    i = 0
    while i < len(lines):
        line = lines[i]
        i += 1
        if SCOPE.match(line):
            inside = True
        elif line.startswith(("#define", "#undef")):
            while line.endswith("\\"):
                line = lines[i]
                i += 1
            if group:
                yield group
            group = Declaration(comment, [lines[i - 1] if "\\" not in line else line])
            comment = []
        elif not inside or line.startswith("#") or re.match(r"^\}(?:\s*// namespace.*)?$", line):
            comment = []
        elif line.startswith("//"):
            if group:
                yield group
                group = None
            comment.append(line)
        elif not line.strip():
            if group:
                yield group
            group, comment = None, []
        else:
            code, i = statement(lines, i - 1)
            if re.match(r"^(class|struct|enum class) [\w:]+;$", code):
                comment = []
                continue
            if group is None:
                group = Declaration(comment)
                comment = []
            group.code.append(shortened(code))
    if group:
        yield group


def statement(lines: list[str], start: int) -> tuple[str, int]:
    """The declaration that begins at a line, and the line after it."""
    depth, i = 0, start
    while True:
        line = code_only(lines[i])
        depth += sum(line.count(c) for c in "{([") - sum(line.count(c) for c in "})]")
        i += 1
        if i >= len(lines) or (depth <= 0 and re.search(r"[;}]\s*$", line)):
            return "\n".join(lines[start:i]), i


def shortened(code: str) -> str:
    """The declaration without private members and bodies."""
    if re.match(r"^(template <[^;{]*?>\s*)?(class|struct|union) ", code):
        return "\n".join(without_private(code.split("\n")))
    if TYPE.match(code) or ALIAS.match(code) or code.startswith(("extern", "#")):
        return code
    return without_body(code)


def without_private(lines: list[str]) -> Iterator[str]:
    """The lines of a class without its private parts and the bodies of its functions."""
    is_class = any(line.startswith("class ") for line in lines[:3])
    visible = not is_class
    i = 0
    while i < len(lines):
        line = lines[i]
        found = re.match(r"^ (public|protected|private):", line)
        if found:
            visible = found[1] != "private"
        is_frame = not line.startswith(" ") and i != 0
        opens = i == 0 or line.startswith(("class ", "struct ", "template ", "    :"))
        if is_frame or (opens and "private:" not in line):
            if line.startswith("}") or opens:
                yield line
            i += 1
        elif not visible:
            i += 1
        elif re.match(r"^  [^ /}#]", line):
            code, i = statement(lines, i)
            inner = "\n".join(
                piece[2:] if piece.startswith("  ") else piece for piece in code.split("\n")
            )
            is_type = re.match(r"^(template <[^;{]*?>\s*)?(class|struct|union|enum)", inner)
            yield from (code if is_type else indented(without_body(inner))).split("\n")
        else:
            yield line
            i += 1


def indented(code: str) -> str:
    """The code, two spaces further in."""
    return "\n".join(f"  {line}" if line else line for line in code.split("\n"))


def without_body(code: str) -> str:
    """A function that is defined over several lines becomes its declaration."""
    if code.count("\n") < 2 or "{" not in code_only(code.replace("\n", " ")):
        return code
    depth = 0
    for match in re.finditer(r"[(){}=;]", code):
        if match[0] == "(":
            depth += 1
        elif match[0] == ")":
            depth -= 1
        elif match[0] in "=;" and depth == 0:
            return code
        elif match[0] == "{" and depth == 0:
            head = code[: match.start()].rstrip()
            return (
                re.sub(r"\)(\s*(?:const|noexcept)*)\s*:\s.*$", r")\1", head, flags=re.DOTALL) + ";"
            )
    return code


def prose(comment: list[str]) -> str:
    """A comment as Markdown: indented lines are code, an empty comment line ends a paragraph."""
    parts: list[str] = []
    code: list[str] = []
    for line in [*comment, "//"]:
        text = re.sub(r"^// ?", "", line)
        if text.startswith("  ") and not re.match(r"\s+[-*] ", text):
            code.append(text[2:])
            continue
        if code:
            parts += ["", "```cpp", *code, "```", ""]
            code = []
        parts.append(escaped(text))
    return "\n".join(parts).strip()


def escaped(text: str) -> str:
    """Plain text, in which Markdown sees no markup but code in backticks."""
    pieces = text.split("`")
    for i in range(0, len(pieces), 2):
        pieces[i] = re.sub(r"([*_\[\]#|])", r"\\\1", pieces[i]).replace("<", "&lt;")
    joined = "`".join(pieces)
    return re.sub(r"^\\\*( )", r"*\1", joined)


def page(header: str) -> str:
    """The page of a header."""
    lines = (SRC / header).read_text().split("\n")
    name = header.removeprefix("robocell/")
    shown: set[str] = set()
    index = "../" * header.count("/") + "headers.md"
    parts = [
        f"# {name}",
        f"[All headers]({index})",
        prose(head_comment(lines)),
        f'```cpp\n#include "{header}"\n```',
    ]
    for declaration in declarations(lines[len(head_comment(lines)) :]):
        if declaration.names:
            heading = ", ".join(f"`{name}`" for name in declaration.names[:4])
            parts.append(f"## {heading}")
        parts.append(prose(declaration.comment))
        code = "\n".join(declaration.code)
        parts.append(f"```cpp\n{code}\n```")
        for example in new_examples(declaration, shown):
            parts.append(f"Example: {escaped(example.about)}\n\n```cpp\n{example.code}\n```")
    return "\n\n".join(part for part in parts if part) + "\n"


def new_examples(declaration: Declaration, shown: set[str]) -> Iterator[Example]:
    """The examples of what is declared that the page does not have yet."""
    names = {name.split(" ")[-1] for name in declaration.names}
    for example in examples():
        if example.title not in shown and names & {*example.names}:
            shown.add(example.title)
            yield example


def summary(header: str) -> str:
    """The first sentence of a header's comment, without the name that it begins with."""
    comment = head_comment((SRC / header).read_text().split("\n"))
    lines = [re.sub(r"^// ?", "", line) for line in comment]
    end = next((i for i, line in enumerate(lines) if not line or line.startswith(" ")), len(lines))
    text = " ".join(lines[:end])
    sentence = re.split(r"(?<=[.:])\s+(?=[A-Z])", text, maxsplit=1)[0]
    return escaped(sentence)


def pages() -> dict[str, str]:
    """All pages by src_uri: one for each header, one for each folder, one over all."""
    by_folder: dict[str, list[str]] = {}
    for header in public_headers():
        by_folder.setdefault(str(Path(header).parent), []).append(header)
    out = {}
    index = ["# C++ headers", "", "`#include <robocell/robocell.h>` includes the whole interface."
             " Each header can also be included alone.", "", "## What the examples start with", "",
             "The examples of these pages are inside a function of a struct that is derived from"
             " `Start`. A comment on a line that prints says what it prints.", "",
             f"```cpp\n{examples_start()}\n```", ""]  # fmt: skip
    for folder, headers in by_folder.items():
        index += [
            f"## {folder.removeprefix('robocell/')}",
            "",
            "| header | declares | about |",
            "|---|---|---|",
        ]
        for header in headers:
            uri = f"{header.removesuffix('.h')}.md"
            lines = (SRC / header).read_text().split("\n")
            found = declarations(lines[len(head_comment(lines)) :])
            names = [name.split(" ")[-1] for each in found for name in each.names]
            shown = ", ".join(f"`{name}`" for name in dict.fromkeys(names))
            index.append(f"| [`{Path(header).name}`]({uri}) | {shown} | {summary(header)} |")
            out[f"reference/cpp/{uri}"] = page(header)
        index.append("")
    out["reference/cpp/headers.md"] = "\n".join(index)
    return out
