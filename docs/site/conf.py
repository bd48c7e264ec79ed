# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx's settings. scripts/site.sh sets HFR_ROOT, HFR_VERSION and HFR_DOXYGEN_XML."""

import importlib.util
import os
import sys

project = "HFRemesh"
author = "the HFRemesh authors"
copyright = author
release = version = os.environ["HFR_VERSION"]

extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc"]
html_theme = "furo"
html_title = f"HFRemesh {release}"
html_copy_source = False
# Nothing is fetched by who reads the site either: furo brings its own fonts and scripts.
html_theme_options = {"navigation_with_keys": True}

myst_heading_anchors = 4
myst_enable_extensions = []
# Some pages begin a section at the third level. Every header of C++ declares the namespace, and C names a type twice.
suppress_warnings = ["myst.header", "duplicate_declaration.cpp", "duplicate_declaration.c"]

breathe_projects = {"hfremesh": os.environ["HFR_DOXYGEN_XML"]}
breathe_default_project = "hfremesh"
breathe_domain_by_extension = {"h": "c"}
breathe_default_members = ("members",)
cpp_id_attributes = []
highlight_language = "none"

# With the wheel installed beside Sphinx the reference is complete. Without, it has what is written in Python.
if importlib.util.find_spec("hfremesh") is None:
    sys.path.insert(0, os.path.join(os.environ["HFR_ROOT"], "bindings", "python"))
    autodoc_mock_imports = ["numpy", "hfremesh._core"]
autodoc_typehints = "none"
autodoc_member_order = "groupwise"
