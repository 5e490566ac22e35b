"""Studies: their files as frozen classes, a check for every fault before the first job, and the
resulting jobs.

`experiments`, `artefacts` and `claims` hold the models of files whose parts have no other home;
`definition` the study that they form; `reading`, `checks`, `design` and `published` find every
fault; `jobs`, `page` and `alternatives` define what is made, `stored` what a folder of results is
to hold.
"""
