#!/usr/bin/env python3
"""How many samples a second `tautline interaction --follow` takes, and how long one sample waits for its answer.

usage: scripts/stream.py CAMPAIGN MODEL [--samples 1000000] [--binary target/release/tautline]

CAMPAIGN needs a quiet CSV trial, whose samples are sent again and again with time going on: first all at once, then 1,000 a
second for two seconds, a sample at a time.
"""
import argparse
import pathlib
import statistics
import subprocess
import threading
import time


def samples(campaign, number):
    """Header and lines of the campaign's longest CSV log, repeated with time going on."""
    file = max(pathlib.Path(campaign).glob("*.csv"), key=lambda f: f.stat().st_size)
    header, *lines = file.read_text().splitlines()
    place = header.split(",").index("time_s")
    rows = [line.split(",") for line in lines]
    step = float(rows[1][place]) - float(rows[0][place])
    out = []
    for i in range(number):
        row = list(rows[i % len(rows)])
        row[place] = f"{i * step:.5f}"
        out.append(",".join(row) + "\n")
    return header + "\n", out


def start(options):
    command = [options.binary, "interaction", options.campaign, "--model", options.model, "--follow", "--quiet"]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("campaign")
    parser.add_argument("model")
    parser.add_argument("--samples", type=int, default=1_000_000)
    parser.add_argument("--binary", default="target/release/tautline")
    options = parser.parse_args()
    header, lines = samples(options.campaign, options.samples)
    text = "".join(lines)

    program = start(options)
    program.stdin.write(header)
    program.stdin.write(lines[0])
    program.stdin.flush()
    program.stdout.readline(), program.stdout.readline()  # until the quiet trials are read
    began = time.perf_counter()
    feeder = threading.Thread(target=lambda: (program.stdin.write(text[len(lines[0]):]), program.stdin.close()))
    feeder.start()
    answers = sum(1 for _ in program.stdout)
    seconds = time.perf_counter() - began
    feeder.join()
    assert answers == options.samples - 1, answers
    print(f"{answers / seconds:,.0f} samples a second, all at once")

    program = start(options)
    program.stdin.write(header)
    waits = []
    for line in lines[:2000]:
        sent = time.perf_counter()
        program.stdin.write(line)
        program.stdin.flush()
        if not waits:
            program.stdout.readline()
        program.stdout.readline()
        waits.append(time.perf_counter() - sent)
        time.sleep(max(0.0, 1e-3 - waits[-1]))
    program.stdin.close()
    waits = sorted(1e6 * w for w in waits[1:])
    print(f"one sample's answer: median {statistics.median(waits):.0f} us, 99 % within {waits[int(0.99 * len(waits))]:.0f} us")


main()
