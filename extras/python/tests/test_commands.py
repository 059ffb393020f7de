import threading
import time

import matplotlib
import numpy as np
import pytest

matplotlib.use("Agg")

import touchstone as ts
from conftest import SOURCE


def test_evaluations_of_a_data_set(plane, tmp_path):
    evaluations = ts.evaluate(dataset=plane, out=tmp_path / "all")
    assert len(evaluations) > 3
    assert evaluations["god-object"].metrics["rms_force_error"] > 0
    assert "god-object" in evaluations._repr_html_()
    evaluations.plot()


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


def test_a_comparison_that_fails_is_no_exception(plane, god_object, tmp_path, program):
    rendered = ts.replay(god_object, ts.datasets()["plane"].mesh, ts.load_recording(plane / "scan.csv"))
    rendered.save(tmp_path / "a.h5")
    assert ts.compare(tmp_path / "a.h5", rendered).passed
    other = ts.compare(rendered, plane / "scan.csv")
    assert not other.passed and other.status == 1 and other.verdict == "missing"
    program("compare", tmp_path / "a.h5", plane / "scan.csv", status=1)
    with pytest.raises(TypeError, match="ask for .passed"):
        bool(other)


def test_a_check_says_of_each_case_what_the_program_says(tmp_path):
    check = ts.check("plane-taps", model="god-object", out=tmp_path / "failures")
    assert check.passed
    assert [(one["case"], one["model"], one["state"]) for one in check.tests] == [("plane-taps", "god-object", "passed")]
    assert "plane-taps" in check._repr_html_()
    # The penalty method is not the god-object, and it cannot start inside.
    other = ts.check("shell-thin-push", model="god-object", renderer="penalty", out=tmp_path / "failures")
    (one,) = other.tests
    assert not other.passed and one["state"] == "failed" and "force" in one["text"]


def test_subcommands_are_called_by_their_names(tmp_path):
    result = ts.run("golden export", "plane-taps", to=tmp_path, golden=ts.bundled("golden"), model="god-object")
    assert result.passed and (tmp_path / "god-object.json").is_file()
    assert "golden accept" in ts.commands and "reason" in [one["name"] for one in ts.commands["golden accept"]["options"]]
    with pytest.raises(ts.UsageError, match="there is no option too"):
        ts.run("golden export", "plane-taps", too=tmp_path)


def test_every_command_is_there():
    named = {"evaluate", "fit", "discrepancy", "perceive", "leaderboard", "check", "compare", "history", "tool replay"}
    assert named <= set(ts.commands)
    assert "--" not in ts.evaluate.__doc__.split("\n")[0]
    assert "mesh_unit: Unit of the mesh" in ts.evaluate.__doc__
    assert "stiffness" in str(ts.evaluate.__signature__)
    assert ts.build_info()["version"] == ts.__version__
    assert (SOURCE / "VERSION").read_text().strip() == ts.__version__
