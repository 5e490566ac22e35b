"""Studies: what their files say as frozen classes, every fault found before the first job, and the jobs that follow.

`experiments`, `artefacts` and `claims` hold the models, one a kind of mapping in the files; `definition` the study that they make;
`reading` and `checks` find every fault; `jobs` and `alternatives` say what is run, `targets` what Snakemake asks for.
"""
