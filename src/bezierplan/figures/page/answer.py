"""The answer in a few sentences, computed from the content of the page: which papers reproduce, how far, what fails, how surely."""

from collections import Counter
from statistics import median

from bezierplan.analysis.claims.verdicts import DECIDED, MOSTLY, VERDICTS
from bezierplan.figures.page.content import Claim, Number, Part, Study

Sentence = list[Part]

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
    sentences = [_numbers(counted), _claims(claims), *of_studies, _replication(claims), _readings(claims), _audit(studies), _gaps(studies)]
    return [sentence for sentence in sentences if sentence]


def _counted(study: Study) -> list[Number]:
    return [number for table in study.tables for number in table.numbers if number.counted]


def _sentences(study: Study) -> list[Claim]:
    """Sentences of the paper, without our own findings."""
    return [claim for claim in study.claims if not claim.finding]


def _share(part: int, whole: int) -> str:
    return f"{part} ({100 * part / whole:.0f} %)"


def _numbers(counted: list[Number]) -> Sentence:
    if not counted:
        return []
    found = Counter(number.verdict for number in counted)
    words = {
        "reproduced": "are reproduced",
        "not told apart": "agree, but within an interval too wide to tell methods apart",
        "cannot fail": "agree where no number could have failed",
        "not reproduced": "are not reproduced",
    }
    parts = [f"{_share(found[name], len(counted))} {said}" for name, said in words.items() if found[name]]
    return [Part(text=f"Of {len(counted)} published numbers that can be judged, {_joined(parts)}.")]


def _claims(claims: list[Claim]) -> Sentence:
    if not claims:
        return []
    found = Counter(claim.verdict for claim in claims)
    parts = [f"{found[name]} {_said(name, found[name])}" for name in (*VERDICTS, *sorted(found.keys() - set(VERDICTS))) if found[name]]
    return [Part(text=f"Of {len(claims)} sentences that the papers state, {_joined(parts)}.")]


def _said(verdict: str, count: int) -> str:
    verb = "is" if count == 1 else "are"
    words = {
        "mostly": "hold" + "s" * (count == 1) + " mostly",
        "in part": "hold" + "s" * (count == 1) + " in part",
        "seldom": "hold" + "s" * (count == 1) + " seldom",
        "no effect": "show" + "s" * (count == 1) + " no effect",
        "undecided": f"{verb} undecided",
    }
    return words.get(verdict, f"{verb} {verdict}")


def _of_study(key: str, study: Study) -> Sentence:
    """How far a study reproduces, and which of its claims fail."""
    counted, claims = _counted(study), _sentences(study)
    good = sum(number.verdict == "reproduced" for number in counted)
    bad = sum(number.verdict == "not reproduced" for number in counted)
    supported = sum(claim.verdict == "supported" for claim in claims)
    failed = [claim for claim in claims if claim.verdict in ("contradicted", "no effect")]
    said = [f" {good} reproduced, {bad} not, {len(counted) - good - bad} not decisive"] if counted else []
    said += [f" {supported} of {len(claims)} claims supported"] if claims else []
    parts = [Part(text=key, address=study.address), Part(text=f" {_degree(good, bad, len(counted))}:{';'.join(said)}")]
    if failed:
        parts.append(Part(text="; against the paper: "))
        for n, claim in enumerate(failed):
            parts += [Part(text=", ")] if n else []
            parts.append(Part(text=claim.id, address=claim.address))
    return [*parts, Part(text=".")]


def _degree(good: int, bad: int, count: int) -> str:
    """How far numbers reproduce, in words; the same shares as in verdicts on claims."""
    if good + bad < DECIDED * count or not count:
        return "can hardly be judged by its numbers"
    share = good / (good + bad)
    if share in (0, 1):
        return "reproduces" if share else "does not reproduce"
    return "mostly reproduces" if share >= MOSTLY else "hardly reproduces" if share <= 1 - MOSTLY else "reproduces in part"


def _replication(claims: list[Claim]) -> Sentence:
    known = [claim.replication for claim in claims if claim.verdict == "supported" and claim.replication is not None]
    if not known:
        return []
    likely = sum(share >= _LIKELY for share in known)
    text = f"A fresh experiment of the paper's size would show a supported claim again with a median probability of {median(known):.2f}"
    return [Part(text=f"{text}; {likely} of {len(known)} reach {_LIKELY:g}. Intervals are at the 95 % level.")]


def _readings(claims: list[Claim]) -> Sentence:
    several = [claim for claim in claims if claim.readings]
    if not several:
        return []
    same = sum(all(reading.verdict == claim.verdict for reading in claim.readings) for claim in several)
    return [Part(text=f"{same} of {len(several)} claims that can be read in several ways have the same verdict in every reading.")]


def _audit(studies: dict[str, Study]) -> Sentence:
    checked = [row for study in studies.values() for row in study.audit if row.consistent is not None]
    if not checked:
        return []
    bad = sum(not row.consistent for row in checked)
    where = [(key, f"{study.address}/audit") for key, study in studies.items() if any(row.consistent is False for row in study.audit)]
    parts = [Part(text=f"Without any run, {bad} of {len(checked)} checks find printed numbers that contradict each other or a bound")]
    for n, (key, place) in enumerate(where):
        parts += [Part(text=", " if n else ": "), Part(text=key, address=place)]
    return [*parts, Part(text=".")]


def _gaps(studies: dict[str, Study]) -> Sentence:
    """The median excess length over the exact bound, study by study."""
    parts: Sentence = []
    for key, study in studies.items():
        gaps = [number.gap for number in _counted(study) if number.gap is not None]
        if gaps:
            parts += [Part(text=", " if parts else ""), Part(text=key, address=study.address), Part(text=f" {100 * median(gaps):.1f} %")]
    before = "Feasible paths exceed the exact shortest path in the median table cell by: "
    return [Part(text=before), *parts, Part(text=".")] if parts else []


def _joined(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
