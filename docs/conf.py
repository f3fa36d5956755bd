"""Configuration of the documentation site; ``.ci/docs FOLDER`` builds it.

The source folder is the repository's root and not ``docs``: pages link to README, validation cases and source
files by relative paths, which then resolve here exactly as they do where the repository is browsed."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent / "_extensions"))
os.environ.setdefault("MPLBACKEND", "Agg")

from mpmfw import __version__

project = "mpmfw"
author = "The mpmfw developers"
copyright = "The mpmfw developers"
version = release = __version__
root_doc = "docs/index"

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.intersphinx",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "myst_parser",
    "sphinx_gallery.gen_gallery",
    "command_reference",
    "docstrings",
    "mathml",
    "nested_pages",
]

# What is a page. Everything else can still be linked to: it becomes a download.
include_patterns = ["docs/**", "validation/**.md", "README.md", "CONTRIBUTING.md", "CHANGELOG.md"]
exclude_patterns = [
    "docs/_*/**",
    "docs/news/**",
    "docs/*template*/**/tests/**",
    "docs/gallery/**",
    "**/.pytest_cache/**",
    "**/*.egg-info/**",
    ".*",
    "build",
    "dist",
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath", "fieldlist"]
myst_heading_anchors = 4
myst_links_external_new_tab = False
myst_dmath_double_inline = True

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
python_maximum_signature_line_length = 88
autodoc_type_aliases = {
    name: name for name in ("AnyArray", "FloatArray", "IndexArray", "IntArray", "Floats", "Indices", "Ints")
}
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
python_use_unqualified_type_names = True
toc_object_entries_show_parents = "hide"
numfig = True
math_numfig = True

# What docstrings name of other packages; the lists are kept here, so that the site is built without a
# network.
intersphinx_mapping = {
    "python": ("https://docs.python.org/3", "docs/_inventories/python.txt"),
    "matplotlib": ("https://matplotlib.org/stable", "docs/_inventories/matplotlib.txt"),
    "xarray": ("https://docs.xarray.dev/en/stable", "docs/_inventories/xarray.txt"),
    "pandas": ("https://pandas.pydata.org/docs", "docs/_inventories/pandas.txt"),
    "pydantic": ("https://docs.pydantic.dev/latest", "docs/_inventories/pydantic.txt"),
}

# Every reference in a docstring must lead somewhere, but for aliases of array types, and types of mpmfw that
# stand in signatures and on no page.
nitpicky = True
nitpick_ignore_regex = [
    (
        "py:class",
        r"(Any|Float|Index|Int)Array|Floats|Ints|Indices|TypeAliasForwardRef|Params|Layout|BodyPairs",
    ),
    (
        "py:class",
        r"IndexMap|Results|ContactLaw|Path|RunCost|Scene(Problem)?|Threads|numpy\.\w+",
    ),
    (
        "py:class",
        r"(scipy\.)?sparse\.(_csr\.)?csr_matrix",
    ),
    (
        "py:class",
        r"mpmfw\.(geometry\.layout\.Layout|kernels\._jit\.Result|scene\.(scene\.)?Scene|errors\.SceneProblem)",
    ),
    (
        "py:class",
        r"mpmfw\.(results\.(references|point_fields)\.\w+|plugin\.hookspecs\.HookSpecs|studies\.loading\.Study)",
    ),
    ("py:class", r"mpmfw\.(stability\.(invariants\.Invariants|chart\.Request)|studies\.choosing\.Request)"),
    ("py:class", r"mpmfw\.(campaigns\.(measures\.Measure|running\.\w+))"),
    (
        "py:class",
        r"mpmfw\.(contact\.shared_nodes\.GridNodes|state\.(history\.IndexMap|structs\.Factors)|plugin\.setup\.Acts)",
    ),
    ("py:class", r"NearRigid"),
    ("py:class", r"tuple\[Layout|dict\[str|Callable\[\[\]|Effect|Side|Transfer"),  # annotations of Setup
    ("py:.*", r"declare_fields|hookimpl|Interrupted|KAPPA|mpmfw\.state\.fields\.CONTACT_SERIES"),
]
html_math_renderer = "mathml"
math_eqref_format = "({number})"

# Copied without what a prompt or a program prints
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True

html_theme = "furo"
html_title = f"mpmfw {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
templates_path = ["_templates"]
html_additional_pages = {"index": "to_the_first_page.html"}
html_copy_source = False
html_show_sourcelink = False

sphinx_gallery_conf: dict[str, Any] = {
    "examples_dirs": ["docs/gallery"],
    "gallery_dirs": ["docs/auto/gallery"],
    "filename_pattern": r"/\w+\.py",
    "ignore_pattern": r"/_",
    "within_subsection_order": "FileNameSortKey",
    "copyfile_regex": r".*\.toml",
    "abort_on_example_error": True,
    "remove_config_comments": True,
    "ignore_repr_types": r"matplotlib\.figure|mpmfw\.plots|pathlib",
    "first_notebook_cell": "%matplotlib inline",
    "write_computation_times": False,
    "show_memory": False,
    "show_signature": False,
    "download_all_examples": False,
    "image_scrapers": ("gallery_figures.figures",),
    "reset_modules": (),
    "matplotlib_animations": False,
    "plot_gallery": "True",
}
