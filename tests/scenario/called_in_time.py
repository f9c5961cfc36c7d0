# Components of ours whose contexts are of other processes (`rtse join`), in lock step: called_in_time.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import sys

from foreign_members import Mixed, relay

case, bin_dir, lib_dir, source = sys.argv[1:]
empty = f"{source}/worlds/empty.sdf"


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


if __name__ == "__main__":
    globals()[case]()
