"""Studies: their files as frozen classes, a check for every fault before the first job, and the
resulting jobs.

`experiments`, `artefacts` and `claims` hold the models, one per kind of mapping in the files;
`definition` the study that they form; `reading` and `checks` find every fault; `jobs` and
`alternatives` define what is run, `targets` what Snakemake asks for.
"""
