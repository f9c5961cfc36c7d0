# Components of ours whose contexts are of other processes (`rtse join`), in lock step: called_in_time.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
from foreign_rig import Mixed, bin_dir, case, empty, lib_dir, relay, source


def knows_the_time():
    # Components of ours that other processes call, as members or by tick(), are in the time of who calls: stamps show it. So nothing in them waits by the clock on the wall.
    for joining, context in ([], "PeriodicExecutionContext"), (["--tick"], "SynchExtTriggerEC"), (["--tick"], "LogicalTimeTriggeredEC"):
        with Mixed(bin_dir, lib_dir) as s:
            s.naming()
            s.server(empty, "--lockstep", "--paused", "--rtf", "0")
            s.rtcd("-o", f"exec_cxt.periodic.type:{context}", relay("Called", **{"conf.default.source": 1, "conf.default.journal": f"{s.work}/Called.txt"}))
            s.rtse("wait", "Called", "--state", "any", "--timeout", "60")
            s.rtse("join", "Called", *joining, "--rate", "100", "--server-id", s.server_id)
            s.rtse("act", "Called")
            s.until("a participant", lambda: len(s.participants()) == 1)
            s.simctl("step", "1000")
            seen = s.values("Called")
            assert seen[-101:] == [(round(n / 100, 9), seen[-1][1] - 100 + n) for n in range(101)], (context, seen)


def velocity_before_a_reset():
    # What was sent to a drive before a reset moves nothing after it: neither where the drive's context is of another process, nor where the robot has been told at once.
    for is_joined in (True, False):
        with Mixed(bin_dir, lib_dir) as s:
            s.naming()
            s.server(f"{source}/worlds/obstacle_course.sdf", *["--lockstep"] * is_joined, "--paused", "--rtf", "0")
            s.rtcd("RTCPosition2d?conf.default.device_id=pioneer2dx::position2d")
            s.rtse("wait", "RTCPosition2d0", "--state", "any", "--timeout", "60")
            if is_joined:
                s.rtse("join", "RTCPosition2d0", "--phase", "2", "--rate", "10", "--server-id", s.server_id)
            s.rtse("act", "RTCPosition2d0")
            s.simctl("step", "150")

            def pose():
                return [round(float(word), 3) for word in s.simctl("pose", "pioneer2dx").split()[:2]]

            def send():
                s.rtse("inject", "RTCPosition2d0:velocity", '{"data":{"vx":0.2,"vy":0,"va":0}}')
            start = pose()
            send()
            s.simctl("reset")
            s.simctl("step", "500")
            assert pose() == start, (is_joined, start, pose())
            s.simctl("reset")
            send()
            s.simctl("step", "500")
            assert pose() != start, (is_joined, start, pose())


if __name__ == "__main__":
    globals()[case]()
