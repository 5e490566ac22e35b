"""Run the scripts of jobs in forks of one process that has imported what they need.

To start Python and to import numba, pandas and seaborn takes one to two seconds, longer than most
jobs work. Snakemake starts an interpreter for each script; here one process imports these libraries
once per workflow, most of them while no job waits, and forks a child per job. A child inherits
modules, never results: the parent reads no file of the workflow.
"""

import contextlib
import gc
import importlib
import inspect
import logging
import os
import pickle
import select
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable
from functools import partial
from typing import Any, TextIO

from bezierplan.running.jobs import log
from bezierplan.running.jobs.watchdog import UNDER_WAY, describe_end, end_with_parent

# The first jobs of a workflow import these, and wait for it: each on its own would take as long,
# and more time of all cores.
FIRST = (
    "snakemake.iocontainers",
    "bezierplan.study.jobs",
    "pyarrow.dataset",
    "bezierplan.running.problems",
    "bezierplan.running.execution",
    "scipy.sparse.csgraph",
)
# Later jobs import these, in the order in which they need them.
LATER = (
    "bezierplan.geometry.arc_length",
    "bezierplan.running.recheck",
    "shapely",
    "bezierplan.analysis.claims.judge",
    "scipy.stats",
    "bezierplan.figures.sheet",
    "seaborn",
    "matplotlib.backends.backend_pdf",
    "matplotlib.backends.backend_svg",
    "bezierplan.figures.page.build",
)
ARRIVES = b"\n"
PROCESS, ENDED = "process", "ended"
"""Words that come through a job's socket beside what begins (`watchdog.begin`): its number, its
end.
"""
# pyarrow's allocator would start a thread on import; a fork of a process with several threads may
# lock up, and Python 3.12 warns of it.
ONE_THREAD = {"JE_ARROW_MALLOC_CONF": "background_thread:false"}


class Forks:
    """The process that is forked, seen from Snakemake. It starts with the first job, or before
    (`start`), and ends with Snakemake, or when this object goes.
    """

    def __init__(self, interpreter: str, script: Callable[..., None]) -> None:
        """Take the path of Python's interpreter, and Snakemake's function that runs a script in an
        interpreter of its own.
        """
        self._interpreter = interpreter
        self._script = script
        self._names = inspect.signature(script)
        self._starting, self._control = threading.Lock(), None
        self._process: subprocess.Popen | None = None

    def start(self) -> None:
        """Start the process that is forked, unless it runs. It imports modules while Snakemake has
        other work.
        """
        with self._starting:
            if self._control is None:
                self._begin()

    def end(self) -> None:
        """End the process that is forked, if it is there, and wait for it: its time and that of all
        jobs then count as that of this process's children.
        """
        with self._starting:
            self._stop()

    def _stop(self) -> None:
        """End the process that is forked, if it is there."""
        if self._control is not None:
            self._control.close()
            self._process.kill()
            self._process.wait()
            self._control = None

    def script(self, *arguments: Any) -> None:
        """Run a script as Snakemake's function of the same name does, with the same arguments.

        Raises subprocess.CalledProcessError if the script fails, after the script has said why on
        stderr.
        """
        from snakemake.iocontainers import Snakemake
        from snakemake.script import SourceCache, get_source

        job = self._names.bind(*arguments).arguments
        cache = SourceCache(job["sourcecache_path"], job["runtime_sourcecache_path"])
        file, source, *_ = get_source(
            job["path"], cache, job["basedir"], job["wildcards"], job["params"]
        )
        # Elsewhere libraries may not survive a fork; another environment has a Python of its own.
        if sys.platform != "linux" or job["conda_env"]:
            self._script(*arguments)
            return
        names = (
            "input",
            "output",
            "params",
            "wildcards",
            "threads",
            "resources",
            "log",
            "config",
            "rulename",
            "bench_iteration",
        )
        name = file.get_path_or_uri(secret_free=True)
        work = Snakemake(*(job[each] for each in names))
        if not self.run_in_fork(name, source, work, job["bench_record"]):
            raise subprocess.CalledProcessError(1, name)

    def run_in_fork(self, name: str, source: str, snakemake: Any, benchmark: Any = None) -> bool:
        """Run a script in a fork, in this process's folder, and return whether its status was 0.

        snakemake: the object that scripts know by this name. benchmark: Snakemake's record of time
        and memory. If the fork ends without a report of its own, the log and stderr get a line that
        names what was under way.
        """
        ours, theirs = socket.socketpair()
        work = pickle.dumps((os.getcwd(), name, source, snakemake))
        with ours:
            with theirs, self._starting:
                self._hand_over(theirs)
            under_way, status, ended = _watch(ours, work, benchmark)
        if status is not None and not ended:
            # A script that ends with 1 has told why; of any other end nothing has been told.
            if status in (0, 1):
                return status == 0
            ended = describe_end(status)
        log.report(
            str(snakemake.log[0]),
            f"{under_way or snakemake.output[0]}: {ended or 'its process was lost'}",
        )
        return False

    def _hand_over(self, job: socket.socket) -> None:
        """Send the child's end of a job's socket to the process that is forked. It is started if it
        does not run, or no longer runs.
        """
        if self._control is not None:
            with contextlib.suppress(ConnectionError):
                socket.send_fds(self._control, [ARRIVES], [job.fileno()])
                return
        self._stop()
        self._begin()
        socket.send_fds(self._control, [ARRIVES], [job.fileno()])

    def _begin(self) -> None:
        """Start the process that is forked."""
        self._control, theirs = socket.socketpair()
        with theirs:
            self._process = subprocess.Popen(
                [self._interpreter, "-m", __name__],
                stdin=theirs,
                stdout=choose_stream(sys.stdout),
                stderr=choose_stream(sys.stderr),
                env=os.environ | ONE_THREAD,
            )


def _watch(job: socket.socket, work: bytes, benchmark: Any) -> tuple[str, int | None, str]:
    """Send a job its work, and follow it until it ends.

    Return what it last had under way, its exit status (None if unknown), and why it was ended here:
    it took longer than it may; empty otherwise.
    """
    process, under_way, end, rest = 0, "", "", b""
    with contextlib.ExitStack() as measuring:
        while True:
            try:
                read = job.recv(1 << 16)
            except TimeoutError:
                end = f"not done within the time limit of {job.gettimeout():g} s; it is ended"
                # How it ended is still to come.
                job.settimeout(None)
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)
                continue
            except ConnectionError:
                read = b""
            *lines, rest = (rest + read).split(b"\n")
            for line in lines:
                kind, _, text = line.decode().partition(" ")
                if kind == ENDED:
                    return under_way, int(text), end
                if kind == PROCESS:
                    process = int(text)
                    if benchmark is not None:
                        from snakemake.benchmark import benchmarked

                        measuring.enter_context(benchmarked(process, benchmark))
                    # Only now, because a job that has ended cannot be measured. One that dies at
                    # once leaves nobody to read.
                    with contextlib.suppress(ConnectionError):
                        job.sendall(work)
                        job.shutdown(socket.SHUT_WR)
                elif not end:
                    under_way = text
                    job.settimeout(None if kind == "inf" else float(kind))
            if not read:
                return under_way, None, end


def choose_stream(stream: TextIO | None) -> int | None:
    """Return where a new process writes: to this process's stream, or nowhere if that is closed."""
    # The number of a closed stream is given to the next file that is opened.
    return subprocess.DEVNULL if stream is None else None


def serve(control: socket.socket) -> None:
    """Fork a child for each socket that arrives, and return when the other end has closed.

    The modules that the first jobs need are imported before, those of later jobs while none
    arrives.
    """
    # A terminal sends Ctrl-C to all processes at once; this one ends with its socket.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    jobs: dict[int, socket.socket] = {}
    signal.signal(signal.SIGCHLD, partial(reap, jobs))
    first, later = (
        [partial(importlib.import_module, name) for name in names] for names in (FIRST, LATER)
    )
    first.append(compile_first)
    while True:
        if first or (later and not select.select([control], [], [], 0)[0]):
            # The jobs that need a module report what is wrong with it.
            with contextlib.suppress(Exception):
                (first or later).pop(0)()
            continue
        arrived, sockets, *_ = socket.recv_fds(control, 1, 1)
        if not arrived:
            return
        parent = socket.socket(fileno=sockets[0])
        # No child ends unnoticed before it is listed.
        signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGCHLD])
        child = os.fork()
        if child == 0:
            # A copy here would keep the sockets of other jobs open after these have ended.
            for other in (control, *jobs.values()):
                other.close()
            run(parent)
        jobs[child] = parent
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGCHLD])


def reap(jobs: dict[int, socket.socket], *_: Any) -> None:
    """Report through their sockets how children have ended."""
    with contextlib.suppress(ChildProcessError):
        while True:
            child, status = os.waitpid(-1, os.WNOHANG)
            if not child:
                return
            with jobs.pop(child) as parent, contextlib.suppress(OSError):
                parent.sendall(f"{ENDED} {os.waitstatus_to_exitcode(status)}\n".encode())


def compile_first() -> None:
    """Compile one function: the first takes numba half a second more, cached or not."""
    import numba

    numba.njit(lambda: 0)()


def run(parent: socket.socket) -> None:
    """Run, in a child, the script that a socket brings, and end the process. An exception ends it
    as it would end an interpreter.
    """
    end_with_parent()
    # The process that forks has handlers of its own; a script needs those of any process.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGCHLD])
    # What was imported before the fork is no garbage: to look through it again and again takes a
    # fifth of a second of most jobs.
    gc.freeze()
    tell = parent.makefile("w", encoding="utf-8")
    tell.write(f"{PROCESS} {os.getpid()}\n")
    tell.flush()
    with parent.makefile("rb") as stream:
        folder, name, source, snakemake = pickle.load(stream)
    UNDER_WAY.addHandler(logging.StreamHandler(tell))
    # A workflow may have changed its folder since this process's parent was started.
    os.chdir(folder)
    exec(
        compile(source, name, "exec"),
        {"__name__": "__main__", "__file__": name, "snakemake": snakemake},
    )
    logging.shutdown()
    sys.stdout.flush()
    sys.stderr.flush()
    # Not `sys.exit`, which would go on in code and exit handlers of the process that forks.
    os._exit(0)


if __name__ == "__main__":
    end_with_parent()
    with socket.socket(fileno=os.dup(0)) as control, open(os.devnull, "rb") as nothing:
        # A script that reads its input would otherwise take the sockets of other jobs.
        os.dup2(nothing.fileno(), 0)
        serve(control)
