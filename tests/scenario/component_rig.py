# Components and what they send: what the scenarios of interface components share. The words of the program are CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import sys

from rig import Rig

case, *folders = sys.argv[1:]
rig = Rig(*folders)
device = rig.device


def sample(port):
    return json.loads(rig.rtse("--json", "print", port, "-n", "1", "-t", "60"))["value"]


def truth(iface):
    return json.loads(rig.simctl("--json", "echo", iface, "-n", "1"))


def close(got, wanted, tolerance):
    assert len(got) == len(wanted) and all(abs(a - b) <= tolerance for a, b in zip(got, wanted)), f"expected {wanted}, got {got}"


# The probe calls a service; it goes to the error state at another answer than it expects.
def call(what):
    rig.rtse("conf", "DeviceProbe0", "set", "call", what)
    rig.rtse("act", "DeviceProbe0")
    assert rig.state("DeviceProbe0") == "Active", rig.log(rig.running[-1])
    rig.rtse("deact", "DeviceProbe0")
