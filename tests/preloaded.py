"""What processes that tests start have imported already: see `starts`."""

import gc
import importlib

from bezierplan.running.jobs import forks

for name in (
    *("snakemake.cli", "snakemake.dag", "snakemake.executors.dryrun"),
    *("snakemake.executors.local", "snakemake.scheduling.greedy", "snakemake_logger_plugin_rich"),
    *("docutils.core", "jinja2", "requests", "rich.progress", "smart_open", "yaml"),
    *forks.FIRST,
    *forks.LATER,
):
    importlib.import_module(name)
forks.compile_first()
gc.collect()
gc.freeze()
