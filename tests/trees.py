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

EXPERIMENTS = "config/studies/song2016/experiments.yaml"
SMALL = {
    "population: 200": "population: 10",
    "generations: 100": "generations: 5",
    "population: 20200": "population: 60",
    "repeats: {smoke: 2, full: 100, extended: 250}": "repeats: {smoke: 2, full: 4, extended: 8}",
    "chunk: {smoke: 2, full: 50, extended: 125}": "chunk: {smoke: 2, full: 2, extended: 4}",
    "smooth_quadratic: 125, smooth_single: 125, shortest_path: 125, straight_line: 125, "
    "rounded: 125, random_search: 125": "smooth_single: 4",
}


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


def edit(file: Path, old: str, new: str) -> None:
    """Replace a text, which must be there, where it first stands."""
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))


def small(tree: Path) -> None:
    """Give the experiments of song2016 in a copy few runs, and searches of few steps."""
    for old, new in SMALL.items():
        edit(tree / EXPERIMENTS, old, new)
