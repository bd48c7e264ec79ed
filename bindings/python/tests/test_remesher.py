# SPDX-License-Identifier: BSD-3-Clause
"""A mesh inside of a simulation: steps, edits, fields."""

import gc
import os
import signal
import weakref

import numpy as np
import pytest

import hfremesh as hf


def swirl(points, angle):
    """Turns what lies near the axis of the unit cube; its surface stays."""
    p = np.asarray(points) - 0.5
    weight = np.clip(1 - 2 * np.abs(p).max(axis=1), 0, None)
    a = angle * weight
    turned = np.stack([np.cos(a) * p[:, 0] - np.sin(a) * p[:, 1], np.sin(a) * p[:, 0] + np.cos(a) * p[:, 1], p[:, 2]], 1)
    return turned - p


@pytest.fixture
def loaded():
    box = hf.generate.box((7, 7, 7), jitter=0.15)
    p, c = np.array(box.points), np.array(box.cells)
    middle = p[c].mean(axis=1)
    return hf.Mesh(p, c, point_fields={"T": p @ [1.0, 2.0, 3.0] + 1, "one": np.ones(len(p))},
                   cell_fields={"p": 1 + middle[:, 0] ** 2, "material": (middle[:, 2] > 0.5).astype(int)})


WAYS = {"T": "linear", "one": "linear", "p": "conserve", "material": "inherit"}


def volumes(points, cells):
    p = points[cells]
    return np.linalg.det(p[:, 1:] - p[:, :1]) / 6


def applied(edits, points, cells):
    """The new arrays, of the old ones and the edits alone."""
    new_points = points[edits.maps.old_vertices]
    for vertices, places in ((edits.created_vertices, edits.created_points), (edits.moved_vertices, edits.moved_points)):
        new_points[vertices] = places
    new_cells = np.empty((len(edits.maps.old_cells), 4), np.int64)
    kept = np.flatnonzero(edits.maps.old_cells >= 0)
    new_cells[kept] = edits.maps.vertices[cells[edits.maps.old_cells[kept]]]
    new_cells[edits.created_cells] = edits.created_cell_vertices
    return new_points, new_cells


def test_steps_keep_a_moving_mesh_good(loaded):
    rm = hf.Remesher(loaded, goal=15, trigger=10, transfer=WAYS)
    before = hf.stats(loaded)
    changed = unchanged = 0
    for _ in range(20):
        points, cells = rm.points, rm.cells
        d = swirl(points, 0.15)
        mass = float((rm.field("p") * volumes(points + d, cells)).sum())
        step = rm.step(d)
        assert step.inverted == 0 and step.min_dihedral > 8 and step.fraction == 1
        if not step.changed:
            assert step.edits is None or step.edits.empty
            np.testing.assert_array_equal(rm.points, points + d)
            unchanged += 1
            continue
        changed += 1
        new_points, new_cells = applied(step.edits, points + d, cells)
        np.testing.assert_array_equal(rm.points, new_points)
        np.testing.assert_array_equal(rm.cells, new_cells)
        assert float((rm.field("p") * volumes(rm.points, rm.cells)).sum()) == pytest.approx(mass, rel=1e-12)
        assert {f.name for f in step.repairs[0].fields} == set(WAYS)
    assert changed >= 2 and unchanged >= 2, (changed, unchanged)
    assert (rm.field("one") == 1).all()
    p = rm.field("p")
    assert 1 <= p.min() and p.max() <= 2.0
    assert set(rm.field("material")) == {0, 1} and rm.field("material").dtype == np.int64
    after = hf.stats(rm.mesh)
    assert after.volume == pytest.approx(before.volume) and after.min_dihedral == rm.min_dihedral
    assert hf.stats(loaded).min_dihedral == before.min_dihedral  # the mesh that it was made of


def test_one_repair_says_everything_of_itself(loaded):
    rm = hf.Remesher(loaded, transfer=WAYS, ids=True)
    ids, cell_ids = rm.vertex_ids, rm.cell_ids
    assert len(set(ids)) == rm.n_vertices
    step = None
    while step is None or not step.changed:
        old_points = rm.points + swirl(rm.points, 0.25)
        old_T, old_one = rm.field("T"), rm.field("one")
        ids, cell_ids = rm.vertex_ids, rm.cell_ids
        step = rm.step(swirl(rm.points, 0.25))
    edits = step.edits
    rm.step(np.zeros((rm.n_vertices, 3)))  # parents are found when they are asked for, whatever came since
    assert step.cause in ("angle", "inverted") and len(edits.created_cells) > 0 and "created" in repr(edits)
    offsets = edits.parent_offsets
    assert len(offsets) == len(edits.created_cells) + 1 and offsets[-1] == len(edits.parent_cells)
    sums = np.add.reduceat(edits.parent_shares, offsets[:-1])
    if hf.stats(old_points, loaded.cells).inverted == 0:
        np.testing.assert_allclose(sums, 1, atol=1e-9)
    np.testing.assert_allclose(edits.moved_weights.sum(axis=1), 1, atol=1e-12)
    kept = np.flatnonzero(edits.maps.old_vertices >= 0)
    np.testing.assert_array_equal(rm.vertex_ids[kept], ids[edits.maps.old_vertices[kept]])
    assert not set(rm.cell_ids[edits.created_cells]) & set(cell_ids)
    still = np.setdiff1d(kept, edits.moved_vertices)
    np.testing.assert_array_equal(rm.field("T")[still], old_T[edits.maps.old_vertices[still]])


def test_parents_that_are_left_out_are_said_to_be(loaded):
    rm = hf.Remesher(loaded, goal=15, trigger=10, parents=False)
    step = rm.step(swirl(rm.points, 1.0))
    with pytest.raises(ValueError, match="left out"):
        step.repairs[0].edits.parent_cells


def test_a_quiet_step_changes_nothing(loaded):
    rm = hf.Remesher(loaded, trigger=2)
    step = rm.step(np.zeros((rm.n_vertices, 3)))
    assert not step.changed and step.cause == "none" and step.n_looked_at == 0 and step.repairs == []
    assert rm.needs_repair == "none" and step.edits is None


def test_triggers_are_any_of_them(loaded):
    still = np.zeros((loaded.n_vertices, 3))
    assert hf.Remesher(loaded, goal=33, trigger=32).step(still).cause == "angle"
    assert hf.Remesher(loaded, goal=25, trigger=0, metrics={"mean-ratio": 0.9}).step(still).cause == "metric"
    assert hf.Remesher(loaded, goal=25, trigger=0, every=1).step(still).cause == "steps"
    assert hf.Remesher(loaded, goal=25, trigger=0).step(still).cause == "none"


def test_a_field_of_cells_calls_for_a_repair_where_it_is_not_zero(loaded):
    rm = hf.Remesher(loaded, goal=25, trigger=0, indicator="material")
    everywhere = np.full((rm.n_vertices, 3), 1e-6)
    rm.set_field("material", np.zeros(rm.n_cells, dtype=int))
    assert rm.step(everywhere).cause == "none"
    rm.set_field("material", np.ones(rm.n_cells, dtype=int))
    assert rm.step(everywhere).cause == "indicator"
    with pytest.raises(ValueError, match="no such field"):
        hf.Remesher(loaded, indicator="no such field")


def test_a_function_carries_a_field_over(loaded):
    seen = []

    def nearest(old, new, edits):
        values = np.full(len(new.points), -1.0)
        kept = edits.maps.old_vertices >= 0
        values[kept] = np.array(old.points)[edits.maps.old_vertices[kept], 0]
        seen.append((edits, old, new))
        return values

    rm = hf.Remesher(loaded, transfer={"T": nearest, "one": "linear"})
    while not seen:
        before = rm.points + swirl(rm.points, 0.25)
        rm.step(swirl(rm.points, 0.25))
    edits, old, new = seen[0]
    np.testing.assert_array_equal(old.points, before)
    np.testing.assert_array_equal(new.cells, rm.cells)
    kept = edits.maps.old_vertices >= 0
    np.testing.assert_array_equal(rm.field("T")[kept], before[edits.maps.old_vertices[kept], 0])
    assert (rm.field("T")[~kept] == -1).all()

    def fails(old, new, edits):
        raise LookupError("no values")

    rm = hf.Remesher(loaded, transfer={"T": fails})
    rm.set_field("T", np.arange(rm.n_vertices, dtype=float))
    with pytest.raises(LookupError):
        for _ in range(20):
            before = rm.points
            rm.step(swirl(rm.points, 0.25))
    np.testing.assert_array_equal(rm.points, before)
    np.testing.assert_array_equal(rm.field("T"), np.arange(rm.n_vertices))
    with pytest.raises(KeyError):
        hf.Remesher(loaded, transfer={"nothing": fails})


def test_floats_are_no_values_of_a_field_of_integers(loaded):
    rm = hf.Remesher(loaded, transfer={"material": lambda old, new, edits: np.full(new.n_cells, 1.9)})
    with pytest.raises(ValueError, match="1 integer components"):
        for _ in range(20):
            rm.step(swirl(rm.points, 0.25))


def test_a_name_of_vertices_and_of_cells_needs_of(tet):
    mesh = hf.Mesh(*tet, point_fields={"p": np.zeros(4)}, cell_fields={"p": [2.5]})
    rm = hf.Remesher(mesh, transfer={"p": "conserve"})
    assert rm.field("p", of="cells").tolist() == [2.5] and len(rm.field("p", of="vertices")) == 4
    rm.set_field("p", [3.5], of="cells")
    assert rm.field("p", of="cells").tolist() == [3.5]
    with pytest.raises(ValueError, match="both vertices and cells"):
        rm.field("p")
    with pytest.raises(ValueError, match="both vertices and cells"):
        rm.set_field("p", [3.5])
    with pytest.raises(ValueError, match="both vertices and cells"):
        hf.Remesher(mesh, transfer={"p": lambda old, new, edits: None})
    with pytest.raises(ValueError, match="not 'edges'"):
        rm.field("p", of="edges")


def test_a_remesher_that_was_never_made_is_collected():
    """Its callbacks are let go once, though a cycle leads through it."""
    import gc
    import sys

    def progress(now):
        pass

    def fails():
        try:
            hf.Remesher(hf.generate.cavity((2, 2, 2)), goal=5, trigger=10, progress=progress)
        except ValueError as error:
            kept = error  # frame, error, traceback, frame
            assert kept

    before = sys.getrefcount(progress)
    fails()
    gc.collect()
    assert sys.getrefcount(progress) == before


def test_refused_motion_names_its_cells(loaded):
    rm = hf.Remesher(loaded, on_inversion="refuse")
    d = np.zeros((rm.n_vertices, 3))
    d[8 * 8 * 3 + 8 * 3 + 3] = 0.4
    before = rm.points
    step = rm.step(d)
    assert step.fraction == 0 and len(step.refused) > 0 and not step.changed
    np.testing.assert_array_equal(rm.points, before)
    assert (rm.cells[step.refused] == 8 * 8 * 3 + 8 * 3 + 3).any(axis=1).all()


def test_inner_vertices_may_follow(loaded):
    p = np.array(loaded.points)
    d = np.where(p[:, :1] == 1, [[0.2, 0, 0]], [[0.0, 0, 0]])
    for motion in ("laplace", "elastic"):
        rm = hf.Remesher(loaded, motion=motion, trigger=1)
        rm.move(d)
        moved = rm.points - p
        np.testing.assert_array_equal(moved[p[:, 0] == 1], d[p[:, 0] == 1] + p[p[:, 0] == 1] - p[p[:, 0] == 1])
        inside = (p > 0).all(axis=1) & (p < 1).all(axis=1)
        assert (moved[inside, 0] > 0).mean() > 0.9


def test_parts_of_a_step_can_be_called_alone(loaded):
    rm = hf.Remesher(loaded, goal=20, trigger=1, transfer={"T": "linear"})
    move = rm.move(swirl(rm.points, 0.5))
    assert move.n_moved > 0 and move.fraction == 1
    repair = rm.repair()
    reports = rm.transfer()
    assert not repair.edits.empty and [r.name for r in reports] == ["T"] and reports[0].n_changed > 0


def test_fields_can_be_read_and_replaced(loaded):
    rm = hf.Remesher(loaded)
    assert sorted(rm.field_names) == ["T", "material", "one", "p"]
    rm.set_field("T", np.arange(rm.n_vertices, dtype=np.float32))
    np.testing.assert_array_equal(rm.field("T"), np.arange(rm.n_vertices))
    with pytest.raises(KeyError, match="there is no field 'heat'"):
        rm.field("heat")
    with pytest.raises(KeyError, match="give it to the Mesh"):
        rm.set_field("heat", [1.0])
    with pytest.raises(ValueError, match=r"T: .*one row a vertex, is wanted, not \(3,\)"):
        rm.set_field("T", [1.0, 2, 3])
    with pytest.raises(ValueError, match="has 1 integer components"):
        rm.set_field("material", np.zeros(rm.n_cells))


@pytest.mark.parametrize(
    "change, message",
    [
        (lambda d: d[:-1], r"displacement: an array of shape \(512, 3\) is wanted, not \(511, 3\)"),
        (lambda d: d[:, :2], r"displacement: an array of shape \(n, 3\)"),
        (lambda d: np.where(np.arange(512)[:, None] == 7, np.nan, d), r"displacement\[7, 0\] is nan"),
    ],
)
def test_bad_displacements_move_nothing(loaded, change, message):
    rm = hf.Remesher(loaded)
    before = rm.points
    for door in (rm.step, rm.move):
        with pytest.raises(ValueError, match=message):
            door(change(np.full((512, 3), 0.01)))
    np.testing.assert_array_equal(rm.points, before)


@pytest.mark.parametrize(
    "options, message",
    [
        ({"trigger": 99}, "trigger: degrees from 0 to 70.5"),
        ({"transfer": {"T": "paint"}}, "transfer: 'paint' is no way"),
        ({"transfer": {"heat": "linear"}}, "heat"),
        ({"transfer": {"T": "conserve"}}, "T"),
        ({"on_inversion": "pray"}, "on_inversion: repair, substeps or refuse"),
        ({"metrics": {"beauty": 1}}, "trigger_metric: no metric is called 'beauty'"),
        ({"goal": 80}, "min_dihedral: degrees"),
        ({"surface": "loose"}, "surface: frozen"),
    ],
)
def test_bad_options_are_named(loaded, options, message):
    with pytest.raises(ValueError, match=message):
        hf.Remesher(loaded, **options)


def test_unknown_words_are_type_errors(loaded):
    with pytest.raises(TypeError, match="no option is called 'min_angle'"):
        hf.Remesher(loaded, min_angle=1)
    with pytest.raises(TypeError, match="a Mesh is wanted"):
        hf.Remesher([[0, 0, 0]])


def test_what_a_callback_raises_leaves_the_step_undone(loaded):
    def raises(_):
        raise RuntimeError("of the callback")

    rm = hf.Remesher(loaded, goal=33, trigger=32, progress=raises)
    points, cells = rm.points, rm.cells
    with pytest.raises(RuntimeError, match="of the callback"):
        rm.step(swirl(points, 0.1))
    np.testing.assert_array_equal(rm.points, points)
    np.testing.assert_array_equal(rm.cells, cells)


def test_interrupts_end_a_step_with_a_valid_mesh(loaded):
    told = []

    def interrupt(_):
        told.append(1)
        if len(told) == 1:
            os.kill(os.getpid(), signal.SIGINT)

    rm = hf.Remesher(loaded, goal=33, trigger=32, progress=interrupt)
    step = rm.step(swirl(rm.points, 0.1))
    assert step.stop == "cancelled" and step.inverted == 0
    again = rm.step(np.zeros((rm.n_vertices, 3)))
    assert again.stop != "cancelled"


def test_nobody_looks_into_a_step_in_progress(loaded):
    seen = []

    def look(_):
        try:
            rm.points
        except RuntimeError as error:
            seen.append(str(error))

    rm = hf.Remesher(loaded, goal=33, trigger=32, progress=look)
    assert rm.step(swirl(rm.points, 0.1)).changed
    assert seen and set(seen) == {"a step of this Remesher is in progress"}
    assert len(rm.points) == rm.n_vertices


def test_a_callback_that_knows_its_remesher_is_collected(loaded):
    class Watcher:
        def __init__(self):
            self.rm = hf.Remesher(loaded, progress=self.look)

        def look(self, _):
            pass

    watcher = Watcher()
    gone = weakref.ref(watcher)
    del watcher
    gc.collect()
    assert gone() is None


def test_the_same_bits_for_every_number_of_threads(loaded):
    hashes = set()
    for threads in (1, 2, 3):
        rm = hf.Remesher(loaded, transfer=WAYS, threads=threads)
        assert any([rm.step(swirl(rm.points, 0.2)).changed for _ in range(6)])
        hashes.add((rm.mesh.hash, rm.field("T").tobytes(), rm.field("p").tobytes()))
    assert len(hashes) == 1


def test_improve_carries_fields_and_gives_edits(loaded):
    mesh = loaded.copy()
    mesh.points[:] += swirl(mesh.points, 0.9)
    r = hf.improve(mesh, min_dihedral=20, transfer=WAYS)
    assert r.changed and not r.edits.empty
    points, cells = applied(r.edits, np.array(mesh.points), np.array(mesh.cells))
    np.testing.assert_array_equal(r.points, points)
    np.testing.assert_array_equal(r.cells, cells)
    assert {t.name for t in r.transferred} == set(WAYS) and (r.fields["one"] == 1).all()
    assert r.mesh.hash == hf.improve(mesh, min_dihedral=20).mesh.hash
    with pytest.raises(ValueError, match="heat"):
        hf.improve(mesh, transfer={"heat": "linear"})
    with pytest.raises(ValueError, match="maps=True"):
        hf.improve(mesh, min_dihedral=20, maps=False).edits
