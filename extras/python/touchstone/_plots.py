"""Matplotlib figures of results. Nothing is computed here that a file of the program does not say. Every function returns
matplotlib's figure and gives further arguments to `matplotlib.pyplot.subplots`."""

import textwrap
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from ._tables import number

_AXES = ("x", "y", "z")
_MEASURED, _RENDERED = "0.2", "tab:orange"


def _figure(rows: int = 1, columns: int = 1, **options: Any) -> Tuple[Any, Any]:
    import matplotlib.pyplot as plt

    options.setdefault("figsize", (9, 2.6 * rows))
    figure, axes = plt.subplots(rows, columns, squeeze=False, constrained_layout=True, **options)
    return figure, axes


def recording(data: Any, **options: Any) -> Any:
    """Position and force over time."""
    figure, axes = _figure(2, sharex=True, **options)
    for axis in range(3):
        axes[0, 0].plot(data.time_s, data.position_m[:, axis] * 1e3, label=_AXES[axis], linewidth=1)
        axes[1, 0].plot(data.time_s, data.force_N[:, axis], label=_AXES[axis], linewidth=1)
    axes[0, 0].set_ylabel("tip [mm]")
    axes[1, 0].set_ylabel("force on the probe [N]")
    axes[1, 0].set_xlabel("time [s]")
    axes[0, 0].legend(loc="upper right", ncols=3)
    return figure


def trajectory(data: Any, **options: Any) -> Any:
    """Position over time."""
    figure, axes = _figure(1, **options)
    for axis in range(3):
        axes[0, 0].plot(data.time_s, data.position_m[:, axis] * 1e3, label=_AXES[axis], linewidth=1)
    axes[0, 0].set_ylabel("tip [mm]")
    axes[0, 0].set_xlabel("time [s]")
    axes[0, 0].legend(loc="upper right", ncols=3)
    return figure


def _signal(data: Mapping[str, Any], name: str) -> Optional[Tuple[Any, Any]]:
    for one in data["signals"]:
        if one["name"] == name:
            return np.array(one["t_s"], float), np.array(one["value"], float)
    return None


def evaluation(data: Mapping[str, Any], **options: Any) -> Any:
    """Measured and rendered force over time, axis by axis."""
    figure, axes = _figure(3, sharex=True, **options)
    for axis, name in enumerate(_AXES):
        for kind, colour in (("measured", _MEASURED), ("rendered", _RENDERED)):
            signal = _signal(data, f"{kind}_{name}")
            if signal is not None:
                axes[axis, 0].plot(*signal, color=colour, label=kind, linewidth=1)
        axes[axis, 0].set_ylabel(f"$f_{name}$ [N]")
    axes[0, 0].legend(loc="upper right", ncols=2)
    axes[0, 0].set_title(data["title"])
    axes[2, 0].set_xlabel("time [s]")
    return figure


def metric(entries: Sequence[Mapping[str, Any]], name: str, **options: Any) -> Any:
    """One metric of several evaluations, one picture per group; those without a value are named in its title."""
    groups: Dict[str, List[Tuple[str, float]]] = {}
    missing: Dict[str, List[str]] = {}
    unit = ""
    for entry in entries:
        one = next((one for one in entry.get("metrics", []) if one["name"] == name), None)
        if one is None or one["value"] is None:
            missing.setdefault(entry["group"], []).append(entry["name"])
        else:
            groups.setdefault(entry["group"], []).append((entry["name"], one["value"]))
            unit = one["unit"]
    if not groups:
        raise ValueError(f"no evaluation has a value of the metric {name}")
    sizes = [0.25 * len(rows) + 1.2 for rows in groups.values()]
    options.setdefault("figsize", (8, sum(sizes)))
    figure, axes = _figure(len(groups), sharex=True, gridspec_kw={"height_ratios": sizes}, **options)
    for axis, (group, rows) in zip(axes[:, 0], groups.items()):
        place = np.arange(len(rows))[::-1]
        axis.barh(place, [value for _, value in rows])
        axis.set_yticks(place, [renderer for renderer, _ in rows])
        without = missing.get(group, [])
        axis.set_title(textwrap.fill(group + (f" (no value: {', '.join(without)})" if without else ""), 90), fontsize="medium")
    axes[-1, 0].set_xlabel(name.replace("_", " ") + ("" if unit == "1" else f" [{unit}]"))
    return figure


def fit(data: Mapping[str, Any], **options: Any) -> Any:
    """The metric over each fitted parameter; the fitted value is the vertical line."""
    fitted = data["parameters"]
    options.setdefault("figsize", (4.5 * len(fitted), 3))
    figure, axes = _figure(1, len(fitted), **options)
    for place, one in zip(axes[0], fitted):
        place.plot(one["profile"]["value"], one["profile"]["metric"], marker=".", linewidth=1)
        place.axvline(one["value"], color=_RENDERED)
        place.set_xlabel(one["name"])  # with its unit
        place.set_ylabel(f"{data['metric']['name'].replace('_', ' ')} [{data['metric']['unit']}]")
    return figure


def findings(data: Mapping[str, Any], **options: Any) -> Any:
    """The force error before and after the effects that were found, in parts of the motion."""
    where = [one for one in data.get("where", []) if one["before"] is not None]
    options.setdefault("figsize", (8, 0.35 * len(where) + 1.4))
    figure, axes = _figure(1, **options)
    place = np.arange(len(where))[::-1]
    after = [np.nan if one["after"] is None else one["after"] for one in where]
    axes[0, 0].barh(place + 0.2, [one["before"] for one in where], 0.4, label="before", color="0.6")
    axes[0, 0].barh(place - 0.2, after, 0.4, label="after", color=_RENDERED)
    axes[0, 0].set_yticks(place, [one["regime"] for one in where])
    if data["gap"]["noise_floor"] is not None:
        axes[0, 0].axvline(data["gap"]["noise_floor"], color="k", linestyle=":", label="noise floor")
    axes[0, 0].set_xlabel("RMS force error [N]")
    axes[0, 0].set_title(f"verdict: {data['verdict']}", fontsize="medium")
    axes[0, 0].legend()
    return figure


def perception(data: Mapping[str, Any], **options: Any) -> Any:
    """How far each condition is from the real process, channel by channel, in just noticeable differences."""
    conditions = data["conditions"]
    names = list(dict.fromkeys(one["name"] for condition in conditions for one in condition["channels"]))
    options.setdefault("figsize", (8, 0.25 * len(names) * len(conditions) + 1.4))
    figure, axes = _figure(1, **options)
    height = 0.8 / max(1, len(conditions))
    place = np.arange(len(names))[::-1]
    for index, condition in enumerate(conditions):
        by_name = {one["name"]: one for one in condition["channels"]}
        found = [by_name.get(name, {}) for name in names]
        axes[0, 0].barh(place + 0.4 - (index + 0.5) * height, [one.get("jnd", np.nan) for one in found], height,
                        xerr=[one.get("standard_error_jnd", np.nan) for one in found],
                        label=f"{condition['name']}: {condition['verdict']}")
    axes[0, 0].axvline(1.0, color="k", linestyle=":")
    axes[0, 0].set_yticks(place, names)
    axes[0, 0].set_xlabel("distance from the real process [just noticeable differences], one standard error")
    axes[0, 0].legend()
    return figure


def board(data: Mapping[str, Any], **options: Any) -> Any:
    """Scores with their intervals, one picture per task."""
    tasks = [task for task in data["tasks"] if task.get("ranking", {}).get("order")]
    if not tasks:
        raise ValueError("no task of this leaderboard has a ranking")
    sizes = [0.3 * len(task["ranking"]["order"]) + 1 for task in tasks]
    options.setdefault("figsize", (8, sum(sizes)))
    figure, axes = _figure(len(tasks), gridspec_kw={"height_ratios": sizes}, **options)
    for place, task in zip(axes[:, 0], tasks):
        order = task["ranking"]["order"][::-1]
        score = np.array([one["score_N"] for one in order], float)
        low, high = (np.array([one["interval95_N"][i] for one in order], float) for i in (0, 1))
        place.errorbar(score, [one["renderer"] for one in order], xerr=[score - low, high - score], fmt="o", capsize=3)
        place.set_ylim(-0.6, len(order) - 0.4)
        place.set_title(task["name"], fontsize="medium")
        place.set_xlabel("RMS force error [N], 95 % interval")
    return figure


#: As the program's own maps (Okabe and Ito's palette): the worst that a case shows decides.
_ATLAS_COLOURS = (("?", "#BBBBBB"), ("p", "#D55E00"), ("l", "#CC79A7"), ("i", "#0072B2"), ("s", "#E69F00"))
_CLEAN = "#DDEEE7"
_SHARPNESS = {"bump": ("side_angle_rad", 1.0, "angle of the sides [rad]"), "shell": ("thickness_m", 1e3, "thickness [mm]")}


def atlas(data: Mapping[str, Any], scene: str = "bump", mu: Optional[float] = None, **options: Any) -> Any:
    """A map per renderer: sharpness against stiffness, with the letters of the program's maps."""
    if scene not in _SHARPNESS:
        raise ValueError(f"there is no scene {scene!r}; there are {', '.join(_SHARPNESS)}")
    key, factor, label = _SHARPNESS[scene]
    cases = [one for one in data["cases"] if one["scene"] == scene]
    mus = sorted({one["mu"] for one in cases})
    if not cases or mu is not None and mu not in mus:
        raise ValueError(f"the atlas has no cases of {scene} with mu {mu}; there are {', '.join(map(number, mus))}")
    mu = mus[0] if mu is None else mu
    cases = [one for one in cases if one["mu"] == mu]
    renderers = list(dict.fromkeys(one["renderer"] for one in cases))
    xs, ys = (sorted({one[name] for one in cases}) for name in (key, "stiffness_N_per_m"))
    options.setdefault("figsize", (0.5 * len(xs) * len(renderers) + 2.2, 0.35 * len(ys) + 1.6))
    figure, axes = _figure(1, len(renderers), sharey=True, **options)
    for place, name in zip(axes[0], renderers):
        found: Dict[Tuple[float, float], str] = {
            (one[key], one["stiffness_N_per_m"]): one.get("faults", "?") for one in cases if one["renderer"] == name}
        for column, x in enumerate(xs):
            for row, y in enumerate(ys):
                letters = found.get((x, y), "?")
                colour = next((colour for letter, colour in _ATLAS_COLOURS if letter in letters), _CLEAN)
                place.add_patch(_square(column, row, colour))
                place.text(column, row, letters or "-", ha="center", va="center", fontsize="small")
        place.set_xlim(-0.5, len(xs) - 0.5)
        place.set_ylim(-0.5, len(ys) - 0.5)
        place.set_xticks(range(len(xs)), [f"{factor * x:.3g}" for x in xs], rotation=90)
        place.set_yticks(range(len(ys)), [f"{y:.4g}" for y in ys])
        place.set_title(name, fontsize="medium")
        place.set_xlabel(label)
    axes[0, 0].set_ylabel("stiffness [N/m]")
    figure.suptitle(f"{scene}, mu = {mu:g}: s sticks, p pops through, l loses contact, i pulls inward, ? not known",
                    fontsize="medium")
    return figure


def _square(column: int, row: int, colour: str) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((column - 0.5, row - 0.5), 1, 1, facecolor=colour, edgecolor="white")
