"""Print a checksum of each run table. Neither the order of rows nor times matter: tables with equal
checksums have the same content.
"""

from pathlib import Path

from bezierplan.analysis.stored_runs import compute_table_digest, list_run_tables


def main(folder: Path) -> None:
    """Print a hash of each run table below a folder. Raises FileNotFoundError, or ValueError for an
    unreadable file.

    Parameters
    ----------
    folder : Path
        a folder of results, such as results/full
    """
    for name, files in list_run_tables(folder).items():
        print(f"{compute_table_digest(files)}  {name}", flush=True)
