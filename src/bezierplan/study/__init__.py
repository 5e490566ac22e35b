"""Studies: their files as frozen classes, the checks before the first job, and the resulting jobs.

The models of a study's files are in `experiments`, `artefacts` and `claims`, and `definition` joins
them into a study. `reading` reads the files; `checks`, `design` and `published` check them. `jobs`,
`page` and `alternatives` derive the jobs, and `stored` lists the files that these jobs write.
"""
