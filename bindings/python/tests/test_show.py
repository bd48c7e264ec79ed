# SPDX-License-Identifier: BSD-3-Clause
"""Pages, pictures and plots of a result."""

import json
import re

import pytest

import hfremesh as hf


def test_a_page_has_the_figures_of_both_meshes(cavity, tmp_path):
    r = hf.improve(cavity)
    r.report(tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text()
    payload = json.loads(re.search(r'id="payload">(.*?)</script>', page, re.S).group(1))
    for side, figures in (("before", r.before), ("after", r.after)):
        assert payload["report"][side]["cells"] == figures.cells
        assert payload["report"][side]["min_dihedral"]["min"] == figures.min_dihedral
    assert [p.name for p in tmp_path.iterdir()] == ["page.html"]


def test_a_picture_is_a_png(cavity, tmp_path):
    r = hf.improve(cavity, iterations=1)
    r.report(None, png=tmp_path / "picture.png")
    assert (tmp_path / "picture.png").read_bytes().startswith(b"\x89PNG\r\n")


def test_what_cannot_be_written_raises(cavity, tmp_path):
    r = hf.improve(cavity, iterations=1)
    with pytest.raises(OSError, match="no folder"):
        r.report(tmp_path / "none" / "page.html")
    with pytest.raises(ValueError, match="a path"):
        r.report(None)
    with pytest.raises(ValueError, match="statistics=True"):
        hf.improve(cavity, iterations=1, statistics=False).plot()


def test_a_plot_has_both_meshes_in_both_histograms(cavity):
    pytest.importorskip("matplotlib").use("agg")
    figure = hf.improve(cavity).plot()
    assert [len(axes.patches) for axes in figure.axes] == [2, 2]


def test_a_view_has_both_meshes_and_their_poor_cells(cavity, tmp_path):
    pytest.importorskip("pyvista")
    r = hf.improve(cavity)
    view = r.view(below=20, axis="z", at=0.6, off_screen=True)
    names = [set(renderer.actors) for renderer in view.renderers]
    assert {"surface before", "cut before", "invalid before"} <= names[0]
    assert {"surface after", "cut after"} <= names[1]
    assert "invalid after" not in names[1] and not r.invalid_cells.size
    degrees = hf.min_dihedral(r.mesh)
    shown = view.renderers[1].actors["poor after"].mapper.dataset.n_cells if "poor after" in names[1] else 0
    assert shown == ((degrees > 0) & (degrees < 20)).sum()
    view.screenshot(tmp_path / "view.png")
    assert (tmp_path / "view.png").read_bytes().startswith(b"\x89PNG\r\n")
    view.close()


def test_a_view_wants_an_axis_and_a_share(cavity):
    r = hf.improve(cavity, iterations=1)
    for wrong in ({"axis": "w"}, {"at": 1.5}):
        with pytest.raises(ValueError, match="axis is x, y or z"):
            r.view(**wrong)
