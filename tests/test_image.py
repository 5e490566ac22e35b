"""The Dockerfile is sound as far as a linter sees: nothing here builds an image."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.rare

ROOT = Path(__file__).parents[1]
HADOLINT = shutil.which("hadolint", path=str(Path(sys.executable).parent))


# What can be checked without it stands in the other test.
@pytest.mark.skipif(HADOLINT is None, reason="hadolint has wheels for Linux on x86-64 alone")
def test_a_linter_finds_nothing_in_the_dockerfile():
    words = [HADOLINT, str(ROOT / "Dockerfile")]
    found = subprocess.run(words, capture_output=True, text=True, check=False, timeout=60)
    assert found.returncode == 0, found.stdout


def test_what_the_dockerfile_copies_is_there():
    lines = (ROOT / "Dockerfile").read_text(encoding="utf-8").splitlines()
    copied = [name for line in lines if line.startswith("COPY ") for name in line.split()[1:-1]]
    assert "environment.txt" in copied
    assert [name for name in copied if not (ROOT / name).exists()] == []
