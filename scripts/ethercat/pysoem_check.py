#!/usr/bin/env python3
"""An independent EtherCAT master (pysoem, which is SOEM) drives the software bus over a pair of virtual network interfaces.

    scripts/ethercat/pysoem_check.py --binary target/release/tautline

Needs `pip install pysoem` and no root, but user namespaces; where they are not allowed it says so and ends with 0. What is
checked: masters with any Ethernet address; identity and names out of the EEPROM; SDOs expedited, in one piece and in segments, up and down; refusals; OP with
distributed clocks; process data with the right working counter; the drive enabled after CiA 402, its motor moving the joint, the
torque sensor; a following error and its emergency message; the output watchdog; a fault that `rig emulate --fault` puts in under a
motion, seen by this master, and the emulator's own report of it.
"""

import argparse
import json
import math
import os
import socket
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

MASTER, DEVICES = "ec_master", "ec_devices"
INSIDE = "TAUTLINE_IN_NAMESPACE"
VENDOR, DRIVE, TERMINAL = 0x0ABC, 0x0402, 0x0301
COUNTS_PER_RAD = 1_048_576 / math.tau
PERIOD_S = 0.002
# No verdict here may hang on how busy the machine is: the output watchdog gets as long as a machine may stall.
WATCHDOG_S = 2.0
PATIENCE_US = 200_000


def enter_namespace():
    """Runs this script again in a network namespace of its own."""
    probe = subprocess.run(["unshare", "-Urn", "true"], capture_output=True, text=True)
    if probe.returncode != 0:
        print(f"skipped: this machine allows no user namespaces ({probe.stderr.strip()})")
        sys.exit(0)
    os.environ[INSIDE] = "1"
    os.execvp("unshare", ["unshare", "-Urn", sys.executable, *sys.argv])


def ip(*words):
    subprocess.run(["ip", *words], check=True)


def make_wire():
    ip("link", "add", MASTER, "type", "veth", "peer", "name", DEVICES)
    for interface in (MASTER, DEVICES):
        ip("link", "set", interface, "up")


def check(what, right):
    print(f"{'ok  ' if right else 'FAIL'} {what}", flush=True)
    if not right:
        raise SystemExit(f"failed: {what}")


def refused(slave, index, sub, value, code):
    import pysoem

    try:
        slave.sdo_write(index, sub, value)
    except pysoem.SdoError as error:
        return error.abort_code == code
    return False


def eeprom(drive):
    """The vendor stands there; an alias that is written stands there too."""
    drive.eeprom_write(4, b"\x34\x12")
    return drive.eeprom_read(8) == struct.pack("<I", VENDOR) and drive.eeprom_read(4)[:2] == b"\x34\x12"


def check_objects(drive, terminal):
    check("drive: vendor, product, revision out of the EEPROM", (drive.man, drive.id, drive.rev) == (VENDOR, DRIVE, 1))
    check("terminal: the same", (terminal.man, terminal.id, terminal.rev) == (VENDOR, TERMINAL, 1))
    check("order numbers out of the EEPROM's strings", (drive.name, terminal.name) == ("TL7402", "TL3001"))
    check("EEPROM read and written word by word", eeprom(drive))
    check("expedited upload: 0x1018:1", struct.unpack("<I", drive.sdo_read(0x1018, 1))[0] == VENDOR)
    check("upload in one piece: 0x1008", drive.sdo_read(0x1008, 0) == b"Winch drive, CiA 402")
    sheet = drive.sdo_read(0x2100, 0, 2048)
    check(f"segmented upload: 0x2100, {len(sheet)} bytes", sheet == bytes(65 + i % 26 for i in range(700)))
    written = bytes(i * 7 % 251 for i in range(1000))
    drive.sdo_write(0x2100, 0, written)
    check("segmented download: 0x2100, 1000 bytes", drive.sdo_read(0x2100, 0, 2048) == written)
    drive.sdo_write(0x6065, 0, struct.pack("<I", 12345))
    check("expedited download: 0x6065", struct.unpack("<I", drive.sdo_read(0x6065, 0))[0] == 12345)
    drive.sdo_write(0x6065, 0, struct.pack("<I", round(0.1 * COUNTS_PER_RAD)))
    check("refused: read only", refused(drive, 0x6041, 0, b"\0\0", 0x06010002))
    check("refused: no such object", refused(drive, 0x5FFF, 0, b"\0", 0x06020000))
    check("refused: no such subindex", refused(drive, 0x1018, 9, b"\0\0\0\0", 0x06090011))
    check("refused: too long", refused(drive, 0x6060, 0, b"\0\0\0\0", 0x06070012))
    check("refused: too high", refused(drive, 0x6060, 0, b"\x40", 0x06090031))
    check("refused: a mapping while in use", refused(drive, 0x1C12, 1, b"\0\x16", 0x08000022))


def exchange(master):
    master.send_processdata()
    counter = master.receive_processdata(PATIENCE_US)
    time.sleep(PERIOD_S)
    return counter


def command(drive, control, target):
    drive.output = struct.pack("<Hibih", control, target, 8, 0, 0)


def status(drive):
    """Status word, position in counts, speed, torque in per mille, mode, error code."""
    return struct.unpack("<HiihbH", drive.input)


def power_up(master, drive):
    for control, mask, wanted in ((0x06, 0x6F, 0x21), (0x07, 0x6F, 0x23), (0x0F, 0x6F, 0x27)):
        for _ in range(100):
            command(drive, control, status(drive)[1])
            exchange(master)
            if status(drive)[0] & mask == wanted:
                break
        check(f"drive: control word {control:#04x} leads to {wanted:#04x}", status(drive)[0] & mask == wanted)


def move(master, drive, terminal):
    """Half a rad and back as a cosine; the joint follows, and its sensor sees it."""
    begin, torques, worst, steps = status(drive)[1], [], 0.0, 1500
    for i in range(steps):
        target = begin + round(0.25 * COUNTS_PER_RAD * (1 - math.cos(math.tau * i / steps)))
        command(drive, 0x0F, target)
        exchange(master)
        worst = max(worst, abs(target - status(drive)[1]) / COUNTS_PER_RAD)
        torques.append(struct.unpack("<Hh", terminal.input)[1] / 32767 * 10 / 2)
    check(f"drive: follows within {worst:.4f} rad", worst < 0.05)
    check(f"sensor: {min(torques):.3f} to {max(torques):.3f} N m", max(torques) - min(torques) > 0.1)
    check("drive: still enabled, no error", status(drive)[0] & 0x6F == 0x27 and status(drive)[5] == 0)


def stray(master, drive):
    """A target out of reach: following error, fault, an emergency message; reset, and enabled again."""
    import pysoem

    heard = []
    drive.add_emergency_callback(heard.append)
    far = status(drive)[1] + round(1.0 * COUNTS_PER_RAD)
    # The drive's own time for a following error is in milliseconds, however many cycles that are.
    until = time.monotonic() + 2.0
    while time.monotonic() < until:
        command(drive, 0x0F, far)
        exchange(master)
        if status(drive)[0] & 0x4F == 0x08:
            break
    word, code = status(drive)[0], status(drive)[5]
    check(f"drive: following error, then fault (status {word:#06x}, code {code:#06x})", word & 0x204F == 0x2008 and code == 0x8611)
    for _ in range(20):
        try:
            drive.mbx_receive()
        except pysoem.Emergency:
            pass
        exchange(master)
    check("the emergency message is heard", [hex(emergency.error_code) for emergency in heard] == ["0x8611"])
    for control, mask, wanted in ((0x00, 0x4F, 0x08), (0x80, 0x4F, 0x40)):
        for _ in range(10):
            command(drive, control, status(drive)[1])
            exchange(master)
        check(f"drive: control word {control:#04x} leads to {wanted:#04x}", status(drive)[0] & mask == wanted)
    power_up(master, drive)


def to_op(master, drive):
    import pysoem

    # Pulses without outputs until a synchronisation error, each of which counts 3: as many as a machine may stall.
    drive.sdo_write(0x10F1, 2, struct.pack("<H", int(3 * WATCHDOG_S * 1000)))
    master.config_map()
    check("clocks: both devices have one", master.config_dc())
    for slave in master.slaves:
        slave.dc_sync(act=True, sync0_cycle_time=1_000_000)
    drive.set_watchdog("processdata", WATCHDOG_S * 1000)
    check("SAFE-OP", master.state_check(pysoem.SAFEOP_STATE, 500_000) == pysoem.SAFEOP_STATE)
    command(drive, 0, status(drive)[1])
    for _ in range(10):
        exchange(master)
    master.state = pysoem.OP_STATE
    master.write_state()
    for _ in range(500):
        counter = exchange(master)
        if master.state_check(pysoem.OP_STATE, 1000) == pysoem.OP_STATE:
            break
    check("OP with clocks", master.state_check(pysoem.OP_STATE, 50_000) == pysoem.OP_STATE)
    check(f"working counter {counter} of {master.expected_wkc}", counter == master.expected_wkc == 4)


def scan(master):
    """How many devices there are, once the bus is up."""
    for _ in range(50):
        if (devices := master.config_init()) > 0:
            return devices
        time.sleep(0.1)
    return 0


def shows(master, right):
    """Whether the states that the master reads come right: on a busy machine an answer may be late."""
    for _ in range(20):
        master.read_state()
        if right():
            return True
        time.sleep(0.1)
    return False


def emulated(binary, act, *faults):
    """`act` with this master and the software bus, which may have faults to come."""
    import pysoem

    devices = subprocess.Popen([binary, "rig", "emulate", "--interface", DEVICES, *faults])
    try:
        master = pysoem.Master()
        master.open(MASTER)
        check("two devices", scan(master) == 2)
        act(master, *master.slaves)
        master.close()
    finally:
        devices.kill()
        devices.wait()


def whole(master, drive, terminal):
    import pysoem

    check_objects(drive, terminal)
    to_op(master, drive)
    power_up(master, drive)
    move(master, drive, terminal)
    stray(master, drive)
    check("all in OP still", shows(master, lambda: drive.state == terminal.state == pysoem.OP_STATE))
    time.sleep(WATCHDOG_S)
    starved = shows(master, lambda: (drive.state, drive.al_status) == (0x14, 0x1B))
    check("output watchdog: SAFE-OP with error 0x1B", starved)
    check("the terminal, which has no outputs, stays in OP", terminal.state == pysoem.OP_STATE)


def struck(master, drive, terminal):
    """Too much current while the joint moves: this master sees the drive's fault and its code."""
    to_op(master, drive)
    power_up(master, drive)
    begin = status(drive)[1]
    for i in range(2000):
        command(drive, 0x0F, begin + round(i * PERIOD_S * 0.3 * COUNTS_PER_RAD))
        exchange(master)
        if status(drive)[0] & 0x4F == 0x08:
            break
    word, code = status(drive)[0], status(drive)[5]
    check(f"put in: a fault of the drive (status {word:#06x}, code {code:#06x})", word & 0x4F == 0x08 and code == 0x2310)


def answered(source):
    """Whether a frame from a master of this Ethernet address is answered by both devices, and told from what was sent: the first
    device sets the second bit of the sender's address (IEEE 802: locally administered), which a master's own may have as well."""
    wire = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(0x88A4))
    wire.bind((MASTER, 0x88A4))
    wire.settimeout(1.0)
    # Datagram 7 is a broadcast read, here of AL status (0x0130).
    datagram = struct.pack("<BBHHHH2xH", 7, 0x5A, 0, 0x0130, 2, 0, 0)
    wire.send((b"\xff" * 6 + source + b"\x88\xa4" + struct.pack("<H", 0x1000 | len(datagram)) + datagram).ljust(60, b"\0"))
    try:
        reply = wire.recv(1514)
    except TimeoutError:
        return False
    finally:
        wire.close()
    return reply[6:12] == bytes([source[0] | 2]) + source[1:] and reply[17] == 0x5A and struct.unpack_from("<H", reply, 28)[0] == 2


def addresses(master, drive, terminal):
    for source in ("101010101010", "021a2b3c4d5e", "0200000000fe"):
        check(f"a master of the Ethernet address {source} is answered", answered(bytes.fromhex(source)))


def run(binary):
    make_wire()
    emulated(binary, addresses)
    emulated(binary, whole)
    with tempfile.TemporaryDirectory() as scratch:
        report = Path(scratch) / "report.json"
        faults = ["--fault", "drive-fault:0x2310", "--at-rad", "0.1", "--report", str(report)]
        emulated(binary, struck, *faults)
        check("the emulator reports when torque was off", report.exists() and json.loads(report.read_text())["off_ms"] > 0)
    print("all well")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--binary", default="target/release/tautline", help="the program [target/release/tautline]")
    binary = arguments.parse_args().binary
    try:
        import pysoem  # noqa: F401
    except ImportError:
        sys.exit("pysoem is missing; get it by: pip install pysoem")
    if INSIDE not in os.environ:
        enter_namespace()
    run(binary)


if __name__ == "__main__":
    main()
