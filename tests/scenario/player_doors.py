# Who may come in to player-gateway, and what those cost who only stand there: player_doors.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import os
import signal
import struct
import traceback

from player_rig import *

AUTH = 7


def without_zero(value):
    raw = value.encode()
    return struct.pack(">II", len(raw), len(raw)) + raw + b"\0" * (-len(raw) % 4)


# What the function returns (a text) when another account calls it.
def as_stranger(function):
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.setgroups([])
            os.setgid(65534)
            os.setuid(65534)
            os.write(writing, function().encode())
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            os._exit(1)
    os.close(writing)
    with os.fdopen(reading) as file:
        heard = file.read()
    assert os.waitpid(child, 0)[1] == 0, "see above"
    return heard


# Whether a client of another account is told which devices there are.
def listed(port):
    def ask():
        try:
            return "listed" if Client(port).devices() else "nothing"
        except (AssertionError, Closed, ConnectionResetError, BrokenPipeError):
            return "refused"

    return as_stranger(ask)


# Only the account of the gateway (and root) is served, on loopback as everywhere; --open serves everybody, and says so.
def accounts():
    with Rig() as rig:
        rig.sim()
        rig.gateway()
        Client(rig.ports[0]).devices()
        assert "open" not in rig.log(rig.process)
        if os.geteuid() != 0:
            return
        assert listed(rig.ports[0]) == "refused"
        await_("a line", lambda: "rejected: of another account or host" in rig.log(rig.process))
        for _ in range(30):
            assert listed(rig.ports[0]) == "refused"
        assert rig.log(rig.process).count("rejected: of another account") < 25
        Client(rig.ports[0]).devices()
        rig.process.terminate()
        assert rig.process.wait(20) == 0
        rig.gateway("--port", "0", "--open")
        assert "open: every client that reaches 127.0.0.1" in rig.log(rig.process)
        assert listed(rig.ports[0]) == "listed"
        rig.process.terminate()
        assert rig.process.wait(20) == 0
        rig.gateway("--port", "0", "--address", "0.0.0.0")
        assert "listening on 0.0.0.0, but clients of other hosts and accounts are rejected" in rig.log(rig.process)
        assert listed(rig.ports[0]) == "refused"
        Client(rig.ports[0]).devices()


def with_key(port):
    first = Client(port)  # asks for PULL at once, as libplayerc does, and is served
    first.refused(PLAYER, 0, 1)
    first.refused(LASER, 0, 3)
    first.refused(PLAYER, 0, 3, dev_request(LASER, 0, OPEN))
    first.command(POSITION2D, 0, 1, velocity(1, 0, 0))
    first.refused(PLAYER, 0, AUTH, text("salami"))
    first.demand(PLAYER, 0, AUTH, text("sesame"))
    first.devices()
    first.subscribe(LASER)
    first.read_until(LASER)
    second = Client(port)
    for _ in range(2):
        second.refused(PLAYER, 0, AUTH, text("salami"))
    second.send(message(PLAYER, 0, REQ, AUTH, text("salami")))
    try:
        second.next()
        return "an answer to the third key that is wrong"
    except (Closed, ConnectionResetError):
        return "done"


# With a key, others are served when they have sent it; one's own account needs none.
def key():
    with Rig() as rig:
        rig.sim()
        wrong = rig.try_gateway("--port", "0", "--auth", "x" * 33)
        assert wrong.returncode == 2 and "1 to 32 characters" in wrong.stderr, wrong
        rig.process = rig.start(f"{bin_dir}/player-gateway", "--port", "0", RTMSIM_PLAYER_AUTH="sesame")
        rig.ports = await_("ports", lambda: rig.shown(2))
        assert "send the key" in rig.log(rig.process) and "sesame" not in rig.log(rig.process)
        own = Client(rig.ports[0])
        own.devices()
        own.demand(PLAYER, 0, AUTH, text("sesame"))
        own.demand(PLAYER, 0, AUTH, without_zero("sesame"))
        for _ in range(5):
            own.refused(PLAYER, 0, AUTH, text("salami"))
        own.devices()
        if os.geteuid() != 0:
            return
        assert as_stranger(lambda: with_key(rig.ports[0])) == "done"
        assert "three keys that are wrong" in rig.log(rig.process)


# The table of descriptors is raised, and who has asked for nothing is sent away after five seconds.
def silent():
    with Rig() as rig:
        rig.sim()
        rig.process = rig.start("sh", "-c", f"ulimit -S -n 64; exec {bin_dir}/player-gateway --port 0")
        rig.ports = await_("ports", lambda: rig.shown(2))
        good = Client(rig.ports[0])
        good.subscribe(LASER)
        idle = Client(rig.ports[0])  # has asked once, and may be silent
        wires = [Wire(rig.ports[0]) for _ in range(200)]
        cut = Wire(rig.ports[0])
        cut.send(header(PLAYER, 0, REQ, 5, 4)[:20])
        good.read_until(LASER)
        for wire in (*wires, cut):
            try:
                wire.next()
                raise AssertionError("an answer to nothing")
            except (Closed, ConnectionResetError):
                pass
        assert "has sent no whole request in 5 s" in rig.log(rig.process)
        idle.devices()
        good.read_until(LASER)


# No room: who has asked for nothing gives way, who is connected is served, and nothing spins.
def exhausted():
    with Rig() as rig:
        rig.sim()
        rig.process = rig.start("sh", "-c", f"ulimit -n 64; exec {bin_dir}/player-gateway --port 0")
        rig.ports = await_("ports", lambda: rig.shown(2))
        good = Client(rig.ports[0])
        good.subscribe(LASER)
        others = [Wire(rig.ports[0], banner=False) for _ in range(80)]
        for _ in range(5):
            Client(rig.ports[0]).close()
            good.read_until(LASER)
        good.subscribe(SONAR)  # there are descriptors left for ifaces
        good.read_until(SONAR)
        # All that there is room for, and each has asked: the next is refused, and told about in the log.
        clients, refused = [], 0
        while refused < 10 and len(clients) < 64:
            try:
                clients.append(Client(rig.ports[0]))
            except (AssertionError, Closed, ConnectionResetError):
                refused += 1
        assert 20 <= len(clients) <= 40 and refused == 10, (len(clients), refused)
        await_("a line", lambda: "rejected: too many clients" in rig.log(rig.process))
        assert rig.log(rig.process).count("rejected: too many clients") < 10
        good.read_until(LASER)
        for one in (*clients, *others):
            one.close()

        def connects():
            try:
                Client(rig.ports[0]).close()
                return True
            except (TimeoutError, AssertionError, Closed, ConnectionResetError):
                return False

        await_("a new client", connects)


# With however few descriptors it ends with one line or when it is told to, never deaf.
def few_descriptors():
    with Rig() as rig:
        rig.sim()
        for count in (*range(4, 16), 24, 31, 32, 33, 40):
            process = rig.start("sh", "-c", f"ulimit -n {count}; exec {bin_dir}/player-gateway --port 0")
            await_(f"a gateway with {count} descriptors", lambda: process.poll() is not None or "port " in rig.log(process))
            process.send_signal(signal.SIGTERM)
            code, lines = process.wait(20), rig.log(process).splitlines()
            if count < 32:
                assert code in (1, 127) and len(lines) == 1 and (f"{count} may be open" in lines[0] or code == 127), (count, code, lines)
            else:
                assert code == 0, (count, code, lines)


run(accounts, key, silent, exhausted, few_descriptors)
