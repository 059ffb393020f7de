"""What `touchstone check --junit` writes."""

import os
import xml.etree.ElementTree
from typing import Dict, List, Union


def read_junit(path: Union[str, "os.PathLike[str]"]) -> List[Dict[str, str]]:
    """For each golden case and model: case, model, state (passed, failed or skipped), and text, which says why."""
    tests = []
    for one in xml.etree.ElementTree.parse(path).getroot().iter("testcase"):
        state, text = "passed", ""
        for failure in one.iter("failure"):
            state, text = "failed", f"{failure.get('message', '')}\n{failure.text or ''}".strip()
        for skipped in one.iter("skipped"):
            state, text = "skipped", skipped.get("message", "")
        # classname is golden.<case>
        tests.append({"case": one.get("classname", "").partition(".")[2], "model": one.get("name", ""), "state": state,
                      "text": text})
    return tests
