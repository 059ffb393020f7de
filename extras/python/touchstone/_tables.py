"""Tables of HTML, as a notebook shows results. Nothing is computed here that a file of the program does not say."""

import html
from typing import Any, Dict, List, Mapping, Sequence, Tuple

escape = html.escape


def number(value: Any) -> str:
    """Four digits of a number, nothing for what has no value, a text as it is."""
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


def table(head: Sequence[str], rows: Sequence[Sequence[Any]], caption: str = "") -> str:
    """A table; texts are escaped, numbers have four digits."""
    lines = ["<table>"]
    if caption:
        lines.append(f"<caption>{escape(caption)}</caption>")
    lines.append("<thead><tr>" + "".join(f"<th>{escape(cell)}</th>" for cell in head) + "</tr></thead><tbody>")
    for row in rows:
        lines.append("<tr>" + "".join(f"<td>{escape(number(cell))}</td>" for cell in row) + "</tr>")
    return "\n".join([*lines, "</tbody></table>"])


def _headline(data: Mapping[str, Any]) -> List[Any]:
    return [m for m in data["metrics"] if m["status"] == "ok" and not m["name"][-2:] in ("_x", "_y", "_z")]


def evaluation(data: Mapping[str, Any]) -> str:
    rows = [[m["name"], m["value"], m["unit"], m.get("reference"), m["meaning"]] for m in _headline(data)]
    notes = "".join(f"<p>{escape(message)}</p>" for message in data["messages"])
    return table(["metric", "value", "unit", "of", "meaning"], rows, data["title"]) + notes


def with_unit(value: Any, unit: str) -> str:
    """A number and its unit; a ratio has none, and what has no value is empty."""
    return "" if value is None else number(value) + ("" if unit == "1" else f" {unit}")


def evaluations(entries: Sequence[Mapping[str, Any]]) -> str:
    """Entries of evaluations.json: one table per group; renderers that do not enter stand with the reason."""
    names = ["rms_force_error", "max_force_error", "rms_position_error", "mean_operations"]
    parts = []
    for group in dict.fromkeys(entry["group"] for entry in entries):
        rows, out = [], []
        for entry in entries:
            if entry["group"] != group:
                continue
            if entry.get("does_not_enter"):
                out.append(f"<p>{escape(entry['name'])} does not enter: {escape(entry['does_not_enter'])}</p>")
                continue
            values = {m["name"]: with_unit(m["value"], m["unit"]) for m in entry.get("metrics", [])}
            rows.append([entry["name"], *(values.get(name, "") for name in names)])
        parts.append(table(["renderer", *(name.replace("_", " ") for name in names)], rows, group) + "".join(out))
    return "\n".join(parts)


def fit(data: Mapping[str, Any]) -> str:
    rows = []
    for one in data["parameters"]:
        interval = one["interval95"]
        rows.append([one["name"], one["initial"], one["value"], one["unit"],
                     "" if interval is None else f"{number(interval[0])} to {number(interval[1])}"])
    score, metric = data["score"], data["metric"]
    caption = f"{metric['name']}: {number(score['before'])} to {number(score['after'])} {metric['unit']}"
    return table(["parameter", "given", "fitted", "unit", "95 % interval"], rows, caption)


def findings(data: Mapping[str, Any]) -> str:
    gap = data["gap"]
    rows: List[List[Any]] = [["verdict", data["verdict"]]]
    for effect in data["effects"]:
        values = ", ".join(f"{one['name']} = {with_unit(one['value'], one['unit'])}" for one in effect["parameters"])
        rows.append([f"{effect['side']} effect", f"{effect['name']}: {values}"])
    rows += [[f"gap on {which} [{gap['unit']}]", f"{number(gap[which]['before'])} before, {number(gap[which]['after'])} after"]
             for which in ("train", "holdout")]
    rows.append([f"noise floor [{gap['unit']}]", gap["noise_floor"]])
    return table(["", "finding"], rows)


def board(data: Mapping[str, Any]) -> str:
    parts = []
    for task in data["tasks"]:
        if "ranking" not in task:
            continue
        rows = [["-".join(map(str, dict.fromkeys(one["rank"]))), one["renderer"], one["score_N"],
                 f"{number(one['interval95_N'][0])} to {number(one['interval95_N'][1])}"]
                for one in task["ranking"]["order"]]
        parts.append(table(["rank", "renderer", "RMS force error [N]", "95 % interval"], rows, task["name"]))
    return "\n".join(parts)


def atlas(data: Mapping[str, Any]) -> str:
    rows: Dict[Tuple[str, str, float], List[int]] = {}
    for case in data["cases"]:
        row = rows.setdefault((case["scene"], case["renderer"], case["mu"]), [0] * 7)
        faults = case.get("faults", "?")
        row[0] += 1
        row[1] += faults == ""
        for column, letter in enumerate("spli?", start=2):
            row[column] += letter in faults
    head = ["scene", "renderer", "mu", "cases", "clean", "sticks", "pops through", "loses contact", "pulls inward", "not known"]
    return table(head, [[*key, *row] for key, row in rows.items()])


def perception(data: Mapping[str, Any]) -> str:
    if "conditions" not in data:
        return ""
    rows = []
    for one in sorted(data["conditions"], key=lambda one: one.get("rank") or 0):
        strongest = next((c for c in one.get("channels", []) if c["name"] == one.get("gives_away")), None)
        rows.append([one.get("rank"), one["name"], one.get("noticed_probability"), one.get("d_prime"), one.get("verdict"),
                     "" if strongest is None else f"{strongest['name']}: {strongest['what']}"])
    return table(["rank", "condition", "probability that a person tells it", "d'", "verdict", "by"], rows)


def comparison(data: Mapping[str, Any]) -> str:
    rows = [["verdict", data["verdict"]]]
    rows += [[name.replace("_", " "), value] for name, value in data.items() if isinstance(value, (int, float))]
    return table(["", "comparison"], rows)


def scorecard(cards: Sequence[Mapping[str, Any]]) -> str:
    rows = []
    for card in cards:
        found = card.get("findings", [])
        rows += [[card["engine"]["name"], one["name"], one["what"]] for one in found]
        if not found:
            rows.append([card["engine"]["name"], "nothing found", ""])
    return table(["renderer", "fault", "what"], rows)
