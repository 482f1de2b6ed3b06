"""A campaign made of arrays or data frames, and what the program says of it.

The program runs as a process of its own and reads the logs from a folder: arrays pass through CSV, at some 2 million numbers a second.
"""

from __future__ import annotations

import json
import pathlib
import tempfile
import warnings
from typing import Any, Iterable, Mapping, Optional, Sequence, Union

from . import Doubt, run, table

Numbers = Sequence[float]
PathLike = Union[str, "pathlib.Path"]

# Quantities of a trial with the unit that their arrays are in.
UNITS = {
    "time_s": ("time", "s"),
    "position_rad": ("position", "rad"),
    "torque_nm": ("torque", "N m"),
    "velocity_rad_s": ("velocity", "rad/s"),
    "current_a": ("current", "A"),
    "load_torque_nm": ("load_torque", "N m"),
    "temperature_degc": ("temperature", "degC"),
    "command_rad": ("command", "rad"),
}
TRIAL_KEYS = ("protocol", "speed_rad_s", "repeat", "trajectory")


class Result(dict):
    """The JSON of a command, with the folder that it wrote. In a notebook its figures are shown."""

    def __init__(self, found: Mapping[str, Any], folder: pathlib.Path) -> None:
        super().__init__(found)
        self.folder = folder

    def figures(self) -> "dict[str, str]":
        """Each figure as SVG, by name."""
        return {file.stem: file.read_text(encoding="utf-8") for file in sorted(self.folder.glob("plots/*.svg"))}

    def _repr_html_(self) -> str:
        return "".join(f"<div>{svg[max(svg.find('<svg'), 0):]}</div>" for svg in self.figures().values())


class Campaign:
    """One joint, recorded: a folder with a campaign.toml and its logs."""

    def __init__(self, folder: PathLike) -> None:
        self.folder = pathlib.Path(folder)
        self._scratch: Optional[tempfile.TemporaryDirectory[str]] = None

    @classmethod
    def from_arrays(
        cls,
        trials: Iterable[Mapping[str, Any]],
        *,
        joint: Mapping[str, Any],
        dynamics: Mapping[str, Any],
        torque_sign: int,
        lowpass_hz: float = 5.0,
        lowpass_order: int = 4,
        uncertainty: Optional[Mapping[str, float]] = None,
        controller: Optional[Mapping[str, Any]] = None,
        folder: Optional[PathLike] = None,
    ) -> "Campaign":
        """Makes a campaign of arrays.

        Each of `trials` maps `time_s`, `position_rad`, `torque_nm` (or `current_a`, or `command_rad`; for a slide m and N under the same names), and
        whatever else was recorded, to arrays of one length, and `protocol` (`uniform` with `speed_rad_s`, `cosine`, `free`,
        `interaction`), `repeat` and `trajectory` to values. `joint`, `dynamics`, `uncertainty` and `controller` (for `command_rad`
        without a torque) hold the keys of these sections of campaign.toml. Without a `folder` the logs live as long as the object.
        """
        if isinstance(trials, Mapping):
            raise TypeError("trials is a list with a dict of arrays for each trial: put a single one into a list")
        trials = list(trials)
        if not trials:
            raise ValueError("a campaign has at least one trial")
        scratch = None if folder else tempfile.TemporaryDirectory(prefix="tautline-")
        path = pathlib.Path(scratch.name if scratch else str(folder))
        path.mkdir(parents=True, exist_ok=True)
        names = [name for name in trials[0] if name not in TRIAL_KEYS]
        unknown = [name for name in names if name not in UNITS]
        if unknown:
            known = ", ".join([*UNITS, *TRIAL_KEYS])
            raise ValueError(f"unknown quantity {unknown[0]!r}: arrays are in SI and radians under these names: {known}")
        is_slide = joint.get("kind") == "prismatic"
        units = {name: _of_slide(unit) if is_slide else unit for name, (_, unit) in UNITS.items()}
        lines = ['format = "campaign/1"', ""]
        lines += _section("joint", {"name": "joint", **joint}) + _section("dynamics", dynamics)
        lines += _section("uncertainty", uncertainty) if uncertainty else []
        lines += _section("signal", {"torque_sign": int(torque_sign), "lowpass_hz": float(lowpass_hz), "lowpass_order": lowpass_order})
        lines += _section("controller", controller) if controller else []
        lines += ["[columns]"] + [f'{UNITS[name][0]} = {{ name = "{name}", unit = "{units[name]}" }}' for name in names]
        for number, trial in enumerate(trials, 1):
            if [name for name in trial if name not in TRIAL_KEYS] != names:
                raise ValueError(f"trial {number} holds other quantities than the first: {', '.join(names)}")
            file = f"trial_{number}.csv"
            _write(path / file, names, [_list(trial[name]) for name in names], number)
            keys = {"file": file, "protocol": "free", "repeat": 1, **{key: trial[key] for key in TRIAL_KEYS if trial.get(key) is not None}}
            lines += ["", "[[trials]]"] + _pairs(keys)
        (path / "campaign.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
        made = cls(path)
        made._scratch = scratch
        return made

    @classmethod
    def from_dataframe(
        cls,
        frame: Any,
        *,
        by: Optional[str] = None,
        columns: Optional[Mapping[str, str]] = None,
        trials: Optional[Mapping[Any, Mapping[str, Any]]] = None,
        **declared: Any,
    ) -> "Campaign":
        """Makes a campaign of a data frame of pandas, polars or pyarrow.

        `columns` maps quantities (`time_s`, ...) to the frame's columns, where these are called otherwise; `by` names the column that
        tells trials apart; `trials` maps each of its values to `protocol`, `speed_rad_s`, `repeat`, `trajectory`. The rest is as in
        `from_arrays`.
        """
        held = [str(name) for name in getattr(frame, "column_names", None) or list(frame.columns)]
        named = dict(columns or {name: name for name in UNITS if name in held})
        lacking = [name for name in [*named.values(), *([by] if by else [])] if name not in held]
        if lacking or not named:
            raise ValueError(f"the frame has no column {lacking[0] if lacking else 'time_s'!r}; it has {', '.join(held)}")
        if "position_rad" not in named:
            raise ValueError(f"no column for 'position_rad': say columns={{'position_rad': ..., ...}}; the frame has {', '.join(held)}")
        data = {quantity: _list(frame[name]) for quantity, name in named.items()}
        keys = _list(frame[by]) if by else [None] * len(next(iter(data.values())))
        rows: "dict[Any, list[int]]" = {}
        for row, key in enumerate(keys):
            rows.setdefault(key, []).append(row)
        told = trials or {}
        made = [
            {**{quantity: [values[row] for row in of] for quantity, values in data.items()}, "repeat": number, **told.get(key, {})}
            for number, (key, of) in enumerate(rows.items(), 1)
        ]
        return cls.from_arrays(made, **declared)

    def validate(self, **options: Any) -> "dict[str, Any]":
        """What was understood, every problem and every doubt. Raises `Refused` only where there is no campaign at all."""
        return run("validate", self.folder, accept=(0, 2), **options)

    def identify(self, output: Optional[PathLike] = None, **options: Any) -> Result:
        """Identifies the joint. Raises `Refused` with the cure where the campaign cannot be used."""
        return self._command("identify", output, **options)

    def diagnose(self, model: Any, output: Optional[PathLike] = None, **options: Any) -> Result:
        """Finds where the gap between `model` (a Result of `identify`, or a model.json) and the recordings lies, and why."""
        return self._command("diagnose", output, model=_model(model), **options)

    def evaluate(self, model: Any, output: Optional[PathLike] = None, **options: Any) -> Result:
        """Scores `model` on the recordings."""
        return self._command("evaluate", output, model=_model(model), **options)

    def predict(self, model: Any, output: Optional[PathLike] = None, **options: Any) -> "dict[str, dict[str, Any]]":
        """What `model` makes of every sample: per trial the columns `time_s`, `torque_nm`, `predicted_nm`, ... as arrays (NumPy's where
        it is installed)."""
        result = self._command("predict", output, model=_model(model), **options)
        return {file.stem: _arrays(file) for file in sorted(result.folder.glob("*.csv"))}

    def _command(self, command: str, output: Optional[PathLike], **options: Any) -> Result:
        if output is None:
            if self._scratch is None:
                self._scratch = tempfile.TemporaryDirectory(prefix="tautline-")
            output = tempfile.mkdtemp(prefix=f"{command}-", dir=self._scratch.name) + "/out"
        found = run(command, self.folder, output=output, **options)
        if found.get("warnings"):
            warnings.warn("\n".join(map(str, found["warnings"])), Doubt, stacklevel=3)
        return Result(found, pathlib.Path(output))


def _of_slide(unit: str) -> str:
    return {"rad": "m", "rad/s": "m/s", "N m": "N"}.get(unit, unit)


def _model(model: Any) -> pathlib.Path:
    """The model.json of a Result, a folder or a file."""
    path = pathlib.Path(getattr(model, "folder", model))
    return path / "model.json" if path.is_dir() else path


def _list(values: Any) -> "list[Any]":
    for method in ("to_pylist", "to_list", "tolist"):
        if hasattr(values, method):
            return list(getattr(values, method)())
    return list(values)


def _arrays(file: pathlib.Path) -> "dict[str, Any]":
    """The columns of a CSV of numbers, as NumPy's arrays where it is installed."""
    try:
        import numpy
    except ImportError:
        return table(file)
    try:
        with open(file, encoding="utf-8") as opened:
            names = opened.readline().strip().split(",")
            return dict(zip(names, numpy.loadtxt(opened, delimiter=",", ndmin=2).T))
    except ValueError:  # a cell is empty: there is no number
        return {name: numpy.array(values, dtype=float) for name, values in table(file).items()}


def _write(file: pathlib.Path, names: "list[str]", columns: "list[list[float]]", number: int) -> None:
    lengths = {len(column) for column in columns}
    if len(lengths) != 1:
        told = ", ".join(f"{name} {len(column)}" for name, column in zip(names, columns))
        raise ValueError(f"the arrays of trial {number} differ in length: {told}")
    with open(file, "w", encoding="utf-8") as out:
        out.write(",".join(names) + "\n")
        try:
            out.writelines(",".join(map(repr, map(float, row))) + "\n" for row in zip(*columns))
        except TypeError:
            raise ValueError(f"the arrays of trial {number} are to hold one number for each sample: none of two dimensions, no texts") from None


def _section(name: str, values: Mapping[str, Any]) -> "list[str]":
    return [f"[{name}]", *_pairs(values), ""]


def _pairs(values: Mapping[str, Any]) -> "list[str]":
    # TOML's texts, numbers and booleans are written as JSON writes them.
    return [f"{key} = {json.dumps(value, default=_plain)}" for key, value in values.items()]


def _plain(value: Any) -> Any:
    """A NumPy number as Python's own."""
    if not hasattr(value, "item"):
        raise TypeError(f"{value!r} is no number, text or table")
    return value.item()
