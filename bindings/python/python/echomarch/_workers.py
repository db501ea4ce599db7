"""Worker processes: each has its own OpenGL context.

A worker is a new Python process, not a fork, and not a process of ``multiprocessing``: a script needs no guard
``if __name__ == "__main__"``, and notebooks work. Requests and results are pickles with their length in front, on the
worker's standard input and output.
"""

from __future__ import annotations

import json
import os
import pickle
import queue
import struct
import subprocess
import sys
import threading
from typing import IO, Any, Dict, List, Optional, Sequence, Tuple

from . import _renderer
from ._errors import WorkerError
from ._response import traced

MAIN = "import sys, json; sys.path[:] = json.loads(sys.argv[1]); from echomarch._workers import main; main()"

_LENGTH = struct.Struct("<Q")

THREADS = ("LP_NUM_THREADS", "RAYON_NUM_THREADS")
"""The environment variables that set the number of threads of llvmpipe and of the library."""


def send(stream: IO[bytes], message: Any) -> None:
    """Write a message."""
    data = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    stream.write(_LENGTH.pack(len(data)))
    stream.write(data)
    stream.flush()


def receive(stream: IO[bytes]) -> Any:
    """Read a message.

    Raises
    ------
    EOFError
        The stream has ended.
    """
    head = stream.read(_LENGTH.size)
    if len(head) < _LENGTH.size:
        raise EOFError
    (length,) = _LENGTH.unpack(head)
    data = stream.read(length)
    if len(data) < length:
        raise EOFError
    return pickle.loads(data)


class Worker:
    """A worker process."""

    def __init__(self, count: int) -> None:
        environment = dict(os.environ)
        threads = max(1, (os.cpu_count() or 1) // count)
        for name in THREADS:
            environment.setdefault(name, str(threads))
        self._process = subprocess.Popen(
            [sys.executable, "-c", MAIN, json.dumps(sys.path)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
        )
        send(self._stdin, _renderer.chosen())

    @property
    def _stdin(self) -> IO[bytes]:
        assert self._process.stdin is not None
        return self._process.stdin

    def do(self, task: str, *arguments: Any) -> Any:
        """Send a task, and return its result or raise its exception."""
        assert self._process.stdout is not None
        try:
            send(self._stdin, (task, arguments))
            is_done, result = receive(self._process.stdout)
        except (EOFError, OSError):
            code = self._process.wait()
            raise WorkerError(f"a worker process ended with exit code {code}") from None
        if is_done:
            return result
        raise result

    def end(self) -> None:
        """End the process at once."""
        self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            try:
                if stream is not None:
                    stream.close()
            except OSError:
                # The process ended before it had read everything.
                pass


def run(tasks: Sequence[Tuple[Any, ...]], workers: int, on_done: Any = None) -> List[Any]:
    """Do tasks in worker processes, and return the results in the order of the tasks.

    The first exception ends all workers. `on_done` receives the number of completed tasks and the result of the last one,
    on the calling thread.
    """
    waiting: "queue.Queue[int]" = queue.Queue()
    for index in range(len(tasks)):
        waiting.put(index)
    done: "queue.Queue[Tuple[int, bool, Any]]" = queue.Queue()
    count = min(workers, len(tasks))
    started: List[Worker] = []

    def serve(worker: Worker) -> None:
        while True:
            try:
                index = waiting.get_nowait()
            except queue.Empty:
                return
            try:
                done.put((index, True, worker.do(*tasks[index])))
            except BaseException as error:  # noqa: B902 - it is raised on the calling thread
                done.put((index, False, error))
                return

    results: List[Any] = [None] * len(tasks)
    try:
        for _ in range(count):
            started.append(Worker(count))
        for worker in started:
            threading.Thread(target=serve, args=(worker,), daemon=True).start()
        for number in range(len(tasks)):
            index, is_done, result = done.get()
            if not is_done:
                raise result
            results[index] = result
            if on_done is not None:
                on_done(number + 1, result)
    finally:
        for worker in started:
            worker.end()
    return results


def _study_shard(file: str, shard: int, of: int, folder: str) -> None:
    from ._echomarch import Study

    Study(file).compute(shard, of, folder, None)


TASKS: Dict[str, Any] = {"responses": traced, "study": _study_shard}


def main() -> None:
    """Serve tasks until standard input ends."""
    import signal

    # Ctrl+C reaches all processes of a terminal. The parent process ends its workers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    requests, results = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    # Drivers may print. Their output must not be among the results.
    os.dup2(2, 1)
    chosen: Tuple[str, Optional[int]] = receive(requests)
    if chosen != _renderer.chosen():
        _renderer.use_renderer(*chosen)
    while True:
        try:
            task, arguments = receive(requests)
        except EOFError:
            return
        try:
            send(results, (True, TASKS[task](*arguments)))
        except Exception as error:
            send(results, (False, error))
