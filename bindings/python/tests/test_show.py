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
