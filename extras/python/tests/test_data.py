import gc
import os
import re

import numpy as np
import pytest

import touchstone as ts
from conftest import SOURCE


def test_a_recording_is_arrays_without_a_copy(plane):
    recording = ts.load_recording(plane / "scan.csv")
    assert len(recording) == 1171
    assert recording.position_m.shape == (1171, 3) and recording.position_m.dtype == np.float64
    assert recording.orientation_xyzw.shape == (1171, 4)
    assert recording.torque_Nm is None
    # The same memory each time, and nobody may write to what was measured.
    first, again = recording.position_m, recording.position_m
    assert first.__array_interface__["data"][0] == again.__array_interface__["data"][0]
    assert not first.flags.owndata
    with pytest.raises(ValueError):
        first[0, 0] = 1.0
    # h5py-like columns: the file's own numbers.
    table = np.genfromtxt(plane / "scan.csv", delimiter=",", names=True)
    assert np.array_equal(recording.time_s, table["t_s"])
    assert np.array_equal(recording.force_N[:, 2], table["fz_N"])


def test_an_array_outlives_its_recording(plane):
    force = ts.load_recording(plane / "scan.csv").force_N
    want = force.copy()
    gc.collect()
    junk = [np.full(1171 * 3, 7.0) for _ in range(50)]
    assert np.array_equal(force, want) and len(junk) == 50


@pytest.mark.parametrize("name", ["a.csv", "a.csv.gz", "a.h5"])
def test_what_is_written_is_read_back_to_the_bit(tmp_path, name):
    rng = np.random.default_rng(5)
    time = np.cumsum(rng.uniform(1e-4, 2e-3, 500))
    quaternions = rng.normal(size=(500, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1)[:, None]
    recording = ts.Recording(time, rng.normal(size=(500, 3)), rng.normal(size=(500, 3)), orientation_xyzw=quaternions,
                             torque_Nm=rng.normal(size=(500, 3)))
    recording.save(tmp_path / name)
    back = ts.load_recording(tmp_path / name)
    for what in ("time_s", "position_m", "force_N", "torque_Nm"):
        assert np.array_equal(getattr(back, what), getattr(recording, what)), what
    assert np.allclose(back.orientation_xyzw, quaternions, rtol=0, atol=4e-16)


def test_errors_are_those_of_the_program(tmp_path, program):
    path = tmp_path / "bad.csv"
    path.write_text("t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n0,0,0,0,0,0,0\n1,nan,0,0,0,0,0\n")
    said = program("convert", path, tmp_path / "out.h5", status=3).stderr
    with pytest.raises(ts.BadData) as error:
        ts.load_recording(path)
    assert said == f"touchstone: {error.value}\n"
    with pytest.raises(ts.UsageError, match=r"position_m has the shape \(5, 2\); \(N, 3\) was expected"):
        ts.Recording(np.arange(5.0), np.zeros((5, 2)), np.zeros((5, 3)))
    with pytest.raises(ts.UsageError, match="force_N has 4 samples, but time_s has 5"):
        ts.Recording(np.arange(5.0), np.zeros((5, 3)), np.zeros((4, 3)))
    with pytest.raises(ts.UsageError, match="names the vertex 9"):
        ts.Mesh(np.zeros((3, 3)), np.array([[0, 1, 9]], dtype=np.int32))


def test_meshes(tmp_path):
    mesh = ts.synthetic.mesh("sphere", triangles=2000, radius_m=0.03)
    mesh.save(tmp_path / "ball.ply")
    back = ts.load_mesh(tmp_path / "ball.ply")
    assert np.array_equal(back.vertices_m, mesh.vertices_m) and np.array_equal(back.triangles, mesh.triangles)
    mesh.save(tmp_path / "ball.obj", unit="mm")
    assert np.allclose(ts.load_mesh(tmp_path / "ball.obj", unit="mm").vertices_m, mesh.vertices_m, rtol=1e-14)
    closest = mesh.surface().closest([[0.05, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert closest["signed_distance_m"][0] == pytest.approx(0.02, abs=1e-4)
    assert closest["signed_distance_m"][1] < -0.029


def test_exact_answers_of_synthetic_surfaces():
    sphere = ts.synthetic.surface("sphere", radius_m=0.03)
    tips = np.array([[0.0, 0.0, 0.029], [0.04, 0.0, 0.0]])
    exact = sphere.exact_contact(tips, stiffness_N_per_m=1000)
    assert np.allclose(exact["force_N"], [[0, 0, 1.0], [0, 0, 0]], atol=1e-12)
    rendered = ts.replay(ts.model("god-object", stiffness_N_per_m=1000),
                         ts.synthetic.mesh("sphere", triangles=80000, radius_m=0.03),
                         ts.Trajectory([0.0, 0.001], [[0.0, 0.0, 0.04], [0.0, 0.0, 0.029]]))
    deviation = ts.synthetic.mesh_deviation_m("sphere", triangles=80000, radius_m=0.03)
    # The depths of two surfaces differ by no more than the surfaces do.
    assert abs(np.linalg.norm(rendered.force_N[1]) - np.linalg.norm(exact["force_N"][0])) <= 1000 * deviation * (1 + 1e-9)
    with pytest.raises(ts.UsageError, match="radius_mm"):
        ts.synthetic.surface("sphere", radius_mm=3)


def test_golden_cases_are_what_renderers_must_give():
    goldens = ts.goldens()
    assert len(goldens) > 40
    golden = goldens["plane-taps"]
    model = golden.models["god-object"]
    assert model.parameters == {"stiffness_N_per_m": 500.0}
    expected = golden.expected("god-object")
    assert np.array_equal(expected.position_m, golden.trajectory.position_m)
    assert ts.compare(expected, ts.replay(model, golden.mesh, golden.trajectory)).passed
    with pytest.raises(ts.UsageError, match="there is no model god; there are god-object, "):
        golden.expected("god")


def test_the_page_for_users_runs_as_written(tmp_path, monkeypatch, capsys):
    """docs/how-to/python.md, block by block, in an empty folder."""
    page = (SOURCE / "docs" / "how-to" / "python.md").read_text()
    blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert len(blocks) > 5
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "page"}
    for block in blocks:
        exec(compile(block, "python.md", "exec"), names)  # the page is ours
    assert names["golden"].passed
    assert "absent.csv" in capsys.readouterr().out
    assert names["exact"]["force_N"] == pytest.approx(np.array([[0, 0, 0.5]]))
    # Every function that its table names is there.
    for name in re.findall(r"^\| `(\w+)`", page, re.MULTILINE):
        assert hasattr(ts, name), name


def resident_kB():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE") // 1024


def test_a_thousand_replays_do_not_grow():
    mesh = ts.synthetic.mesh("sphere", triangles=2000)
    model = ts.model("god-object", stiffness_N_per_m=500)
    trajectory = ts.synthetic.trajectory("hand-scan", seed=3)
    for _ in range(200):
        ts.replay(model, mesh, trajectory)
    before = resident_kB()
    for _ in range(1000):
        ts.replay(model, mesh, trajectory)
    # One rendered trajectory alone is larger: a leak of any of its columns would show a thousandfold.
    assert resident_kB() - before < len(trajectory) * 8 * 10 // 1024 + 2048
