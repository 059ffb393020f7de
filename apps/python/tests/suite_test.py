"""The whole conformance and golden suite on the god-object in Python, as on the program's own renderers."""

import re

import touchstone as ts
from conftest import SOURCE, run_suite

EXAMPLE = SOURCE / "examples" / "python-renderer" / "god_object.py"

#: What a god-object for point tips may skip, with the reason: tests about servo loops, and shapes that a test is not about.
MAY_SKIP = re.compile(r"is about servo loops|is no thin shell|an open sheet has no inside")


def test_the_whole_suite():
    done = run_suite(EXAMPLE)
    assert done.returncode == 0, done.stdout[-6000:]
    outcomes = re.findall(r"god-object-in-python\.(\S+) (PASSED|SKIPPED|FAILED)", done.stdout)
    golden = [verdict for name, verdict in outcomes if name.startswith("golden.")]
    with_model = [name for name, case in ts.goldens().items() if "god-object" in case.data["models"]]
    assert golden == ["PASSED"] * len(with_model)
    conformance = [verdict for name, verdict in outcomes if name.startswith("conformance.")]
    assert conformance.count("PASSED") >= 70
    reasons = re.findall(r"^SKIPPED \[\d+\] .*", done.stdout, re.MULTILINE)
    assert reasons and all(MAY_SKIP.search(one) for one in reasons), reasons
