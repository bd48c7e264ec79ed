# SPDX-License-Identifier: BSD-3-Clause
"""Progress, cancelling, interrupts and threads."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import hfremesh as hf


def test_progress_is_told(cavity):
    seen = []
    hf.improve(cavity, progress=seen.append)
    assert len(seen) > 3
    assert 0 <= seen[0].inverted <= hf.stats(cavity).inverted
    fractions = [now.fraction for now in seen]
    assert all(0 <= f <= 1 for f in fractions) and fractions[-1] > fractions[0]
    assert all(isinstance(now.stage, str) and now.stage for now in seen)


@pytest.mark.parametrize("callback", ["progress", "cancel"])
def test_what_a_callback_raises_comes_out(cavity, bytes_of, callback):
    class Mine(Exception):
        pass

    def raises(*_):
        raise Mine("of the callback")

    before = bytes_of(cavity)
    with pytest.raises(Mine, match="of the callback"):
        hf.improve(cavity, **{callback: raises})
    assert bytes_of(cavity) == before


def test_cancel_ends_a_run_with_a_mesh_no_worse(cavity):
    asked = []

    def cancel():
        asked.append(1)
        return len(asked) > 3

    r = hf.improve(cavity, cancel=cancel)
    assert r.cancelled and r.stop == "cancelled" and len(asked) == 4
    assert r.after.inverted <= r.before.inverted and r.after.min_dihedral >= r.before.min_dihedral
    assert hf.check(r.mesh).rule == "kNone"


def test_keyboard_interrupt_gives_the_best_mesh(cavity):
    def interrupt(now):
        if now.stage != "untangle":
            os.kill(os.getpid(), signal.SIGINT)

    r = hf.improve(cavity, progress=interrupt)
    assert r.cancelled and r.after.inverted <= r.before.inverted
    assert hf.improve(cavity, min_dihedral=10).goal_reached  # nothing of the interrupt is left


def test_another_signal_handler_has_its_way(cavity):
    class Stop(Exception):
        pass

    def handler(*_):
        raise Stop

    old = signal.signal(signal.SIGUSR1, handler)
    try:
        with pytest.raises(Stop):
            hf.improve(cavity, progress=lambda now: os.kill(os.getpid(), signal.SIGUSR1))
    finally:
        signal.signal(signal.SIGUSR1, old)


def test_the_lock_is_released_while_a_run_works():
    mesh = hf.generate.cavity((24, 24, 24))
    ticks, running = [], True

    def tick():
        while running:
            ticks.append(time.perf_counter())
            time.sleep(0.002)

    other = threading.Thread(target=tick)
    other.start()
    begin = time.perf_counter()
    hf.improve(mesh, threads=1, iterations=2)
    end = time.perf_counter()
    running = False
    other.join()
    during = [t for t in ticks if begin < t < end]
    assert end - begin > 0.05, "the mesh is too small to show anything"
    assert len(during) > 5


def test_several_threads_at_once_give_the_bits_of_one(cavity):
    meshes = [hf.generate.cavity((7, 7, 7), seed=seed) for seed in range(6)]
    alone = [hf.improve(mesh, threads=1).mesh.hash for mesh in meshes]
    together = [None] * len(meshes)

    def work(i):
        seen = []
        together[i] = hf.improve(meshes[i], threads=2, progress=seen.append).mesh.hash
        assert seen

    workers = [threading.Thread(target=work, args=(i,)) for i in range(len(meshes))]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert together == alone and len(set(alone)) == len(alone)


def test_one_mesh_may_be_read_by_all(cavity):
    results = []

    def work():
        results.append((hf.stats(cavity).min_dihedral, hf.improve(cavity, min_dihedral=15).mesh.hash,
                        int(np.sum(cavity.vertex_cells(100)))))

    workers = [threading.Thread(target=work) for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(results) == 4 and len(set(results)) == 1
