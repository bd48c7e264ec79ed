# SPDX-License-Identifier: BSD-3-Clause
"""Opens a page of --report in headless Chromium, uses its controls as a user would, and looks for errors on its
console. Exit code 77, a skip, where there is no Chromium.
Usage: page_test.py TOOL"""
import json
import subprocess
import sys
import tempfile

from browser import Page, find_browser


def pictures(page):
    return page.run("[0, 1].map((i) => byId(`canvas-${i}`).toDataURL())")


class Checks:
    def __init__(self, page):
        self.page = page
        self.n = 0

    def expect(self, what, truth):
        if not truth:
            sys.exit(f"not so: {what}\nconsole: {self.page.faults}")
        self.n += 1

    def use(self, what, act, both=True):
        """What a user does has to be seen, in both views or in the first."""
        before = pictures(self.page)
        act()
        self.page.frame()
        after = pictures(self.page)
        self.expect(f"{what} changes the view before", before[0] != after[0])
        if both:
            self.expect(f"{what} changes the view after", before[1] != after[1])

    def set(self, name, value, event="input"):
        field = "checked" if isinstance(value, bool) else "value"
        self.page.run(f"byId('{name}').{field} = {json.dumps(value)}; "
                      f"byId('{name}').dispatchEvent(new Event('{event}', {{bubbles: true}})); 0")


def check_views(page, checks):
    checks.expect("the views are there", page.run("document.documentElement.dataset.ready") == "view")
    for i, url in enumerate(pictures(page)):
        checks.expect(f"view {i} is not blank", len(url) > 8000)  # one that is compresses to next to nothing
    checks.use("the cut", lambda: checks.set("cut", "0.3"))
    checks.use("the axis", lambda: checks.set("axis", "0", "change"))
    checks.use("the other side", lambda: checks.set("flip", True, "change"))
    checks.use("no cut", lambda: checks.set("axis", "none", "change"))
    checks.use("the surface", lambda: checks.set("opacity", "0.3"))
    checks.use("the limit", lambda: checks.set("limit", "30"), both=False)  # after, there is no cell below
    checks.set("opacity", "1")
    checks.set("axis", "1", "change")
    checks.use("poor cells beyond the cut", lambda: checks.set("float", False, "change"), both=False)
    page.run("byId('canvas-0').focus()")
    for key in ("ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "+", "-"):
        checks.use(f"the key {key}", lambda key=key: page.key(key))
    page.run("byId('view').scrollIntoView()")
    x, y = page.run("(() => { const b = byId('canvas-0').getBoundingClientRect(); "
                    "return [b.left + b.width / 2, b.top + b.height / 2]; })()")
    checks.use("a drag", lambda: page.drag(x, y, 60, 20))
    checks.use("the wheel", lambda: page.mouse("mouseWheel", x, y, deltaX=0, deltaY=-300))
    checks.use("the first view", lambda: page.run("byId('reset').click()"))
    checks.use("a click", lambda: page.click(x, y), both=False)
    picked = page.run("byId('picked').textContent")
    checks.expect(f"a click picks a cell and says its six angles: {picked}",
                  picked.startswith("before: ") and picked.count("°") >= 6)


def check_lists(page, checks):
    cell = page.run("meshes[1].cells[0]")
    checks.use("a cell of the list", lambda: page.run("document.querySelector('[data-place=\"0\"]').click()"))
    picked = page.run("byId('picked').textContent")
    smallest = page.run(f"degrees({cell['degrees']})")
    checks.expect(f"its number and angle are said: {picked}",
                  f"Cell {cell['cell']} has a smallest dihedral of {smallest}." in picked)
    if "limit" in cell:
        checks.expect(f"the reason is said: {picked}", f"({cell['limit']})" in picked)
    for part in ("words", "all-angles", "smallest-angles", "course", "tables", "time-tables", "stuck-lists",
                 "part-tables"):
        checks.expect(f"{part} has something", len(page.run(f"byId('{part}').textContent.trim()")) > 10)
    text = page.run("document.querySelector('main').innerText")
    for side in ("before", "after"):
        worst = page.run(f"degrees(report.{side}.min_dihedral.min)")
        checks.expect(f"the worst angle {side} is written", worst in text)
    checks.expect("nothing is undefined", "undefined" not in text and "NaN" not in text)
    checks.expect("tables have headings for readers",
                  page.run("[...document.querySelectorAll('table')].every((t) => t.querySelector('th[scope]'))"))
    checks.expect("charts have names for readers",
                  page.run("[...document.querySelectorAll('svg')].every((s) => s.getAttribute('aria-label').length > 20)"))


def check_meshes(page, checks):
    """What the page unpacks are the meshes: figures that are counted anew."""
    for i, side in enumerate(("before", "after")):
        figures = page.run(f"report.{side}")
        counted = page.run(f"""(() => {{
          const mesh = app.views[{i}].mesh, below = (end) => mesh.codes.filter((code) => code < end).length;
          let worst = 0;
          for (let c = 0; c < mesh.nCells; c += 97) {{
            const code = mesh.codes[c];
            if (code === 0 || code === GOOD) continue;
            const angle = Math.min(...dihedralAngles(app.views[{i}].cornersOf(c)));
            worst = Math.max(worst, Math.abs(angle - (code - 0.5) / STEPS_PER_DEGREE));
          }}
          return [mesh.nCells, below(1), below(1 + 15 * STEPS_PER_DEGREE), worst];
        }})()""")
        invalid = figures["inverted"] + figures["flat"]
        checks.expect(f"the cells {side} are all there",
                      counted[:3] == [figures["cells"], invalid, figures["cells_below"]["15"]])
        checks.expect(f"cells {side} have their angles: {counted[3]}", counted[3] < 0.25)


def check_first_view(page, checks):
    """The mesh fills its view, and no part of it is outside."""
    checks.set("axis", "none", "change")
    page.run("byId('reset').click()")
    page.frame()
    for i in (0, 1):
        left, right, top, bottom = page.run(f"""(() => {{
          const {{ width, height }} = byId('canvas-{i}');
          const copy = Object.assign(document.createElement('canvas'), {{ width, height }}).getContext('2d');
          copy.drawImage(byId('canvas-{i}'), 0, 0);
          const {{ data }} = copy.getImageData(0, 0, width, height);
          const paper = [...data.slice(0, 3)], box = [width, -1, height, -1];
          for (let y = 0; y < height; ++y)
            for (let x = 0; x < width; ++x)
              if (paper.some((c, k) => Math.abs(c - data[4 * (width * y + x) + k]) > 8)) {{
                box[0] = Math.min(box[0], x); box[1] = Math.max(box[1], x);
                box[2] = Math.min(box[2], y); box[3] = Math.max(box[3], y);
              }}
          return [box[0] / width, box[1] / width, box[2] / height, box[3] / height];
        }})()""")
        checks.expect(f"mesh {i} fills the first view: {left:.2f} {right:.2f} {top:.2f} {bottom:.2f}",
                      max(right - left, bottom - top) > 0.8)
        checks.expect(f"all of mesh {i} is in the first view", min(left, top) > 0.01 and max(right, bottom) < 0.99)


def tables_that_overflow(page):
    return page.run("[...document.querySelectorAll('.scroll')].filter((t) => t.scrollWidth > t.clientWidth).length")


def check_narrow(page, checks):
    checks.expect("a narrow page is not wider than its window",
                  page.run("document.documentElement.scrollWidth <= document.documentElement.clientWidth"))
    checks.expect("tables are wider than a narrow window", tables_that_overflow(page) > 0)
    page.run("document.querySelectorAll('details').forEach((d) => { d.open = true; }); 0")
    page.frame()
    checks.expect("they, and no others, are reached by the keyboard", page.run(
        "[...document.querySelectorAll('.scroll')].every((t) => (t.scrollWidth > t.clientWidth) === (t.tabIndex === 0))"))


def check_paper(page, checks):
    page.run("document.querySelectorAll('#stuck details').forEach((d) => { d.open = false; }); 0")
    page.send("Emulation.setEmulatedMedia", media="print")
    page.run("window.dispatchEvent(new Event('beforeprint')); 0")
    page.frame()
    checks.expect("all lists of cells are open on paper",
                  page.run("[...document.querySelectorAll('#stuck details')].map((d) => d.open).join()") == "true")
    checks.expect("no table is cut off on paper", tables_that_overflow(page) == 0)


def main(tool):
    browser = find_browser()
    if browser is None:
        print("skipped: no Chromium here (Debian: chromium)")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        mesh, out, file, ball, round_file = (f"{folder}/{name}" for name in (
            "in.mesh", "out.mesh", "page.html", "ball.mesh", "ball.html"))
        subprocess.run([tool, "generate", "cavity", "-o", mesh, "-q"], check=True)
        subprocess.run([tool, mesh, "-o", out, "--report", file, "-q"], check=True)
        subprocess.run([tool, "generate", "ball", "-o", ball, "-q"], check=True)
        subprocess.run([tool, "report", ball, ball, "-o", round_file, "-q"], check=True)
        n = 0
        # On A4 with Chromium's margins 718 pixels are left.
        for width, name, looks in ((1280, file, (check_views, check_lists, check_meshes)), (400, file, (check_narrow,)),
                                   (718, file, (check_paper,)), (1280, round_file, (check_first_view,))):
            with Page(browser, width, 1000) as page:
                page.open(name)
                checks = Checks(page)
                for look in looks:
                    look(page, checks)
                checks.expect("no error on the console", not page.faults)
                n += checks.n
        print(f"{n} checks passed")


main(sys.argv[1])
