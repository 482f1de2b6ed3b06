#!/usr/bin/env python3
"""Opens every kind of report page in a headless browser and uses it as a reader would: hover, box zoom, legend, trial selector,
sorting, keyboard, map, deep links, dark, phone, print, without script.

usage: scripts/pages.py [--binary target/release/tautline] [--write] [--full] [--keep FOLDER]

Needs a Chromium (CHROMIUM names it, else /usr/bin/chromium and its kin) and the Python packages playwright and pillow. Fails on any
console message, network request, sideways scrolling on a phone, a page slower than a second or larger than its limit, or a picture
that differs from the stored one (tests/pages; --write renews them). --full adds the paper's campaign: 63 trials, 4 million rows.
"""
import argparse
import io
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

from PIL import Image, ImageChops, ImageStat
from playwright.sync_api import Error, sync_playwright

ROOT = pathlib.Path(__file__).resolve().parent.parent
PICTURES = ROOT / "tests/pages"
TRUTH = "data/elbow/truth/model.json"
# Limits: bytes of an evaluation of six trials, seconds until a page can be used, mean difference of pictures (of 255).
SIX_TRIALS_BYTES, READY_S, DIFFERENCE = 1_500_000, 1.0, 7.0
# Stored pictures: the first screens, small, so that fonts of other machines do not count.
PICTURE_PX, SHOWN_PX = (240, 360), (1200, 1800)
# A browser crashes now and then as it starts on a machine without a display: starts that are tried.
STARTS = 3


def make(run, full):
    """The folders of the reports, by name."""
    run(f"simulate --model {TRUTH} -o six --rate-hz 100 --speeds 6 --repeats 1 --cosines 6 --seed 3")
    run("identify data/elbow -o identify")
    run(f"evaluate six --model {TRUTH} -o evaluate")
    run(f"simulate --model {TRUTH} -o stiff --rate-hz 50 --speeds 5 --repeats 1 --cosines 2 --effect elastic_spring:stiffness_nm_rad=0.25")
    run(f"diagnose stiff --model {TRUTH} -o diagnose")
    run(f"interaction data/arm --model {TRUTH} -o interaction")
    run(f"compare {TRUTH} identify/model.json -o compare")
    for day in (1, 2, 3):
        effect = "--effect sensor_bias:bias_nm=0.1" if day == 3 else ""
        run(f"simulate --model {TRUTH} -o fleet/elbow-1/2026-0{day} --rate-hz 50 --speeds 6 --repeats 2 --cosines 1 --seed {day} {effect}")
    run("batch fleet -o batch")
    run("repeatability fleet -o repeatability")
    run("validate data/elbow -o validate")
    pages = ["identify", "evaluate", "diagnose", "interaction", "compare", "batch/fleet", "repeatability", "validate"]
    if full:
        run(f"simulate --model {TRUTH} -o paper --rate-hz 1000")
        run("identify paper -o full-identify")
        run(f"evaluate paper --model {TRUTH} -o full-evaluate --sweeps")
        pages += ["full-identify", "full-evaluate"]
    return pages


class Tab:
    """A page in a browser that reports nothing and asks for nothing."""

    def __init__(self, browser, path, width=1200, height=900, dark=False, script=True, hash=""):
        self.said = []
        self.context = browser.new_context(
            viewport={"width": width, "height": height}, color_scheme="dark" if dark else "light", java_script_enabled=script
        )
        self.page = self.context.new_page()
        self.page.on("console", lambda message: self.said.append(f"console: {message.text}"))
        self.page.on("pageerror", lambda error: self.said.append(f"error: {error}"))
        self.page.on("request", lambda request: request.url.startswith("file:") or self.said.append(f"request: {request.url[:80]}"))
        began = time.monotonic()
        self.page.goto(path.as_uri() + hash)
        if script:
            self.page.wait_for_selector("html[data-ready=yes]", timeout=60_000)
        self.ready_s = time.monotonic() - began

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.context.close()

    def value(self, code):
        return self.page.evaluate(code)

    def hit(self, figure, at=0):
        """The data area of a panel, scrolled into view: left, top, width, height."""
        area = self.page.locator(f"#{figure} .hit").nth(at)
        area.scroll_into_view_if_needed()
        box = area.bounding_box()
        return box["x"], box["y"], box["width"], box["height"]

    def ticks(self, figure):
        return self.value(f"[...document.querySelectorAll('#{figure} .drawing text')].map((text) => text.textContent).join('|')")

    def drag(self, figure, at, from_share, to_share):
        x, y, width, height = self.hit(figure, at)
        mouse = self.page.mouse
        mouse.move(x + from_share * width, y + 0.5 * height)
        mouse.down()
        mouse.move(x + 0.5 * (from_share + to_share) * width, y + 0.5 * height)
        mouse.move(x + to_share * width, y + 0.5 * height)
        mouse.up()


class Checks:
    def __init__(self):
        self.failed = 0

    def __call__(self, name, holds, told=""):
        self.failed += not holds
        print(f"{'ok' if holds else 'FAILED':7}{name}{f'  {told}' if told else ''}", flush=True)


def every_page(browser, name, path, check):
    # The best of three: other work on the machine does not count.
    times = []
    for _ in range(3):
        with Tab(browser, path) as tab:
            times.append(tab.ready_s)
            loaded_ms = tab.value("performance.getEntriesByType('navigation')[0].domContentLoadedEventEnd")
            heap_mb = tab.value("performance.memory.usedJSHeapSize") / 1e6
    told = f"{min(times):.2f} s, DOMContentLoaded after {loaded_ms:.0f} ms, {path.stat().st_size / 1e3:.0f} kB, script's memory {heap_mb:.0f} MB"
    check(f"{name}: usable within {READY_S} s", min(times) < READY_S, told)
    with Tab(browser, path) as tab:
        first = tab.page.locator("figure .drawing").first
        check(f"{name}: a figure is drawn on the first screen", first.bounding_box()["y"] < 900)
        tab.value("dispatchEvent(new Event('beforeprint'))")
        tab.page.wait_for_timeout(100)
        drawn = tab.value("[...document.querySelectorAll('figure[data-figure]')].filter((f) => f.offsetParent).every((f) => f.querySelector('.drawing'))")
        check(f"{name}: all figures are drawn for print", drawn)
        check(f"{name}: every figure is labelled for screen readers", tab.value("[...document.querySelectorAll('.drawing')].every((s) => s.getAttribute('aria-label').length > 10)"))
        light = tab.value("getComputedStyle(document.body).backgroundColor")
        tab.page.click("#theme")
        check(f"{name}: the button darkens it", tab.value("getComputedStyle(document.body).backgroundColor") != light)
        for link in tab.page.locator("nav a").all():
            link.click()
        check(f"{name}: contents unfold and lead there", tab.value("[...document.querySelectorAll('details.part')].every((one) => one.open)"))
        check(f"{name}: nothing on the console, no request", not tab.said, "; ".join(tab.said[:3]))
    for width in (390, 320):
        with Tab(browser, path, width=width, height=800) as tab:
            tab.value("dispatchEvent(new Event('beforeprint'))")
            tab.page.wait_for_timeout(100)
            wide = tab.value("document.documentElement.scrollWidth")
            check(f"{name}: no sideways scrolling at {width} px", wide <= width, f"{wide} px")
    with Tab(browser, path, dark=True) as tab:
        ground = tab.value("getComputedStyle(document.body).backgroundColor")
        check(f"{name}: dark where the system is", sum(int(part) for part in ground[4:-1].split(",")) < 150, ground)
    with Tab(browser, path, script=False) as tab:
        check(f"{name}: drawings without script", tab.page.locator("figure svg").count() > 0)


def hover(browser, path, check):
    with Tab(browser, path) as tab:
        x, y, width, height = tab.hit("cosine_1_series", 1)
        tab.page.mouse.move(x + 0.4 * width, y + 0.5 * height)
        told = tab.page.locator("#cosine_1_series .tip").inner_text()
        check("evaluate: hover tells trial, time and values", all(word in told for word in ("cosine_1", "time (s)", "measured", "predicted")), told.replace("\n", " "))
        crosses = tab.page.locator("#cosine_1_series .cross").count()
        check("evaluate: the crosshair stands in all panels of the trial", crosses == 4, str(crosses))


def zoom(browser, path, check):
    with Tab(browser, path) as tab:
        before = tab.ticks("cosine_1_series"), tab.ticks("cosine_1_raw")
        tab.drag("cosine_1_series", 1, 0.4, 0.5)
        tab.page.wait_for_timeout(100)
        after = tab.ticks("cosine_1_series"), tab.ticks("cosine_1_raw")
        check("evaluate: a box zooms position, torque and error together, and the raw figure", before[0] != after[0] and before[1] != after[1])
        address = tab.page.url
        check("evaluate: the address keeps trial and zoom", "trial=cosine_1" in address and "from=" in address, address.split("#")[-1])
        tab.page.locator("#cosine_1_series .reset").click()
        check("evaluate: reset goes back", tab.ticks("cosine_1_series") == before[0])
    with Tab(browser, path, hash="#" + address.split("#")[-1]) as tab:
        check("evaluate: a deep link opens zoomed", tab.ticks("cosine_1_series") == after[0])


def legend_and_choice(browser, path, check):
    with Tab(browser, path) as tab:
        lines = lambda: tab.page.locator("#cosine_1_series .drawing g path[fill=none]").count()
        before, button = lines(), tab.page.locator("#cosine_1_series .legend button", has_text="measured").first
        button.click()
        check("evaluate: the legend hides a series", lines() == before - 1 and button.get_attribute("aria-pressed") == "false")
        button.click()
        check("evaluate: and shows it again", lines() == before)
        tab.page.locator(".picker select").select_option(index=2)
        shown = tab.value("[...document.querySelectorAll('[data-option]')].filter((one) => !one.hidden).map((one) => one.dataset.option).join()")
        check("evaluate: one trial at a time", shown.startswith("cosine_3"), shown)
        check("evaluate: its figures are drawn", tab.page.locator("#cosine_3_series .drawing").count() == 1)
        tab.page.locator(".picker button").last.click()
        check("evaluate: next trial", "cosine_4" in tab.page.url)


def sort(browser, path, check):
    with Tab(browser, path) as tab:
        column = lambda: tab.value("[...document.querySelectorAll('#s-by-trial tbody tr')].map((row) => parseFloat(row.cells[2].textContent))")
        head = tab.page.locator("#s-by-trial th .sort").nth(2)
        head.click()
        up = column()
        head.click()
        down = column()
        check("evaluate: tables sort both ways", up == sorted(up) and down == sorted(down, reverse=True) and len(up) == 6, str(up))


def keyboard(browser, path, check):
    with Tab(browser, path) as tab:
        figure = "cosine_1_series"
        tab.page.locator(f"#{figure} .drawing").focus()
        for _ in range(3):
            tab.page.keyboard.press("ArrowRight")
        told = tab.page.locator(f"#{figure} .sr").inner_text()
        check("evaluate: arrow keys speak values", "time" in told, told)
        before = tab.ticks(figure)
        tab.page.keyboard.press("+")
        zoomed = tab.ticks(figure)
        tab.page.keyboard.press("Escape")
        check("evaluate: plus zooms, Escape resets", zoomed != before and tab.ticks(figure) == before)
        reached = set()
        for _ in range(40):
            tab.page.keyboard.press("Tab")
            reached.add(tab.value("document.activeElement.tagName"))
        check("evaluate: Tab reaches buttons, selectors, figures", {"BUTTON", "svg"} <= reached, ",".join(sorted(reached)))


def map_click(browser, path, check):
    with Tab(browser, path) as tab:
        x, y, width, height = tab.hit("map", 0)
        opened = ""
        for share in (0.02, 0.25, 0.5, 0.75, 0.98):
            tab.page.mouse.click(x + share * width, y + 0.15 * height)
            tab.page.wait_for_timeout(100)
            opened = tab.page.url.split("#")[-1] if "#" in tab.page.url else ""
            if opened:
                break
        spots = tab.page.locator(".spot").count()
        check("diagnose: a click on the map shows those samples", "trial=" in opened and spots > 0, f"{opened}, {spots} marked stretches")


def terms(browser, path, check):
    with Tab(browser, path) as tab:
        marked = tab.value("[...document.querySelectorAll('abbr.term')].map((term) => [term.textContent.toLowerCase(), term.title])")
        told = tab.value("[...document.querySelectorAll('#s-terms dt')].map((term) => [term.textContent.toLowerCase(), term.nextElementSibling.textContent])")
        check("diagnose: terms say on hovering what they mean", len(marked) > 3 and all(one in told for one in marked), ", ".join(name for name, _ in marked))
        check("diagnose: each only where it first stands", len({name for name, _ in marked}) == len(marked))


def map_in_the_dark(browser, path, check):
    """What is large must stand out from the ground: dark on light, bright on dark, also after the button; paper is light."""
    ends = """(() => {
        const bar = [...document.querySelectorAll('#map .drawing > rect[width="12"]')].slice(0, 40).map((rect) => rect.getAttribute('fill'));
        return [bar[0], bar[bar.length - 1]].map((color) => color.match(/\\d+/g).map(Number).reduce((a, b) => a + b));
    })()"""
    for dark in (False, True):
        with Tab(browser, path, dark=dark) as tab:
            tab.hit("map", 0)
            low, high = tab.value(ends)
            check(f"diagnose: the map's largest stands out, {'dark' if dark else 'light'}", (high > low) == dark, f"{low}, {high}")
            tab.page.click("#theme")
            low, high = tab.value(ends)
            check("diagnose: and after the button", (high > low) != dark, f"{low}, {high}")
            tab.value("dispatchEvent(new Event('beforeprint'))")
            low, high = tab.value(ends)
            check("diagnose: and on paper", low > high, f"{low}, {high}")


def drift(browser, path, check):
    with Tab(browser, path) as tab:
        links = tab.page.locator("tbody a")
        check("batch: drifts link to their evidence", links.count() > 0)
        links.first.click()
        tab.page.wait_for_timeout(100)
        check("batch: one click leads to the joint's figure", tab.page.locator("figure[id^=joint_] .drawing").first.is_visible())


def pictures(browser, name, path, write, check):
    with Tab(browser, path, *SHOWN_PX) as tab:
        tab.value("document.querySelectorAll('#provenance, .kicker').forEach((one) => one.remove())")
        seen = Image.open(io.BytesIO(tab.page.screenshot(clip={"x": 0, "y": 0, "width": SHOWN_PX[0], "height": SHOWN_PX[1]}))).convert("L")
    small = seen.resize(PICTURE_PX, Image.Resampling.BOX)
    stored = PICTURES / f"{name.replace('/', '_')}.png"
    if write:
        PICTURES.mkdir(exist_ok=True)
        small.quantize(16).save(stored, optimize=True)
    if not stored.exists():
        check(f"{name}: looks as stored", False, f"{stored} is missing; --write makes it")
        return
    apart = ImageStat.Stat(ImageChops.difference(small, Image.open(stored).convert("L"))).mean[0]
    check(f"{name}: looks as stored", apart < DIFFERENCE, f"mean difference {apart:.2f} of 255")


def launched(playwright, chromium):
    """The browser at the path `chromium`, without a graphics card; a start that crashes is tried again."""
    for attempt in range(1, STARTS + 1):
        try:
            return playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
        except Error as error:
            print(f"{chromium} does not start, attempt {attempt} of {STARTS}: {error.message.splitlines()[0]}", file=sys.stderr)
    sys.exit(f"{chromium} does not start")


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--binary", type=pathlib.Path, default=ROOT / "target/release/tautline")
    arguments.add_argument("--write", action="store_true", help="renew the stored pictures")
    arguments.add_argument("--full", action="store_true", help="63 trials, 4 million rows too")
    arguments.add_argument("--keep", type=pathlib.Path, help="keep the reports in this folder")
    a = arguments.parse_args()
    found = [os.environ.get("CHROMIUM"), *(shutil.which(name) for name in ("chromium", "chromium-browser", "google-chrome"))]
    chromium = next((path for path in found if path), None)
    if chromium is None:
        sys.exit("no Chromium: install one, or name it in CHROMIUM")
    scratch = tempfile.TemporaryDirectory()
    folder = (a.keep or pathlib.Path(scratch.name)).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / "data").exists():
        (folder / "data").symlink_to(ROOT / "data")
    binary = a.binary.resolve()
    took = {}

    def run(command):
        words = command.split()
        target = folder / words[words.index("-o") + 1]
        if a.keep and target.exists():
            return
        began = time.monotonic()
        done = subprocess.run([binary, *words, "--quiet"], cwd=folder, capture_output=True, text=True)
        took[command] = time.monotonic() - began
        if done.returncode not in (0, 1):
            sys.exit(f"tautline {command}\n{done.stderr}")

    names = make(run, a.full)
    check = Checks()
    with sync_playwright() as playwright:
        browser = launched(playwright, chromium)
        for name in names:
            path = folder / name / "report.html"
            every_page(browser, name, path, check)
            if not name.startswith("full"):
                pictures(browser, name, path, a.write, check)
        page = lambda name: folder / name / "report.html"
        size = page("evaluate").stat().st_size
        check(f"evaluate: six trials in {SIX_TRIALS_BYTES / 1e6} MB", size <= SIX_TRIALS_BYTES, f"{size} bytes")
        for use in (hover, zoom, legend_and_choice, sort, keyboard):
            use(browser, page("evaluate"), check)
        for use in (map_click, map_in_the_dark, terms):
            use(browser, page("diagnose"), check)
        drift(browser, page("batch/fleet"), check)
        browser.close()
    for command, seconds in took.items():
        print(f"{seconds:7.1f} s  tautline {command}")
    sys.exit(check.failed > 0)


if __name__ == "__main__":
    main()
