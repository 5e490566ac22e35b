# The door: `snakemake` and `snakemake NAME` start here. The workflow itself is in workflow/, and
# can be used from there as a module.
include: "workflow/Snakefile"


# Rules of an included file never become the default target.
rule default:
    default_target: True
    input:
        rules.all.input,
