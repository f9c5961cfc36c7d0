# Nodes of the gateway as peers see them: ros2_graph.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import struct

from ros2_rig import *


# One node for all robots, and frames without prefix on a topic of each robot.
def shapes():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway("--one-node", "--tf-per-robot", "--distro", "jazzy", robots=2)
        peer = rig.peer()
        peer.reader("info", "ros_discovery_info", wire.type_on_wire("rmw_dds_common/ParticipantEntitiesInfo"), durability="transient", user_data=jazzy_hash)
        listed = peer.endpoints(lambda all: any(one[1] == "rt/follower/scan" for one in all) and any(one[1] == "rt/leader/tf" for one in all))
        own = {one[3] for one in listed if one[1] != "ros_discovery_info"}

        def is_one_node(info):
            nodes = info["node_entities_info_seq"]
            named = {gid["data"].hex() for node in nodes for kind in ("reader_gid_seq", "writer_gid_seq") for gid in node[kind]}
            return [(node["node_namespace"], node["node_name"]) for node in nodes] == [("/", "ros2_gateway")] and own <= named

        peer.message("info", "rmw_dds_common/ParticipantEntitiesInfo", is_one_node)
        # Parameters of the one node alone.
        assert {one[1].split("/")[1] for one in listed if one[1].endswith("list_parametersRequest")} == {"ros2_gateway"}, listed
        assert not any(one[1] in ("rt/tf", "rt/leader/robot/list_parameters") for one in listed), listed
        for robot in ("leader", "follower"):
            peer.subscribe(f"/{robot}/tf", "tf2_msgs/TFMessage")
            peer.subscribe(f"/{robot}/tf_static", "tf2_msgs/TFMessage", durability="transient")
            (frame,) = peer.message(f"/{robot}/tf", "tf2_msgs/TFMessage")["transforms"]
            assert (frame["header"]["frame_id"], frame["child_frame_id"]) == ("odom", "base_link"), frame
            fixed = {one["child_frame_id"]: one["header"]["frame_id"] for one in peer.message(f"/{robot}/tf_static", "tf2_msgs/TFMessage")["transforms"]}
            assert fixed["laser"] == "base_link", fixed
        peer.subscribe("/leader/scan", "sensor_msgs/LaserScan")
        assert peer.message("/leader/scan", "sensor_msgs/LaserScan")["header"]["frame_id"] == "laser"


# What peers see of the nodes: type hashes, and each endpoint in the list of its node.
def graph():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway("--distro", "jazzy", robots=2)
        peer = rig.peer()
        peer.reader("info", "ros_discovery_info", wire.type_on_wire("rmw_dds_common/ParticipantEntitiesInfo"), durability="transient", user_data=jazzy_hash)
        listed = peer.endpoints(lambda all: any(one[1] == "rt/follower/scan" for one in all) and any("/leader/robot/set_parameters_atomically" in one[1] for one in all))
        assert all("typehash=RIHS01_" in one[4] for one in listed), [one for one in listed if "typehash" not in one[4]]
        assert all(one[2].endswith("_") and "::dds_::" in one[2] for one in listed), listed
        services = [one for one in listed if one[1].startswith(("rq/", "rr/"))]
        assert services and all(one[4].startswith("serviceid=") for one in services)

        def is_complete(info):
            named = {gid["data"].hex() for node in info["node_entities_info_seq"] for kind in ("reader_gid_seq", "writer_gid_seq") for gid in node[kind]}
            return {one[3] for one in listed if one[1] != "ros_discovery_info"} <= named

        info = peer.message("info", "rmw_dds_common/ParticipantEntitiesInfo", is_complete)
        # What rcl makes for each node.
        for topic in ("rt/rosout", "rt/parameter_events"):
            assert len([one for one in listed if one[1] == topic]) == 3, topic
        nodes = {(node["node_namespace"], node["node_name"]) for node in info["node_entities_info_seq"]}
        assert nodes == {("/", "ros2_gateway"), ("/leader", "robot"), ("/follower", "robot")}, nodes
        assert info["gid"]["data"][12:] == b"\0\0\1\xc1", info["gid"]


# What the gateway logs is on /rosout, for those who come later, too.
def log():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway(robots=2)
        peer = rig.peer()
        peer.subscribe("/leader/scan", "nav_msgs/Odometry")  # another type than the gateway's
        peer.subscribe("/rosout", "rcl_interfaces/Log")
        line = "/leader/scan has type nav_msgs/msg/Odometry, expected sensor_msgs/msg/LaserScan"
        message = peer.message("/rosout", "rcl_interfaces/Log", lambda m: line in m["msg"])
        assert (message["level"], message["name"]) == (30, "ros2_gateway") and message["stamp"]["sec"] > 10**9, message
        assert line in rig.log(rig.process)
        late = rig.peer()
        late.subscribe("/rosout", "rcl_interfaces/Log", durability="transient")
        late.message("/rosout", "rcl_interfaces/Log", lambda m: line in m["msg"])


# Nothing of the graph is sent before the family is known; to Humble, gids of 24 bytes; a second family is reported.
def families():
    kind = wire.type_on_wire("rmw_dds_common/ParticipantEntitiesInfo")
    for family, user_data, size in (("jazzy", jazzy_hash, 16), ("humble", "-", 24)):
        with Rig() as rig:
            rig.sim(two)
            rig.gateway(robots=2)
            peer = rig.peer()
            peer.reader("info", "ros_discovery_info", kind, durability="transient")
            peer.subscribe("/clock", "rosgraph_msgs/Clock")
            peer.message("/clock", "rosgraph_msgs/Clock")
            assert not peer.samples["info"]
            peer.writer("own", "ros_discovery_info", kind, durability="transient", user_data=user_data)
            await_("the graph", lambda: peer.samples["info"])
            data = peer.samples["info"][0][4:]
            assert data[size : size + 4] != b"\0\0\0\0" and data[12:16] == b"\0\0\1\xc1", data[:40].hex()
            assert data[16:24] == (b"\0" * 8 if size == 24 else data[16:24])
            count = struct.unpack_from("<I", data, size)[0]
            assert count == 3, (family, count)
            peer.writer("other", "ros_discovery_info", kind, durability="transient", user_data="-" if size == 16 else jazzy_hash)
            await_("the report", lambda: "Nodes of both cannot share a domain" in rig.log(rig.process))


# A subscriber that can never receive a topic of the gateway is logged with the policy, and so is a publisher of commands.
def policies():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway("--distro", "jazzy", robots=2)
        peer = rig.peer()
        for policy, words in (("deadline", "a deadline"), ("lease", "a lease of liveliness"), ("manual", "manual liveliness"), ("exclusive", "exclusive ownership")):
            peer.reader(policy, "rt/leader/scan", wire.type_on_wire("sensor_msgs/LaserScan"), durability=policy)
            await_(policy, lambda: f"/leader/scan has the default QoS, but {words} is requested by a reader" in rig.log(rig.process))
            assert not peer.samples[policy]
        peer.writer("command", "rt/leader/cmd_vel", wire.type_on_wire("geometry_msgs/Twist"), durability="exclusive")
        await_("the writer", lambda: "/leader/cmd_vel has the default QoS, but exclusive ownership is offered by a writer" in rig.log(rig.process))
        # A writer that offers more than the default matches.
        peer.writer("strict", "rt/leader/cmd_vel", wire.type_on_wire("geometry_msgs/Twist"), durability="deadline")
        peer.await_matched("strict")
        assert "deadline is offered" not in rig.log(rig.process)


globals()[case]()
