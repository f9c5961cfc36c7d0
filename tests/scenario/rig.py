# A system in real time, with a robot of the obstacle course in it: what the scenarios of whole systems, of interface components and of the editor share.
import json

from system import System, await_, watchdog


class Rig(System):
    def __init__(self, bin_dir, lib_dir, source):
        super().__init__(bin_dir, lib_dir)
        self.source = source

    def path(self, name):
        return f"{self.work}/{name}"

    def server(self, *options, world=None, server_id=None):
        return super().server(world or f"{self.source}/worlds/obstacle_course.sdf", *options, server_id=server_id)

    # The component with the server id of this run.
    def device(self, component, *more):
        return f"{component}?" + "&".join([f"conf.default.server_id={self.server_id}", *more])

    # Components register again soon when a naming service was restarted.
    def host(self, *components, options=()):
        return self.rtcd("-o", "naming.update.interval:1", *options, *components, cwd=self.work)

    # As a program: the case that it was called with.
    def run_case(self, case, cases):
        with self:
            cases[case]()
        print("ok")

    def there(self, *components):
        self.rtse("wait", *components, "--state", "any", "--timeout", str(watchdog))

    def state(self, component):
        return json.loads(self.rtse("--json", "cat", component))["state"]

    def robot(self, iface="pioneer2dx::position2d", server_id=None):
        return json.loads(self.simctl("--json", "echo", iface, "-n", "1", server_id=server_id))

    def speed(self, iface="pioneer2dx::position2d", server_id=None):
        return self.robot(iface, server_id)["velocity"][0]

    def driving(self, what, iface="pioneer2dx::position2d", server_id=None):
        await_(what, lambda: self.speed(iface, server_id) > 0.1)

    def standing(self, what, iface="pioneer2dx::position2d", server_id=None):
        await_(what, lambda: abs(self.speed(iface, server_id)) < 0.01 and not self.robot(iface, server_id)["commanded"])
