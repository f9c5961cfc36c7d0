# Ids of simulators for tests that run side by side: a socket that stays bound says that an id is taken. `rtse run` takes its own from 5000 on.
import os
import socket

claims = []  # until the process ends


# The first of `count` ids in a row that are nobody else's, as a word for a command line.
def claim(count=1):
    begin = 1000 + os.getpid() * 3 % 3900
    for server_id in list(range(begin, 4990)) + list(range(1000, begin)):
        sockets = []
        try:
            for k in range(count):
                sockets.append(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
                sockets[-1].bind(("127.0.0.1", 10000 + server_id + k))
        except OSError:
            for bound in sockets:
                bound.close()
            continue
        claims.extend(sockets)
        return str(server_id)
    raise RuntimeError("no server id is free")
