"""Every figure that a command gives in Python is the program's, to the bit: both write their files, and all numbers of both
are compared. What a clock says, and how the command was called, is its own."""

import json
import os

import numpy as np
import pytest

import touchstone as ts

#: Entries that hold times, places and ways of calling.
OWN = {"provenance", "command", "created_utc", "timing", "timings", "time_s", "seconds", "folder", "report", "wall_s"}


def without_clocks(value):
    if isinstance(value, dict):
        return {key: without_clocks(one) for key, one in value.items() if key not in OWN}
    if isinstance(value, list):
        return [without_clocks(one) for one in value if not is_a_time(one)]
    return value


def is_a_time(value):
    return isinstance(value, dict) and "step" in str(value.get("name")) and value.get("unit") in ("us", "ms", "s")


def numbers(value):
    """How many numbers there are to compare."""
    if isinstance(value, (dict, list)):
        return sum(map(numbers, value.values() if isinstance(value, dict) else value))
    return int(isinstance(value, (int, float)) and not isinstance(value, bool))


def same(got, path, at_least):
    want = without_clocks(json.loads(path.read_text()))
    got = without_clocks(got)
    assert got == want
    assert numbers(want) >= at_least, "hardly anything was compared"


def words_of(options):
    """The options as one types them."""
    words = []
    for name, value in options.items():
        for one in value if isinstance(value, list) else [value]:
            words += [f"--{name.replace('_', '-')}"] + ([] if one is True else [one])
    return words


@pytest.fixture
def press(plane, god_object):
    return {"recording": plane / "scan.csv", "mesh": plane / "plane.obj", "mesh_unit": "mm", "model": god_object,
            "tip_radius": "1.5mm"}


COLUMNS = ("time_s", "position_m", "contact_m", "force_N", "contact")


def test_evaluate(press, plane, tmp_path, program):
    program("evaluate", *words_of(press), "--out", tmp_path / "program")
    evaluation = ts.evaluate(**press, out=tmp_path / "python")
    same(evaluation.data, tmp_path / "program" / "result.json", 1000)
    rendered = ts.load_rendered(tmp_path / "program" / "rendered.csv")
    for column in COLUMNS:
        assert np.array_equal(getattr(evaluation.rendered, column), getattr(rendered, column)), column
    # Provenance: the command as one would type it, the same inputs, the same build.
    got = evaluation["provenance"]
    said = json.loads((tmp_path / "program" / "result.json").read_text())["provenance"]
    assert got["inputs"] == said["inputs"]
    assert got["build"]["commit"] == said["build"]["commit"]
    assert got["command"].startswith("touchstone evaluate --") and "--model=" in got["command"]
    # Objects in memory give the same numbers as their files.
    again = ts.evaluate(recording=ts.load_recording(plane / "scan.csv"), mesh=ts.load_mesh(plane / "plane.obj", unit="mm"),
                        model=ts.model("god-object", stiffness_N_per_m=500), tip_radius="1.5mm", out=tmp_path / "memory")
    assert again.metrics["rms_force_error"] == evaluation.metrics["rms_force_error"]


@pytest.fixture
def strokes(plane, tmp_path):
    """The way of the tip's lowest point, which goes into the plate."""
    scan = ts.load_recording(plane / "scan.csv")
    path = tmp_path / "strokes.h5"
    ts.Trajectory(scan.time_s, scan.position_m - [0, 0, 0.002]).save(path)
    return path


def test_replay(plane, god_object, strokes, tmp_path, program):
    program("replay", "--model", god_object, "--mesh", plane / "plane.obj", "--mesh-unit", "mm", "--trajectory", strokes,
            "--out", tmp_path / "program.h5")
    want = ts.load_rendered(tmp_path / "program.h5")
    got = ts.replay(god_object, plane / "plane.obj", strokes, mesh_unit="mm")
    assert 100 < got.contact.sum() < len(got)
    for column in COLUMNS:
        assert np.array_equal(getattr(got, column), getattr(want, column)), column


def test_fit(press, tmp_path, program):
    options = {**press, "parameter": "stiffness_N_per_m=100:5000", "in_trajectory": "measured"}
    program("fit", *words_of(options), "--out", tmp_path / "program")
    fit = ts.fit(**options, out=tmp_path / "python")
    same(fit.data, tmp_path / "program" / "fit.json", 20)
    assert 100 <= fit.parameters["stiffness_N_per_m"] <= 5000
    assert fit.model.parameters["stiffness_N_per_m"] == fit.parameters["stiffness_N_per_m"]


def test_compare(plane, god_object, strokes, tmp_path, program):
    soft = ts.model("god-object", stiffness_N_per_m=499)
    files = []
    for name, model in (("a", god_object), ("b", soft)):
        files.append(tmp_path / f"{name}.h5")
        ts.replay(model, plane / "plane.obj", strokes, mesh_unit="mm").save(files[-1])
    program("compare", *files, "--json", tmp_path / "program.json", status=1)
    comparison = ts.compare(*files)
    assert comparison.status == 1
    same(comparison.data, tmp_path / "program.json", 20)


def test_check(tmp_path, program):
    said = program("check", "plane-taps", "sphere-scan", "--golden", ts.bundled("golden"), "--out", tmp_path / "p").stdout
    check = ts.check("plane-taps", "sphere-scan", golden=ts.bundled("golden"), out=tmp_path / "q")
    assert check.text == said
    assert len(check.tests) == said.count("equal ") > 10


def test_perceive(plane, god_object, tmp_path, program):
    exact = plane / "scan.exact.csv"
    options = {"real": plane / "scan.csv", "condition": [f"exact={exact}"], "model": [f"stiff={god_object}"],
               "mesh": plane / "plane.obj", "mesh_unit": "mm"}
    program("perceive", *words_of(options), "--out", tmp_path / "program")
    same(ts.perceive(**options, out=tmp_path / "python").data, tmp_path / "program" / "perception.json", 50)
    # Named by a dictionary, and in memory.
    options.update(condition={"exact": exact}, model={"stiff": ts.model(god_object)})
    same(ts.perceive(**options, out=tmp_path / "memory").data, tmp_path / "program" / "perception.json", 50)


def test_leaderboard(plane, god_object, tmp_path, program):
    soft = tmp_path / "soft.json"
    soft.write_text(ts.model("god-object", stiffness_N_per_m=300).to_json())
    options = {"dataset": plane, "model": [god_object, soft], "no_reports": True}
    program("leaderboard", *words_of(options), "--out", tmp_path / "program")
    same(ts.leaderboard(**options, out=tmp_path / "python").data, tmp_path / "program" / "leaderboard.json", 20)


def test_atlas(tmp_path, program):
    options = {"renderers": "god-object,penalty", "mus": "0,0.5", "angles": "0.5,1.2", "thicknesses": "0.0005",
               "stiffnesses": "200,2000"}
    program("atlas", *words_of(options), "--out", tmp_path / "program")
    atlas = ts.atlas(**options)
    same(atlas.data, tmp_path / "program" / "atlas.json", 200)
    # In a folder that is there as long as the result.
    assert atlas.page().is_file()


def test_discrepancy(tmp_path, program):
    data = os.environ.get("TOUCHSTONE_DATA_DIR", "")
    sample = os.path.join(data, "discrepancy-sample", "pw2huf7x")
    if not data or not os.path.isdir(sample):
        pytest.skip("TOUCHSTONE_DATA_DIR has no discrepancy-sample")
    names = {"model": "model.json", "mesh": "mesh.obj", "recording": "train.csv", "holdout": "holdout.csv",
             "instrument": "instrument.json"}
    options = {name: os.path.join(sample, file) for name, file in names.items() if os.path.exists(os.path.join(sample, file))}
    program("discrepancy", *words_of(options), "--out", tmp_path / "program")
    findings = ts.discrepancy(**options, out=tmp_path / "python")
    same(findings.data, tmp_path / "program" / "findings.json", 20)
    assert findings.model.to_json() == ts.Model.load(tmp_path / "program" / "model.json").to_json()
