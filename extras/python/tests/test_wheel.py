"""The wheel that pip makes of this build, installed where nothing else of Touchstone is."""

import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import touchstone as ts
from conftest import SOURCE

BUILD = Path(os.environ["TOUCHSTONE_PROGRAM"]).parents[1]

#: In the environment: a bundled data set, and a golden case on a renderer in Python, which runs in the plug-in host.
USE = """
import json, sys
import touchstone as ts
plane = ts.datasets()["plane"].folder
evaluation = ts.evaluate(recording=plane / "scan.csv", mesh=plane / "plane.obj", mesh_unit="mm",
                         model=ts.model("god-object", stiffness_N_per_m=500))
check = ts.check("plane-taps", model="god-object", renderer="god-object-in-python", renderers=sys.argv[1], out="failures")
print(json.dumps({"places": [ts.__file__, str(plane)], "metrics": evaluation.metrics, "passed": check.passed}))
"""


def run(*words, **more):
    own = ("PYTHONPATH", "TOUCHSTONE_PROGRAM", "TOUCHSTONE_SOURCE_DIR")  # the build's
    environment = {key: value for key, value in os.environ.items() if key not in own}
    done = subprocess.run([str(word) for word in words], text=True, capture_output=True, env=environment, **more)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def without_times(metrics):
    return {name: value for name, value in metrics.items() if not name.endswith("_step_cost")}


def test_pip_installs_what_the_build_has(tmp_path):
    run(sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-index", "--no-build-isolation",
        "--config-settings", f"build-folder={BUILD}", "-w", tmp_path, SOURCE)
    (wheel,) = tmp_path.glob("*.whl")
    python = "cp{0.major}{0.minor}".format(sys.version_info)
    assert wheel.name == f"touchstone-{ts.__version__}-{python}-{python}-linux_x86_64.whl"
    assert any(name.endswith(".dist-info/LICENSE") for name in zipfile.ZipFile(wheel).namelist())

    home = tmp_path / "environment"
    run(sys.executable, "-m", "venv", "--system-site-packages", home)  # numpy is Debian's
    python = home / "bin" / "python"
    run(python, "-m", "pip", "install", "--no-index", wheel)
    example = SOURCE / "examples" / "python-renderer" / "god_object.py"
    used = json.loads(run(python, "-c", USE, example, cwd=tmp_path).splitlines()[-1])
    assert all(Path(place).is_relative_to(home) for place in used["places"]) and used["passed"]

    plane = ts.datasets()["plane"].folder
    here = ts.evaluate(recording=plane / "scan.csv", mesh=plane / "plane.obj", mesh_unit="mm",
                       model=ts.model("god-object", stiffness_N_per_m=500))
    assert "rms_force_error" in used["metrics"] and without_times(used["metrics"]) == without_times(here.metrics)
    run(python, "-m", "pip", "uninstall", "-y", "touchstone")
    assert not [path for path in home.rglob("*") if path.is_file() and "touchstone" in str(path.relative_to(home))]
