"""Figures hold the program's figures: what a line or a bar shows is read back from matplotlib. To look at the pictures:
TOUCHSTONE_PICTURES=FOLDER pytest test_plots.py"""

import os
from pathlib import Path

import matplotlib
import numpy as np
import pytest

matplotlib.use("Agg")

import touchstone as ts


@pytest.fixture
def look(request):
    """Keeps a figure, and a result's table, for people."""

    def keep(figure, result=None):
        figure.canvas.draw()
        folder = os.environ.get("TOUCHSTONE_PICTURES")
        if folder:
            figure.savefig(Path(folder) / f"{request.node.name}.png", dpi=80)
            if result is not None:
                (Path(folder) / f"{request.node.name}.html").write_text(f"<meta charset=utf-8>{result._repr_html_()}")
        matplotlib.pyplot.close(figure)

    return keep


@pytest.fixture
def press(plane, god_object):
    return {"recording": plane / "scan.csv", "mesh": plane / "plane.obj", "mesh_unit": "mm", "model": god_object,
            "tip_radius": "1.5mm"}


def test_recording(plane, look):
    recording = ts.load_recording(plane / "scan.csv")
    figure = recording.plot()
    tip, force = figure.axes
    assert np.array_equal(tip.lines[2].get_ydata(), recording.position_m[:, 2] * 1e3)
    assert np.array_equal(force.lines[1].get_ydata(), recording.force_N[:, 1])
    assert tip.get_ylabel() == "tip [mm]" and force.get_ylabel() == "force on the probe [N]"
    assert "1171" in recording._repr_html_() and "16.67 ms" in recording._repr_html_()
    look(figure, recording)


def test_trajectory_and_mesh(look):
    trajectory = ts.synthetic.trajectory("taps")
    figure = trajectory.plot()
    assert np.array_equal(figure.axes[0].lines[2].get_ydata(), trajectory.position_m[:, 2] * 1e3)
    assert "60 x 60 x 60 mm" in ts.Mesh(0.03 * np.array([[-1, -1, -1], [1, 1, 1], [0, 0, 0.0]]), [[0, 1, 2]])._repr_html_()
    look(figure, trajectory)


def test_evaluation(press, tmp_path, look):
    evaluation = ts.evaluate(**press, out=tmp_path)
    figure = evaluation.plot()
    signals = {one["name"]: one["value"] for one in evaluation["signals"]}
    for axis, name in zip(figure.axes, "xyz"):
        assert np.array_equal(axis.lines[0].get_ydata(), np.array(signals[f"measured_{name}"], float), equal_nan=True)
        assert np.array_equal(axis.lines[1].get_ydata(), np.array(signals[f"rendered_{name}"], float), equal_nan=True)
    assert f"{evaluation.metrics['rms_force_error']:.4g}" in evaluation._repr_html_()
    look(figure, evaluation)


def test_evaluations(plane, tmp_path, look):
    evaluations = ts.evaluate(dataset=plane, out=tmp_path)
    figure = evaluations.plot()
    wide = [bar.get_width() for axis in figure.axes for bar in axis.patches]
    assert len(figure.axes) == 2 and wide == [one.metrics["rms_force_error"] for one in evaluations]
    assert figure.axes[1].get_xlabel() == "rms force error [N]"
    html = evaluations._repr_html_()
    assert html.count("friction-cone") == 2 and "voxel does not enter: " in html
    with pytest.raises(ValueError, match="no evaluation has a value of the metric nonsense"):
        evaluations.plot("nonsense")
    look(figure, evaluations)


def test_fit(press, tmp_path, look):
    fit = ts.fit(**press, parameter="stiffness_N_per_m=100:5000", in_trajectory="measured", out=tmp_path)
    figure = fit.plot()
    profile, fitted = figure.axes[0].lines
    assert list(profile.get_ydata()) == fit["parameters"][0]["profile"]["metric"]
    assert fitted.get_xdata()[0] == fit.parameters["stiffness_N_per_m"]
    look(figure, fit)


def test_perception(plane, tmp_path, look):
    perception = ts.perceive(real=plane / "scan.csv", condition={"exact": plane / "scan.exact.csv"}, out=tmp_path)
    figure = perception.plot()
    (condition,) = perception["conditions"]
    assert [bar.get_width() for bar in figure.axes[0].patches] == [one["jnd"] for one in condition["channels"]]
    assert condition["verdict"] in perception._repr_html_()
    look(figure, perception)


def test_board(plane, god_object, tmp_path, look):
    soft = tmp_path / "soft.json"
    soft.write_text(ts.model("god-object", stiffness_N_per_m=300).to_json())
    board = ts.leaderboard(dataset=plane, model=[god_object, soft], no_reports=True, out=tmp_path / "board")
    figure = board.plot()
    order = board["tasks"][0]["ranking"]["order"]
    points = figure.axes[0].lines[0]
    assert list(points.get_xdata()) == [one["score_N"] for one in order[::-1]]
    assert "god-object" in board._repr_html_() and "soft" in board._repr_html_()
    look(figure, board)


@pytest.mark.parametrize("scene", ["bump", "shell"])
def test_atlas(scene, look):
    atlas = ts.atlas(renderers="god-object,penalty,voxel", mus="0,0.5", angles="0.5,0.9,1.2", thicknesses="0.0002,0.0005,0.001",
                     stiffnesses="200,2000")
    figure = atlas.plot(scene)
    letters = [text.get_text() for axis in figure.axes for text in axis.texts]
    cases = [one for one in atlas["cases"] if one["scene"] == scene and one["mu"] == 0]
    assert sorted(letters) == sorted(one["faults"] or "-" for one in cases)
    # A case that could not be run is neither clean nor faulty.
    del cases[0]["faults"]
    broken = atlas.plot(scene)
    assert "?" in [text.get_text() for axis in broken.axes for text in axis.texts]
    matplotlib.pyplot.close(broken)
    with pytest.raises(ValueError, match="with mu 0.3; there are 0, 0.5"):
        atlas.plot(scene, mu=0.3)
    look(figure, atlas)


def test_findings(look):
    """The figure of findings needs no search: this is what a findings.json holds of it, with a part without a value."""
    findings = ts.Findings(0, "", {
        "verdict": "found", "gap": {"unit": "N", "noise_floor": 0.02, "train": {"before": 0.3, "after": 0.02},
                                    "holdout": {"before": 0.31, "after": 0.021}},
        "effects": [{"side": "contact", "name": "coulomb-friction",
                     "parameters": [{"name": "mu_dynamic", "value": 0.2, "unit": "1"}]}],
        "where": [{"regime": "sliding", "before": 0.3, "after": 0.02}, {"regime": "at rest", "before": 0.1, "after": None},
                  {"regime": "pressing", "before": None, "after": None}]})
    figure = findings.plot()
    widths = [bar.get_width() for bar in figure.axes[0].patches]
    assert widths[:3] == [0.3, 0.1, 0.02] and np.isnan(widths[3])
    assert "coulomb-friction: mu_dynamic = 0.2" in findings._repr_html_()
    look(figure, findings)
