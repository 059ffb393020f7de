"""The program beside the package is the truth: what Python says must be what it says."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import touchstone as ts

SOURCE = Path(os.environ["TOUCHSTONE_SOURCE_DIR"])
PROGRAM = os.environ["TOUCHSTONE_PROGRAM"]


@pytest.fixture
def plane():
    return ts.datasets()["plane"].folder


@pytest.fixture
def program():
    def run(*words, status=0):
        done = subprocess.run([PROGRAM, *map(str, words)], text=True, capture_output=True)
        assert done.returncode == status, done.stderr
        return done

    return run


@pytest.fixture
def god_object(tmp_path):
    path = tmp_path / "god-object.json"
    path.write_text(json.dumps({"schema": "touchstone-model/1", "renderer": "god-object",
                                "parameters": {"stiffness_N_per_m": 500}}))
    return path


def run_suite(file, *words):
    """pytest --touchstone FILE in a process of its own; names of tests as ctest writes them."""
    done = subprocess.run([sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-v", "-rs", "--touchstone", file, *words],
                          text=True, capture_output=True)
    done.stdout = done.stdout.replace("::", ".")  # pytest's way of writing the dots of a name
    return done
