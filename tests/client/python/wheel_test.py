"""The wheel of the Python package: what is in it, and that it needs nothing else."""

import importlib.util
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parent / "../../../client/python"
BUILD = "from setuptools import build_meta; build_meta.build_wheel('.')"


@unittest.skipUnless(importlib.util.find_spec("setuptools") and importlib.util.find_spec("wheel"),
                     "setuptools and wheel are missing: install python3-setuptools and python3-wheel")
class Wheel(unittest.TestCase):
    def test_is_built_with_all_modules_and_no_dependency(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(SOURCE, folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__"))
            subprocess.run([sys.executable, "-c", BUILD], cwd=folder, check=True, capture_output=True)
            wheel = next(Path(folder).glob("unwrapd_client-*-py3-none-any.whl"))
            with zipfile.ZipFile(wheel) as archive:
                names = archive.namelist()
                metadata = archive.read(next(name for name in names if name.endswith("METADATA"))).decode()
            for module in (SOURCE / "unwrapd").glob("*.py"):
                self.assertIn(f"unwrapd/{module.name}", names)
            self.assertIn("unwrapd/py.typed", names)
            needed = [line for line in metadata.splitlines() if line.startswith("Requires-Dist")]
            self.assertTrue(all("extra ==" in line for line in needed), needed)
            use = "import unwrapd; print(unwrapd.__file__, unwrapd.unwrap.__name__)"
            run = subprocess.run([sys.executable, "-I", "-c", f"import sys; sys.path.insert(0, {str(wheel)!r}); {use}"],
                                 capture_output=True, text=True, check=True)
            self.assertRegex(run.stdout, r"\.whl/unwrapd/__init__\.py unwrap\n$")


if __name__ == "__main__":
    unittest.main()
