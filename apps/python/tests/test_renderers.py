import subprocess
import sys

import numpy as np
import pytest

import touchstone as ts
from conftest import SOURCE

EXAMPLE = SOURCE / "examples" / "python-renderer" / "god_object.py"


class Wall(ts.Renderer):
    """A half-space below z = 0."""

    name = "wall-in-python"
    parameters = [ts.Parameter("stiffness_N_per_m", "N/m", 1, 1e6, 500, "k of F = k dx")]

    def __init__(self, vertices_m, triangles, stiffness_N_per_m):
        self.stiffness = stiffness_N_per_m
        self.steps = 0

    def reset(self):
        self.steps = 0

    def step(self, tip):
        self.steps += 1
        depth = -tip.position_m[2]
        if depth <= 0:
            return ts.Step.free(tip)
        return ts.Step((0, 0, self.stiffness * depth), (*tip.position_m[:2], 0), (0, 0, 1), depth)


def presses():
    z = np.array([0.001, -0.001, -0.002, 0.001])
    return ts.Trajectory(np.arange(4) * 1e-3, np.column_stack([np.zeros(4), np.zeros(4), z]))


def test_a_class_is_replayed():
    rendered = ts.replay(Wall, ts.synthetic.mesh("plane"), presses(), time_steps=True)
    assert np.allclose(rendered.force_N[:, 2], [0, 0.5, 1.0, 0])
    assert rendered.contact.tolist() == [0, 1, 1, 0]
    assert (rendered.step_us > 0).all()
    stiff = ts.replay(ts.model("wall-in-python", stiffness_N_per_m=1000), ts.synthetic.mesh("plane"), presses())
    assert np.allclose(stiff.force_N[:, 2], [0, 1.0, 2.0, 0])


def test_an_exception_in_a_step_ends_the_run_with_its_place():
    class Broken(Wall):
        name = "broken-in-python"

        def step(self, tip):
            if self.steps == 2:
                raise ValueError("the third step")
            return super().step(tip)

    with pytest.raises(ts.RendererFailed, match=r"ValueError: the third step .*test_renderers.py, line \d+"):
        ts.replay(Broken, ts.synthetic.mesh("plane"), presses())
    with pytest.raises(TypeError, match="there is no ability thin_shell;"):
        ts.register(type("Odd", (Wall,), {"name": "odd", "cannot": {"thin_shell": "no"}}))


def test_a_class_goes_through_the_commands(plane, tmp_path):
    evaluation = ts.evaluate(recording=plane / "scan.csv", mesh=plane / "plane.obj", mesh_unit="mm",
                             model=ts.model(Wall), renderers=Wall, tip_radius="0mm", out=tmp_path / "e")
    plain = ts.evaluate(recording=plane / "scan.csv", mesh=plane / "plane.obj", mesh_unit="mm",
                        model=ts.model("spring-linear", stiffness_N_per_m=500), tip_radius="0mm", out=tmp_path / "s")
    # The plate is the half-space: two renderers of one law.
    assert evaluation.metrics["rms_force_error"] == pytest.approx(plain.metrics["rms_force_error"], rel=1e-6)
    check = ts.check("plane-taps", model="god-object", renderer="god-object-in-python", renderers=EXAMPLE,
                     out=tmp_path / "failures")
    assert check.passed, check.text
    # Python allocates in a step: the diagnosis says so by name.
    card = ts.scorecard(renderers=Wall, no_cases=True, no_cost=True, renderer="wall-in-python", out=tmp_path / "card")
    assert not card.passed and "energy" not in [one["name"] for one in card[0]["findings"]]


def suite(*words, file=EXAMPLE):
    done = subprocess.run([sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-v", "-rs",
                           "--touchstone", file, *words], text=True, capture_output=True)
    done.stdout = done.stdout.replace("::", ".")  # pytest's way of writing the dots of a name
    return done


#: Those that take seconds in Python; the night has them all.
CHOSEN = ("FlushTops or ForceIsThatOfTheTipNow or plane-taps or (ball and (NoForceInFreeSpace or StepAllocatesNothing or "
          "ForceStaysInTheFrictionCone))")


def test_the_god_object_in_python_passes_the_suite():
    done = suite("-k", CHOSEN)
    assert done.returncode == 0, done.stdout[-4000:]
    assert "god-object-in-python.conformance.NoForceInFreeSpace.ball PASSED" in done.stdout
    assert "god-object-in-python.golden.plane-taps PASSED" in done.stdout
    assert "StepAllocatesNothing.ball SKIPPED" in done.stdout
    assert "cost of a step in Python" in done.stdout


@pytest.mark.parametrize("fault, name", [
    ("self.last_answer, answer = answer, getattr(self, 'last_answer', answer)", "delay"),
    ("answer = answer._replace(force_N=tuple(1.01 * f for f in answer.force_N))", None),
    ("answer = answer._replace(force_N=tuple(-f for f in answer.force_N))", "ForceStaysInTheFrictionConeAndNeverPulls"),
])
def test_a_planted_fault_is_caught_by_name(tmp_path, fault, name):
    file = tmp_path / "faulty.py"
    file.write_text(EXAMPLE.read_text() + f"""

class Faulty(GodObject):
    name = "faulty-in-python"

    def step(self, tip):
        answer = super().step(tip)
        {fault}
        return answer

del GodObject
""")
    done = suite("-k", CHOSEN, file=file)
    assert done.returncode == 1, done.stdout[-4000:]
    if name is None:
        # One per cent too stiff is only seen against what is right.
        assert "faulty-in-python.golden.plane-taps FAILED" in done.stdout
    else:
        assert name in done.stdout
