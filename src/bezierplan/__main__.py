"""The command line: `python -m bezierplan list`, `replay RUN`, `digest FOLDER`, `check-planner FILE`, `outcome`."""

import argparse
import sys
from pathlib import Path


def main(words: list[str]) -> None:
    """Do what the words of a command line say; a fault ends the process with one line."""
    parser = argparse.ArgumentParser(prog="python -m bezierplan", description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    lister = commands.add_parser("list", help="studies, their artefacts, methods, workspaces and numbers of repeats")
    lister.add_argument("--studies", nargs="+", metavar="STUDY", help="studies instead of those of config/config.yaml")
    lister.set_defaults(do=lambda given: list_studies(given.studies))
    digester = commands.add_parser("digest", help="one hash a run table, over sorted rows without times: what `same content` means")
    digester.add_argument("folder", type=Path, help="a folder of results, such as results/full")
    digester.set_defaults(do=lambda given: print_digests(given.folder))
    replayer = commands.add_parser("replay", help="one run again, bit-equal, with its picture")
    replayer.add_argument("run", help="its name: study/experiment/condition/method/repeat")
    replayer.set_defaults(do=lambda given: replay_run(given.run))
    contract = commands.add_parser("check-planner", help="the contract tests of a planner, on small and degenerate problems")
    contract.add_argument("planner", help="its name, or the path of its file")
    contract.add_argument(
        "--settings", default="{}", metavar="'{NAME: VALUE, ...}'", help="a value for each of its settings, as in a study"
    )
    contract.set_defaults(do=lambda given: check_planner(given.planner, given.settings))
    keeper = commands.add_parser("outcome", help="copy the outcome of results/full to docs/outcome and into the README")
    keeper.set_defaults(do=lambda given: keep_outcome())
    commands.add_parser("plan", help="one path on a map, checked by exact geometry", add_help=False)
    if words[:1] == ["plan"]:
        from bezierplan.commands import plan

        plan.main(argparse.ArgumentParser(prog="python -m bezierplan plan"), words[1:])
        return
    given = parser.parse_args(words)
    try:
        given.do(given)
    except (ValueError, FileNotFoundError) as fault:
        sys.exit(str(fault))


def list_studies(names: list[str] | None) -> None:
    """Print what the studies of the configuration, or those named, hold."""
    from bezierplan import study_file

    for key, study in study_file.load(study_file.read_config({"studies": names} if names else {})).items():
        print(f"{key}: {study.title}")
        for kind, artefacts in (("table", study.tables), ("figure", study.figures)):
            for name, content in artefacts.items():
                print(f"  {kind:12}{key}_{name:12} {content['title']}")
        for name, method in study.methods.items():
            variant = f", a variant of {method['variant_of']}" if "variant_of" in method else ""
            print(f"  {'method':12}{name:20} {study.planner(name)}{variant}")
        for name, workspace in study.workspaces.items():
            print(f"  {'workspace':12}{name:20} {workspace['kind']}")
        for name, experiment in study.experiments.items():
            size = f"{len(experiment['problems'])} problems, {len(experiment['methods'])} methods"
            repeats = ", ".join(f"{number} ({scale})" for scale, number in experiment["repeats"].items())
            print(f"  {'experiment':12}{name:20} {size}, repeats {repeats}")


def replay_run(name: str) -> None:
    """Make a run again, print what it came to and whether it equals the stored one, and save its picture below results/replay."""
    from bezierplan import replay, study_file

    studies = study_file.load(study_file.read_config({}))
    made = replay.replay(name, studies)
    run = made.runs.iloc[0]
    shown = ("objective", "length", "bound", "claimed_feasible", "feasible", "collision_at", "collision_depth", "clearance", "evaluations")
    for column in shown:
        print(f"{column:18}{run[column]}")
    for file, stored in replay.stored_runs(name, Path("results")).items():
        print(f"{'stored in':18}{file}: {'equal' if replay.equal(run, stored) else 'NOT EQUAL'}")
    picture = Path("results/replay") / f"{name}.svg"
    replay.draw(made, studies[run["study"]], picture)
    print(f"{'picture':18}{picture}")


def check_planner(planner: str, text: str) -> None:
    """Print what the contract tests find on a planner, with the settings of a YAML text; end with 1 if a fact failed. Raises Fault."""
    from bezierplan import checked, contract

    settings = checked.parse(text, "--settings")
    if not isinstance(settings, dict):
        raise checked.Fault(f"--settings: {text}: expected '{{name: value, ...}}'")
    failed = total = 0
    for finding in contract.check_planner(planner, settings):
        print(finding, flush=True)
        total += 1
        failed += not finding.passed
    print(f"{total - failed} of {total} facts hold")
    if failed:
        sys.exit(1)


def keep_outcome() -> None:
    """Write docs/outcome and the README's table from results/full."""
    from bezierplan import outcome

    outcome.write()


def print_digests(folder: Path) -> None:
    """Print a hash of the runs of each method of each experiment below a folder."""
    from bezierplan.run_digest import run_tables, table_digest

    for name, files in run_tables(folder).items():
        print(f"{table_digest(files)}  {name}")


if __name__ == "__main__":
    main(sys.argv[1:])
