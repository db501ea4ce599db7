"""Threads, signals, forks, worker processes, users' GLSL, memory."""

import concurrent.futures
import os
import sys
import time

import numpy as np
import pytest

import echomarch as em
from conftest import SCENES

CHEAP = {"waves": 1024, "seconds": 0.2}

ROOM = """
import echomarch as em
room = em.Scene.shoebox((8, 3, 5), absorption=0.05)
room.add_source("talker", (-2, 0, -1.5))
room.add_listener("seat", (2, -0.3, 1.5))
"""


def test_threads_share_the_context(room):
    """Protects threads: calls from many threads give the results of one thread."""
    expected = [em.response(room, seed=seed, **CHEAP) for seed in range(4)]
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda seed: em.response(room, seed=seed % 4, **CHEAP), range(16)))
    assert found == 4 * expected
    assert expected[0] != expected[1]


def test_the_gil_is_released(python):
    """Protects other threads: they run while waves are traced."""
    done = python(
        ROOM
        + """
import threading, time
em.response(room, waves=1024, seconds=0.1)
ticks, running = [], True
def tick():
    while running:
        ticks.append(time.perf_counter())
        time.sleep(0.01)
thread = threading.Thread(target=tick)
thread.start()
begin = time.perf_counter()
em.response(room, waves=200_000, seconds=0.5)
end = time.perf_counter()
running = False
thread.join()
during = [at for at in ticks if begin < at < end]
print(len(during), end - begin)
assert len(during) > 20 * (end - begin)
"""
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_an_interrupt_ends_a_response_and_the_next_one_works(python):
    """Protects Ctrl+C: it is handled at once, the process goes on, and it ends without a crash of the driver."""
    done = python(
        ROOM
        + """
import os, signal, threading, time
before = em.response(room, waves=1024, seconds=0.2)
threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
begin = time.perf_counter()
try:
    em.response(room, accuracy=0.001)
except KeyboardInterrupt:
    assert time.perf_counter() - begin < 3.0
else:
    raise AssertionError("it was not interrupted")
assert em.response(room, waves=1024, seconds=0.2) == before
print("went on")
"""
    )
    assert (done.returncode, done.stdout) == (0, "went on\n"), done.stderr


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_fork_after_use_is_refused_with_advice(python):
    """Protects forked processes from waiting forever for a thread that a fork does not copy."""
    done = python(
        ROOM
        + """
import os
em.response(room, waves=1024, seconds=0.2)
child = os.fork()
if child == 0:
    try:
        em.response(room, waves=1024, seconds=0.2)
    except em.ForkError as error:
        assert isinstance(error, RuntimeError)
        print(error, flush=True)
        os._exit(0)
    os._exit(1)
assert os.waitpid(child, 0)[1] == 0
# A fork before the first use is allowed, and so is the parent process afterwards.
em.response(room, waves=1024, seconds=0.2)
"""
    )
    assert done.returncode == 0, done.stderr
    assert 'use multiprocessing.get_context("spawn"), or echomarch.responses(scenes, workers=…)' in done.stdout


def test_a_process_that_only_forks_may_trace(python):
    """Protects multiprocessing with fork: a child of a process that has not traced works."""
    if not hasattr(os, "fork"):
        pytest.skip("there is no fork")
    done = python(ROOM + "import os\nif os.fork() == 0:\n    print(em.response(room, waves=1024, seconds=0.2).seed)\n    os._exit(0)\nassert os.wait()[1] == 0\n")
    assert done.returncode == 0, done.stderr


def test_workers_give_the_results_of_one_process(room):
    """Protects determinism: the results do not depend on the number of processes, and keep their order."""
    room.add_source("piano", (0, 0, -2))
    items = [*room.pairs(), em.Scene("shoebox")]
    counts = []
    one = em.responses(items, seed=3, **CHEAP)
    two = em.responses(items, workers=2, seed=3, progress=counts.append, **CHEAP)
    assert one == two and [r.source for r in two] == ["talker", "piano", "1"] and counts == [1, 2, 3]
    np.testing.assert_array_equal(one[1].ir(), two[1].ir())


def test_items_are_grouped_by_scene_and_source(room):
    """Protects the order of results, and progress: the items of a source may lie apart, and a copy is another scene."""
    room.add_source("piano", (0, 0, -2))
    room.add_listener("door", (3, 0, 1))
    alone = em.response(room, "piano", "seat", seed=3, **CHEAP)
    items = [(room, "talker", "seat"), (room, "piano", "seat"), (room, "talker", 2), (room.copy(), "talker", 1)]
    counts = []
    found = em.responses(iter(items), seed=3, progress=counts.append, **CHEAP)
    assert [(r.source, r.listener) for r in found] == [
        ("talker", "seat"), ("piano", "seat"), ("talker", "door"), ("talker", "seat")
    ]
    assert counts == [2, 3, 4]
    assert found[1] == alone, "a single listener of a source is traced as by response()"
    assert found[0] != found[3], "listeners that share waves have other random numbers"
    counts.clear()
    accurate = em.responses(room.pairs(), accuracy=0.02, progress=counts.append)
    assert counts[-1] == 4 and counts == sorted(set(counts)) and len(accurate) == 4
    assert em.responses([]) == []
    with pytest.raises(em.SettingsError, match="fast"):
        em.responses(room.pairs(), profile="fast")
    with pytest.raises(em.SettingsError, match="no setting \"wave\""):
        em.responses(room.pairs(), wave=2)


def test_a_script_needs_no_guard_for_workers(python):
    """Protects scripts and notebooks: workers do not run the script again."""
    done = python("import echomarch as em\nprint('once')\nrooms = [em.Scene('shoebox'), em.Scene('corner')]\nprint(len(em.responses(rooms, workers=2, waves=1024, seconds=0.1)))\n")
    assert (done.returncode, done.stdout) == (0, "once\n2\n"), done.stderr


def test_a_workers_error_is_raised(room, tmp_path):
    """Protects the reason of a failure: the exception of a worker process keeps its class and its sentence."""
    (tmp_path / "ball.glsl").write_text("float field(vec3 p) { return length(p) - radius; }")
    room.add_surface('Field(file: "ball.glsl", lipschitz: 1, size: (2, 2, 2))', name="ball", folder=tmp_path)
    with pytest.raises(em.SettingsError, match="ball.glsl:1: 'radius' undeclared"):
        em.responses([em.Scene("shoebox"), room], workers=2, **CHEAP)
    with pytest.raises(em.SettingsError, match="workers must be 1 or more, not 0"):
        em.responses([room], workers=0)


def test_users_glsl_is_tried_in_a_child_process(tmp_path):
    """Protects the process from users' GLSL: a good text is traced, a text that would never end is refused."""
    field = tmp_path / "ball.glsl"
    field.write_text("float field(vec3 p) { return length(p) - 0.8; }")

    def with_field(room):
        room.add_surface('Field(file: "ball.glsl", lipschitz: 1, size: (2, 2, 2))', name="ball", folder=tmp_path)
        room.add_source("s", (-3, 0, 0))
        room.add_listener("l", (3, 0, 0))
        return room

    room = with_field(em.Scene.shoebox((8, 3, 5), 0.3))
    r = em.response(room, **CHEAP)
    assert r.paths["kind"][0] != "direct"
    field.write_text("float field(vec3 p) { float x = p.x; for (int i = 0; i < 2000000000; i++) { x = sin(x + p.y); } return length(p) - 0.8 + 1e-9 * x; }")
    endless = with_field(em.Scene.shoebox((8, 3, 5), 0.3))
    with pytest.raises(em.SettingsError, match="ball.glsl"):
        em.response(endless, **CHEAP)
    assert em.response(room, **CHEAP) == r


def test_users_glsl_without_an_interpreter_is_refused_with_advice(python):
    """Protects programs that embed Python: nothing can try users' GLSL, so it is refused."""
    done = python(
        f"""
import sys
sys.executable = ""
import echomarch as em
try:
    em.response(em.Scene({str(SCENES / "gyroid.ron")!r}), waves=1024, seconds=0.1)
except em.EchomarchError as error:
    print(error)
"""
    )
    assert done.returncode == 0 and "gyroid.glsl" in done.stdout, done


def test_a_missing_renderer_is_reported(python):
    """Protects users without OpenGL: the error is that of the library, and a second call reports it again."""
    done = python(
        ROOM
        + """
em.use_renderer(gpu=99)
for _ in range(2):
    try:
        em.response(room, waves=1024)
    except em.RendererError as error:
        print(error)
em.use_renderer()
em.response(room, waves=1024, seconds=0.1)
"""
    )
    assert done.returncode == 0 and done.stdout.count("there is no GPU 99") == 2, done


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_many_responses_take_no_more_memory(python):
    """Protects long runs: after the first responses the memory of the process does not grow.

    ECHOMARCH_RESPONSES sets the number; 60 by default.
    """
    count = int(os.environ.get("ECHOMARCH_RESPONSES", "60"))
    done = python(
        ROOM
        + f"""
import gc
def kibibytes():
    gc.collect()
    return int(next(line for line in open("/proc/self/status") if line.startswith("VmRSS:")).split()[1])
def once(seed):
    scene = em.Scene.shoebox((8, 3, 5 + seed % 3), absorption=0.2)
    scene.add_source("s", (-2, 0, -1.5))
    scene.add_listener("l", (2, -0.3, 1.5))
    r = em.response(scene, waves=2048, seconds=0.2, seed=seed)
    return r.figures, r.paths, r.echogram, r.ir(8000)
count = {count}
for seed in range(count // 3):
    once(seed)
before = kibibytes()
for seed in range(count):
    once(seed)
print((kibibytes() - before) / 1024)
""",
        env={**os.environ, "MALLOC_ARENA_MAX": "2"},
    )
    assert done.returncode == 0, done.stderr
    # In MiB: four times as much as 1,000 responses took (1.6 MiB), and a few of the responses of 2 MB.
    assert float(done.stdout) < 8.0, done.stdout
