"""A Slurm cluster of one node for a test: munged, slurmctld and slurmd of Debian's packages slurm-wlm and munge, with
configuration, ports and spool of their own in a temporary folder."""

import ctypes
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

DAEMONS = ["munged", "slurmctld", "slurmd"]
START_S = 60

# Where the packages put them; /usr/sbin is not on everybody's PATH.
PATH = os.environ["PATH"] + ":/usr/sbin:/sbin"


def missing():
    """Why no cluster can be started here, or None."""
    absent = [name for name in [*DAEMONS, "sbatch", "srun"] if shutil.which(name, path=PATH) is None]
    if absent:
        return f"Slurm is not installed ({', '.join(absent)} missing): apt-get install slurm-wlm munge"
    return None if os.geteuid() == 0 else "Slurm's daemons have to be started by root"


def free_ports(number):
    sockets = [socket.socket() for _ in range(number)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


def end_with_parent():
    """A test that is itself killed leaves no daemon behind."""
    PR_SET_PDEATHSIG = 1
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


class Cluster:
    def __init__(self, folder, environment):
        """`environment`: of the commands, which Slurm passes on to the jobs."""
        self.folder = pathlib.Path(folder)
        self.processes = []
        self.host = socket.gethostname().split(".")[0]
        self.environment = {**environment, "PATH": PATH, "SLURM_CONF": str(self.folder / "slurm.conf")}
        try:
            self.start()
        except BaseException:
            self.stop()
            raise

    def start(self):
        for name in ["state", "spool", "munge"]:
            (self.folder / name).mkdir(mode=0o755, parents=True)
        self.folder.chmod(0o755)
        (self.folder / "key").write_bytes(os.urandom(1024))
        (self.folder / "key").chmod(0o400)
        socket_path = self.folder / "munge" / "socket"
        self.configure(socket_path)
        # --force: the key and the socket lie below a folder that others can write to.
        self.launch("munged", "--foreground", "--force", f"--socket={socket_path}", f"--key-file={self.folder}/key",
                    f"--pid-file={self.folder}/munge/pid", f"--seed-file={self.folder}/munge/seed",
                    f"--log-file={self.folder}/munge/log")
        self.wait_for(socket_path.exists, "munged")
        self.launch("slurmctld", "-D", "-f", self.folder / "slurm.conf")
        self.launch("slurmd", "-D", "-f", self.folder / "slurm.conf", "-N", self.host)
        self.wait_for(lambda: "idle" in self.run("sinfo", "--noheader", "--format=%T", check=False), "the node")

    def configure(self, socket_path):
        controller, node = free_ports(2)
        (self.folder / "cgroup.conf").write_text("CgroupAutomount=no\n")
        (self.folder / "slurm.conf").write_text(f"""\
ClusterName=test
SlurmctldHost={self.host}(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={node}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={socket_path}
CredType=cred/munge
StateSaveLocation={self.folder}/state
SlurmdSpoolDir={self.folder}/spool
SlurmctldPidFile={self.folder}/slurmctld.pid
SlurmdPidFile={self.folder}/slurmd.pid
SlurmctldLogFile={self.folder}/slurmctld.log
SlurmdLogFile={self.folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=pmix
SwitchType=switch/none
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=1,sched_interval=1
SelectType=select/cons_tres
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=5
MailProg=/bin/true
NodeName={self.host} NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=test Nodes={self.host} Default=YES MaxTime=INFINITE State=UP
""")

    def launch(self, *words):
        log = open(self.folder / f"{words[0]}.out", "wb")
        self.processes.append(subprocess.Popen([str(w) for w in words], env=self.environment, stdin=subprocess.DEVNULL,
                                               stdout=log, stderr=log, cwd=self.folder, start_new_session=True,
                                               preexec_fn=end_with_parent))
        log.close()

    def wait_for(self, ready, what):
        end = time.monotonic() + START_S
        while not ready():
            if time.monotonic() > end or any(p.poll() is not None for p in self.processes):
                logs = "\n".join(f"{p.name}:\n{p.read_text(errors='replace')[-2000:]}"
                                 for p in sorted(self.folder.glob("*.out")) + sorted(self.folder.glob("*.log")))
                raise RuntimeError(f"{what} did not come up\n{logs}")
            time.sleep(0.1)

    def run(self, *words, check=True):
        done = subprocess.run([str(w) for w in words], env=self.environment, stdin=subprocess.DEVNULL, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60)
        if check and done.returncode != 0:
            raise RuntimeError(f"{words}: {done.stdout}")
        return done.stdout

    def job_state(self, job):
        """RUNNING, PENDING, COMPLETED, …; of a job that Slurm has forgotten, an empty text."""
        for word in self.run("scontrol", "show", "job", job, check=False).split():
            if word.startswith("JobState="):
                return word.partition("=")[2]
        return ""

    def stop(self):
        """The daemons in the reverse order, each by its own number."""
        for process in reversed(self.processes):
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
                try:
                    process.wait(timeout=15)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
