# rtm-studio and its viewers: what the scenarios of the studio share. The words of the program are CASE BIN_DIR LIB_DIR SOURCE_DIR.
import struct
import sys

from rig import Rig, await_
from web_peer import Socket, request

case, *folders = sys.argv[1:]
rig = Rig(*folders)


class Studio:
    def __init__(self, *options, **environment):
        self.process = rig.start(f"{rig.bin_dir}/rtm-studio", "--ns", rig.names, "-s", rig.server_id, "--port", "0", *options, **environment)
        await_("the URL, or an end", lambda: rig.log(self.process).startswith("http") or self.process.poll() is not None)
        assert self.process.poll() is None, (self.process.args, self.process.returncode, rig.log(self.process))
        url = rig.log(self.process).splitlines()[0]
        self.token = url.split("token=")[1]
        self.port = int(url.split(":")[2].split("/")[0])

    def viewer(self, **more):
        socket = Socket(self.port, self.token, **more)
        assert socket.status == 101, socket.head
        return socket

    # With the token, if nothing else is said.
    def get(self, target="/", token=None, **more):
        return request(self.port, target, token=self.token if token is None else token, **more)

    def lives(self):
        assert self.process.poll() is None, self.process.returncode
        viewer = self.viewer()
        viewer.event("hello")
        viewer.close()


def poses_in(frame):
    count = struct.unpack_from("<I", frame, 16)[0]
    return {struct.unpack_from("<I", frame, 24 + 24 * i)[0]: struct.unpack_from("<fff", frame, 28 + 24 * i) for i in range(count)}


def is_poses(message):
    return isinstance(message, bytes) and message[0] == 0x81
