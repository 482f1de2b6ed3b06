"""What the scripts here read of a captured campaign: its trials and the rows of their logs."""

import csv
import tomllib
from pathlib import Path


def trials(folder: Path) -> list[dict]:
    """`[[trials]]` of campaign.toml; none where the capture was stopped before the first."""
    if not (folder / "campaign.toml").exists():
        return []
    return tomllib.loads((folder / "campaign.toml").read_text())["trials"]


def rows(log: Path) -> list[dict]:
    """The whole rows of a log; what a killed recorder left of one is dropped."""
    whole = log.read_bytes().rpartition(b"\n")[0].decode()
    return list(csv.DictReader(whole.splitlines()))


def accounted(folder: Path) -> tuple[int, int, int]:
    """Samples, late and missed cycles of all trials. Every cycle from the first row of a log to its last must be a row or
    counted as missed."""
    samples = late = missed = 0
    for trial in trials(folder):
        cycles = [int(row["cycle"]) for row in rows(folder / trial["file"])]
        gaps = cycles[-1] - cycles[0] + 1 - len(cycles)
        assert all(b > a for a, b in zip(cycles, cycles[1:])), f"{trial['file']}: cycles go back"
        if "incomplete" not in trial:
            assert gaps <= trial["missed_cycles"], f"{trial['file']}: {gaps} cycles are gone, {trial['missed_cycles']} told"
        samples, late, missed = samples + len(cycles), late + trial["late_cycles"], missed + trial["missed_cycles"]
    return samples, late, missed
