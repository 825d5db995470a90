"""Runs the notebooks of docs/notebooks and writes each as a page with its output.

    python scripts/docsite/notebook_pages.py    runs all of them; exit code 1 if a cell fails

The notebooks in the repository have no output. The executed ones lie in build/site/notebooks and
are made anew only if the notebook, the package, the extension, an example or a model changed.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import nbformat
from jupyter_client import AsyncKernelManager
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from python_reference import PACKAGE, STUBS

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = ROOT / "docs" / "notebooks"
EXECUTED = ROOT / "build" / "site" / "notebooks"
SHARED = (ROOT / "examples", ROOT / "models")  # folders that the notebooks read


def newest_source() -> float:
    """Returns when the package, its extension or a file that the notebooks share last changed."""
    shared = [
        path
        for folder in SHARED
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    ]
    files = [*PACKAGE.rglob("*.py"), *STUBS.glob("_core*"), *shared]
    return max(file.stat().st_mtime for file in files)


def execute(notebook: Path) -> Path:
    """Runs a notebook unless its result is newer than what it depends on; returns the result."""
    result = EXECUTED / notebook.name
    changed = max(newest_source(), notebook.stat().st_mtime)
    if result.exists() and result.stat().st_mtime > changed:
        return result
    folder = EXECUTED / notebook.stem
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for shared in SHARED:
        (folder / shared.name).symlink_to(shared)
    content = nbformat.read(notebook, as_version=4)
    resources = {"metadata": {"path": str(folder)}}
    with tempfile.TemporaryDirectory(prefix="robocell_") as sockets:
        kernel = AsyncKernelManager(kernel_name="python3", transport="ipc", ip=f"{sockets}/kernel")
        NotebookClient(content, km=kernel, timeout=300, resources=resources).execute(
            cleanup_kc=True
        )
    result.write_text(nbformat.writes(content))
    return result


def pages() -> dict[str, str]:
    """The page of each notebook by src_uri."""
    notebooks = sorted(NOTEBOOKS.glob("*.ipynb"))
    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(execute, notebooks))
    return {f"notebooks/{result.stem}.md": page(result) for result in results}


def page(executed: Path) -> str:
    """An executed notebook as Markdown."""
    parts = []
    for cell in nbformat.read(executed, as_version=4).cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
        elif cell.cell_type == "code":
            parts.append(f"```python\n{cell.source}\n```")
            parts += [text for output in cell.outputs if (text := shown(output))]
    title, *rest = parts
    source = f"*This page is the notebook `docs/notebooks/{executed.name}` with its output.*"
    return "\n\n".join([title, source, *rest]) + "\n"


def shown(output: Any) -> str:
    """One output of a cell: HTML, a picture, or text."""
    if output.output_type == "stream":
        return f"```text\n{output.text.rstrip()}\n```" if output.name == "stdout" else ""
    data = output.get("data", {})
    if "text/html" in data:
        return f'<div class="output">{"".join(data["text/html"].splitlines())}</div>'
    if "image/png" in data:
        return f'<img class="output" src="data:image/png;base64,{data["image/png"].strip()}">'
    return f"```text\n{data['text/plain']}\n```" if "text/plain" in data else ""


def main() -> int:
    """Runs all notebooks."""
    try:
        print(f"notebooks: {len(pages())} ran from top to bottom")
    except CellExecutionError as error:
        print(error)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
