"""Draw a figure on a sheet of one text column, from the data of the wide one."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.figures import sheet, style
    from bezierplan.running import problems
    from bezierplan.workspaces import files

    job, inputs = snakemake.params.job, snakemake.input
    bare = {name: files.load(description, Path(snakemake.params.folder)) for name, description in job["workspaces"].items()}
    met = {name: problems.read(file) for name, file in zip(job["repeats"], inputs.problems, strict=True)}
    panels = job["spec"]["panels"]
    scene = sheet.Scene(met, bare, job["labels"], job["unit"], job["looks"])
    figure = sheet.draw(panels, sheet.read_data(inputs.data), scene, sheet.narrow_columns(panels), style.NARROW)
    sheet.save(figure, output.svg, pdf=output.pdf)
