"""`make format` wraps wide comments and leaves tables, examples and code alone."""

from __future__ import annotations

from wrap_comments import list_wide, wrap

LONG = "word " * 25


def test_a_wide_paragraph_is_filled_and_loses_no_word():
    lines = [f"  // {LONG.strip()}", "  // and its end.", "  int a;"]
    out = wrap(lines)
    assert all(len(line) <= 100 for line in out)
    assert out[-1] == "  int a;"
    words = " ".join(line.strip("/ ") for line in out[:-1])
    assert words == f"{LONG.strip()} and its end."


def test_tables_examples_and_narrow_comments_stay():
    lines = [
        "// one",
        "// two",
        "//   indented example " + "x" * 90,
        "// name     meaning " + "x" * 90,
        "// - item " + "x" * 95,
        'f("http://" ' + "x" * 100 + ");",
    ]
    assert wrap(lines) == lines


def test_a_paragraph_ends_at_an_example():
    out = wrap([f"// {LONG.strip()}", "//   Scene scene = Build();", "// rest"])
    assert out[-2:] == ["//   Scene scene = Build();", "// rest"]


def test_a_wide_comment_behind_code_moves_above_it():
    out = wrap([f"  int a;  // {LONG.strip()}"])
    assert out[-1] == "  int a;"
    assert out[0].startswith("  // word")


def test_wide_comments_are_listed_and_wide_code_is_not(tmp_path, capsys):
    file = tmp_path / "a.h"
    file.write_text("int a;\n// " + "x" * 98 + "\nint b = " + "1" * 100 + ";\n")
    assert list_wide(str(file)) == 1
    assert capsys.readouterr().out == f"{file}:2: 101 columns, 100 are allowed\n"
