"""pytest --touchstone my_renderer.py: the conformance suite and the golden cases on renderers written in Python.

The tests are those of `touchstone-conformance` and `touchstone check`, with their names and messages. One run of each
serves all of its tests that were chosen.
"""

import json
import os
import re
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Tuple, Type

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
    from ._programs import find_program

    place = find_program(name)
    if place is None:
        where = "libtouchstone-dev" if name == "touchstone-conformance" else "touchstone"
        raise pytest.UsageError(f"{name} was not found; it is in the Debian package {where}")
    return str(place)


def _plugin() -> str:
    from ._programs import PLUGIN

    return f"--plugin={PLUGIN}"


def _environment(file: Path) -> Dict[str, str]:
    return {**os.environ, renderers.FILE_VARIABLE: str(file)}


def _is_real_time(gtest: str) -> bool:
    return any(f".{name}/" in gtest for name in REAL_TIME)


def _subject(name: str) -> str:
    return "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in name)


class RendererFile(pytest.File):
    """One file: for each of its renderers the suite and the golden cases."""

    def collect(self) -> Iterator[pytest.Item]:
        self.runs: List[Any] = []
        for one in renderers.load_renderers(self.path):
            yield from self._conformance(one)
            if one.golden_like is not None:
                yield from self._golden(one)

    def _conformance(self, one: Type[renderers.Renderer]) -> Iterator[pytest.Item]:
        facts = [f"--{fact.replace('_', '-')}={value!r}" for fact, value in one.facts.items()]
        # Golden cases are tests of their own, below.
        suite = Suite(self.path, [_plugin(), "--no-cases", f"--renderer={one.name}", *facts])
        self.runs.append(suite)
        group = ""
        for line in suite.list().splitlines():
            if not line.startswith(" "):
                group = line.strip()
                continue
            full = group + line.split("#")[0].strip()
            test, _, shape = full.rpartition(".")[2].partition("/")
            # As ctest names them: <renderer>.conformance.<Test>.<shape>
            shape = shape.removeprefix(_subject(one.name)).strip("_")
            name = ".".join(part for part in (one.name, "conformance", test, shape) if part)
            yield SuiteTest.from_parent(self, name=name, run=suite, key=full)

    def _golden(self, one: Type[renderers.Renderer]) -> Iterator[pytest.Item]:
        from ._programs import bundled

        golden = GoldenCases(self.path, one)
        self.runs.append(golden)
        for case in sorted(bundled("golden").glob("*/case.json")):
            if one.golden_like in json.loads(case.read_text())["models"]:
                name = case.parent.name
                yield SuiteTest.from_parent(self, name=f"{one.name}.golden.{name}", run=golden, key=name)

    def teardown(self) -> None:
        for run in getattr(self, "runs", []):
            run.close()


class Outcome(NamedTuple):
    verdict: str  # passed, failed or skipped
    text: str  # what the program says of it


class Suite:
    """The conformance program on one renderer: one run for all tests that were chosen, read while it goes on."""

    _END = re.compile(r"\[ *(OK|FAILED|SKIPPED) *\] ([^\s,]+)")

    def __init__(self, file: Path, arguments: List[str]) -> None:
        self._file = file
        self._command = [_program("touchstone-conformance"), *arguments, "--gtest_color=no"]
        self._process: Optional["subprocess.Popen[str]"] = None
        self._outcomes: Dict[str, Outcome] = {}
        self._last = ""  # of a run that ended before its tests did

    def list(self) -> str:
        listed = subprocess.run([*self._command, "--gtest_list_tests"], env=_environment(self._file), text=True,
                                capture_output=True)
        if listed.returncode != 0:
            raise pytest.UsageError(listed.stderr.strip())
        return listed.stdout

    def outcome(self, key: str, chosen: List[str]) -> Outcome:
        if _is_real_time(key):
            return Outcome("skipped", "is about servo loops; Python allocates in a step, and its cost is reported at the end")
        if self._process is None:
            wanted = ":".join(one for one in chosen if not _is_real_time(one))
            self._process = subprocess.Popen([*self._command, f"--gtest_filter={wanted}"], env=_environment(self._file),
                                             text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        while key not in self._outcomes:
            if not self._read_one_test():
                return Outcome("failed", f"the suite ended before this test:\n{self._last}")
        return self._outcomes[key]

    def _read_one_test(self) -> bool:
        """The next test's outcome; False: there are no more."""
        assert self._process is not None and self._process.stdout is not None
        said: List[str] = []
        for line in self._process.stdout:
            end = self._END.match(line)
            if line.startswith("[ RUN "):
                said = []
            elif end is None:
                said.append(line)
            else:
                verdict = {"OK": "passed", "FAILED": "failed", "SKIPPED": "skipped"}[end[1]]
                self._outcomes.setdefault(end[2], Outcome(verdict, "".join(said)))
                return True
        self._last = self._last or "".join(said)
        return False

    def close(self) -> None:
        if self._process is not None:
            self._process.terminate()
            self._process.communicate()


class GoldenCases:
    """`touchstone check` on one renderer: one run for all cases that were chosen."""

    def __init__(self, file: Path, renderer: Type[renderers.Renderer]) -> None:
        self._file = file
        self._renderer = renderer
        self._outcomes: Optional[Dict[str, Outcome]] = None
        self._said = ""

    def outcome(self, key: str, chosen: List[str]) -> Outcome:
        if self._outcomes is None:
            self._outcomes = self._run(chosen)
        return self._outcomes.get(key, Outcome("failed", f"the check ended before this case:\n{self._said}"))

    def _run(self, cases: List[str]) -> Dict[str, Outcome]:
        from ._golden_results import read_junit
        from ._programs import bundled

        with tempfile.TemporaryDirectory(prefix="touchstone-") as folder:
            report = Path(folder) / "golden.xml"
            done = subprocess.run(
                [_program("touchstone"), "check", *cases, f"--model={self._renderer.golden_like}",
                 f"--renderer={self._renderer.name}", _plugin(), f"--golden={bundled('golden')}",
                 f"--plugin-source={self._file.parent}", f"--out={folder}/failures", f"--junit={report}"],
                env=_environment(self._file), text=True, capture_output=True)
            self._said = done.stdout + done.stderr
            tests = read_junit(report) if report.is_file() else []
        return {one["case"]: Outcome(one["state"], one["text"]) for one in tests}

    def close(self) -> None:
        pass


class Failed(Exception):
    """What a test of the suite says."""


class SuiteTest(pytest.Item):
    """One test of a run: its outcome is the program's."""

    def __init__(self, *, run: Any, key: str, **options: Any) -> None:
        super().__init__(**options)
        self._run = run
        self._key = key

    def runtest(self) -> None:
        chosen = [one._key for one in self.session.items if isinstance(one, SuiteTest) and one._run is self._run]
        outcome = self._run.outcome(self._key, chosen)
        if outcome.verdict == "failed":
            raise Failed(outcome.text)
        if outcome.verdict == "skipped":
            # GoogleTest puts the reason on a line of its own, below its place; pytest's summary shows one line.
            pytest.skip(" ".join(outcome.text.split()) or "declared")

    def repr_failure(self, excinfo: Any, style: Any = None) -> Any:
        return str(excinfo.value) if excinfo.errisinstance(Failed) else super().repr_failure(excinfo, style)

    def reportinfo(self) -> Tuple[Path, Optional[int], str]:
        return self.path, None, self.name


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    if not config.getoption("--touchstone"):
        return
    from ._models import measure_steps
    from ._touchstone import Error, Trajectory
    from .synthetic import mesh, trajectory

    radius_m = 0.03
    ball = mesh("sphere", triangles=2000, radius_m=radius_m)
    taps = trajectory("taps")
    above = Trajectory(taps.time_s, taps.position_m + [0.0, 0.0, radius_m])
    for one in renderers.registered():
        try:
            cost = measure_steps(one, ball, above)
        except Error as error:
            terminalreporter.write_line(f"{one.name}: the cost of a step could not be measured: {error}")
            continue
        terminalreporter.write_line(
            f"{one.name}: cost of a step in Python: median {cost['median_us']:.3g} us, 99th percentile {cost['p99_us']:.3g} us "
            f"({cost['steps']} steps of taps on a ball of {len(ball)} triangles)")
