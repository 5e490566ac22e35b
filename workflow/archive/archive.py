"""Pack the results of a scale with all that made them as an RO-Crate for an archive: `make
archive`.

The crate follows the profile Workflow Run Crate 0.5 (https://w3id.org/ro/wfrun/workflow/0.5): the
workflow with its code, configuration and environment as kept in git, one run of it, and what it
made. The validator must accept it before it is zipped.
"""

import json
import re
import shutil
import subprocess
import sys
from argparse import ArgumentParser
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROFILE = "https://w3id.org/ro/wfrun/{}/0.5"
# Logs name places of the machine.
LEFT_OUT = ("logs",)
MEDIA = {
    ".html": "text/html",
    ".csv": "text/csv",
    ".md": "text/markdown",
    ".txt": "text/plain",
    ".yaml": "application/yaml",
}


def main() -> None:
    """Read the command line, pack, check, and zip."""
    parser = ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("scale", nargs="?", default="full")
    parser.add_argument("--into", type=Path, default=Path("archive"))
    given = parser.parse_args()
    results = Path("results", given.scale)
    if not (results / "index.html").is_file():
        sys.exit(
            f"{results}/index.html: not found; make it with snakemake "
            f"{'all' if given.scale == 'full' else given.scale}"
        )
    version = code_version()
    folder = given.into / f"bezierplan-{given.scale}-{version}"
    shutil.rmtree(folder, ignore_errors=True)
    copy(code_files(), ROOT, folder)
    copy(result_files(results), Path(), folder)
    describe(folder, given.scale, version)
    faults = check(folder)
    if faults:
        sys.exit("\n".join(f"{folder}/ro-crate-metadata.json: {fault}" for fault in faults))
    print(f"{shutil.make_archive(str(folder), 'zip', folder)}: accepted as a Workflow Run Crate")


def code_version() -> str:
    """The commit; with `-dirty` if files differ from it."""
    return _git("describe", "--always", "--dirty", "--abbrev=12").strip()


def code_files() -> list[Path]:
    """What git keeps, without results: the workflow, its configuration, environment, tests and
    documents.
    """
    return [
        Path(name)
        for name in _git("ls-files", "-z").split("\0")
        if name and (ROOT / name).is_file()
    ]


def result_files(results: Path) -> list[Path]:
    """The files of a scale that go into the archive."""
    found = (
        file for file in sorted(results.rglob("*")) if file.is_file() and file.suffix != ".log"
    )
    return [file for file in found if not set(file.relative_to(results).parts[:-1]) & set(LEFT_OUT)]


def copy(files: Iterable[Path], source: Path, target: Path) -> None:
    """Copy files by their paths below a folder."""
    for file in files:
        (target / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source / file, target / file)


def describe(folder: Path, scale: str, version: str) -> None:
    """Write ro-crate-metadata.json for the files of a folder."""
    import yaml
    from rocrate.model import ContextEntity
    from rocrate.rocrate import ROCrate

    cited = yaml.safe_load((folder / "CITATION.cff").read_text(encoding="utf-8"))
    crate = ROCrate(version="1.1")

    def thing(identity: str, kind: str, **more) -> ContextEntity:
        return crate.add(ContextEntity(crate, identity, properties={"@type": kind} | more))

    def file(name: str, /, **more):
        media = {"encodingFormat": MEDIA[Path(name).suffix]} if Path(name).suffix in MEDIA else {}
        return crate.add_file(
            folder / name,
            name,
            properties={"contentSize": str((folder / name).stat().st_size)} | media | more,
        )

    results = f"results/{scale}"
    made = datetime.fromtimestamp((folder / results / "index.html").stat().st_mtime, UTC).isoformat(
        timespec="seconds"
    )
    licence = thing(
        f"https://spdx.org/licenses/{cited['license']}",
        "CreativeWork",
        name=f"{cited['license']} licence",
    )
    authors = [_author(thing, number, author) for number, author in enumerate(cited["authors"])]
    crate.name, crate.description, crate.license = (
        f"{cited['title']}: results at scale {scale}",
        cited["abstract"],
        licence,
    )
    crate.datePublished = made
    crate.root_dataset["author"] = authors
    crate.root_dataset["version"] = version
    crate.root_dataset["conformsTo"] = [
        thing(PROFILE.format("process"), "CreativeWork", name="Process Run Crate", version="0.5"),
        thing(PROFILE.format("workflow"), "CreativeWork", name="Workflow Run Crate", version="0.5"),
        thing(
            "https://w3id.org/workflowhub/workflow-ro-crate/1.0",
            "CreativeWork",
            name="Workflow RO-Crate",
            version="1.0",
        ),
    ]
    snakemake = _locked(folder / "environment.txt", "snakemake")
    flow = crate.add_workflow(
        folder / "Snakefile", "Snakefile", main=True, lang="snakemake", lang_version=snakemake
    )
    flow["name"], flow["version"], flow["license"], flow["author"] = (
        cited["title"],
        version,
        licence,
        authors,
    )
    flow["softwareRequirements"] = [file("environment.txt"), file("environment-build.txt")]
    parameters = {
        name: thing(
            f"#{name}",
            "FormalParameter",
            name=name,
            additionalType="Dataset",
            conformsTo={"@id": _FORMAL},
            **more,
        )
        for name, more in (("configuration", {"valueRequired": True}), ("results", {}))
    }
    flow["input"], flow["output"] = parameters["configuration"], parameters["results"]

    page = file(
        f"{results}/index.html",
        name="All results on one page",
        description="Opens in any browser, without a network",
    )
    tables = [
        file(name)
        for name in _there(
            folder,
            *(f"{results}/{each}" for each in ("numbers.csv", "claims.csv", "methods.csv")),
        )
    ]
    made_folder = crate.add_dataset(
        folder / results, results, properties={"name": f"Results at scale {scale}"}
    )
    config = crate.add_dataset(
        folder / "config",
        "config",
        properties={"name": "The five studies: experiments, maps, published numbers, claims"},
    )
    config["exampleOfWork"], made_folder["exampleOfWork"] = (
        parameters["configuration"],
        parameters["results"],
    )
    made_folder["hasPart"] = [page, *tables]
    for name in ("README.md", "results/README.md", "CONTRIBUTING.md", "CITATION.cff", "LICENSE"):
        file(name)
    for name in ("src", "workflow", "tests", "docs"):
        crate.add_dataset(folder / name, name)
    run = thing(
        "#run", "CreateAction", name=f"Run of {cited['title']} at scale {scale}", endTime=made
    )
    run["instrument"], run["object"], run["result"], run["agent"] = (
        flow,
        config,
        [made_folder, page, *tables],
        authors,
    )
    run["actionStatus"] = "http://schema.org/CompletedActionStatus"
    crate.root_dataset["mentions"] = run
    (folder / "ro-crate-metadata.json").write_text(
        json.dumps(crate.metadata.generate(), indent=1, ensure_ascii=False) + "\n", encoding="utf-8"
    )


_FORMAL = "https://bioschemas.org/profiles/FormalParameter/1.0-RELEASE"


def check(folder: Path) -> list[str]:
    """What the validator finds wrong with a crate; nothing if it accepts it."""
    from rocrate_validator import services
    from rocrate_validator.models import Severity

    settings = services.ValidationSettings(
        rocrate_uri=folder,
        profile_identifier="workflow-run-crate-0.5",
        requirement_severity=Severity.REQUIRED,
    )
    _serve_context_without_network()
    return [
        f"{issue.check.identifier}: {issue.message}"
        for issue in services.validate(settings).get_issues()
    ]


def _serve_context_without_network() -> None:
    """Let the validator's session fall back to rocrate's copy of the JSON-LD context, a later
    version, with the names of version 1.1.
    """
    import io
    from importlib import resources

    from requests.adapters import HTTPAdapter
    from requests.exceptions import ConnectionError as Unreachable
    from rocrate_validator.utils.http import HttpRequester
    from urllib3 import HTTPResponse

    text = (resources.files("rocrate") / "data" / "ro-crate.jsonld").read_text(encoding="utf-8")
    body = text.replace("https://bioschemas.org/terms/", "https://bioschemas.org/").encode()

    class OrCopy(HTTPAdapter):
        def send(self, request, **more):
            try:
                return super().send(request, **more)
            except Unreachable:
                head = {"Content-Type": "application/ld+json"}
                return self.build_response(
                    request, HTTPResponse(io.BytesIO(body), head, 200, preload_content=False)
                )

    HttpRequester().session.mount("https://w3id.org/ro/crate/1.1/context", OrCopy())


def _author(thing, number: int, author: dict):
    """A person or an organisation as in CITATION.cff."""
    names = [author[key] for key in ("given-names", "family-names") if key in author]
    kind = "Person" if names else "Organization"
    return thing(
        author.get("orcid", f"#author{number}"), kind, name=" ".join(names) or author["name"]
    )


def _locked(requirements: Path, package: str) -> str:
    """The version of a package in an environment."""
    return re.search(
        rf"^{package}==([^ \\]+)", requirements.read_text(encoding="utf-8"), re.MULTILINE
    ).group(1)


def _there(folder: Path, *names: str) -> list[str]:
    return [name for name in names if (folder / name).is_file()]


def _git(*words: str) -> str:
    try:
        return subprocess.run(
            ["git", "-C", ROOT, *words], check=True, capture_output=True, text=True
        ).stdout
    except (OSError, subprocess.CalledProcessError):
        sys.exit(f"{ROOT}: not a git checkout; the archive names the commit whose code it holds")


if __name__ == "__main__":
    main()
