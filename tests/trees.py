"""Copies of the working tree, for tests that change files or run whole workflows."""

import shutil
from pathlib import Path

ROOT = Path(__file__).parents[1]
NAMES = (
    "Snakefile",
    "Makefile",
    "README.md",
    "environment.txt",
    "environment-build.txt",
    "environment-dev.txt",
    "environment-cluster.txt",
    "workflow",
    "src",
    "config",
    "profiles",
    "docs",
    "results/README.md",
)
# What is named by its content is as good in a copy, and takes minutes to make.
KEPT = (".cache/kernels", ".cache/syntax")


def copy(tree: Path) -> Path:
    """Copy the tree to a new folder, with a configuration that names song2016 alone; without
    environment and results.
    """
    for name in (*NAMES, *(kept for kept in KEPT if (ROOT / kept).exists())):
        source, copied = ROOT / name, tree / name
        copied.parent.mkdir(parents=True, exist_ok=True)
        (shutil.copytree if source.is_dir() else shutil.copy2)(source, copied)
    (tree / "config" / "config.yaml").write_text("studies: [song2016]\n")
    return tree
