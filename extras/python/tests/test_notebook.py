"""In a kernel of Jupyter, as a notebook has it: progress is drawn, and interrupting stops the work and not the kernel."""

import os
import time

import pytest

jupyter_client = pytest.importorskip("jupyter_client")

#: A replay of ten million steps: minutes if nothing stops it.
LONG = """
import numpy as np, touchstone as ts
count = {count}
mesh = ts.synthetic.mesh("sphere", triangles=20000)
ts.Trajectory(np.arange(count) * 1e-3, np.zeros((count, 3)) + [0, 0, 0.0299]).save({path!r})
mesh.save({path!r}.replace(".h5", ".ply"))
"""
WORK = """
ts.run("replay", model=ts.model("god-object", stiffness_N_per_m=500), mesh=mesh, trajectory={path!r},
       out={path!r}.replace("long", "out"))
"""
IN_MEMORY = """
ts.replay(ts.model("god-object", stiffness_N_per_m=500), mesh, ts.load_trajectory({path!r}))
"""


@pytest.fixture(scope="module")
def kernel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("jupyter")
    environment = {**os.environ, "IPYTHONDIR": str(folder / "ipython"), "JUPYTER_CONFIG_DIR": str(folder / "config"),
                   "JUPYTER_DATA_DIR": str(folder / "data"), "JUPYTER_RUNTIME_DIR": str(folder / "runtime")}
    manager, client = jupyter_client.manager.start_new_kernel(kernel_name="python3", env=environment)
    yield manager, client
    client.stop_channels()
    manager.shutdown_kernel(now=True)


def outputs_until_idle(client, call, seconds=120):
    """The outputs of one cell, in order."""
    outputs = []
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        message = client.get_iopub_msg(timeout=seconds)
        if message["parent_header"].get("msg_id") != call:
            continue
        if message["msg_type"] == "status" and message["content"]["execution_state"] == "idle":
            while client.get_shell_msg(timeout=seconds)["parent_header"].get("msg_id") != call:
                pass
            return outputs
        outputs.append((message["msg_type"], message["content"]))
    raise TimeoutError


def test_a_notebook_shows_progress(kernel, tmp_path):
    _, client = kernel
    path = str(tmp_path / "long.h5")
    outputs_until_idle(client, client.execute(LONG.format(count=1_000_000, path=path)))
    outputs = outputs_until_idle(client, client.execute(WORK.format(path=path)))
    assert not [content for kind, content in outputs if kind == "error"]
    shown = [content["data"]["text/html"] for kind, content in outputs if kind == "display_data"]
    drawn_anew = [content["data"]["text/html"] for kind, content in outputs if kind == "update_display_data"]
    assert len(shown) == 1 and "replay long.h5" in shown[0]
    assert drawn_anew, "one line, drawn anew"


@pytest.mark.parametrize("work", [WORK, IN_MEMORY], ids=["command", "in-memory"])
def test_interrupting_stops_the_work_and_not_the_kernel(kernel, tmp_path, work):
    manager, client = kernel
    path = str(tmp_path / "long.h5")
    outputs_until_idle(client, client.execute(LONG.format(count=10_000_000, path=path)))
    call = client.execute(work.format(path=path))
    time.sleep(2.0)
    began = time.monotonic()
    manager.interrupt_kernel()
    outputs = outputs_until_idle(client, call)
    took = time.monotonic() - began
    errors = [content["ename"] for kind, content in outputs if kind == "error"]
    assert errors == ["KeyboardInterrupt"]
    assert took < 60, "it ran to its end"
    time.sleep(0.5)  # after an error a kernel drops, for a moment, cells that were sent before anyone saw it
    after = outputs_until_idle(client, client.execute("1 + 1"))
    assert [content["data"]["text/plain"] for kind, content in after if kind == "execute_result"] == ["2"]
    # What was not finished is not there.
    assert not [name for name in os.listdir(tmp_path) if name.startswith("out")]


def test_the_lock_of_the_interpreter_is_free(kernel):
    """Another thread counts while a surface of many triangles is made."""
    _, client = kernel
    outputs = outputs_until_idle(client, client.execute("""
import threading, time
counts, stop = [0], threading.Event()
def counting():
    while not stop.is_set():
        counts[0] += 1
        time.sleep(0.0005)
thread = threading.Thread(target=counting)
thread.start()
big = ts.synthetic.mesh("sphere", triangles=200000)
before = counts[0]
big.surface()
during = counts[0] - before
stop.set()
thread.join()
during > 3
"""))
    assert [content["data"]["text/plain"] for kind, content in outputs if kind == "execute_result"] == ["True"]
