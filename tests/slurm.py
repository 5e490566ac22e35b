"""A Slurm of one node on the loopback, for tests: Debian's packages slurm-wlm and munge, started
without systemd, stopped at the end.
"""

import os
import secrets
import shutil
import signal
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

CONFIGURATION = Path("/etc/slurm/slurm.conf")
"""Where Slurm's programs look: the environment variable SLURM_CONF does not reach the inside of a
job.
"""

CORES, MEMORY = 4, 16_000


def obstacle() -> str:
    """Why a Slurm cannot be started here, in one line; empty if it can."""
    missing = [
        name for name in ("munged", "slurmctld", "slurmd", "sbatch", "squeue") if not program(name)
    ]
    if missing:
        return f"no {', '.join(missing)} here (Debian: apt install slurm-wlm munge)"
    if os.getuid() != 0:
        return "only root can start a Slurm"
    if CONFIGURATION.exists() or CONFIGURATION.is_symlink():
        return f"this machine has a Slurm already ({CONFIGURATION})"
    return ""


def program(name: str) -> str | None:
    """A program's path, also of one for administrators."""
    return shutil.which(name, path=f"{os.environ['PATH']}:/usr/sbin:/sbin")


def _free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def _configuration(folder: Path) -> str:
    host = socket.gethostname()
    return f"""\
ClusterName=loopback
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={_free_port()}
SlurmdPort={_free_port()}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmUser=root
SlurmdUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SlurmdParameters=config_overrides
NodeName=node1 NodeHostname={host} NodeAddr=127.0.0.1 CPUs={CORES} RealMemory={MEMORY}
PartitionName=main Nodes=node1 Default=YES MaxTime=INFINITE State=UP
"""


@contextmanager
def running(folder: Path) -> Iterator[None]:
    """Keep a Slurm running, with its files in a folder. Raises RuntimeError if its node is not
    ready within 30 s.
    """
    for name in ("state", "spool"):
        (folder / name).mkdir(parents=True)
    folder.chmod(0o755)
    key = folder / "munge.key"
    key.write_bytes(secrets.token_bytes(64))
    key.chmod(0o400)
    (folder / "slurm.conf").write_text(_configuration(folder))
    CONFIGURATION.parent.mkdir(parents=True, exist_ok=True)
    CONFIGURATION.symlink_to(folder / "slurm.conf")
    with ExitStack() as at_end:
        at_end.callback(CONFIGURATION.unlink)
        munge = {
            "key-file": key,
            "socket": folder / "munge.socket",
            "pid-file": folder / "munged.pid",
        }
        munge |= {"log-file": folder / "munged.log", "seed-file": folder / "munged.seed"}
        for name, words in {
            "munged": ["--force", *(f"--{key}={value}" for key, value in munge.items())],
            "slurmctld": ["-c"],
            "slurmd": ["-N", "node1"],
        }.items():
            started = subprocess.run(
                [program(name), *words], capture_output=True, text=True, check=False, timeout=30
            )
            if started.returncode:
                raise RuntimeError(f"{name}: {started.stderr.strip()}")
            at_end.callback(_stop, folder / f"{name}.pid")
        at_end.callback(
            subprocess.run,
            ["scancel", "--user", "root"],
            check=False,
            capture_output=True,
            timeout=30,
        )
        deadline = time.monotonic() + 30
        while _state() != "idle":
            if time.monotonic() > deadline:
                raise RuntimeError(
                    f"the node is {_state() or 'not there'}; see {folder}/slurmd.log"
                )
            time.sleep(0.2)
        yield


def _state() -> str:
    """The state of the node, in Slurm's words."""
    return subprocess.run(
        ["sinfo", "--noheader", "--format=%T"],
        capture_output=True,
        text=True,
        check=False,
        timeout=30,
    ).stdout.strip()


def _stop(pid: Path) -> None:
    """End the daemon that wrote a file of its process id."""
    if pid.is_file():
        number = int(pid.read_text())
        os.kill(number, signal.SIGTERM)
        deadline = time.monotonic() + 10
        while Path(f"/proc/{number}").exists() and time.monotonic() < deadline:
            time.sleep(0.1)
