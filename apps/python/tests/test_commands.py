import json
import os
import signal
import subprocess
import sys
import threading
import time

import matplotlib
import numpy as np
import pytest

matplotlib.use("Agg")

import touchstone as ts
from conftest import SOURCE


def measured(metrics):
    """Without what a clock says."""
    return [one for one in metrics if one["unit"] not in ("us", "ms", "s") or "step" not in one["name"]]


def test_evaluate_is_the_programs_to_the_bit(plane, god_object, tmp_path, program):
    options = dict(recording=plane / "scan.csv", mesh=plane / "plane.obj", mesh_unit="mm", model=god_object,
                   tip_radius="1.5mm")
    words = [word for name, value in options.items() for word in ("--" + name.replace("_", "-"), value)]
    program("evaluate", *words, "--out", tmp_path / "program")
    evaluation = ts.evaluate(**options, out=tmp_path / "python")
    want = json.loads((tmp_path / "program" / "result.json").read_text())
    assert measured(evaluation["metrics"]) == measured(want["metrics"])
    assert len(measured(want["metrics"])) > 30
    for same in ("signals", "episodes", "messages", "settings", "input"):
        assert evaluation[same] == want[same], same
    rendered = ts.load_rendered(tmp_path / "program" / "rendered.csv")
    for column in ("time_s", "position_m", "contact_m", "force_N", "contact"):
        assert np.array_equal(getattr(evaluation.rendered, column), getattr(rendered, column)), column
    # Provenance: the command as one would type it, the same inputs, the same build.
    got, said = evaluation["provenance"], want["provenance"]
    assert got["inputs"] == said["inputs"]
    assert got["build"]["commit"] == said["build"]["commit"]
    assert got["command"].startswith("touchstone evaluate --") and "--model=" in got["command"]
    # Objects in memory give the same numbers as their files.
    again = ts.evaluate(recording=ts.load_recording(plane / "scan.csv"), mesh=ts.load_mesh(plane / "plane.obj", unit="mm"),
                        model=ts.model("god-object", stiffness_N_per_m=500), tip_radius="1.5mm", out=tmp_path / "memory")
    assert again.metrics["rms_force_error"] == evaluation.metrics["rms_force_error"]


def test_evaluations_of_a_data_set(plane, tmp_path):
    evaluations = ts.evaluate(dataset=plane, out=tmp_path / "all")
    assert len(evaluations) > 3
    assert evaluations["god-object"].metrics["rms_force_error"] > 0
    assert "god-object" in evaluations._repr_html_()
    evaluations.plot()


def test_discrepancy_is_the_programs_to_the_bit(tmp_path, program):
    data = os.environ.get("TOUCHSTONE_DATA_DIR", "")
    sample = os.path.join(data, "discrepancy-sample", "pw2huf7x")
    if not data or not os.path.isdir(sample):
        pytest.skip("TOUCHSTONE_DATA_DIR has no discrepancy-sample")
    names = {"model": "model.json", "mesh": "mesh.obj", "recording": "train.csv", "holdout": "holdout.csv",
             "instrument": "instrument.json"}
    options = {name: os.path.join(sample, file) for name, file in names.items() if os.path.exists(os.path.join(sample, file))}
    words = [word for name, value in options.items() for word in ("--" + name, value)]
    program("discrepancy", *words, "--out", tmp_path / "program")
    findings = ts.discrepancy(**options, out=tmp_path / "python")
    want = json.loads((tmp_path / "program" / "findings.json").read_text())
    # Whatever names a time, a folder or a way of calling is its own.
    for own in ("provenance", "command", "created_utc"):
        want.pop(own, None)
        findings.data.pop(own, None)
    assert findings.data == want
    assert findings.model.to_json() == ts.Model.load(tmp_path / "program" / "model.json").to_json()
    assert "verdict" in findings._repr_html_()
    findings.plot()


def test_fit_and_compare_and_check(plane, god_object, tmp_path, program):
    fit = ts.fit(parameter="stiffness_N_per_m=100:5000", recording=plane / "scan.csv", mesh=plane / "plane.obj",
                 mesh_unit="mm", model=god_object, tip_radius="1.5mm", in_trajectory="measured", out=tmp_path / "fit")
    assert 100 <= fit.parameters["stiffness_N_per_m"] <= 5000
    assert fit.model.parameters["stiffness_N_per_m"] == fit.parameters["stiffness_N_per_m"]
    fit.plot()
    rendered = ts.replay(god_object, ts.datasets()["plane"].mesh, ts.load_recording(plane / "scan.csv"))
    rendered.save(tmp_path / "a.h5")
    assert ts.compare(tmp_path / "a.h5", rendered).passed
    other = ts.compare(rendered, plane / "scan.csv")
    assert not other.passed and other.status == 1 and other.verdict == "missing"
    program("compare", tmp_path / "a.h5", plane / "scan.csv", status=1)
    check = ts.check("plane-taps", model="god-object", out=tmp_path / "failures")
    assert check.passed and len(check.tests) == 1


def test_replay_is_the_programs_to_the_bit(plane, god_object, tmp_path, program):
    program("replay", "--model", god_object, "--mesh", plane / "plane.obj", "--mesh-unit", "mm", "--trajectory",
            plane / "scan.csv", "--out", tmp_path / "program.h5")
    want = ts.load_rendered(tmp_path / "program.h5")
    got = ts.replay(god_object, plane / "plane.obj", plane / "scan.csv", mesh_unit="mm")
    for column in ("time_s", "position_m", "contact_m", "force_N", "contact"):
        assert np.array_equal(getattr(got, column), getattr(want, column)), column


def test_errors_have_the_programs_messages(plane, tmp_path, program):
    said = program("evaluate", "--recording", "none.csv", status=2).stderr
    with pytest.raises(ts.UsageError) as error:
        ts.evaluate(recording="none.csv", out=tmp_path)
    assert said == f"touchstone: {error.value}\n"
    with pytest.raises(ts.UsageError, match="there is no option recordings"):
        ts.evaluate(recordings="a.csv")
    # Outputs never destroy inputs, and the next command may read what one wrote.
    copy = tmp_path / "scan.csv"
    copy.write_bytes((plane / "scan.csv").read_bytes())
    with pytest.raises(ts.UsageError, match="nothing was written"):
        ts.run("convert", copy, copy)
    ts.run("convert", copy, tmp_path / "b.csv")
    ts.run("convert", tmp_path / "b.csv", copy)


def test_the_pages_of_the_program_open_from_a_result(plane, god_object, tmp_path):
    evaluation = ts.evaluate(recording=plane / "scan.csv", mesh=plane / "plane.obj", mesh_unit="mm", model=god_object,
                             tip_radius="1.5mm", out=tmp_path / "e")
    assert evaluation.page().name == "report.html" and evaluation.page().stat().st_size > 10000
    assert "rms_force_error" in evaluation._repr_html_()
    figure = evaluation.plot()
    assert len(figure.axes) == 3
    recording = ts.load_recording(plane / "scan.csv")
    assert "1171" in recording._repr_html_()
    recording.plot()


def test_other_threads_run_meanwhile(plane):
    count, stop = 0, False

    def counting():
        nonlocal count
        while not stop:
            count += 1
            time.sleep(0.0005)

    thread = threading.Thread(target=counting)
    thread.start()
    mesh = ts.synthetic.mesh("sphere", triangles=200000)
    before = count
    mesh.surface()
    during = count - before
    stop = True
    thread.join()
    assert during > 3


def test_ctrl_c_stops_long_work(tmp_path):
    """In a process of its own: a search that takes minutes ends at once, as KeyboardInterrupt, and Python goes on."""
    script = tmp_path / "long.py"
    script.write_text(f"""
import sys, time
sys.path[:0] = {sys.path!r}
import numpy as np, touchstone as ts
mesh = ts.synthetic.mesh("sphere", triangles=20000)
trajectory = ts.Trajectory(np.arange(100_000_000) * 1e-3, np.zeros((100_000_000, 3)) + [0, 0, 0.0299])
print("ready", flush=True)
began = time.monotonic()
try:
    ts.replay(ts.model("god-object", stiffness_N_per_m=500), mesh, trajectory)
    print("it was not stopped")
except KeyboardInterrupt:
    print("stopped")
print(len(ts.replay(ts.model("god-object", stiffness_N_per_m=500), mesh, ts.Trajectory([0, 1], np.zeros((2, 3))))))
""".replace("100_000_000", "10_000_000"))
    child = subprocess.Popen([sys.executable, script], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "ready\n"
    time.sleep(0.3)
    child.send_signal(signal.SIGINT)
    rest = child.communicate(timeout=60)[0]
    assert rest == "stopped\n2\n"


def test_progress_is_reported(plane, god_object, tmp_path):
    seen = []
    ts.progress(lambda what, done, total: seen.append((what, done, total)))
    try:
        rng = np.random.default_rng(1)
        count = 400_000
        position = np.column_stack([rng.normal(0, 1e-3, count), rng.normal(0, 1e-3, count), np.full(count, -1e-4)])
        ts.Trajectory(np.arange(count) * 1e-3, position).save(tmp_path / "long.csv")
        ts.run("replay", model=god_object, mesh=plane / "plane.obj", mesh_unit="mm", trajectory=tmp_path / "long.csv",
               out=tmp_path / "out.h5")
    finally:
        ts.progress(None)
    assert seen and all(what.startswith("replay long.csv") for what, _, _ in seen)
    done = [one[1] for one in seen]
    assert done == sorted(done)


def test_every_command_is_there():
    assert {"evaluate", "fit", "discrepancy", "perceive", "leaderboard", "check", "compare"} <= set(ts.commands)
    assert "--" not in ts.evaluate.__doc__.split("\n")[0]
    assert "mesh_unit: Unit of the mesh" in ts.evaluate.__doc__
    assert "stiffness" in str(ts.evaluate.__signature__)
    assert ts.build_info()["version"] == ts.__version__
    assert (SOURCE / "VERSION").read_text().strip() == ts.__version__
