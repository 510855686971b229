#!/usr/bin/python3
"""A sweep as a Slurm job array on this machine: two nodes, one of which dies in the middle.

usage: slurm_test.py TRILENS SCRATCH_FOLDER [JOBS, a multiple of 4]. Starts a controller and two daemons of its own, hands in what
`trilens sweep submit --print` writes, kills one node with its jobs, and compares the summary with that of an
unbroken run. Exits 77 where Slurm is missing or cannot run here.
"""
import getpass
import json
import os
import shutil
import signal
import subprocess
import sys
import time

SKIPPED = 77
CONFIGURATION = """
ClusterName=trilens
SlurmctldHost=localhost
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/none
# How long a job that is queued anew waits; two minutes unless told.
AuthInfo=cred_expire=10
CredType=cred/none
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/controller.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/controller.log
SlurmdLogFile={folder}/%n.log
ReturnToService=2
SlurmdTimeout=10
KillWait=2
MessageTimeout=60
MaxArraySize=10001
MaxJobCount=20000
SchedulerParameters=sched_interval=1,batch_sched_delay=0
JobRequeue=1
NodeName=n[0-1] NodeHostname=localhost Port=[{first}-{second}] CPUs=1 RealMemory=500 State=UNKNOWN
PartitionName=main Nodes=n[0-1] Default=YES MaxTime=INFINITE State=UP
"""
JOBS = 200
SECONDS_PER_JOB = 30  # at most, on a busy machine
# Of the machine, and so of no summary that is compared.
MACHINE = ("t_", "peak_", "machine_", "jobs", "threads", "repeats")


def skip(why):
    print("skipped:", why)
    sys.exit(SKIPPED)


def call(*words, **options):
    return subprocess.run([str(word) for word in words], check=True, text=True, capture_output=True, **options).stdout


class Cluster:
    """A controller and two daemons, ended with the test."""

    def __init__(self, folder):
        self.folder = folder
        os.makedirs(folder + "/state")
        port = 20000 + os.getpid() % 20000
        with open(folder + "/slurm.conf", "w") as file:
            file.write(CONFIGURATION.format(folder=folder, port=port, first=port + 1, second=port + 2, user=getpass.getuser()))
        os.environ["SLURM_CONF"] = folder + "/slurm.conf"
        try:
            call("slurmctld", "-f", folder + "/slurm.conf")
            for node in ("n0", "n1"):
                call("slurmd", "-N", node, "-f", folder + "/slurm.conf", env={**os.environ, "SLURMD_NODENAME": node})
        except subprocess.CalledProcessError as error:
            self.end()
            skip("Slurm's daemons do not start: " + error.stderr.strip())
        if not self.wait(lambda: call("sinfo", "-h", "-o", "%t %D").split() == ["idle", "2"], 60):
            self.end()
            skip("Slurm's nodes do not come up")

    @staticmethod
    def wait(condition, seconds, pause=0.3):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                if condition():
                    return True
            except subprocess.CalledProcessError:
                pass
            time.sleep(pause)
        return False

    def process(self, name):
        try:
            with open(f"{self.folder}/{name}.pid") as file:
                return int(file.read())
        except (OSError, ValueError):
            return None

    def processes_of(self, node):
        """The daemon of the node, its steps, and every process of this cluster's jobs there; in the order in which
        nobody is left to tell the controller of the others' end."""
        found = []
        for entry in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{entry}/environ", "rb") as file:
                    environment = file.read().split(b"\0")
                with open(f"/proc/{entry}/comm") as file:
                    is_job = not file.read().startswith("slurm")
            except OSError:
                continue
            is_here = f"SLURM_CONF={self.folder}/slurm.conf".encode() in environment
            if is_here and f"SLURMD_NODENAME={node}".encode() in environment:
                found.append((is_job, int(entry)))
        return [process for _, process in sorted(found)]

    @staticmethod
    def send(signal_number, processes):
        for process in processes:
            try:
                os.kill(process, signal_number)
            except ProcessLookupError:
                pass

    def kill_node(self, node):
        killed = self.processes_of(node)
        self.send(signal.SIGKILL, killed)
        return len(killed)

    def stop_node_in_a_job(self, node):
        """Whether the daemon and something of a job are there, held still; else all goes on. What was seen a moment ago
        may have ended, so that it counts only what is there after all are stopped."""
        self.send(signal.SIGSTOP, self.processes_of(node))
        stopped = self.processes_of(node)
        if len(stopped) > 1:
            return True
        self.send(signal.SIGCONT, stopped)
        return False

    def end(self):
        for node in ("n0", "n1"):
            self.kill_node(node)
        controller = self.process("controller")
        if controller:
            os.kill(controller, signal.SIGKILL)


def comparable(folder):
    """summary.json without what tells of the machine."""
    with open(folder + "/summary.json") as file:
        summary = json.load(file)
    for run in summary["runs"]:
        run["metrics"] = {name: value for name, value in run["metrics"].items() if not name.startswith(MACHINE)}
    return json.dumps(summary, sort_keys=True)


def done_runs(folder):
    if not os.path.isdir(folder + "/runs"):
        return 0
    return sum(os.path.exists(f"{folder}/runs/{run}/DONE") for run in os.listdir(folder + "/runs"))


def main(trilens, scratch, jobs):
    if not all(shutil.which(name) for name in ("slurmctld", "slurmd", "sbatch", "squeue")):
        skip("Slurm is not installed")
    shutil.rmtree(scratch, ignore_errors=True)
    os.makedirs(scratch)
    scene = scratch + "/scene.json"
    with open(scene, "w") as file:
        file.write(call(trilens, "scene", "example", "mirror-sphere"))
    axes = ["--over", f"/cameras/0/yfov=30..{29 + jobs // 4}:+1", "--over", "engine=exact,classic", "--over", "resolution=1,2",
            "--size", "48x36", "--spp", "1"]
    # Names that the shell, sbatch and Slurm's patterns would each read otherwise.
    whole, farm = scratch + "/whole", scratch + "/it's 5%a # \"farm\""
    call(trilens, "sweep", "run", scene, *axes, "-o", whole, "-q", "-j", "2")
    script = call(trilens, "sweep", "submit", scene, *axes, "-o", farm, "--system", "slurm", "--print")
    with open(scratch + "/submit.sh", "w") as file:
        file.write(script)
    assert f"#SBATCH --array=0-{jobs - 1}\n" in script, script

    cluster = Cluster(scratch + "/slurm")
    try:
        started = time.monotonic()
        call("sbatch", scratch + "/submit.sh")
        assert cluster.wait(lambda: done_runs(farm) >= jobs // 4 and cluster.stop_node_in_a_job("n1"), jobs * SECONDS_PER_JOB,
                            pause=0.02), "the array does not get going"
        before = done_runs(farm)
        killed = cluster.kill_node("n1")
        assert 0 < before < jobs and killed > 1, "the node was to die in the middle, with a job"
        ended = cluster.wait(lambda: not call("squeue", "-h").strip() and os.path.exists(farm + "/report.html"), jobs * SECONDS_PER_JOB)
        states = call("squeue")
        assert ended, f"{done_runs(farm)} of {jobs} runs are done, and in the queue is\n{states}"
        seconds = time.monotonic() - started
        assert call("sinfo", "-h", "-n", "n1", "-o", "%t").startswith("down"), "the killed node is not down"
    finally:
        cluster.end()
    assert done_runs(farm) == jobs
    logs = {name for name in os.listdir(farm) if name.startswith("slurm-")}
    assert logs == {f"slurm-{job}.log" for job in range(jobs)} | {"slurm-report.log"}, f"the logs are {sorted(logs)}"
    assert comparable(farm) == comparable(whole), "the farm's summary is another than that of an unbroken run"
    print(f"{jobs} jobs; a node with {killed} processes killed after {before} runs; all done after {seconds:.0f} s; same summary")


if __name__ == "__main__":
    main(os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else JOBS)
