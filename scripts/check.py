"""Does `tautline check` turn red when it should, and only then? Seeds regressions into copies of the bundled campaigns.

    python3 scripts/check.py [--binary tautline]

Each copy of data/elbow has one thing changed, in its logs or its campaign.toml, and must end with status 1; each of the
harmless changes (order of the columns, other units, other rounding) with status 0. Needs polars.
"""

import argparse
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

import polars

TORQUE, POSITION = "torque_nm", "position_deg"
RATE_HZ = 50


def logs(change, pattern="*"):
    """A change of every log whose name matches."""

    def act(folder):
        for file in sorted(folder.glob(pattern + ".parquet")):
            change(polars.read_parquet(file)).write_parquet(file)

    return act


def column(name, change, pattern="*"):
    return logs(lambda frame: frame.with_columns(change(polars.col(name)).alias(name)), pattern)


def toml(old, new):
    """A change of campaign.toml."""

    def act(folder):
        file = folder / "campaign.toml"
        text = file.read_text()
        assert old in text, old
        file.write_text(text.replace(old, new, 1))

    return act


def lose(folder):
    (folder / "sweep_0.0706_2.parquet").unlink()
    file = folder / "campaign.toml"
    parts = file.read_text().split("\n[[trials]]\n")
    file.write_text("\n[[trials]]\n".join(part for part in parts if "sweep_0.0706_2" not in part))


def swap(folder):
    one, two, aside = folder / "cosine_1.parquet", folder / "cosine_2.parquet", folder / "aside"
    one.rename(aside), two.rename(one), aside.rename(two)


def rounded(frame):
    """Every value off by up to 1e-12 of it, as another program's arithmetic leaves it. Equal values stay equal, as they do there:
    an encoder stands still in them."""
    return frame.with_columns(polars.col(frame.columns) * (1 + 1e-12 * (polars.col(frame.columns) * 1e7).sin()))


def in_radians(folder):
    column(POSITION, lambda x: x * (math.pi / 180))(folder)
    toml('name = "position_deg", unit = "deg"', 'name = "position_deg", unit = "rad"')(folder)


RED = {
    "torque scaled by 1.02": column(TORQUE, lambda x: x * 1.02),
    "torque of one trial scaled by 1.05": column(TORQUE, lambda x: x * 1.05, "cosine_2"),
    "torque 50 ms late": column(TORQUE, lambda x: x.shift(round(0.05 * RATE_HZ)).backward_fill(), "cosine_*"),
    "sign of the torque": column(TORQUE, lambda x: -x),
    "sign of the torque declared otherwise": toml("torque_sign = -1", "torque_sign = 1"),
    "a trial lost": lose,
    "filter off by one order": toml("lowpass_order = 4", "lowpass_order = 5"),
    "another low-pass": toml("lowpass_hz = 5.0", "lowpass_hz = 6.0"),
    "two trials swapped": swap,
    "gravity": toml("gravity_nm = 0.6916", "gravity_nm = 0.70"),
    "backlash": toml("backlash_m = 0.0008", "backlash_m = 0.0009"),
    "position off by 1 deg": column(POSITION, lambda x: x + 1.0),
    "torque clipped": column(TORQUE, lambda x: x.clip(x.min() * 0.9, x.max() * 0.9), "cosine_*"),
    "torque sensor's zero off by 5 mN m": column(TORQUE, lambda x: x + 0.005),
}
CODE = {
    "code: filter off by one order": ('"signal.lowpass_order":"4"', '"signal.lowpass_order":"5"'),
    "code: another low-pass by 1 %": ('"signal.lowpass_hz":"5"', '"signal.lowpass_hz":"5.05"'),
    "code: gravity off by 0.1 %": ('"dynamics.gravity_nm":"0.6916"', '"dynamics.gravity_nm":"0.6923"'),
}
RED |= {
    "code: filter off by one order": toml("lowpass_order = 4", "lowpass_order = 5"),
    "code: another low-pass by 1 %": toml("lowpass_hz = 5.0", "lowpass_hz = 5.05"),
    "code: gravity off by 0.1 %": toml("gravity_nm = 0.6916", "gravity_nm = 0.6923"),
}
GREEN = {
    "nothing": lambda folder: None,
    "columns in another order": logs(lambda frame: frame.select(reversed(frame.columns))),
    "values rounded at 1e-12": logs(rounded),
    "position in radians": in_radians,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--binary", default="tautline")
    binary = parser.parse_args().binary

    def run(*arguments):
        return subprocess.run([binary, "check", *map(str, arguments)], capture_output=True, text=True)

    data = pathlib.Path(__file__).resolve().parent.parent / "data"
    wrong = 0
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        for name in ("elbow", "davinci_l4", "arm"):
            status = run(data / name, "--baseline", data / name / "baseline.json").returncode
            wrong += status != 0
            print(f"{'ok' if status == 0 else 'WRONG':6}green  bundled {name}")
        for wanted, changes in ((1, RED), (0, GREEN)):
            for name, change in changes.items():
                folder = scratch / "elbow"
                shutil.copytree(data / "elbow", folder)
                change(folder)
                # A change of code leaves the settings as they were: the baseline then declares the changed one, too.
                baseline = scratch / "baseline.json"
                text = (data / "elbow" / "baseline.json").read_text()
                if name in CODE:
                    assert CODE[name][0] in text
                    text = text.replace(*CODE[name])
                baseline.write_text(text)
                done = run(folder, "--baseline", baseline, "--format", "json")
                shutil.rmtree(folder)
                found = json.loads(done.stdout) if done.stdout else {"findings": []}
                regressed = [f for f in found["findings"] if f["outcome"] == "regressed"]
                parts = sorted({f["part"] for f in regressed})
                figures = [f for f in regressed if f["part"] == "figure"]
                ok = done.returncode == wanted
                wrong += not ok
                colour = ("green", "red")[wanted]
                told = f"{', '.join(parts)}; {len(figures)} figures" if regressed else ""
                print(f"{'ok' if ok else 'WRONG':6}{colour:7}{name:45}{told} {done.stderr[:200]}")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
