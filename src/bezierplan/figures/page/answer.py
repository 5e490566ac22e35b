"""The answer in a few short sentences, computed from the content of the page: which papers reproduce, how far, what fails, how surely."""

from collections import Counter

from bezierplan.analysis.claims.verdicts import DECIDED, MOSTLY
from bezierplan.figures.page.content import Claim, Number, Part, Study

Sentence = list[Part]

# What the verdict on a claim says in short; any other verdict leaves the claim undecided.
IN_SHORT = {
    "supported": "hold",
    "mostly": "hold in part",
    "in part": "hold in part",
    "seldom": "hold in part",
    "contradicted": "fail",
    "no effect": "fail",
}
_OWN = "fail by our criterion alone"
# Least probability that an experiment of the paper's size shows the same.
_LIKELY = 0.8


def answer(studies: dict[str, Study]) -> list[Sentence]:
    """Sentences: all numbers and all claims, one of each study, then how certain this is. Without numbers and claims, one that says so."""
    counted = [number for study in studies.values() for number in _counted(study)]
    claims = [claim for study in studies.values() for claim in _sentences(study)]
    if not counted and not claims:
        runs = sum(shown.count for study in studies.values() for shown in study.shown if not shown.problem) or "no"
        return [[Part(text=f"A subset that shows how the page works: {runs} runs, too few to judge numbers or claims.")]]
    of_studies = [_of_study(key, study) for key, study in studies.items() if study.claims or _counted(study)]
    sentences = [_numbers(counted), _claims(claims), *of_studies, _replication(claims), _readings(claims), _audit(studies)]
    return [sentence for sentence in sentences if sentence]


def failing(studies: dict[str, Study]) -> list[tuple[str, Claim]]:
    """Sentences of papers that fail, each with the name of its study."""
    return [(key, claim) for key, study in studies.items() for claim in _sentences(study) if _fails(claim)]


def _in_short(claim: Claim) -> str:
    """What the verdict on a claim says; a sentence that fails by a criterion of ours alone is no failure of the paper."""
    said = IN_SHORT.get(claim.verdict, "undecided")
    return _OWN if said == "fail" and claim.own_criterion else said


def _fails(claim: Claim) -> bool:
    return _in_short(claim) == "fail"


def _counted(study: Study) -> list[Number]:
    return [number for table in study.tables for number in table.numbers if number.counted]


def _sentences(study: Study) -> list[Claim]:
    """Sentences of the paper, without our own findings."""
    return [claim for claim in study.claims if not claim.finding]


def _numbers(counted: list[Number]) -> Sentence:
    if not counted:
        return []
    good, bad, weak = _degrees(counted)

    def share(part: int) -> str:
        return f"{part} ({100 * part / len(counted):.0f}\u00a0%)"

    said = f"{share(good)} {_verb(good, 'is', 'are')} reproduced, {share(bad)} {_verb(bad, 'is', 'are')} not"
    rest = f"; tests of the rest ({weak}) are too weak to tell" if weak else ""
    return [Part(text=f"Of {len(counted)} published numbers, {said}{rest}.")]


def _degrees(counted: list[Number]) -> tuple[int, int, int]:
    """How many numbers are reproduced or identified, how many are not, and how many agree in a test that could hardly have failed."""
    found = Counter(number.verdict for number in counted)
    good, bad = found["identified"] + found["reproduced"], found["not reproduced"]
    return good, bad, len(counted) - good - bad


def _claims(claims: list[Claim]) -> Sentence:
    if not claims:
        return []
    found = Counter(map(_in_short, claims))
    singular = {"hold": "holds", "hold in part": "holds in part", "fail": "fails", _OWN: "fails by our criterion alone"}
    singular |= {"undecided": "is undecided"}
    plural = {word: word for word in singular} | {"undecided": "are undecided"}
    parts = [f"{found[word]} {_verb(found[word], singular[word], plural[word])}" for word in singular if found[word]]
    return [Part(text=f"Of {len(claims)} claims of the papers, tested at the 95\u00a0% level, {_joined(parts)}.")]


def _of_study(key: str, study: Study) -> Sentence:
    """How far a study reproduces, and which of its claims fail."""
    counted, claims = _counted(study), _sentences(study)
    parts, failed = [Part(text=key, address=study.address)], [claim for claim in claims if _fails(claim)]
    if counted:
        good, bad, weak = _degrees(counted)
        parts.append(Part(text=f" {_degree(good, bad, weak)}" + ("; " if claims else "")))
    if claims:
        supported = sum(claim.verdict == "supported" for claim in claims)
        parts.append(Part(text=f"{'' if counted else ': '}{supported} of {len(claims)} claims hold, " + ("" if failed else "none")))
        parts += _listed([(claim.id, claim.address) for claim in failed])
        parts.append(Part(text=" fail" if len(failed) > 1 else " fails"))
    return [*parts, Part(text=".")]


def _degree(good: int, bad: int, weak: int) -> str:
    """How far numbers reproduce, in words; the same shares as in verdicts on claims."""
    decisive, count = good + bad, good + bad + weak
    if decisive < DECIDED * count:
        return f"has too few decisive numbers to tell ({decisive} of {count})"
    share = good / decisive
    if share in (0, 1):
        degree = "reproduces" if share else "does not reproduce"
    else:
        degree = "mostly reproduces" if share >= MOSTLY else "hardly reproduces" if share <= 1 - MOSTLY else "reproduces in part"
    return f"{degree} ({good} of {decisive} decisive numbers)"


def _replication(claims: list[Claim]) -> Sentence:
    known = [claim.replication for claim in claims if claim.verdict == "supported" and claim.replication is not None]
    if not known:
        return []
    likely = sum(share >= _LIKELY for share in known)
    again = f"{likely} would show again in at least {100 * _LIKELY:g}\u00a0% of experiments of the paper's size"
    return [Part(text=f"Of {len(known)} supported claims that can be resampled, {again}.")]


def _readings(claims: list[Claim]) -> Sentence:
    several = [claim for claim in claims if claim.readings]
    if not several:
        return []
    same = sum(all(reading.verdict == claim.verdict for reading in claim.readings) for claim in several)
    text = f"Of {len(several)} {_verb(len(several), 'claim', 'claims')} that can be read in more than one way, {same}"
    return [Part(text=f"{text} {_verb(same, 'keeps its', 'keep their')} verdict in every reading.")]


def _audit(studies: dict[str, Study]) -> Sentence:
    """What is wrong with the printed numbers themselves."""
    checked = [row for study in studies.values() for row in study.audit if row.consistent is not None]
    if not checked:
        return []
    bad = sum(not row.consistent for row in checked)
    where = [(key, f"{study.address}/audit") for key, study in studies.items() if any(row.consistent is False for row in study.audit)]
    text = f"The papers' own numbers contradict each other or an exact bound in {bad} of {len(checked)} checks"
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


def _joined(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
