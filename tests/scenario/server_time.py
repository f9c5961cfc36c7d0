# Simulated time as clients of sim-server see it, one case per run: server_time.py CASE BIN_DIR SOURCE_DIR.
import json
import select
import signal
import subprocess

from server_rig import *


# A drive ends with the step that its time ends in, however fast the simulator is and however late the client looks.
def drives_for_simulated_seconds():
    ways = {}
    for rtf in ("0", "20", "0"):
        process = started("--rtf", rtf)
        for _ in range(2):
            ok("reset")
            start = position(robot)
            ok("velocity", f"{robot}::position2d", "0.3", "0", "0", "--for", "0.5")
            await_("a robot that stands", lambda: max(abs(v) for v in read("velocity", robot)["linear"]) < 1e-4)
            ways.setdefault(rtf, []).append([round(b - a, 6) for a, b in zip(start, position(robot), strict=True)])
        stop(process)
    distances = [(way[0] ** 2 + way[1] ** 2) ** 0.5 for all_of_one in ways.values() for way in all_of_one]
    assert 0.1 < distances[0] < 0.3, ways
    assert max(distances) - min(distances) < 1e-3, f"0.5 s of 0.3 m/s are as many ways: {ways}"


# The simulator ends the command itself: the client is stopped as soon as the robot moves and could not.
def a_stopped_client_drives_no_further():
    process = started("-u")
    drive = client("velocity", f"{robot}::position2d", "0.3", "0", "0", "--for", "0.2")

    def is_commanded():
        ok("step", "10")
        return read("echo", f"{robot}::position2d", "-n", "1")["commanded"]

    await_("a drive", is_commanded)
    drive.send_signal(signal.SIGSTOP)
    ok("step", "200")
    assert not read("echo", f"{robot}::position2d", "-n", "1")["commanded"], "a drive of 0.2 s goes on for longer"
    drive.send_signal(signal.SIGCONT)
    assert drive.wait(watchdog) == 0
    stop(process)


def pushes_for_simulated_seconds():
    process = started("--rtf", "20")
    box = ("<sdf version='1.9'><model name='crate'><link name='l'><inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"
           "<gravity>0</gravity></link></model></sdf>")
    ok("pause")
    ok("spawn", box, "--name", "crate", "--pose", "0", "0", "50", "0")
    ok("run")
    for number in range(1, 3):
        ok("wrench", "crate", "0.4", "0", "0", "--for", "10")
        near(read("velocity", "crate")["linear"], (number * 0.4 / 2 * 10, 0, 0), 1e-6)  # the command has ended, so the push has
    ok("pause")
    ok("wrench", "crate", "4", "0", "0", "--for", "1000")  # while time stands still it returns at once
    stop(process)


# Who subscribes while time stands still is shown the present; after that samples come at their own times.
def the_schedule_stays():
    process = started("-u")
    ok("step", "1234")
    echo = subprocess.Popen([f"{bin_dir}/simctl", "-s", server_id, "--json", "echo", f"{robot}::laser", "-n", "3"], stdout=subprocess.PIPE, text=True)
    running.append(echo)
    times = [json.loads(echo.stdout.readline())["stamp"]["sim_time"]]
    ok("step", "300")
    times += [json.loads(line)["stamp"]["sim_time"] for line in echo.communicate(timeout=watchdog)[0].splitlines()]
    near(times, (1.234, 1.3, 1.4), 1e-9)
    stop(process)


# As many samples as the simulator makes in a time in which nobody reads are printed afterwards, as long as the shared memory has them.
def echoes_every_sample():
    process = started("-u")
    echo = subprocess.Popen([f"{bin_dir}/simctl", "-s", server_id, "--json", "echo", f"{robot}::position2d", "-n", "21"], stdout=subprocess.PIPE, text=True)
    running.append(echo)
    first = json.loads(echo.stdout.readline())["stamp"]["sequence"]
    for _ in range(2):
        echo.send_signal(signal.SIGSTOP)
        ok("step", "200")  # ten samples of a drive
        echo.send_signal(signal.SIGCONT)
        await_("samples", lambda: bool(select.select([echo.stdout], [], [], 0)[0]))
    numbers = [json.loads(line)["stamp"]["sequence"] for line in echo.communicate(timeout=watchdog)[0].splitlines()]
    assert numbers == list(range(first + 1, first + 21)), numbers
    # What nobody could read in time is said.
    late = subprocess.Popen([f"{bin_dir}/simctl", "-s", server_id, "--json", "echo", f"{robot}::position2d", "-n", "3"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    running.append(late)
    late.stdout.readline()
    late.send_signal(signal.SIGSTOP)
    ok("step", "20000")
    late.send_signal(signal.SIGCONT)
    said = late.communicate(timeout=watchdog)[1]
    assert said.startswith(f"simctl: warning: iface {robot}::position2d: 9") and "were overwritten" in said, said
    stop(process)


run(drives_for_simulated_seconds, a_stopped_client_drives_no_further, pushes_for_simulated_seconds, the_schedule_stays, echoes_every_sample)
