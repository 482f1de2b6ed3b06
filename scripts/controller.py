#!/usr/bin/env python3
"""How long the exported C takes for a sample, at worst: compiled with cc, run over a motion with reversals.

    scripts/controller.py MODEL [--binary tautline] [--samples 1000000]

Every call is timed by itself, the clock's own time taken off. The largest figure holds whatever else the machine did meanwhile;
the 99.99th percentile hardly does.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile

HARNESS = """
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include "NAME_model.h"

static double now_ns(void) { struct timespec t; clock_gettime(CLOCK_MONOTONIC, &t); return 1e9 * t.tv_sec + t.tv_nsec; }
static int order(const void *a, const void *b) { return (*(double *)a > *(double *)b) - (*(double *)a < *(double *)b); }

int main(int argc, char **argv)
{
    const long n = argc > 1 ? atol(argv[1]) : 1000000;
    double *took_ns = malloc(sizeof(double) * n), *clock_ns = malloc(sizeof(double) * n), sum = 0.0;
    NAME_state s;
    NAME_sample x = {0};
    NAME_start(&s, 0.5, 1, 0.0);
    for (long i = 0; i < n; i++) {
        const double t = 0.001 * i, w = 2.0 + sin(0.1 * t);
        x.time_s = x.elapsed_s = t;
        x.own.position_rad = x.measured_rad = 0.8 - 0.6 * cos(w * t);
        x.own.velocity_rad_s = 0.6 * w * sin(w * t);
        x.own.acceleration_rad_s2 = 0.6 * w * w * cos(w * t);
        const double before = now_ns();
        const double between = now_ns();
        sum += NAME_torque_nm(&s, &x);
        const double after = now_ns();
        clock_ns[i] = between - before;
        took_ns[i] = after - between;
    }
    qsort(took_ns, n, sizeof(double), order);
    qsort(clock_ns, n, sizeof(double), order);
    printf("{\\"samples\\": %ld, \\"clock_ns\\": %.0f, \\"median_ns\\": %.0f, \\"p99_99_ns\\": %.0f, \\"largest_ns\\": %.0f, \\"sum\\": %g}\\n",
           n, clock_ns[n / 2], took_ns[n / 2] - clock_ns[n / 2], took_ns[n - 1 - n / 10000] - clock_ns[n / 2],
           took_ns[n - 1] - clock_ns[n / 2], sum);
    return 0;
}
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model")
    parser.add_argument("--binary", default="tautline")
    parser.add_argument("--samples", type=int, default=1_000_000)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch) / "out"
        subprocess.run([arguments.binary, "export", arguments.model, "-o", folder, "--only", "c", "--quiet"], check=True)
        name = next(folder.glob("*_model.h")).name.removesuffix("_model.h")
        (folder / "main.c").write_text(HARNESS.replace("NAME", name))
        strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O2"]
        subprocess.run(["cc", *strict, "main.c", "-lm", "-o", "main"], cwd=folder, check=True)
        done = subprocess.run([folder / "main", str(arguments.samples)], check=True, capture_output=True, text=True)
    found = json.loads(done.stdout)
    print(f"{name}: median {found['median_ns']} ns, 99.99 % within {found['p99_99_ns']} ns, largest {found['largest_ns']} ns "
          f"of {found['samples']} samples (the clock's {found['clock_ns']} ns taken off)")
    assert found["p99_99_ns"] < 1e6, "no sample in a thousandth of a second"


if __name__ == "__main__":
    main()
