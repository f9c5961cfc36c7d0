# A user's first drive: real time, ordinary execution contexts, wired by hand. The commander of the robot is killed: the robot stops. It is started again, wired
# again by the saved file, and the robot drives on, in the same world.
import sys

from rig import Rig, await_

with Rig(*sys.argv[1:]) as rig:
    rig.server()
    rig.naming()
    rig.host(rig.device("RTCLaser"), "LaserObstacleAvoid")
    driver = rig.host(rig.device("RTCPosition2d"))
    components = ("RTCLaser0", "LaserObstacleAvoid0", "RTCPosition2d0")
    rig.there(*components)
    rig.rtse("con", "RTCLaser0:range", "LaserObstacleAvoid0:range")
    rig.rtse("con", "LaserObstacleAvoid0:velocity", "RTCPosition2d0:velocity")
    rig.rtse("act", *components)
    rig.driving("a driving robot")
    saved = rig.path("system.xml")
    rig.rtse("save", saved)
    rig.rtse("check", saved, "--state", "Active")

    rig.kill(driver)
    rig.standing("a robot without commander that stands")

    rig.host(rig.device("RTCPosition2d"))
    await_("the component again", lambda: rig.rtse("cat", "RTCPosition2d0"))
    await_("the connections again", lambda: rig.rtse("load", saved) is not None)
    rig.rtse("start", saved)
    rig.driving("a robot that drives again")
print("ok")
