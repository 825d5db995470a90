"""What pages show of commands is read as meant, and differences are found."""

from __future__ import annotations

from pathlib import Path

import console_blocks

PAGE = """# Page
```yaml title="a/run.yaml"
run: a
```
```console
$ cat a/run.yaml
run: a
$ printf 'one\\n' && \\
  printf 'two\\n'
one
two
```
"""


def test_a_block_with_the_title_of_another_one_continues_its_file(tmp_path: Path):
    page = tmp_path / "page.md"
    page.write_text(PAGE + '```yaml title="a/run.yaml"\nepisodes: 2\n```\n')
    assert console_blocks.files(page) == {"a/run.yaml": "run: a\nepisodes: 2\n"}


def test_files_and_commands_of_a_page(tmp_path: Path):
    page = tmp_path / "page.md"
    page.write_text(PAGE)
    console_blocks.write_files(page, tmp_path)
    first, second = console_blocks.commands(page)
    assert (first.line, first.printed) == ("cat a/run.yaml", ["run: a"])
    assert second.printed == ["one", "two"]
    for command in (first, second):
        assert console_blocks.run(command.line, tmp_path) == command.printed


def test_an_ellipsis_matches_text_and_dots_match_lines():
    printed = ["rate 12 episodes/h", "x", "y", "end"]
    assert console_blocks.agrees(["rate … episodes/h", "...", "end"], printed)
    assert console_blocks.agrees(["...", "end"], printed)
    assert console_blocks.agrees(["rate 12 episodes/h", "...", "x", "y", "end"], printed)


def test_a_different_output_is_reported():
    assert not console_blocks.agrees(["one"], ["two"])
    assert not console_blocks.agrees(["one"], ["one", "two"])
    assert not console_blocks.agrees([], ["error"])
    assert console_blocks.agrees([], [])
