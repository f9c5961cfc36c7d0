# Sweeps by Slurm, on a cluster of one machine that the test starts: slurm.py CASE BIN_DIR SOURCE_DIR. Its daemons have folder, key and ports
# of their own and stay on the loopback; where the machine allows they live in namespaces of their own and end with them. Exit code 77:
# Slurm is not installed, or does not start here.
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import sqlite3
import subprocess
import sys
import tempfile
import time

case, bin_dir, source = sys.argv[1:4]
PATIENCE = 240  # s, for what has no time of its own


def skip(why):
    print(f"skipped: {why}")
    sys.exit(77)


# Mounts, processes and network of our own; shared memory too, since simulators are told apart by their process ids.
# An address beside 127.0.0.1, or the library takes the machine for one that has none of IPv4.
INSIDE = "mount -t tmpfs tmpfs /dev/shm && ip link set lo up && ip address add 192.0.2.1/32 dev lo"


def enter_namespaces():
    if len(sys.argv) > 4:
        return
    for user in ([], ["--user", "--map-root-user"]):
        words = ["unshare", *user, "--net", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc", "sh", "-c"]
        try:
            allowed = subprocess.run([*words, INSIDE], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=60).returncode == 0
        except FileNotFoundError:
            break
        if allowed:
            os.execvp(words[0], [*words, INSIDE + ' && exec python3 -B "$@"', "sh", __file__, *sys.argv[1:4], "inside"])


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


class Cluster:
    def __init__(self, folder):
        self.folder, self.daemons = folder, []
        user = subprocess.run(["id", "-un"], stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
        for name in ("munge", "socket", "state", "spool", "cgroup"):
            (folder / name).mkdir()
        for path in (folder.parent, folder, folder / "socket"):
            path.chmod(0o711)  # munged refuses a socket that others could not reach
        (folder / "munge").chmod(0o700)
        (folder / "munge/key").write_bytes(os.urandom(1024))
        (folder / "munge/key").chmod(0o400)
        (folder / "slurm.conf").write_text(f"""ClusterName=one
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
AuthType=auth/munge
AuthInfo=socket={folder}/socket/munge
CredType=cred/munge
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,batch_sched_delay=0
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
KillWait=20
MinJobAge=10
NodeName=one NodeHostname={socket.gethostname().split(".")[0]} NodeAddr=127.0.0.1 CPUs={os.cpu_count()} State=UNKNOWN
PartitionName=all Nodes=one Default=YES MaxTime=INFINITE State=UP
""")
        # slurmd 22.05 wants to load a plug-in for control groups even when nothing uses it.
        (folder / "cgroup.conf").write_text(f"CgroupPlugin=cgroup/v1\nCgroupMountpoint={folder}/cgroup\n")
        os.environ["SLURM_CONF"] = str(folder / "slurm.conf")

    def bring_up(self):
        folder = self.folder
        self.start("munged", "--foreground", f"--key-file={folder}/munge/key", f"--socket={folder}/socket/munge", f"--pid-file={folder}/munge/pid",
                   f"--log-file={folder}/munge/log", f"--seed-file={folder}/munge/seed")
        self.wait("munged", lambda: (folder / "socket/munge").exists())
        self.start("slurmctld", "-D", "-c", "-f", folder / "slurm.conf")
        self.wait("slurmctld", lambda: self.said("sinfo", "-h", "-o", "%T") != "")
        self.start("slurmd", "-D", "-N", "one", "-f", folder / "slurm.conf")
        self.wait("slurmd", lambda: self.said("sinfo", "-h", "-o", "%T") == "idle")

    def start(self, program, *words):
        log = open(self.folder / f"{program}.log", "wb")
        path = shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin:/sbin")
        self.daemons.append((program, subprocess.Popen([path, *map(str, words)], stdin=subprocess.DEVNULL, stdout=log, stderr=log)))

    def said(self, *words):
        return subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, timeout=60).stdout.strip()

    def wait(self, program, ready):
        deadline = time.monotonic() + 90
        while not ready():
            if self.daemons[-1][1].poll() is not None or time.monotonic() > deadline:
                lines = (self.folder / f"{program}.log").read_text(errors="replace").splitlines()
                skip(f"{program} does not start here: {lines[-1] if lines else 'it says nothing'}")
            time.sleep(0.1)

    def end(self):
        if self.daemons:
            subprocess.run(["scancel", "--quiet", "--signal=KILL", f"--user={os.getuid()}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=60)
        for _, process in reversed(self.daemons):
            process.terminate()
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def jobs(self):
        return self.said("squeue", "-h", "-o", "%i %t").splitlines()


def sweep_words(*words):
    return [f"{bin_dir}/rtse", "--json", "sweep", str(plan), "-o", "rows.db", "--keep", "kept", *map(str, words)]


def sweep(*words, code=0):
    done = subprocess.run(sweep_words(*words), cwd=work, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=PATIENCE)
    assert done.returncode == code, (words, done.returncode, done.stdout, done.stderr, logs())
    return json.loads(done.stdout), done.stderr


def logs():
    return {path.name: path.read_text(errors="replace")[-500:] for path in work.glob("rows.slurm/logs/*")}


def write_plan(text):
    plan.write_text(f"system: {source}/worlds/systems/obstacle_avoidance.xml\nworld: {source}/worlds/obstacle_course.sdf\nduration: 1\n{text}")


def table(sql):
    if not (work / "rows.db").exists():
        return []
    database = sqlite3.connect(work / "rows.db", timeout=60)
    try:
        return database.execute(sql).fetchall()
    finally:
        database.close()


# What a reader of the results sees, times of the wall apart.
TABLES = ("SELECT * FROM rows ORDER BY number", "SELECT * FROM parameters ORDER BY number, name",
          "SELECT key, passed, problem, state, folder, simulated, logs FROM runs ORDER BY key", "SELECT * FROM measures ORDER BY key, name",
          "SELECT key, place, expectation, problem FROM verdicts ORDER BY key, place")


def contents():
    return [table(sql) for sql in TABLES]


def kept():
    return sorted(str(path.relative_to(work)) for path in work.glob("kept/*/*"))


# Rows that pass and rows that fail are the same from both engines, files too; what is stored asks for no job.
def rows():
    write_plan("""vary:
  model/pioneer2dx/pose/yaw: [0, 0.785]
  component/LaserObstacleAvoid0/stop_distance: [0.3, 0.7]
expect:
  - reach: {model: pioneer2dx, region: [-10, -4.45, 10, 10], within: 1}
measure:
  - clearance: {model: pioneer2dx}
  - value: {port: "LaserObstacleAvoid0:velocity", member: data.vx, take: mean, as: speed}
""")
    local = sweep("-j", 2, code=1)[0]
    assert 0 < local["failed"] < 4, local
    here, files = contents(), kept()
    (work / "rows.db").unlink()
    shutil.rmtree(work / "kept")
    cluster = sweep("--engine", "slurm", "--chunk", 3, code=1)[0]
    assert [cluster[key] for key in ("rows", "passed", "failed")] == [local[key] for key in ("rows", "passed", "failed")], (local, cluster)
    for one, other in zip(here, contents()):
        assert one == other, (one, other)
    assert files == kept(), (files, kept())
    assert not (work / "rows.slurm").exists()
    os.environ["SLURM_CONF"] = "/nowhere"
    again = sweep("--engine", "slurm", code=1)[0]
    assert again["stored"] == 4, again


# Begins a sweep; returns when the first row of its first task is told.
def begin(*words):
    process = subprocess.Popen(sweep_words("--engine", "slurm", *words), cwd=work, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + PATIENCE
    while not any(path.stat().st_size for path in work.glob("rows.slurm/parts/*-0")):
        assert time.monotonic() < deadline and process.poll() is None, (process.poll(), cluster.jobs(), logs(), process.communicate(timeout=60))
        time.sleep(0.02)
    return process


# The programs that run rows of this test, found by the folder that they are called with.
def tasks():
    mark = f"{work}/rows.slurm:".encode()
    found = []
    for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = path.read_bytes().split(b"\0")
        except OSError:
            continue
        if b"--task" in words and any(word.startswith(mark) for word in words):
            found.append(int(path.parent.name))
    return found


def told():
    return {json.loads(line)["key"]: json.loads(line)["wall"] for path in work.glob("rows.slurm/parts/*") for line in path.read_text().splitlines(True) if line.endswith("\n")}


def walls():
    return dict(table("SELECT key, wall FROM runs"))


def kill_tasks():
    for pid in tasks():
        os.kill(pid, signal.SIGKILL)


MANY = 60  # rows of a task that does not come to its end before it is killed, however late that is


# A task that dies is tried again, not for ever, and what it has told is not done again.
def broken():
    write_plan(f"repeat: {MANY}\n")
    process = begin("--chunk", MANY, "--tries", 1)
    kill_tasks()
    first = told()
    said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 1 and re.search("row [0-9]+: its task has ended 1 times without its result, and those of", said[1]), said
    assert {key: walls()[key] for key in first} == first, (first, walls())
    process = begin("--chunk", MANY, "--rows", f"1..{len(first) + 4}")
    kill_tasks()
    said = process.communicate(timeout=PATIENCE)
    report = json.loads(said[0])
    assert process.returncode == 0 and (report["rows"], report["passed"]) == (len(first) + 4, len(first) + 4), said
    assert {key: walls()[key] for key in first} == first and not (work / "rows.slurm").exists()


# A caller that is killed finds its jobs again; one that is interrupted takes them out of the queue. The same command goes on.
def killed():
    write_plan("repeat: 6\n")
    process = begin("--chunk", 6)
    process.kill()
    process.communicate()
    first = told()
    report = sweep("--engine", "slurm", "--chunk", 6)[0]
    assert (report["rows"], report["passed"]) == (6, 6), report
    assert {key: walls()[key] for key in first} == first, (first, walls())
    write_plan(f"repeat: {MANY}\n")
    process = begin("--chunk", MANY)
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 1 and "interrupted after" in said[1], said
    assert cluster.jobs() == [] and not tasks(), (cluster.jobs(), tasks())
    then = walls()
    assert 6 < len(then) < MANY, then
    report = sweep("--engine", "slurm", "--chunk", 2, "--rows", f"1..{len(then) + 2}")[0]
    assert report["passed"] == report["rows"] == len(then) + 2 and report["stored"] == len(then), report
    assert {key: walls()[key] for key in then} == then


# What the tasks of a caller that was killed have found is kept by the next one, also when that one asks for other rows.
def other_rows():
    write_plan("repeat: 8\n")
    for asked in ("1..3", "4..6"):
        process = begin("--chunk", 3, "--rows", asked)
        process.kill()
        process.communicate()
        end = time.monotonic() + PATIENCE
        while cluster.jobs():
            assert time.monotonic() < end, (cluster.jobs(), logs())
            time.sleep(0.1)
        first = told()
        assert len(first) == 3, first
        # Once with a row to run, once with none.
        report = sweep("--engine", "slurm", "--rows", "7..7")[0]
        assert (report["rows"], report["passed"]) == (1, 1), report
        assert {key: walls().get(key) for key in first} == first, (first, walls())
        assert not (work / "rows.slurm").exists()
    report = sweep("--engine", "slurm", "--rows", "1..7")[0]
    assert (report["rows"], report["stored"]) == (7, 7), report


for program in ("sbatch", "slurmctld", "slurmd", "munged"):
    if not shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin:/sbin"):
        skip(f"{program} is not installed (scripts/setup --with-slurm)")
enter_namespaces()
folder = pathlib.Path(tempfile.mkdtemp(prefix="slurm-"))
work, plan = folder / "work", folder / "work/plan.yaml"
cluster = None
try:
    work.mkdir()
    (folder / "tmp").mkdir()
    os.environ["TMPDIR"] = str(folder / "tmp")
    (folder / "cluster").mkdir()
    cluster = Cluster(folder / "cluster")
    cluster.bring_up()
    {"rows": rows, "broken": broken, "killed": killed, "other_rows": other_rows}[case]()
finally:
    os.environ["SLURM_CONF"] = str(folder / "cluster/slurm.conf")
    if cluster is not None:
        cluster.end()
    subprocess.run(["rm", "-rf", str(folder)], check=False)
