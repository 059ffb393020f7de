"""pytest --touchstone my_renderer.py: the conformance suite and the golden cases on renderers written in Python.

The tests are those of `touchstone-conformance` and `touchstone check`, with their names and messages. One run of the
suite serves all of its tests that were chosen; a golden case is a run of its own.
"""

import json
import os
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Iterator

import pytest

from . import renderer as renderers


#: Tests that are about a servo loop. Python allocates in a step and takes its own lock; what a step costs is reported at
#: the end instead.
REAL_TIME = ("NoStepAllocates", "StepAllocatesNothing", "NoStepOfAMillionIsASpike")


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("touchstone")
    group.addoption("--touchstone", metavar="FILE", action="append", default=[],
                    help="Python file with touchstone.Renderer classes: run the conformance suite and golden cases on them")


def pytest_configure(config: pytest.Config) -> None:
    files = [str(Path(file).resolve()) for file in config.getoption("--touchstone")]
    for file in files:
        if not Path(file).is_file():
            raise pytest.UsageError(f"--touchstone {file}: there is no such file")
    if files:
        # Without other arguments pytest would collect the whole folder, too.
        given = config.args if config.args_source is pytest.Config.ArgsSource.ARGS else []
        config.args = [*files, *given]


def pytest_collect_file(file_path: Path, parent: Any) -> Any:
    files = [str(Path(file).resolve()) for file in parent.config.getoption("--touchstone")]
    return RendererFile.from_parent(parent, path=file_path) if str(file_path) in files else None


def _program(name: str) -> str:
    from . import _api

    place = _api._find_program(name)
    if place is None:
        where = "libtouchstone-dev" if name == "touchstone-conformance" else "touchstone"
        raise pytest.UsageError(f"{name} was not found; it is in the Debian package {where}")
    return str(place)


def _environment(file: Path) -> dict:
    return {**os.environ, renderers.FILE_VARIABLE: str(file)}


class RendererFile(pytest.File):
    """One file: for each of its renderers the suite and the golden cases."""

    def collect(self) -> Iterator[pytest.Item]:
        from . import _api

        for one in renderers.load_renderers(self.path):
            arguments = [f"--plugin={_api.PLUGIN}", f"--renderer={one.name}"]
            arguments += [f"--{fact.replace('_', '-')}={value!r}" for fact, value in one.facts.items()]
            suite = Suite(self.path, arguments)
            listed = suite.run(["--gtest_list_tests"])
            if listed.returncode != 0:
                raise pytest.UsageError(listed.stderr.strip())
            group = ""
            for line in listed.stdout.splitlines():
                if not line.startswith(" "):
                    group = line.strip()
                    continue
                full = group + line.split("#")[0].strip()
                test, _, shape = full.rpartition(".")[2].partition("/")
                # As ctest names them: <renderer>.conformance.<Test>.<shape>
                shape = shape.removeprefix(_subject(one.name)).strip("_")
                name = ".".join(part for part in (one.name, "conformance", test, shape) if part)
                item = ConformanceTest.from_parent(self, name=name, suite=suite, gtest=full)
                suite.tests.append(item)
                yield item
            if one.golden_like is not None:
                for case in sorted(_api.bundled("golden").glob("*/case.json")):
                    if one.golden_like in json.loads(case.read_text())["models"]:
                        yield GoldenTest.from_parent(self, name=f"{one.name}.golden.{case.parent.name}", renderer=one,
                                                     case=case.parent.name)


def _is_real_time(gtest: str) -> bool:
    return any(f".{name}/" in gtest for name in REAL_TIME)


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    if not config.getoption("--touchstone"):
        return
    from . import _api

    radius_m = 0.03
    ball = _api.synthetic.mesh("sphere", triangles=2000, radius_m=radius_m)
    taps = _api.synthetic.trajectory("taps")
    above = _api.Trajectory(taps.time_s, taps.position_m + [0.0, 0.0, radius_m])
    for one in renderers._registered:
        cost = _api.measure_steps(one, ball, above)
        terminalreporter.write_line(
            f"{one.name}: cost of a step in Python: median {cost['median_us']:.3g} us, 99th percentile {cost['p99_us']:.3g} us "
            f"({cost['steps']} steps of taps on a ball of {len(ball)} triangles)")


def _subject(name: str) -> str:
    return "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in name)


class Suite:
    """The conformance program on one renderer, run once for all tests that were chosen."""

    def __init__(self, file: Path, arguments: list) -> None:
        self._file = file
        self._command = [_program("touchstone-conformance"), *arguments]
        self.tests: list = []
        self._outcomes: Any = None

    def run(self, words: list) -> subprocess.CompletedProcess:
        return subprocess.run([*self._command, *words], env=_environment(self._file), text=True, capture_output=True)

    def outcome(self, gtest: str, chosen: list) -> dict:
        if self._outcomes is None:
            with tempfile.TemporaryDirectory(prefix="touchstone-") as folder:
                report = Path(folder) / "report.json"
                done = self.run([f"--gtest_output=json:{report}", "--gtest_filter=" + ":".join(chosen)])
                self._outcomes = {}
                if report.is_file():
                    for group in json.loads(report.read_text())["testsuites"]:
                        for test in group["testsuite"]:
                            self._outcomes[f"{group['name']}.{test['name']}"] = test
                self._broke = done.stdout[-2000:] + done.stderr[-2000:]
        if gtest not in self._outcomes:
            return {"failures": [{"failure": f"the suite broke down:\n{self._broke}"}]}
        return self._outcomes[gtest]


class Failed(Exception):
    """What a test of the suite says."""


class ConformanceTest(pytest.Item):
    def __init__(self, *, suite: Suite, gtest: str, **options: Any) -> None:
        super().__init__(**options)
        self._suite = suite
        self._gtest = gtest

    def runtest(self) -> None:
        if _is_real_time(self._gtest):
            pytest.skip("is about servo loops; Python allocates in a step, and its cost is reported at the end")
        chosen = [item._gtest for item in self.session.items
                  if isinstance(item, ConformanceTest) and item._suite is self._suite and not _is_real_time(item._gtest)]
        outcome = self._suite.outcome(self._gtest, chosen)
        if outcome.get("failures"):
            raise Failed("\n".join(one["failure"] for one in outcome["failures"]))
        if outcome.get("result") == "SKIPPED":
            pytest.skip("\n".join(one.get("message", "") for one in outcome.get("skipped", [])).strip() or "declared")

    def repr_failure(self, excinfo: Any, style: Any = None) -> Any:
        return str(excinfo.value) if excinfo.errisinstance(Failed) else super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple:
        return self.path, None, self.name


class GoldenTest(ConformanceTest):
    def __init__(self, *, renderer: type, case: str, **options: Any) -> None:
        super().__init__(suite=None, gtest="", **options)
        self._renderer = renderer
        self._case = case

    def runtest(self) -> None:
        from . import _api

        with tempfile.TemporaryDirectory(prefix="touchstone-") as folder:
            done = subprocess.run(
                [_program("touchstone"), "check", self._case, f"--model={self._renderer.golden_like}",
                 f"--renderer={self._renderer.name}", f"--plugin={_api.PLUGIN}", f"--golden={_api.bundled('golden')}",
                 f"--plugin-source={self.path.parent}", f"--out={folder}"],
                env=_environment(self.path), text=True, capture_output=True)
        if done.returncode == 77:
            pytest.skip(done.stdout.strip())
        if done.returncode != 0:
            raise Failed(done.stdout + done.stderr)
