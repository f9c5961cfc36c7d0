# Data ports on topics of ROS 2, before a peer by another maker of DDS and with an encoder of their own: each data type in both directions,
# QoS, connections in files, a module that is not there, a mapping of an author.
import os
import struct
import threading

from port_rows import *
from ros2_rig import *

both = 2  # readers of a port that receives from all writers: one for those of best effort


# Every data type in both directions, with each field: a message arrives at the InPort, and the OutPort sends its value. The module is
# loaded by the first connection.
def types():
    rows = [row for rows in (number_rows, velocity_rows, pose_rows, value_rows, sensor_rows) for row in rows()]
    with PortRig() as rig:
        host = rig.relay()
        assert "ROS2Transport" not in open(f"/proc/{host.pid}/maps").read()
        peer = rig.peer()
        work = list(enumerate(rows))
        lock, failures = threading.Lock(), []

        def connect_some():
            while True:
                with lock:
                    if not work or failures:
                        return
                    i, row = work.pop()
                try:
                    rig.connect(f"{row.port}_in", f"/in_{i}", *row.in_marshaling, *row.more)
                    rig.connect(f"{row.port}_out", f"/out_{i}", *row.marshaling, *row.more)
                except Exception as error:  # of a thread: told by the main one
                    failures.append((row.port, row.kind, error))

        threads = [threading.Thread(target=connect_some) for _ in range(3)]
        for thread in threads:
            thread.start()
        for i, row in enumerate(rows):
            peer.subscribe(f"/out_{i}", row.kind)
            peer.advertise(f"/in_{i}", row.in_kind)
        for thread in threads:
            thread.join()
        assert not failures, (failures, rig.log(host))
        for i, row in enumerate(rows):
            peer.await_matched(f"/in_{i}", both)
            peer.await_matched(f"/out_{i}")
        # A port of several rows sends to all of their topics: a sample of the row before may still be on its way.
        for i, row in enumerate(rows):
            peer.put(f"/in_{i}", row.in_kind, row.sent)
            try:
                await_(f"{row.port} as {row.kind}", lambda: any(are_alike(row.wanted, got) for got in peer.messages(f"/out_{i}", row.kind)))
            except AssertionError as late:
                raise AssertionError(f"{late}: got {peer.messages(f'/out_{i}', row.kind)[-1:]}, wanted {row.wanted}\n{rig.log(host)}") from None
        # What no message holds is refused with a line; the port can name another encoding.
        refused = rig.try_rtse("con", "TopicRelay0:WString_out", "-p", "interface_type=ros2", "-p", "ros2.topic=/wide")
        assert refused.returncode != 0, refused
        assert "interface_type ros2 has no encoding of IDL:RTC/TimedWString:1.0" in rig.log(host), rig.log(host)
        assert "ros2-gateway" not in rig.log(host), rig.log(host)
        # Hashes are in the discovery data.
        listed = [one for one in peer.endpoints(lambda all: len(all) > 2 * len(rows)) if one[3].startswith("010f")]  # not of the peer itself
        assert len(listed) >= 2 * len(rows) and all("typehash=RIHS01_" in one[4] for one in listed), listed


# Values that are no message, and messages that are no value, have a line and end nothing.
def bad_values():
    with PortRig() as rig:
        host = rig.relay()
        peer = rig.peer()
        rig.connect("CameraImage_in", "/image")
        rig.connect("CameraImage_out", "/image_out")
        rig.connect("PointCloud_in", "/cloud")
        rig.connect("PointCloud_out", "/cloud_out")
        for topic, kind in (("/image", "sensor_msgs/Image"), ("/cloud", "sensor_msgs/PointCloud2")):
            peer.advertise(topic, kind)
            peer.subscribe(topic + "_out", kind)
            peer.await_matched(topic, both)
            peer.await_matched(topic + "_out")
        image = {"header": header("any"), "height": 2, "width": 2, "encoding": "mono8", "is_bigendian": 0, "step": 2, "data": b"1234"}
        for change in ({"encoding": "yuv422"}, {"step": 2**31, "height": 2**31}, {"data": b"123"}, {"width": 70000, "step": 70000}, {"is_bigendian": 1, "encoding": "mono16", "step": 4}):
            peer.put("/image", "sensor_msgs/Image", {**image, **change})
        peer.say("put /image 00010000ffffffff")
        peer.put("/image", "sensor_msgs/Image", image)
        got = peer.message("/image_out", "sensor_msgs/Image")
        assert got["data"] == b"1234" and len(peer.samples["/image_out"]) == 1, got
        assert 'encoding "yuv422" is not known' in rig.log(host), rig.log(host)
        cloud = {"header": header("any"), "height": 1, "width": 1, "fields": [{"name": name, "offset": 4 * i, "datatype": 7, "count": 1} for i, name in enumerate("xyz")],
                 "is_bigendian": False, "point_step": 12, "row_step": 12, "data": bytes(12), "is_dense": True}
        for change in ({"width": 2**32 - 1}, {"height": 2**32 - 1}, {"point_step": 0}, {"data": b""}, {"fields": cloud["fields"][:2]}, {"point_step": 11}):
            peer.put("/cloud", "sensor_msgs/PointCloud2", {**cloud, **change})
        peer.put("/cloud", "sensor_msgs/PointCloud2", cloud)
        assert peer.message("/cloud_out", "sensor_msgs/PointCloud2")["width"] == 1
        assert len(peer.samples["/cloud_out"]) == 1 and host.poll() is None


# Best effort and reliable, in the spellings of OpenRTM and in ours; what does not fit is named.
def qos():
    with PortRig() as rig:
        host = rig.relay()
        peer = rig.peer()
        best = "BEST_EFFORT_RELIABILITY_QOS"
        rig.connect("Long_in", "/sensor", "-p", f"ros2.reader_qos.reliability.kind={best}")
        rig.connect("Long_out", "/fast", "-p", f"fast-rtps.publisher.qos.reliability.kind={best}", "-p", "fast-rtps.publisher.topic.historyQos.depth=3",
                    "-p", "fast-rtps.publisher.qos.deadline.period.seconds=1", "-p", "marshaling_type=ros2:std_msgs/Int32", transport="fast-rtps")
        rig.connect("Long_out", "/plain", "-p", "ros2.reliability=best_effort")
        rig.connect("Long_out", "/kept", "-p", "ros2.durability=transient_local", "-p", "ros2.depth=1")
        rig.connect("Double_in", "/strict", "-p", "ros2.reliability=reliable")
        # Without a reliability a reader receives from all writers, each sample once.
        rig.connect("Short_in", "/any")
        rig.connect("Short_out", "/any_out")
        peer.subscribe("/any_out", "std_msgs/Int16")
        for name, reliability in (("sure", "reliable"), ("weak_one", "best_effort")):
            peer.writer(name, "rt/any", wire.type_on_wire("std_msgs/Int16"), reliability)
        peer.await_matched("sure", both)
        peer.await_matched("weak_one")
        peer.await_matched("/any_out")
        for i in range(20):
            peer.put("sure", "std_msgs/Int16", {"data": i})
        await_("the last reliable number", lambda: {"data": 19} in peer.messages("/any_out", "std_msgs/Int16"))

        def weak_one_passes():
            peer.put("weak_one", "std_msgs/Int16", {"data": -1})
            return {"data": -1} in peer.messages("/any_out", "std_msgs/Int16")

        await_("a number of the best effort writer", weak_one_passes, 0.1)
        numbers = [one["data"] for one in peer.messages("/any_out", "std_msgs/Int16") if one["data"] >= 0]
        assert len(numbers) == len(set(numbers)), numbers
        assert "fast-rtps.publisher.qos.deadline.period.seconds=1 without effect: reliability" in rig.log(host), rig.log(host)
        peer.advertise("/sensor", "std_msgs/Int32", "best_effort")
        for topic in ("/fast", "/plain"):
            peer.subscribe(topic, "std_msgs/Int32", "best_effort")
            peer.await_matched(topic)
        peer.await_matched("/sensor")

        def passes():
            peer.put("/sensor", "std_msgs/Int32", {"data": 5})
            return peer.samples["/fast"] and peer.samples["/plain"]

        await_("best effort both ways", passes, 0.1)
        # Late readers of a topic that is kept receive its last sample.
        peer.subscribe("/kept", "std_msgs/Int32", durability="transient")
        assert peer.message("/kept", "std_msgs/Int32") == {"data": 5}
        # Reliable is requested from best effort, in both directions.
        reader = peer.reader("wish", "rt/fast", wire.type_on_wire("std_msgs/Int32"))
        writer = peer.writer("weak", "rt/strict", wire.type_on_wire("std_msgs/Float64"), "best_effort")
        peer.writer("own", "ros_discovery_info", wire.type_on_wire("rmw_dds_common/ParticipantEntitiesInfo"), durability="transient",
                    user_data="typehash=RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e;")
        node = {"node_namespace": "/", "node_name": "stranger", "reader_gid_seq": [{"data": bytes.fromhex(reader)}], "writer_gid_seq": [{"data": bytes.fromhex(writer)}]}
        peer.put("own", "rmw_dds_common/ParticipantEntitiesInfo", {"gid": {"data": bytes.fromhex(reader)[:12] + b"\0\0\1\xc1"}, "node_entities_info_seq": [node]})
        await_("the writer's mismatch", lambda: "/fast is offered as best effort, but reliable is requested by a reader of /stranger" in rig.log(host))
        await_("the reader's mismatch", lambda: "/strict is requested as reliable, but best effort is offered by a writer of /stranger" in rig.log(host))
        assert "ros2-gateway" not in rig.log(host), rig.log(host)
        for words, line in ((("ros2.reliability=sure",), 'ros2.reliability must be best_effort or reliable, got "sure"'),
                            (("ros2.writer_qos.durability.kind=PERSISTENT_DURABILITY_QOS",), "ros2.writer_qos.durability.kind must be volatile or transient_local"),
                            (("ros2.depth=0",), 'ros2.depth must be from 1 to 10000, got "0"')):
            done = rig.try_rtse("con", "TopicRelay0:Short_out", "-p", "interface_type=ros2", "-p", "ros2.topic=/a", *(word for one in words for word in ("-p", one)))
            assert done.returncode != 0 and line in rig.log(host), (words, rig.log(host))


# A misspelled property is named with the one that was meant; -d makes no second connection of a port to its topic.
def keys():
    with PortRig() as rig:
        host = rig.relay()
        rig.connect("Long_out", "/keys", "-p", "ros2.writer_qos.deadline.period.sec=1", "-p", "ros2.depth=3")
        await_("the policy", lambda: "ros2.writer_qos.deadline.period.sec=1 without effect: reliability, durability and history" in rig.log(host))
        assert "ros2.depth" not in rig.log(host), rig.log(host)
        for wrong, line in ((("ros2.topc=/a",), "unknown property ros2.topc; did you mean ros2.topic?"),
                            (("ros2.topic=/a", "ros2.relibility=best_effort"), "unknown property ros2.relibility; did you mean ros2.reliability?"),
                            (("ros2.topic=/a", "ros2.writer_qos.history.dept=3"), "unknown property ros2.writer_qos.history.dept; did you mean ros2.writer_qos.history.depth?"),
                            (("ros2.topic=/a", "ros2.shelf=7"), "unknown property ros2.shelf; expected ros2.topic"),
                            (("ros2.topic=/a//b",), 'ros2.topic has an empty part, or one that begins with a digit, got "/a//b"'),
                            (("ros2.topic=a-b",), 'ros2.topic may have letters, digits, _ and / only, got "a-b"')):
            words = [word for one in ("interface_type=ros2", *wrong) for word in ("-p", one)]
            for port in ("Long_out", "Long_in"):
                done = rig.try_rtse("con", f"TopicRelay0:{port}", *words)
                assert done.returncode != 0 and f"connection rejected: TopicRelay0.{port}: {line}" in rig.log(host), (wrong, rig.log(host))

        def connections():
            rig.rtse("save", f"{rig.work}/system.yaml")
            return open(f"{rig.work}/system.yaml").read().count("/once")

        words = ("-p", "interface_type=ros2", "-p")
        rig.rtse("con", "TopicRelay0:Double_out", *words, "ros2.topic=/once")
        one = connections()
        assert one > 0
        rig.rtse("con", "-d", "TopicRelay0:Double_out", *words, "ros2.topic=once")
        assert connections() == one
        rig.rtse("con", "-d", "TopicRelay0:Double_out", *words, "ros2.topic=/once_more")
        assert connections() == 2 * one


# A saved system has the connections of its ports with topics, as XML and as YAML.
def saved():
    with PortRig() as rig:
        rig.relay()
        peer = rig.peer()
        rig.connect("Double_in", "/in", "-p", "ros2.reliability=best_effort")
        rig.connect("Double_out", "/out", "-p", "marshaling_type=ros2:std_msgs/Float32")
        for file in ("system.xml", "system.yaml"):
            path = f"{rig.work}/{file}"
            rig.rtse("save", path)
            assert open(path).read().count("/in") >= 1
            checked = rig.try_rtse("check", path)
            assert checked.returncode == 0, checked.stdout + checked.stderr
            rig.rtse("dis", "TopicRelay0")
            checked = rig.try_rtse("check", path)
            assert checked.returncode != 0, checked.stdout
            loaded = rig.try_rtse("load", path)
            assert loaded.returncode == 0, loaded.stdout + loaded.stderr
            again = rig.try_rtse("load", path)
            assert again.returncode == 0, again.stdout + again.stderr
            if not peer.samples:
                peer.advertise("/in", "std_msgs/Float64")
                peer.subscribe("/out", "std_msgs/Float32")
            peer.await_matched("/in")
            peer.await_matched("/out")
            count = len(peer.samples["/out"])
            peer.put("/in", "std_msgs/Float64", {"data": 0.5})
            await_("a number through the restored connections", lambda: len(peer.samples["/out"]) > count)
            assert peer.messages("/out", "std_msgs/Float32")[-1] == {"data": 0.5}
        torn = rig.try_rtse("teardown", f"{rig.work}/system.xml")
        assert torn.returncode == 0, torn.stdout + torn.stderr
        assert rig.try_rtse("check", f"{rig.work}/system.xml").returncode != 0


# A process that has had topics ends as one without: while they are there, and after they have gone.
def ends():
    for goes_first in (False, True):
        with PortRig() as rig:
            host = rig.relay()
            rig.connect("Double_in", "/in")
            rig.connect("Double_out", "/out")
            if goes_first:
                rig.rtse("dis", "TopicRelay0")
            host.terminate()
            assert host.wait(30) == 0, (goes_first, rig.log(host))


# Without the module the refusal names it and its package.
def missing():
    with PortRig() as rig:
        folder = f"{rig.work}/modules"
        os.mkdir(folder)
        os.symlink(f"{lib_dir}/TopicRelay.so", f"{folder}/TopicRelay.so")
        rig.naming()
        host = rig.start(f"{sys.argv[2]}/rtcd", "-o", f"corba.nameservers:{rig.names}", "-o", f"manager.modules.load_path:{folder}", "-o", "manager.shutdown_auto:NO", "TopicRelay")
        rig.until("the component", lambda: rig.rtse("act", "TopicRelay0") is not None)
        done = rig.try_rtse("con", "TopicRelay0:Long_in", "-p", "interface_type=ros2", "-p", "ros2.topic=/a")
        assert done.returncode != 0 and "does not find the module ROS2Transport (package rtm-ros2)" in done.stderr, done.stderr
        assert host.poll() is None


# A mapping of an author's own message, as the page shows it: both directions, and used without a marshaling_type.
def own_mapping():
    code = open(f"{source}/tests/ros2/own_mapping.cpp").read()
    shown = "".join("    " + line if line.strip() else line for line in code.splitlines(True))
    assert shown.rstrip("\n") in open(f"{source}/docs/ros2.md").read(), "docs/ros2.md shows another example than tests/ros2/own_mapping.cpp"
    with PortRig() as rig:
        rig.relay("-o", "manager.modules.preload:OwnMapping.so", "TopicRelay")
        peer = rig.peer()
        rig.connect("String_in", "/label")
        rig.connect("String_out", "/label_out", "-p", "marshaling_type=ros2:shop_msgs/Label", "-p", "ros2.frame_id=shelf")
        rig.connect("String_out", "/text_out", "-p", "marshaling_type=ros2:std_msgs/String")
        peer.advertise("/label", "shop_msgs/Label")
        peer.subscribe("/label_out", "shop_msgs/Label")
        peer.subscribe("/text_out", "std_msgs/String")
        peer.await_matched("/label", both)
        for topic in ("/label_out", "/text_out"):
            peer.await_matched(topic)
        peer.put("/label", "shop_msgs/Label", {"header": header("any"), "text": "nails"})
        assert peer.message("/label_out", "shop_msgs/Label") == {"header": header("shelf"), "text": "nails"}
        assert peer.message("/text_out", "std_msgs/String") == {"data": "nails"}


# A component alone: its InPort reads a topic and its OutPort writes one, each wired to ROS 2 by one port. Bad values get a line.
def ports():
    with Rig() as rig:
        rig.naming()
        host = rig.rtcd("-o", "manager.modules.preload:ROS2Transport.so", "-o", f"ros2.domain.id:{rig.domain}", "-o", "ros2.network:loopback",
                        "-o", "ros2.distro:jazzy", "-o", "ros2.node.name:filter", "Filter", "Relay")
        rig.until("the component", lambda: rig.rtse("act", "Filter0") is not None)
        twist = ("-p", "interface_type=ros2", "-p", "marshaling_type=ros2:geometry_msgs/Twist")
        rig.rtse("con", "Filter0:in", *twist, "-p", "ros2.topic=/raw")
        rig.rtse("con", "Filter0:out", "-p", "interface_type=fast-rtps", "-p", "marshaling_type=ros2:geometry_msgs/TwistStamped",
                 "-p", "fast-rtps.topic=smooth")
        peer = rig.peer()
        peer.subscribe("/smooth", "geometry_msgs/TwistStamped")
        peer.advertise("/raw", "geometry_msgs/Twist")
        peer.await_matched("/raw", 2)
        peer.await_matched("/smooth")

        def passes():
            peer.put("/raw", "geometry_msgs/Twist", wire.twist(0.25, -0.5))
            return peer.messages("/smooth", "geometry_msgs/TwistStamped")

        rig.until("a twist through the component", passes, 0.1)
        moved = peer.message("/smooth", "geometry_msgs/TwistStamped", lambda m: m["twist"]["linear"]["x"] != 0)
        assert moved["twist"]["linear"]["x"] > 0 > moved["twist"]["angular"]["z"], moved
        numbers = ("-p", "interface_type=ros2", "-p", "marshaling_type=ros2:std_msgs/Int32")
        rig.rtse("act", "Relay0")
        rig.rtse("con", "Relay0:in", *numbers, "-p", "ros2.topic=/number")
        rig.rtse("con", "Relay0:out", *numbers, "-p", "ros2.topic=/relayed")
        peer.subscribe("/relayed", "std_msgs/Int32")
        peer.advertise("/number", "std_msgs/Int32")
        peer.await_matched("/number", 2)
        peer.await_matched("/relayed")
        peer.put("/number", "std_msgs/Int32", {"data": -7})
        peer.message("/relayed", "std_msgs/Int32", lambda m: m["data"] == -7)
        rig.rtse("con", "Relay0:number", "-p", "interface_type=ros2", "-p", "marshaling_type=ros2:std_msgs/Float64", "-p", "ros2.topic=/one")
        peer.subscribe("/one", "std_msgs/Float64")
        assert peer.message("/one", "std_msgs/Float64") == {"data": 1.0}
        for wrong, words in ((("-p", "ros2.topic=/a//b"), "ros2.topic"), ((), "ros2.topic is missing"),
                             (("-p", "ros2.topic=/a", "-p", "ros2.writer_qos.history.depth=0"), "history.depth must be")):
            assert rig.try_rtse("con", "Filter0:out", *twist, *wrong).returncode != 0, wrong
            assert words in rig.log(host), rig.log(host)
        alone = rig.try_rtse("con", "Filter0:out")
        assert alone.returncode != 0 and "expected a second port" in alone.stderr, alone.stderr
        rig.rtse("dis", "Filter0:in")
        assert host.poll() is None and "unknown key" not in rig.log(host), rig.log(host)


# A port drives a robot of the gateway. That the gateway also takes TwistStamped is no reason for a warning; a type that nobody takes is.
def drives():
    with PortRig() as rig:
        rig.sim(two)
        rig.gateway("--distro", "jazzy", robots=2)
        host = rig.relay()
        peer = rig.peer()
        peer.subscribe("/leader/odom", "nav_msgs/Odometry")
        rig.connect("Velocity2D_out", "/leader/cmd_vel")
        rig.connect("Velocity2D_in", "/wish")
        peer.advertise("/wish", "geometry_msgs/Twist")
        peer.await_matched("/wish", both)

        def moves():
            peer.put("/wish", "geometry_msgs/Twist", wire.twist(0.2, 0.0))
            return peer.messages("/leader/odom", "nav_msgs/Odometry")[-1:] and peer.messages("/leader/odom", "nav_msgs/Odometry")[-1]["twist"]["twist"]["linear"]["x"] > 0.1

        await_("the leader moves", moves, 0.1)
        rig.connect("Double_out", "/number")
        peer.subscribe("/number", "std_msgs/String")
        await_("the doubt", lambda: "/number has type std_msgs/msg/String, expected std_msgs/msg/Float64" in rig.log(host))
        assert rig.log(host).count("has type") == 1 and "has type" not in rig.log(rig.process), (rig.log(host), rig.log(rig.process))


globals()[case]()
