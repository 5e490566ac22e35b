"""What follows the headline in a few short sentences, computed from the content of the page: what
fails in each paper, and how surely.
"""

from collections import Counter

from bezierplan.figures.page.content import BaselineComparison, Claim, Number, Part, Study

Sentence = list[Part]

# What the verdict on a claim says in short; any other verdict leaves the claim undecided.
IN_SHORT = {
    "supported": "hold",
    "partly": "hold in part",
    "contradicted": "fail",
    "no effect": "fail",
}
_OWN = "fail by our criterion alone"
# Least probability that an experiment of the paper's size shows the same.
_LIKELY = 0.8


def answer(studies: dict[str, Study]) -> list[Sentence]:
    """Sentences: one of each study, then how certain this is. Without numbers and claims, one that
    says so.
    """
    claims = [claim for study in studies.values() for claim in _sentences(study)]
    if not claims and not any(_counted(study) for study in studies.values()):
        shown = [each for study in studies.values() for each in study.shown if not each.problem]
        runs = sum(each.count for each in shown) or "no"
        text = (
            f"A subset that shows how the page works: {runs} runs, too few to judge numbers or "
            "claims."
        )
        return [[Part(text=text)]]
    of_studies = [
        _of_study(key, study) for key, study in studies.items() if study.claims or _counted(study)
    ]
    sentences = [*of_studies, _replication(claims), _interpretations(claims), _audit(studies)]
    return [sentence for sentence in sentences if sentence]


def about_scale(scale: str, repeats: dict[str, list[list[int]]]) -> list[str]:
    """How many runs the results of a scale rest on, and how this differs from the README's numbers.

    repeats: scale -> of each study, the least and the largest number of runs of a method under a
    condition.
    """
    runs = {
        name: _span([number for pair in pairs for number in pair])
        for name, pairs in repeats.items()
    }
    first = {
        "smoke": f"Scale smoke is a small subset, of {runs[scale]} runs per method and condition, "
        "which shows that everything works.",
        "full": "Scale full has as many runs as the papers report: "
        f"{runs[scale]} per method and condition.",
        "extended": f"Scale extended has {runs[scale]} runs per method and condition, so its "
        "verdicts are about methods.",
    }[scale]
    if scale == "extended":
        return [first, "The README's numbers are of this scale."]
    return [
        first,
        f"The README's numbers rest on scale extended ({runs['extended']} runs; make extended), "
        "so they can differ from these.",
    ]


def _span(numbers: list[int]) -> str:
    return (
        f"{min(numbers):,}"
        if min(numbers) == max(numbers)
        else f"{min(numbers):,} to {max(numbers):,}"
    )


def reliable(studies: dict[str, Study]) -> list[tuple[str, BaselineComparison]]:
    """Methods that are feasible as often as the baseline, each with the name of its study, the
    shortest paths first.
    """
    rows = [
        (key, row)
        for key, study in studies.items()
        for row in study.baseline_comparison
        if row.feasible >= row.feasible_baseline
    ]
    return sorted(rows, key=lambda each: each[1].length or float("inf"))


def failing(studies: dict[str, Study]) -> list[tuple[str, Claim]]:
    """Sentences of papers that fail, each with the name of its study."""
    return [
        (key, claim)
        for key, study in studies.items()
        for claim in _sentences(study)
        if _fails(claim)
    ]


def _in_short(claim: Claim) -> str:
    """What the verdict on a claim says; a sentence that fails by a criterion of ours alone is no
    failure of the paper.
    """
    said = IN_SHORT.get(claim.verdict, "undecided")
    return _OWN if said == "fail" and claim.own_criterion else said


def _fails(claim: Claim) -> bool:
    return _in_short(claim) == "fail"


def _counted(study: Study) -> list[Number]:
    return [number for table in study.tables for number in table.numbers if number.counted]


def _sentences(study: Study) -> list[Claim]:
    """Sentences of the paper, without our own findings."""
    return [claim for claim in study.claims if not claim.finding]


def _of_study(key: str, study: Study) -> Sentence:
    """How many numbers of a study agree, how many of its claims are supported, and which fail."""
    counted, claims = Counter(number.verdict for number in _counted(study)), _sentences(study)
    failed, said = [claim for claim in claims if _fails(claim)], []
    if counted:
        agree, disagree = counted["identified"] + counted["agrees"], counted["disagrees"]
        said.append(
            f"{agree} of {counted.total()} numbers {_verb(agree, 'agrees', 'agree')}, "
            f"{disagree} {_verb(disagree, 'disagrees', 'disagree')}"
        )
    if claims:
        supported = sum(claim.verdict == "supported" for claim in claims)
        said.append(
            f"{supported} of {_count(len(claims), 'claim')} {_verb(supported, 'is', 'are')} "
            f"supported, {'' if failed else 'none fails'}"
        )
    parts = [Part(text=key, address=study.address), Part(text=": " + "; ".join(said))]
    if failed:
        parts += [
            *_listed([(claim.id, claim.address) for claim in failed]),
            Part(text=_verb(len(failed), " fails", " fail")),
        ]
    return [*parts, Part(text=".")]


def _replication(claims: list[Claim]) -> Sentence:
    known = [
        claim.replication
        for claim in claims
        if claim.verdict == "supported" and claim.replication is not None
    ]
    if not known:
        return []
    likely = sum(share >= _LIKELY for share in known)
    all_or_some = f"All {likely}" if likely == len(known) > 1 else f"{likely} of {len(known)}"
    again = (
        f"would show again in at least {100 * _LIKELY:g}\u00a0% of experiments of the paper's size"
    )
    return [Part(text=f"{all_or_some} supported claims that can be resampled {again}.")]


def _interpretations(claims: list[Claim]) -> Sentence:
    several = [claim for claim in claims if claim.interpretations]
    if not several:
        return []
    same = sum(
        all(interpretation.verdict == claim.verdict for interpretation in claim.interpretations)
        for claim in several
    )
    text = (
        f"{same} of {_count(len(several), 'claim')} that can be interpreted in more than one way "
        f"{_verb(same, 'keeps its', 'keep their')} verdict in every interpretation."
    )
    return [Part(text=text)]


def _audit(studies: dict[str, Study]) -> Sentence:
    """What is wrong with the printed numbers themselves."""
    checked = [
        row for study in studies.values() for row in study.audit if row.consistent is not None
    ]
    if not checked:
        return []
    bad = sum(not row.consistent for row in checked)
    where = [
        (key, f"{study.address}/audit")
        for key, study in studies.items()
        if any(row.consistent is False for row in study.audit)
    ]
    text = (
        f"The papers' own numbers contradict each other or an exact bound in {bad} of "
        f"{_count(len(checked), 'check')}"
    )
    return [Part(text=text + (": " if where else "")), *_listed(where), Part(text=".")]


def _listed(places: list[tuple[str, str]]) -> Sentence:
    """Words, each of which leads to its address, in a list."""
    parts: Sentence = []
    for n, (words, place) in enumerate(places):
        parts += [Part(text=" and " if n == len(places) - 1 else ", ")] if n else []
        parts.append(Part(text=words, address=place))
    return parts


def _verb(count: int, one: str, many: str) -> str:
    return one if count == 1 else many


def _count(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
