"""How results look: tables for notebooks and matplotlib figures. Nothing is computed here that a file of the program
does not say, but for differences of two plotted lines."""

import html
from typing import Any, Mapping, Sequence

import numpy as np

escape = html.escape
_AXES = ("x", "y", "z")


def _number(value: Any) -> str:
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


def table_html(head: Sequence[str], rows: Sequence[Sequence[Any]], caption: str = "") -> str:
    """A table; texts are escaped, numbers have four digits."""
    lines = ["<table>"]
    if caption:
        lines.append(f"<caption>{escape(caption)}</caption>")
    lines.append("<thead><tr>" + "".join(f"<th>{escape(cell)}</th>" for cell in head) + "</tr></thead><tbody>")
    for row in rows:
        lines.append("<tr>" + "".join(f"<td>{escape(_number(cell))}</td>" for cell in row) + "</tr>")
    return "\n".join([*lines, "</tbody></table>"])


def _figure(rows: int = 1, columns: int = 1, **options: Any) -> Any:
    import matplotlib.pyplot as plt

    options.setdefault("figsize", (9, 2.6 * rows))
    return plt.subplots(rows, columns, squeeze=False, constrained_layout=True, **options)


def recording_html(self: Any) -> str:
    time = self.time_s
    force = np.linalg.norm(self.force_N, axis=1)
    low, high = self.position_m.min(axis=0), self.position_m.max(axis=0)
    rows = [
        ["samples", f"{len(self)}"],
        ["time", f"{time[0]:.4g} s to {time[-1]:.4g} s, median interval {np.median(np.diff(time)) * 1e3:.4g} ms"],
        ["largest force", f"{force.max():.4g} N"],
        ["tip", ", ".join(f"{a} {l * 1e3:.4g} to {h * 1e3:.4g} mm" for a, l, h in zip(_AXES, low, high))],
    ]
    rows += [["note", note] for note in self.notes]
    return table_html([type(self).__name__, getattr(self, "source", "")], rows)


def plot_recording(self: Any, **options: Any) -> Any:
    """Position and force over time. Returns matplotlib's figure."""
    figure, axes = _figure(2, sharex=True, **options)
    for axis in range(3):
        axes[0, 0].plot(self.time_s, self.position_m[:, axis] * 1e3, label=_AXES[axis], linewidth=1)
        axes[1, 0].plot(self.time_s, self.force_N[:, axis], label=_AXES[axis], linewidth=1)
    axes[0, 0].set_ylabel("tip [mm]")
    axes[1, 0].set_ylabel("force on the probe [N]")
    axes[1, 0].set_xlabel("time [s]")
    axes[0, 0].legend(loc="upper right", ncols=3)
    return figure


def _headline(data: Mapping[str, Any]) -> list:
    return [m for m in data["metrics"] if m["status"] == "ok" and not m["name"][-2:] in ("_x", "_y", "_z")]


def evaluation_html(data: Mapping[str, Any]) -> str:
    rows = [[m["name"], m["value"], m["unit"], m.get("reference"), m["meaning"]] for m in _headline(data)]
    notes = "".join(f"<p>{escape(message)}</p>" for message in data["messages"])
    return table_html(["metric", "value", "unit", "of", "meaning"], rows, data["title"]) + notes


def evaluations_html(all_data: Sequence[Mapping[str, Any]]) -> str:
    names = ["rms_force_error", "max_force_error", "rms_position_error", "mean_operations"]
    head = ["renderer", *names]
    rows = []
    for data in all_data:
        values = {m["name"]: m for m in data["metrics"]}
        cells = [values.get(name) for name in names]
        rows.append([data["title"], *("" if c is None or c["value"] is None else f"{c['value']:.4g} {c['unit']}".replace(" 1", "") for c in cells)])
    return table_html(head, rows)


def _signal(data: Mapping[str, Any], name: str) -> Any:
    for one in data["signals"]:
        if one["name"] == name:
            return np.array(one["t_s"], float), np.array(one["value"], float)
    return None


def plot_evaluation(data: Mapping[str, Any], **options: Any) -> Any:
    figure, axes = _figure(3, sharex=True, **options)
    for axis, name in enumerate(_AXES):
        for kind, colour in (("measured", "0.2"), ("rendered", "tab:orange")):
            signal = _signal(data, f"{kind}_{name}")
            if signal is not None:
                axes[axis, 0].plot(*signal, color=colour, label=kind, linewidth=1)
        axes[axis, 0].set_ylabel(f"$f_{name}$ [N]")
    axes[0, 0].legend(loc="upper right", ncols=2)
    axes[0, 0].set_title(data["title"])
    axes[2, 0].set_xlabel("time [s]")
    return figure


def plot_metric(all_data: Sequence[Mapping[str, Any]], metric: str, **options: Any) -> Any:
    figure, axes = _figure(1, figsize=options.pop("figsize", (8, 0.4 * len(all_data) + 1)), **options)
    names, values, unit = [], [], ""
    for data in all_data:
        for one in data["metrics"]:
            if one["name"] == metric and one["value"] is not None:
                names.append(data["title"])
                values.append(one["value"])
                unit = one["unit"]
    axes[0, 0].barh(names[::-1], values[::-1])
    axes[0, 0].set_xlabel(f"{metric.replace('_', ' ')} [{unit}]")
    return figure


def fit_html(data: Mapping[str, Any]) -> str:
    rows = []
    for one in data["parameters"]:
        interval = one["interval95"]
        rows.append([one["name"], one["initial"], one["value"], one["unit"],
                     "" if interval is None else f"{interval[0]:.4g} to {interval[1]:.4g}"])
    caption = f"{data['metric']['name']}: {_number(data['score']['before'])} to {_number(data['score']['after'])} {data['metric']['unit']}"
    return table_html(["parameter", "given", "fitted", "unit", "95 % interval"], rows, caption)


def plot_fit(data: Mapping[str, Any], **options: Any) -> Any:
    fitted = data["parameters"]
    figure, axes = _figure(1, len(fitted), figsize=options.pop("figsize", (4.5 * len(fitted), 3)), **options)
    for place, one in zip(axes[0], fitted):
        place.plot(one["profile"]["value"], one["profile"]["metric"], marker=".", linewidth=1)
        place.axvline(one["value"], color="tab:orange")
        place.set_xlabel(f"{one['name']} [{one['unit']}]")
        place.set_ylabel(f"{data['metric']['name'].replace('_', ' ')} [{data['metric']['unit']}]")
    return figure


def findings_html(data: Mapping[str, Any]) -> str:
    gap = data["gap"]
    rows = [["verdict", data["verdict"]]]
    for effect in data["effects"]:
        values = ", ".join(f"{one['name']} = {_number(one['value'])} {one['unit']}" for one in effect["parameters"])
        rows.append([f"{effect['side']} effect", f"{effect['name']}: {values}"])
    rows += [[f"gap on {which} [{gap['unit']}]", f"{_number(gap[which]['before'])} before, {_number(gap[which]['after'])} after"]
             for which in ("train", "holdout")]
    rows.append([f"noise floor [{gap['unit']}]", gap["noise_floor"]])
    return table_html(["", "finding"], rows)


def plot_findings(data: Mapping[str, Any], **options: Any) -> Any:
    where = [one for one in data.get("where", []) if one["before"] is not None]
    height = 0.35 * len(where) + 1.2
    figure, axes = _figure(1, figsize=options.pop("figsize", (8, height)), **options)
    names = [one["regime"] for one in where][::-1]
    place = np.arange(len(where))
    axes[0, 0].barh(place + 0.2, [one["before"] for one in where][::-1], 0.4, label="before", color="0.6")
    axes[0, 0].barh(place - 0.2, [one["after"] or 0.0 for one in where][::-1], 0.4, label="after", color="tab:orange")
    axes[0, 0].set_yticks(place, names)
    axes[0, 0].axvline(data["gap"]["noise_floor"], color="k", linestyle=":", label="noise floor")
    axes[0, 0].set_xlabel("RMS force error [N]")
    axes[0, 0].legend()
    return figure


def board_html(data: Mapping[str, Any]) -> str:
    parts = []
    for task in data["tasks"]:
        if "ranking" not in task:
            continue
        rows = [[f"{one['rank'][0]}-{one['rank'][1]}", one["renderer"], one["score_N"],
                 f"{one['interval95_N'][0]:.4g} to {one['interval95_N'][1]:.4g}"] for one in task["ranking"]["order"]]
        parts.append(table_html(["rank", "renderer", "RMS force error [N]", "95 % interval"], rows, task["name"]))
    return "\n".join(parts)


def plot_board(data: Mapping[str, Any], **options: Any) -> Any:
    tasks = [task for task in data["tasks"] if task.get("ranking", {}).get("order")]
    size = options.pop("figsize", (8, sum(0.3 * len(t["ranking"]["order"]) + 1 for t in tasks)))
    figure, axes = _figure(len(tasks), figsize=size, **options)
    for place, task in zip(axes[:, 0], tasks):
        order = task["ranking"]["order"][::-1]
        score = np.array([one["score_N"] for one in order], float)
        low, high = (np.array([one["interval95_N"][i] for one in order], float) for i in (0, 1))
        place.errorbar(score, [one["renderer"] for one in order], xerr=[score - low, high - score], fmt="o", capsize=3)
        place.set_title(task["name"], fontsize="medium")
        place.set_xlabel("RMS force error [N], 95 % interval")
    return figure


_FAULTS = ("sticks", "pops_through", "loses_contact", "pulls_inward")


def _faults(case: Mapping[str, Any]) -> list:
    return [name.replace("_", " ") for name in _FAULTS if case.get(name)]


def atlas_html(data: Mapping[str, Any]) -> str:
    rows: dict = {}
    for case in data["cases"]:
        row = rows.setdefault((case["scene"], case["renderer"]), [0, 0])
        row[0] += 1
        row[1] += not _faults(case)
    return table_html(["scene", "renderer", "cases", "clean"], [[*key, *row] for key, row in rows.items()])


def plot_atlas(data: Mapping[str, Any], scene: str = "bump", mu: Any = None, **options: Any) -> Any:
    sharpness = {"bump": "side_angle_rad", "shell": "thickness_m"}[scene]
    cases = [one for one in data["cases"] if one["scene"] == scene]
    mus = sorted({one["mu"] for one in cases})
    mu = mus[0] if mu is None and mus else mu
    cases = [one for one in cases if one["mu"] == mu]
    renderers = list(dict.fromkeys(one["renderer"] for one in cases))
    xs, ys = (sorted({one[key] for one in cases}) for key in (sharpness, "stiffness_N_per_m"))
    figure, axes = _figure(1, len(renderers), figsize=options.pop("figsize", (2.6 * len(renderers) + 1, 3)), sharey=True, **options)
    for place, name in zip(axes[0], renderers):
        grid = np.full((len(ys), len(xs)), np.nan)
        for one in cases:
            if one["renderer"] == name:
                grid[ys.index(one["stiffness_N_per_m"]), xs.index(one[sharpness])] = len(_faults(one))
        shown = place.imshow(grid, origin="lower", aspect="auto", vmin=0, vmax=len(_FAULTS), cmap="OrRd")
        place.set_xticks(range(len(xs)), [f"{x:.3g}" for x in xs], rotation=90)
        place.set_yticks(range(len(ys)), [f"{y:.4g}" for y in ys])
        place.set_title(name, fontsize="medium")
        place.set_xlabel(sharpness.replace("_", " "))
    axes[0, 0].set_ylabel("stiffness [N/m]")
    figure.colorbar(shown, ax=axes[0].tolist(), label="kinds of fault")
    figure.suptitle(f"{scene}, friction coefficient {mu:g}")
    return figure


def scorecard_html(cards: Sequence[Mapping[str, Any]]) -> str:
    rows = []
    for card in cards:
        found = card.get("findings", [])
        rows += [[card["engine"]["name"], one["name"], one["what"]] for one in found]
        if not found:
            rows.append([card["engine"]["name"], "nothing found", ""])
    return table_html(["renderer", "fault", "what"], rows)


