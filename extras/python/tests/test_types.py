"""The types that the package declares are those that it has: held by mypy and its stubtest."""

import ast
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import touchstone as ts
from touchstone import _shown, _touchstone  # _shown gives the classes their methods for notebooks

PACKAGE = Path(ts.__file__).parent


def tool(tmp_path, *words):
    environment = {**os.environ, "MYPYPATH": str(PACKAGE.parent)}
    return subprocess.run([sys.executable, "-m", *map(str, words)], cwd=tmp_path, env=environment, text=True,
                          capture_output=True)


@pytest.fixture(scope="module")
def settings(tmp_path_factory):
    path = tmp_path_factory.mktemp("mypy") / "mypy.ini"
    path.write_text("[mypy]\nstrict = True\ncache_dir = cache\n"
                    "[mypy-IPython.*,matplotlib.*]\nignore_missing_imports = True\nfollow_imports = skip\n")
    return path


def test_the_package_keeps_its_types(settings):
    done = tool(settings.parent, "mypy", "--config-file", settings, "-p", "touchstone")
    assert done.returncode == 0, done.stdout


def test_stubs_are_what_is_there(settings):
    allowed = settings.parent / "allowed.txt"
    allowed.write_text(
        # The module in C++: pybind11's classes have a metaclass of their own, and no __init__ if only the library makes them;
        # its submodule is written as a class; methods for notebooks come from _shown.py.
        "touchstone(\\._touchstone)?\\.(Mesh|Model|Recording|Rendered|Surface|Trajectory)(\\.__init__)?\n"
        "touchstone\\._touchstone\\._synthetic.*\n"
        # Modules in Python hold their types themselves.
        "touchstone\\.(_data|_golden_results|_models|_plots|_programs|_progress|_results|_run|_shown|_tables|_types"
        "|pytest_plugin|renderer|synthetic)\\..*\n")
    done = tool(settings.parent, "mypy.stubtest", "--mypy-config-file", settings, "--ignore-missing-stub", "--allowlist",
                allowed, "--ignore-unused-allowlist", "touchstone")
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("line, error", [
    ("ts.evaluate(recording='a.csv', mesh=ts.load_mesh('a.obj'), mesh_unit='mm', model=ts.model('god-object')).status", ""),
    ("ts.compare('a.h5', ts.load_recording('b.csv'), tolerance='t.json').verdict.upper()", ""),
    ("ts.perceive(real='a.csv', condition={'stiff': ts.load_recording('b.csv')}, out='p').plot()", ""),
    ("ts.check('plane-taps', model='god-object').tests[0]['state'].upper()", ""),
    ("ts.load_recording('a.csv').force_N.mean(axis=0)", ""),
    ("ts.synthetic.mesh('sphere', triangles=100, radius_m=0.03).surface().closest([[0, 0, 0]])['point_m'].sum()", ""),
    ("ts.evaluate(recordings='a.csv')", 'Unexpected keyword argument "recordings"'),
    ("ts.load_recording('a.csv').force", 'has no attribute "force"'),
    ("ts.replay(3, 'a.obj', 'b.csv')", "incompatible type"),
])
def test_a_type_checker_knows_calls(settings, line, error):
    script = settings.parent / "script.py"
    script.write_text(f"import touchstone as ts\n\n{line}\n")
    done = tool(settings.parent, "mypy", "--config-file", settings, script)
    assert (done.returncode == 0) == (not error), done.stdout
    assert error in done.stdout


def declared():
    """Functions and methods of _touchstone.pyi: name, argument names, defaults."""
    tree = ast.parse((PACKAGE / "_touchstone.pyi").read_text())
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            yield node.name, node
        elif isinstance(node, ast.ClassDef) and node.name not in ("_synthetic",):
            for one in node.body:
                if isinstance(one, ast.FunctionDef):
                    yield f"{node.name}.{one.name}", one


def test_arguments_of_the_module_in_cpp_are_as_declared():
    """A function of pybind11 says its arguments in the first line of its docstring alone."""
    assert _shown
    checked = 0
    for name, node in declared():
        thing = _touchstone
        for part in name.split("."):
            thing = getattr(thing, part)
        if isinstance(thing, property) or inspect.isfunction(thing) or not (thing.__doc__ or "").startswith(
                name.split(".")[-1] + "("):
            continue
        said = re.match(r"\w+\((.*)\) ->", thing.__doc__.split("\n")[0])[1]
        names = [one for one in re.findall(r"(\w+): ", said) if one != "self"]
        given = [one.arg for one in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs) if one.arg != "self"]
        if not any(one.startswith("arg") for one in names):
            assert names == given, name
            checked += 1
        defaults = dict(re.findall(r"(\w+): [^=,]* = ('[^']*'|[\w.]+)", said))
        kwonly = {one.arg: ast.unparse(default) for one, default in zip(node.args.kwonlyargs, node.args.kw_defaults) if default}
        for argument, default in kwonly.items():
            assert defaults[argument] == default, f"{name}({argument})"
    assert checked > 15


def test_every_public_thing_says_what_it_is():
    undocumented = []
    for name in ts.__all__:
        thing = getattr(ts, name)
        if not callable(thing):
            continue
        if not (inspect.getdoc(thing) or "").strip():
            undocumented.append(name)
        for member, value in vars(thing).items() if inspect.isclass(thing) and thing.__module__.startswith("touchstone") else ():
            if not member.startswith("_") and (callable(value) or isinstance(value, property)) and not inspect.getdoc(value):
                undocumented.append(f"{name}.{member}")
    assert undocumented == []
