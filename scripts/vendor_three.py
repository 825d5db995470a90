"""Makes python/robocell/_web/page/vendor/three.min.js from npm's packages of fixed versions.

    python scripts/vendor_three.py

Needs npm. The page has the file with it, so that it asks no network for anything.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

VENDOR = Path(__file__).resolve().parents[1] / "python/robocell/_web/page/vendor"
PACKAGES = ("three@0.187.0", "esbuild@0.28.2")
NAMES = (
    "AxesHelper BoxGeometry BufferAttribute BufferGeometry CapsuleGeometry Color CylinderGeometry "
    "DataTexture DirectionalLight DoubleSide FrontSide Group HemisphereLight LinearFilter "
    "LinearMipmapLinearFilter Mesh MeshStandardMaterial PerspectiveCamera PlaneGeometry "
    "RepeatWrapping RGBAFormat Scene SphereGeometry SRGBColorSpace Vector3 WebGLRenderer"
)


def main() -> None:
    """Installs the packages in a temporary folder and bundles what the page uses."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "package.json").write_text("{}")
        command = ["npm", "install", "--no-audit", "--no-fund", "--ignore-scripts", *PACKAGES]
        subprocess.run(command, cwd=folder, check=True)
        (folder / "entry.js").write_text(
            f'export {{ {", ".join(NAMES.split())} }} from "three";\n'
            'export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";\n'
        )
        bundle = ["node_modules/.bin/esbuild", "entry.js", "--bundle", "--minify"]
        bundle += ["--format=iife", "--global-name=THREE", "--target=es2020"]
        bundle += ["--legal-comments=inline", f"--outfile={VENDOR / 'three.min.js'}"]
        subprocess.run(bundle, cwd=folder, check=True)
        shutil.copy(folder / "node_modules/three/LICENSE", VENDOR / "LICENSE")


if __name__ == "__main__":
    main()
