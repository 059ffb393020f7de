"""The whole conformance and golden suite on the god-object in Python, as on the program's own renderers."""

import re

import touchstone as ts
from conftest import SOURCE, run_suite

EXAMPLE = SOURCE / "examples" / "python-renderer" / "god_object.py"

#: What a god-object for point tips and one object may skip, with the reason: tests about servo loops, shapes that a test is not
#: about, and scenes.
MAY_SKIP = re.compile(r"is about servo loops|is no thin shell|an open sheet has no inside|takes one object, and the case has")


def test_the_whole_suite():
    done = run_suite(EXAMPLE)
    assert done.returncode == 0, done.stdout[-6000:]
    outcomes = re.findall(r"god-object-in-python\.(\S+) (PASSED|SKIPPED|FAILED)", done.stdout)
    golden = [verdict for name, verdict in outcomes if name.startswith("golden.")]
    with_model = [case for _, case in sorted(ts.goldens().items()) if "god-object" in case.data["models"]]
    assert len(golden) == len(with_model)
    for verdict, case in zip(golden, with_model):
        assert verdict == "PASSED" or (verdict == "SKIPPED" and "scene" in case.data), case.data["name"]
    conformance = [verdict for name, verdict in outcomes if name.startswith("conformance.")]
    assert conformance.count("PASSED") >= 70
    reasons = re.findall(r"^SKIPPED \[\d+\] .*", done.stdout, re.MULTILINE)
    assert reasons and all(MAY_SKIP.search(one) for one in reasons), reasons
