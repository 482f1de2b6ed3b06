"""Runs the program `tautline` and gives its results as dicts.

    import tautline

    found = tautline.run("identify", "data/elbow", output="out", force=True)
    found["friction"]["up"]["mu_c"]
    tautline.table("out/trials.csv")["a_nm"]

Arrays and data frames become a campaign, and come back as arrays:

    campaign = tautline.Campaign.from_arrays(trials, joint={...}, dynamics={"gravity_nm": 0.69}, torque_sign=-1)
    model = campaign.identify()
    campaign.predict(model)["trial_1"]["residual_nm"]

Options are called as on the command line, with `_` for `-`: `rate_hz=200`, `force=True`, a list for what may be repeated.
"""

import csv
import json
import os
import shutil
import subprocess
import sysconfig

__all__ = ["Campaign", "Doubt", "Refused", "Result", "program", "run", "table"]


class Doubt(UserWarning):
    """What the program warns of in a result that it gave all the same."""


class Refused(Exception):
    """The program refused its input (`status` 2) or failed; the text says why, and the cure."""

    def __init__(self, status, text):
        super().__init__(text.strip() or f"tautline ended with status {status}")
        self.status = status


def program():
    """The path of the program: `TAUTLINE`, that of this environment, or the first on the PATH."""
    name = "tautline.exe" if os.name == "nt" else "tautline"
    beside = os.path.join(sysconfig.get_path("scripts"), name)
    found = os.environ.get("TAUTLINE") or (beside if os.path.exists(beside) else shutil.which("tautline"))
    if not found:
        raise Refused(127, "the program tautline is not installed: pip install tautline, or cargo install --path .")
    return found


def run(*command, accept=(0, 1), **options):
    """Runs `command` and gives its JSON.

    A judgement that failed (status 1: `evaluate --fail-above`) is a result too. Raises `Refused` on bad input, or whatever ends
    with a status that is not in `accept`.
    """
    words = [str(word) for word in command]
    for name, value in options.items():
        flag = "--" + name.rstrip("_").replace("_", "-")
        for one in value if isinstance(value, (list, tuple)) else [value]:
            if one is True:
                words.append(flag)
            elif one is not None and one is not False:
                words.append(f"{flag}={one}")
    done = subprocess.run([program(), *words, "--json"], capture_output=True, text=True, encoding="utf-8")
    if done.returncode not in accept or not done.stdout.strip():
        raise Refused(done.returncode, done.stderr)
    return json.loads(done.stdout)


def table(file):
    """A CSV that the program wrote, as a dict of columns: numbers where all of a column are, else texts; None where empty."""
    with open(file, newline="", encoding="utf-8") as opened:
        rows = csv.reader(opened)
        names = next(rows, [])
        return {name: _numbers(cells) for name, cells in zip(names, zip(*rows))}


def _numbers(cells):
    try:
        return [float(cell) if cell else None for cell in cells]
    except ValueError:
        return [cell or None for cell in cells]


from .campaign import Campaign, Result  # noqa: E402  (it needs what stands above)
