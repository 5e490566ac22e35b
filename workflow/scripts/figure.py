"""Draw a figure from its data, which are first written and read back."""

from bezierplan.running import log

with log.job(snakemake) as output:
    import importlib
    from pathlib import Path

    from bezierplan.analysis import results
    from bezierplan.figures import sheet
    from bezierplan.workspaces import files

    job, inputs = snakemake.params.job, snakemake.input
    found = results.read_all(inputs.runs, job["repeats"], inputs.problems, inputs.bounds)
    published = results.read_published(inputs.published)
    found = {name: each._replace(published=published, jobs=job["jobs"].get(name)) for name, each in found.items()}
    functions = vars(importlib.import_module(job["module"])) if job["module"] else {}
    bare = {name: files.load(description, Path(snakemake.params.folder)) for name, description in job["workspaces"].items()}
    panels = job["spec"]["panels"]
    tables = {Path(file).stem: results.published_table(file) for file in inputs.published}
    sheet.write_data(sheet.data(panels, found, bare, functions, tables), output.data)
    scene = sheet.Scene({name: each.problems for name, each in found.items()}, bare, job["labels"], job["unit"], job["looks"])
    figure = sheet.draw(panels, sheet.read_data(output.data), scene, job["spec"]["columns"])
    sheet.save(figure, output.svg, output.png, output.pdf)
    Path(output.caption).write_text(f"{figure.get_label()}\n", encoding="utf-8")
