# Services in the forms of both kinds of client: ros2_services.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import math
import re

from ros2_rig import *

SIMULATION = "simulation_interfaces"


def caller(peer, name):
    front = f"{SIMULATION}::srv::dds_::{name}"
    snake = "".join("_" + c.lower() if c.isupper() else c for c in name).lstrip("_")
    return CycloneClient(peer, "/" + snake, front + "_Request_", front + "_Response_")


def ask(client, kind, value, reply_kind="ResultResponse"):
    reply = client.call(f"{SIMULATION}/{kind}", value, f"{SIMULATION}/{reply_kind}")
    return reply["result"] if reply_kind == "ResultResponse" else reply


# Services in the forms of both kinds of client, alone and side by side.
def services():
    with Rig() as rig:
        rig.sim(two, "--paused")
        rig.gateway("--distro", "jazzy", robots=2)
        peer = rig.peer()
        names = CycloneClient(peer, "/leader/robot/list_parameters", "rcl_interfaces::srv::dds_::ListParameters_Request_", "rcl_interfaces::srv::dds_::ListParameters_Response_")
        listed = names.call("rcl_interfaces/ListParametersRequest", {"prefixes": [], "depth": 0}, "rcl_interfaces/ListParametersResponse")
        assert listed["names"] == ["use_sim_time"], listed

        def fast(service, front, kind, value, reply_kind):
            words = rig.call(f"{bin_dir}/ros2_fast_client", rig.domain, service, front + "_Request_", front + "_Response_", wire.encode(kind, value).hex())
            return wire.decode(reply_kind, bytes.fromhex(words.strip()))

        front = "rcl_interfaces::srv::dds_::"
        assert fast("/leader/robot/list_parameters", front + "ListParameters", "rcl_interfaces/ListParametersRequest", {"prefixes": [], "depth": 0},
                    "rcl_interfaces/ListParametersResponse")["names"] == ["use_sim_time"]
        values = fast("/ros2_gateway/get_parameters", front + "GetParameters", "rcl_interfaces/GetParametersRequest", {"names": ["use_sim_time", "other"]},
                      "rcl_interfaces/GetParametersResponse")["values"]
        assert [(one["type"], one["bool_value"]) for one in values] == [(1, True), (0, False)], values
        # The reply for the client of Fast DDS did not come to that of Cyclone.
        assert len(peer.samples[names.replies]) == 1

        state = caller(peer, "GetSimulationState")
        empty = {"structure_needs_at_least_one_member": 0}

        def current():
            reply = state.call("std_srvs/Empty", empty, "simulation_interfaces/GetSimulationStateResponse")
            assert reply["result"]["result"] == 1
            return reply["state"]

        assert current() == 0
        step = caller(peer, "StepSimulation")
        assert ask(step, "StepSimulationRequest", {"steps": 100})["result"] == 1
        assert rig.stats()["steps"] == 100 and current() == 2
        change = caller(peer, "SetSimulationState")
        assert ask(change, "SetSimulationStateRequest", {"state": 1})["result"] == 1 and current() == 1
        assert ask(change, "SetSimulationStateRequest", {"state": 1})["result"] == 101
        assert ask(change, "SetSimulationStateRequest", {"state": 3})["result"] == 0
        refused = ask(step, "StepSimulationRequest", {"steps": 1})
        assert refused["result"] == 4 and "pause it first" in refused["error_message"], refused
        assert ask(change, "SetSimulationStateRequest", {"state": 0})["result"] == 1 and current() == 0
        assert ask(change, "SetSimulationStateRequest", {"state": 2})["result"] == 103 and current() == 0
        # What takes long does not keep others waiting, and can be ended.
        long = step.start("simulation_interfaces/StepSimulationRequest", {"steps": 10**9})
        await_("the steps", lambda: rig.stats()["steps"] > 0)
        assert ask(change, "SetSimulationStateRequest", {"state": 2})["result"] == 1 and current() == 2
        step.reply(long, "simulation_interfaces/ResultResponse")


# Entities: filters, names, models as text and from the path, poses and velocities, resets.
def entities():
    with Rig() as rig:
        rig.sim(two, "--paused")
        rig.gateway("--distro", "jazzy", robots=2)
        peer = rig.peer()
        listing = caller(peer, "GetEntities")
        unfiltered = {"categories": b"", "tags": [], "filter_mode": 0, "bounds": {"type": 0, "points": []}}
        # Patterns that would take all memory, or for ever.
        for hostile in ("a{1,255}{1,255}{1,255}", "(a{1000}){1000}", "(a*)*\\1", "x" * 201, "["):
            refused = listing.call("simulation_interfaces/GetEntitiesRequest", {"filter": hostile, **unfiltered}, "simulation_interfaces/GetEntitiesResponse")["result"]
            assert refused["result"] == 4 and hostile[:20] in refused["error_message"], refused
        found = listing.call("simulation_interfaces/GetEntitiesRequest", {"filter": "^(lead|foll)", **unfiltered}, "simulation_interfaces/GetEntitiesResponse")
        assert sorted(found["entities"]) == ["follower", "leader"], found
        pose = caller(peer, "GetEntityState")
        where = pose.call("simulation_interfaces/EntityRequest", {"entity": "leader"}, "simulation_interfaces/GetEntityStateResponse")
        assert where["result"]["result"] == 1 and abs(where["state"]["pose"]["position"]["x"] + 3.2) < 1e-3, where
        assert pose.call("simulation_interfaces/EntityRequest", {"entity": "nobody"}, "simulation_interfaces/GetEntityStateResponse")["result"]["result"] == 2
        spawn = caller(peer, "SpawnEntity")
        sdf = '<sdf version="1.9"><model name="box"><link name="l"><inertial><mass>1</mass></inertial><collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link></model></sdf>'
        place = {"header": where["state"]["header"], "pose": {"position": {"x": 2.0, "y": 2.0, "z": 0.5}, "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}}
        place["header"]["frame_id"] = ""
        request = {"name": "crate", "allow_renaming": False, "uri": "", "resource_string": sdf, "entity_namespace": "", "initial_pose": place}

        def spawned(**more):
            reply = spawn.call("simulation_interfaces/SpawnEntityRequest", {**request, **more}, "simulation_interfaces/SpawnEntityResponse")
            return reply["result"]["result"], reply["entity_name"]

        assert spawned() == (1, "crate")
        assert spawned() == (101, "") and spawned(allow_renaming=True) == (1, "crate_1")
        assert spawned(name="x", resource_string="<sdf")[0] == 106 and spawned(name="x", resource_string="")[0] == 104
        # Names that the model would not have; huge texts come back shortened.
        for name in ("", "a::b", "world", "a\nb", "n" * 100000):
            assert spawned(name=name) == (102, ""), name
        assert spawned(name="", allow_renaming=True)[0] == 1
        assert spawned(name="x", resource_string="<mujoco/>")[0] == 103 and spawned(name="x", resource_string="nonsense")[0] == 106
        urdf = '<?xml version="1.0"?><robot name="r"><link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
        assert spawned(name="of_urdf", resource_string=urdf) == (1, "of_urdf")
        for x in (math.nan, math.inf, 1e300):
            far = {**place, "pose": {**place["pose"], "position": {"x": x, "y": 0.0, "z": 0.0}}}
            assert spawned(name="x", initial_pose=far)[0] == 109, x
        lost = pose.call("simulation_interfaces/EntityRequest", {"entity": "n" * 100000}, "simulation_interfaces/GetEntityStateResponse")["result"]
        assert lost["result"] == 2 and len(lost["error_message"]) < 600, len(lost["error_message"])
        spawnables = caller(peer, "GetSpawnables")
        listed = spawnables.call("simulation_interfaces/GetSpawnablesRequest", {"sources": []}, "simulation_interfaces/GetSpawnablesResponse")
        assert listed["result"]["result"] == 1 and listed["spawnables"], listed
        # A client of 2.x has the same request and another reply: told apart by the hash of the reply.
        front = "simulation_interfaces::srv::dds_::GetSpawnables_"
        newer = CycloneClient(peer, "/get_spawnables", front + "Request_", front + "Response_", "typehash=RIHS01_cb61fd741c429d6bc689514b7bfc65bb1518126961317acc6e414a841dc43daa;")
        again = newer.call("simulation_interfaces/GetSpawnablesRequest", {"sources": []}, "simulation_interfaces/GetSpawnablesResponse2")
        assert [one["entity_resource"]["uri"] for one in again["spawnables"]] == [one["uri"] for one in listed["spawnables"]], again
        other = spawnables.call("simulation_interfaces/GetSpawnablesRequest", {"sources": ["https://"]}, "simulation_interfaces/GetSpawnablesResponse")
        assert other["result"]["result"] == 0, other
        assert spawned(name="from_path", resource_string="", uri=listed["spawnables"][0]["uri"])[0] in (1, 106)
        delete = caller(peer, "DeleteEntity")
        assert ask(delete, "EntityRequest", {"entity": "crate"})["result"] == 1
        assert ask(delete, "EntityRequest", {"entity": "crate"})["result"] == 2
        # A text beside a uri is ignored. A uri of nothing is no file that cannot be read.
        assert spawned(name="x", uri="model://there_is_none")[0] == 2
        info = caller(peer, "GetEntityInfo")
        assert [ask(info, "EntityRequest", {"entity": name}, "GetEntityInfoResponse")["category"] for name in ("leader", "crate_1", "wall_north")] == [1, 4, 5]
        assert ask(info, "EntityRequest", {"entity": "nobody"}, "GetEntityInfoResponse")["result"]["result"] == 2
        robots = listing.call("simulation_interfaces/GetEntitiesRequest", {"filter": "", **unfiltered, "categories": b"\1"}, "simulation_interfaces/GetEntitiesResponse")
        assert sorted(robots["entities"]) == ["follower", "leader"], robots
        several = caller(peer, "SpawnEntities")
        ones = [{"name": name, "allow_renaming": False, "entity_resource": {"uri": "", "resource_string": sdf}, "entity_namespace": "", "initial_pose": place}
                for name in ("one", "one", "two")]
        made = ask(several, "SpawnEntitiesRequest", {"spawn_requests": ones}, "SpawnEntitiesResponse")
        assert [(one["result"]["result"], one["entity_name"]) for one in made["results"]] == [(1, "one"), (101, ""), (1, "two")], made
        assert made["result"]["result"] == 150 and made["result"]["error_message"].startswith("spawn_requests[1]: "), made
        assert ask(several, "SpawnEntitiesRequest", {"spawn_requests": []}, "SpawnEntitiesResponse")["result"]["result"] == 1
        states = caller(peer, "GetEntitiesStates")
        both = ask(states, "GetEntitiesRequest", {"filter": "^(leader|follower)$", **unfiltered}, "GetEntitiesStatesResponse")
        assert sorted(both["entities"]) == ["follower", "leader"] and both["result"]["result"] == 1, both
        assert abs(both["states"][both["entities"].index("leader")]["pose"]["position"]["x"] + 3.2) < 1e-3, both
        nobody = ask(states, "GetEntitiesRequest", {"filter": "^nobody$", **unfiltered}, "GetEntitiesStatesResponse")
        assert nobody["result"]["result"] == 1 and not nobody["entities"] and not nobody["states"], nobody
        for part in ({"tags": ["a"]}, {"bounds": {"type": 2, "points": [ZERO] * 3}}):
            refused = ask(states, "GetEntitiesRequest", {"filter": "", **unfiltered, **part}, "GetEntitiesStatesResponse")["result"]
            assert refused["result"] == 0, (part, refused)


# Around what collides: in the frame of the entity; as a filter, in the world.
def bounds():
    def model(name, pose, shape, more=""):
        collision = f"<collision name='c'><geometry>{shape}</geometry></collision>" if shape else ""
        return f"<model name='{name}'>{more}<pose>{pose}</pose><link name='l'><inertial><mass>1</mass></inertial>{collision}</link></model>"

    plank = model("plank", "5 0 1 0 0 0.785398163", "<box><size>2 1 0.5</size></box>")
    rest = (model("ball", "0 0 3 0 0 0", "<sphere><radius>0.5</radius></sphere>") + model("bare", "0 9 9 0 0 0", "") +
            model("ground", "0 0 0 0 0 0", "<plane><normal>0 0 1</normal></plane>", "<static>true</static>"))
    with Rig() as rig:
        rig.sim(f"<sdf version='1.9'><world name='w'>{plank}{rest}</world></sdf>", "--paused")
        rig.gateway("--distro", "jazzy", robots=0)
        peer = rig.peer()
        of_entity, listing = caller(peer, "GetEntityBounds"), caller(peer, "GetEntities")

        def around(entity):
            reply = ask(of_entity, "EntityRequest", {"entity": entity}, "GetEntityBoundsResponse")
            return reply["result"]["result"], reply["bounds"]["type"], [[round(point[axis], 6) for axis in "xyz"] for point in reply["bounds"]["points"]]

        assert around("plank") == (1, 1, [[1, 0.5, 0.25], [-1, -0.5, -0.25]]), around("plank")
        assert around("bare") == (1, 1, [[0, 0, 0], [0, 0, 0]]), around("bare")
        assert around("ground") == (1, 0, []), around("ground")
        assert around("nobody") == (2, 0, []) and around("") == (2, 0, [])

        def within(kind, *points):
            request = {"filter": "", "categories": b"", "tags": [], "filter_mode": 0, "bounds": {"type": kind, "points": [dict(zip("xyz", map(float, one))) for one in points]}}
            reply = ask(listing, "GetEntitiesRequest", request, "GetEntitiesResponse")
            return sorted(reply["entities"]) if reply["result"]["result"] == 1 else reply["result"]["result"]

        # A corner of the plank's box along the axes of the world is free; its own corner is not.
        assert within(3, (5.9, 0.9, 1), (0.2, 0, 0)) == [] and within(3, (5.3, 1, 1), (0.2, 0, 0)) == ["plank"]
        assert within(1, (6, 1, 1.1), (5.8, 0.8, 0.9)) == [] and within(1, (5.5, 0.9, 1.1), (5.2, 0.8, 0.9)) == ["plank"]
        assert within(1, (9, 9, 9), (-9, -9, -9)) == ["ball", "bare", "ground", "plank"]
        assert within(3, (0, 0, 3), (0.1, 0, 0)) == ["ball"] and within(3, (700, 0, -50), (1, 0, 0)) == ["ground"]
        assert within(0) == ["ball", "bare", "ground", "plank"]
        assert within(2, (0, 0, 0), (1, 0, 0), (0, 1, 0)) == 0 and within(9) == 0
        for wrong in ((3, (0, 0, 0)), (3, (0, 0, 0), (-1, 0, 0)), (3, (math.nan, 0, 0), (1, 0, 0)), (3, (0, 0, 0), (math.inf, 0, 0)), (1, (0, 0, 0), (1, 1, 1))):
            assert within(*wrong) == 4, wrong


# The action: feedback, results, and what cannot be executed.
def action():
    front = "simulation_interfaces::action::dds_::SimulateSteps_"
    with Rig() as rig:
        rig.sim(two, "--paused")
        rig.gateway("--distro", "jazzy", robots=2)
        peer = rig.peer()
        of_features = {one: caller(peer, one) for one in ("GetSimulatorFeatures", "SetSimulationState", "ResetSimulation")}
        features = of_features["GetSimulatorFeatures"].call("std_srvs/Empty", {"structure_needs_at_least_one_member": 0}, "simulation_interfaces/GetSimulatorFeaturesResponse")
        assert 33 in features["features"], features
        place = "/simulate_steps/_action/"
        send, result = (CycloneClient(peer, place + name, f"{front}{kind}_Request_", f"{front}{kind}_Response_") for name, kind in (("send_goal", "SendGoal"), ("get_result", "GetResult")))
        stop = CycloneClient(peer, place + "cancel_goal", "action_msgs::srv::dds_::CancelGoal_Request_", "action_msgs::srv::dds_::CancelGoal_Response_")
        peer.subscribe(place + "feedback", "simulation_interfaces/action/SimulateSteps_FeedbackMessage")
        peer.subscribe(place + "status", "action_msgs/GoalStatusArray", durability="transient")
        peer.await_matched(place + "feedback")
        peer.await_matched(place + "status")
        now = {"sec": 0, "nanosec": 0}

        def start(number, steps):
            reply = send.call("simulation_interfaces/SendGoalRequest", {"goal_id": bytes([number]) * 16, "steps": steps}, "simulation_interfaces/SendGoalResponse")
            return reply["accepted"]

        def outcome(number):
            reply = ask(result, "GetResultRequest", {"goal_id": bytes([number]) * 16}, "GetResultResponse")
            return reply["status"], reply["result"]["result"], reply["result"]["error_message"]

        def cancel(number, stamp=now):
            goal = {"goal_id": bytes([number]) * 16, "stamp": stamp}
            reply = stop.call("action_msgs/CancelGoalRequest", {"goal_info": goal}, "action_msgs/CancelGoalResponse")
            return reply["return_code"], [one["goal_id"][0] for one in reply["goals_canceling"]]

        def told(number):
            messages = peer.messages(place + "feedback", "simulation_interfaces/action/SimulateSteps_FeedbackMessage")
            return [(one["completed_steps"], one["remaining_steps"]) for one in messages if one["goal_id"][0] == number]

        def status(number, wanted):
            peer.message(place + "status", "action_msgs/GoalStatusArray", lambda m: any((one["goal_info"]["goal_id"][0], one["status"]) == (number, wanted) for one in m["status_list"]))

        assert start(1, 100) and outcome(1) == (4, 1, "") and rig.stats()["steps"] == 100
        await_("feedback", lambda: told(1)[-1:] == [(100, 0)])
        status(1, 4)
        assert not start(1, 1), "an id is used once"
        assert cancel(1) == (3, []) and cancel(9) == (2, []) and cancel(0) == (0, [])
        assert outcome(9) == (0, 0, "")
        assert start(2, 0) and outcome(2)[:2] == (6, 4) and "from 1 to 1000000000" in outcome(2)[2]
        # A long one: feedback on its way; another one beside it is aborted; by its name, or all, it is canceled.
        for number, name in ((3, 3), (4, 0)):
            assert start(number, 10**9)
            status(number, 2)
            await_("feedback on the way", lambda: len(told(number)) > 1)
            assert start(number + 10, 1) and outcome(number + 10) == (6, 4, "another goal is executed")
            waiting = result.start("simulation_interfaces/GetResultRequest", {"goal_id": bytes([number]) * 16})
            assert cancel(name) == (0, [number])
            reply = result.reply(waiting, "simulation_interfaces/GetResultResponse")
            assert reply["status"] == 5 and re.match(r"canceled: \d+ of 1000000000 steps were made", reply["result"]["error_message"]), reply
            assert rig.stats()["paused"]
            before = told(number)
            assert all(done + left == 10**9 for done, left in before) and before == sorted(before), before
        assert start(5, 10**9)
        await_("feedback on the way", lambda: told(5))
        assert ask(of_features["ResetSimulation"], "ResetSimulationRequest", {"scope": 0})["result"] == 1
        assert outcome(5)[:2] == (6, 4), outcome(5)
        assert ask(of_features["SetSimulationState"], "SetSimulationStateRequest", {"state": 1})["result"] == 1
        assert start(6, 1) and outcome(6) == (6, 4, "the simulation runs; pause it first")


ZERO = {"x": 0.0, "y": 0.0, "z": 0.0}
UPRIGHT = {**ZERO, "w": 1.0}


def entity_state(x=0.0, speed=0.0, frame=""):
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": frame}
    pose = {"position": {**ZERO, "x": x, "z": 5.0}, "orientation": UPRIGHT}
    return {"header": header, "pose": pose, "twist": {"linear": {**ZERO, "x": speed}, "angular": ZERO}, "acceleration": {"linear": ZERO, "angular": ZERO}}


# What a client of 1.x sets, and what one of 2.x chooses; what each scope of a reset leaves.
def states():
    ball = '<sdf version="1.9"><model name="ball"><link name="l"><gravity>0</gravity><inertial><mass>1</mass></inertial></link></model></sdf>'
    with Rig() as rig:
        rig.sim(two, "--paused")
        rig.gateway("--distro", "jazzy", robots=2)
        peer = rig.peer()
        spawn, place, where, reset = (caller(peer, name) for name in ("SpawnEntity", "SetEntityState", "GetEntityState", "ResetSimulation"))
        front = "simulation_interfaces::srv::dds_::SetEntityState_"
        newer = CycloneClient(peer, "/set_entity_state", front + "Request_", front + "Response_",
                              "typehash=RIHS01_0ec3cca7e2bde7323c0c7ea4a5a7947f81edb90c144fc0aef5e2052e94e10061;")

        def spawned(name, x, frame="", **more):
            pose = {"header": entity_state(frame=frame)["header"], "pose": entity_state(x)["pose"]}
            request = {"name": name, "allow_renaming": False, "uri": "", "resource_string": ball, "entity_namespace": "", "initial_pose": pose, **more}
            return ask(spawn, "SpawnEntityRequest", request, "SpawnEntityResponse")["result"]["result"]

        def is_at(entity, x, speed):
            state = ask(where, "EntityRequest", {"entity": entity}, "GetEntityStateResponse")["state"]
            found = state["pose"]["position"]["x"], state["twist"]["linear"]["x"]
            assert abs(found[0] - x) < 1e-6 and abs(found[1] - speed) < 1e-6, (entity, found, (x, speed))

        def set_state(kind, **more):
            return ask(newer if kind.endswith("2") else place, kind, {"entity": "ball", **more})["result"]

        assert spawned("ball", 20.0) == 1
        assert spawned("beside", 1.0, "ball") == 1 and spawned("lost", 1.0, "nowhere") == 109
        is_at("beside", 21.0, 0.0)
        assert set_state("SetEntityStateRequest", state=entity_state(22.0, 0.5)) == 1
        is_at("ball", 22.0, 0.5)
        flags = {"set_pose": False, "set_twist": False, "set_acceleration": False}
        for more, x, speed in (({}, 22.0, 0.5), ({"set_twist": True}, 22.0, 0.25), ({"set_pose": True}, 23.0, 0.25), ({"set_pose": True, "set_twist": True}, 23.0, 0.25)):
            assert set_state("SetEntityStateRequest2", state=entity_state(23.0, 0.25), **{**flags, **more}) == 1, more
            is_at("ball", x, speed)
        assert set_state("SetEntityStateRequest2", state=entity_state(), **{**flags, "set_acceleration": True}) == 0
        assert set_state("SetEntityStateRequest2", state=entity_state(frame="odom"), **{**flags, "set_pose": True}) == 101
        assert set_state("SetEntityStateRequest", entity="nobody", state=entity_state()) == 2
        # Time alone, or what was spawned alone, cannot be reset.
        for scope in (1, 3, 4, 5, 6):
            assert ask(reset, "ResetSimulationRequest", {"scope": scope})["result"] == 0, scope
        assert ask(reset, "ResetSimulationRequest", {"scope": 2})["result"] == 1
        is_at("ball", 20.0, 0.0)
        for scope in (0, 7, 255):
            assert spawned("ball" if scope else "other", 30.0) == 1
            assert ask(reset, "ResetSimulationRequest", {"scope": scope})["result"] == 1, scope
            assert ask(where, "EntityRequest", {"entity": "ball"}, "GetEntityStateResponse")["result"]["result"] == 2


# A robot that is spawned with a namespace has its topics and frames there.
def namespaces():
    robot = '<sdf version="1.9"><model name="probe"><link name="l"><inertial><mass>1</mass></inertial><sensor name="imu" type="imu"><update_rate>20</update_rate></sensor></link></model></sdf>'
    with Rig() as rig:
        rig.sim(two)
        rig.gateway("--distro", "jazzy", robots=2)
        peer = rig.peer()
        spawn = caller(peer, "SpawnEntity")

        def spawned(name, space):
            pose = {"header": entity_state()["header"], "pose": entity_state(9.0)["pose"]}
            request = {"name": name, "allow_renaming": False, "uri": "", "resource_string": robot, "entity_namespace": space, "initial_pose": pose}
            return ask(spawn, "SpawnEntityRequest", request, "SpawnEntityResponse")["result"]["result"]

        assert spawned("probe", "unit/one") == 1
        peer.subscribe("/unit/one/imu/data", "sensor_msgs/Imu")
        assert peer.message("/unit/one/imu/data", "sensor_msgs/Imu")["header"]["frame_id"] == "unit/one/imu"
        for wrong in ("1x", "a//b", "a-b", "/leader", "unit/one"):
            assert spawned("other", wrong) == 105, wrong
        delete = caller(peer, "DeleteEntity")
        assert ask(delete, "EntityRequest", {"entity": "probe"})["result"] == 1
        assert spawned("probe", "") == 1
        peer.subscribe("/probe/imu/data", "sensor_msgs/Imu")
        assert peer.message("/probe/imu/data", "sensor_msgs/Imu")["header"]["frame_id"] == "probe/imu"


globals()[case]()
