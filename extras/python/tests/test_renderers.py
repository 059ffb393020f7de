import numpy as np
import pytest

import touchstone as ts
from conftest import SOURCE, run_suite

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


#: Those that take seconds in Python; suite_test.py has them all, every night.
CHOSEN = ("FlushTops or ForceIsThatOfTheTipNow or plane-taps or sphere-jumps or ForceTurns or (ball and "
          "(ResetGivesTheSameRun or NoForceInFreeSpace or StepAllocatesNothing or ForceStaysInTheFrictionCone or LargeJumps))")


def test_the_god_object_in_python_passes_the_suite():
    done = run_suite(EXAMPLE, "-k", CHOSEN)
    assert done.returncode == 0, done.stdout[-4000:]
    assert "god-object-in-python.conformance.NoForceInFreeSpace.ball PASSED" in done.stdout
    assert "god-object-in-python.golden.plane-taps PASSED" in done.stdout
    assert "StepAllocatesNothing.ball SKIPPED" in done.stdout
    assert "cost of a step in Python" in done.stdout


#: What is planted, and the tests that must say so; all others of CHOSEN pass.
FAULTS = {
    "delay": ("""
    def step(self, tip):
        answer, self.before = getattr(self, "before", None), super().step(tip)
        return answer or self.before
""", ["conformance.TheForceIsThatOfTheTipNow", "golden.plane-taps"]),
    "one-per-cent-too-stiff": ("""
    def step(self, tip):
        answer = super().step(tip)
        return answer._replace(force_N=tuple(1.01 * f for f in answer.force_N))
""", ["golden.plane-taps", "golden.sphere-jumps"]),
    "pulls": ("""
    def step(self, tip):
        answer = super().step(tip)
        return answer._replace(force_N=tuple(-f for f in answer.force_N))
""", ["conformance.ForceStaysInTheFrictionConeAndNeverPulls.ball"]),
    "turns-with-the-tip": ("""
    def step(self, tip):
        answer = super().step(tip)
        w, *v = tip.orientation_wxyz
        t = [2.0 * one for one in cross(v, answer.force_N)]
        u = cross(v, t)
        return answer._replace(force_N=tuple(f + w * a + b for f, a, b in zip(answer.force_N, t, u)))
""", ["conformance.TheForceTurnsWithTheWorldAndNotWithTheTip"]),
    "remembers": ("""
    def step(self, tip):
        self.steps = getattr(self, "steps", 0) + 1  # and reset() forgets it not
        answer = super().step(tip)
        return answer._replace(force_N=tuple((1.0 + 1e-6 * self.steps) * f for f in answer.force_N))
""", ["conformance.ResetGivesTheSameRunToTheBit.ball"]),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_caught_by_name(tmp_path, fault):
    code, names = FAULTS[fault]
    file = tmp_path / "faulty.py"
    file.write_text(EXAMPLE.read_text() + f"""

class Faulty(GodObject):
    name = "faulty-in-python"
{code}

del GodObject
""")
    done = run_suite(file, "-k", CHOSEN)
    assert done.returncode == 1, done.stdout[-4000:]
    for name in names:
        assert f"faulty-in-python.{name} FAILED" in done.stdout, done.stdout[-6000:]
    assert " PASSED" in done.stdout, "not everything is wrong with it"


def test_a_renderer_that_breaks_down_fails_by_name_with_the_place(tmp_path):
    file = tmp_path / "broken.py"
    file.write_text(EXAMPLE.read_text() + """

class Broken(GodObject):
    name = "broken-in-python"

    def step(self, tip):
        raise ValueError("out of order")

del GodObject
""")
    done = run_suite(file, "-k", "ForceIsThatOfTheTipNow or plane-taps")
    assert done.returncode == 1, done.stdout[-4000:]
    for name in ("conformance.TheForceIsThatOfTheTipNow", "golden.plane-taps"):
        assert f"broken-in-python.{name} FAILED" in done.stdout
    assert done.stdout.count("ValueError: out of order (") >= 2 and "broken.py, line " in done.stdout
    assert "broken-in-python: the cost of a step could not be measured" in done.stdout
