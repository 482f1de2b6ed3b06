#!/usr/bin/env python3
"""Writes tests/reference/filter.json: SciPy's zero-phase Butterworth low-pass on short signals, for tests/reference.rs.

usage: scripts/reference/filter.py [--check]      (needs numpy and scipy; run from the top of the project)

With --check nothing is written; it ends with status 1 when the file is not what SciPy gives today.
"""
import json
import pathlib
import sys

import numpy as np
import scipy
from scipy.signal import butter, sosfiltfilt

random = np.random.default_rng(20260101)
cases = []
for order in (1, 2, 3, 4, 5, 6, 8):
    for cutoff_hz, rate_hz in ((5.0, 1000.0), (20.0, 1000.0), (100.0, 1000.0), (5.0, 50.0), (20.0, 50.0)):
        n = int(random.integers(3 * (order + 2) + 2, 160))
        t = np.arange(n) / rate_hz
        signal = 0.3 + np.cumsum(random.normal(size=n)) * 0.05 + np.sin(2 * np.pi * cutoff_hz * t)
        sections = butter(order, cutoff_hz, fs=rate_hz, output="sos")
        cases.append({"order": order, "cutoff_hz": cutoff_hz, "rate_hz": rate_hz, "signal": signal.tolist(),
                      "filtered": sosfiltfilt(sections, signal).tolist()})
out = pathlib.Path("tests/reference/filter.json")
if "--check" in sys.argv:
    stored = json.loads(out.read_text())["cases"]
    off = max(np.max(np.abs(np.subtract(a["filtered"], b["filtered"]))) for a, b in zip(stored, cases, strict=True))
    print(f"{out}: {len(cases)} cases, off by at most {off:.1e}")
    sys.exit(int(off > 1e-11))
out.write_text(json.dumps({"scipy": scipy.__version__, "cases": cases}) + "\n")
print(f"{out}: {len(cases)} cases")
